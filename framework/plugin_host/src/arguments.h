// SPDX-License-Identifier: Apache-2.0
// Checked reading of what plugins pass: texts, growable structs, arrays. Each function throws Refusal that names the
// argument, the value and what is accepted.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "c3de/abi/base.h"
#include "c3de/core/first_size.h"
#include "c3de/core/handle.h"
#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "c3de/core/vec.h"
#include "refusal.h"

namespace c3de::plugin_host {

using Vec3f = std::array<float, 3>;

inline constexpr std::size_t kLongestText = std::size_t{1} << 20;

/// A copy; UTF-8 of at most kLongestText bytes.
[[nodiscard]] std::string textOf(c3de_str text, const char *name);
/// Same as textOf(), for text that is displayed and not looked up: contains no terminal control sequences.
[[nodiscard]] std::string labelOf(c3de_str text, const char *name, Lines lines = Lines::one);
/// A copy; 1 to 200 letters, digits and . _ - / characters.
[[nodiscard]] std::string idOf(c3de_str text, const char *name);

template <class T>
T *requireNonNull(T *pointer, const char *name) {
  if (!pointer) throw Refusal(C3DE_E_ARG, std::string(name) + " is null");
  return pointer;
}

/// A larger stride is invalid data, not that of a newer plugin.
inline constexpr std::uint64_t kLargestStride = 65536;
[[noreturn]] void refuseStride(const char *name, std::uint64_t stride, std::uint64_t least, std::uint64_t alignment);

/// Refuses a struct smaller than its first revision.
template <class T>
void requireSize(const T *in, const char *name) {
  if (const std::string problem = sizeProblem(requireNonNull(in, name)); !problem.empty())
    throw Refusal(C3DE_E_ARG, std::string(name) + ": " + problem);
}

/// The members known to both sides; members beyond the caller's size are zero. Refused below the first size.
template <class T>
[[nodiscard]] T structOf(const T *in, const char *name) {
  requireSize(in, name);
  std::uint32_t size = 0;
  std::memcpy(&size, in, sizeof size);
  T copy{};
  std::memcpy(&copy, in, std::min<std::size_t>(size, sizeof(T)));
  return copy;
}

/// Same as structOf(), for structs whose functions will be called: every slot of their stated revision must be set.
template <class T>
[[nodiscard]] T tableOf(const T *in, const char *name) {
  const T copy = structOf(in, name);
  if (const std::string problem = tableProblem(&copy); !problem.empty()) throw Refusal(C3DE_E_ARG, problem);
  return copy;
}

/// Writes as much as fits into the caller's struct and leaves its size unchanged.
template <class T>
void writeStruct(T *out, T value, const char *name) {
  requireSize(out, name);
  const std::uint32_t size = out->size;
  value.size = size;
  std::memcpy(out, &value, std::min<std::size_t>(size, sizeof(T)));
}

/// Distance between the structs of an array: 0 means contiguous, in the size stated by the caller.
template <class T>
[[nodiscard]] std::uint64_t strideOf(const T *first, std::uint64_t stride, const char *name) {
  std::uint32_t size = 0;
  std::memcpy(&size, first, sizeof size);
  const std::uint64_t step = stride == 0 ? size : stride;
  if (step < MinimumSize<T>::value || step > kLargestStride || step % alignof(T) != 0)
    refuseStride(name, stride, MinimumSize<T>::value, alignof(T));
  return step;
}

inline void writeHandle(c3de_handle *out, Handle handle) { out->v = handle.bits(); }
/// For messages: its number and, if known, its kind.
[[nodiscard]] std::string textOf(c3de_handle handle);
[[nodiscard]] inline Handle handleOf(c3de_handle handle) { return Handle::fromBits(handle.v); }

[[nodiscard]] double finiteOf(double value, const char *name);
[[nodiscard]] Vec3 pointOf(const double *three, const char *name);

/// Layout of the rows of a view. Checks that dtype is accepted and that comps, data, stride and count are plausible.
struct RowLayout {
  const unsigned char *data;
  std::size_t count;
  std::size_t stride;
};
[[nodiscard]] RowLayout layoutOf(const c3de_view &view, const char *name, std::uint32_t comps,
                                 std::initializer_list<std::uint32_t> dtypes);

/// f32 or f64, comps 3, finite.
[[nodiscard]] std::vector<Vec3> positionsOf(const c3de_view &view, const char *name);
[[nodiscard]] std::vector<Vec3f> floatPositionsOf(const c3de_view &view, const char *name);
/// u32, comps 3, every index below vertexCount; at least one.
[[nodiscard]] std::vector<Triangle> trianglesOf(const c3de_view &view, const char *name, std::size_t vertexCount);
/// f32 or f64, comps 1, not NaN.
[[nodiscard]] std::vector<double> numbersOf(const c3de_view &view, const char *name);

/// f64 rows of 3, without a copy if they are contiguous and aligned.
class PointRows {
 public:
  PointRows(const c3de_view &view, const char *name);
  [[nodiscard]] std::span<const Vec3> rows() const { return rows_; }

 private:
  std::vector<Vec3> copy_;
  std::span<const Vec3> rows_;
};

/// Destination of results with one number per row of `input`: the same number of rows, none of which overlaps the
/// input.
[[nodiscard]] RowLayout outputLayoutOf(const c3de_mview &view, const char *name, const c3de_view &input,
                                       std::uint32_t dtype = C3DE_F64);

}  // namespace c3de::plugin_host
