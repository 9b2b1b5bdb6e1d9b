// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "c3de/abi/c3de.h"
#include "c3de/abi/first_sizes.h"

namespace c3de {

/// The minimum size of a struct passed by a plugin, and its name. A struct without a specialisation does not compile.
template <class T>
struct MinimumSize;

#define C3DE_FIRST_SIZE(T, bytes)                                 \
  template <>                                                     \
  struct MinimumSize<T> {                                         \
    static constexpr std::size_t value = bytes;                   \
    static constexpr const char *name = #T;                       \
    static_assert(sizeof(void *) != 8 || sizeof(T) >= bytes, #T); \
  };

C3DE_FIRST_SIZES(C3DE_FIRST_SIZE)

#undef C3DE_FIRST_SIZE

/// "its member size is 4; at least 24 is required (c3de_material)"
[[nodiscard]] std::string sizeProblem(std::uint64_t size, std::size_t least, const char *type);

/// Why a struct cannot be read or written; empty: it can.
template <class T>
[[nodiscard]] std::string sizeProblem(const T *in) {
  if (in == nullptr) return "is null";
  std::uint32_t size = 0;
  std::memcpy(&size, in, sizeof size);
  return size < MinimumSize<T>::value ? sizeProblem(size, MinimumSize<T>::value, MinimumSize<T>::name) : std::string();
}

/// Same for an array; a stride of 0 means contiguous elements of the size stated by the other side.
template <class T>
[[nodiscard]] std::string arrayProblem(const T *first, std::uint64_t n, std::uint64_t stride) {
  if (n == 0) return {};
  if (std::string problem = sizeProblem(first); !problem.empty()) return problem;
  std::uint32_t size = 0;
  std::memcpy(&size, first, sizeof size);
  const std::uint64_t step = stride != 0 ? stride : size;
  if (step < MinimumSize<T>::value)
    return "of the stride, " + sizeProblem(step, MinimumSize<T>::value, MinimumSize<T>::name);
  const auto *bytes = reinterpret_cast<const unsigned char *>(first);
  for (std::uint64_t i = 1; i < n; ++i)
    if (std::string problem = sizeProblem(reinterpret_cast<const T *>(bytes + i * step)); !problem.empty())
      return "element " + std::to_string(i) + ": " + problem;
  return {};
}

}  // namespace c3de
