// SPDX-License-Identifier: Apache-2.0
// Borrowed arrays: from spans into c3de_view, and back with checks.
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "c3de/sdk/result.hpp"

namespace c3de::sdk {

using Vec3 = std::array<double, 3>;

/// C3DE_F32 … of a number type.
template <class T>
inline constexpr std::uint32_t kDtype = [] {
  using N = std::remove_cv_t<T>;
  if constexpr (std::is_same_v<N, float>)
    return C3DE_F32;
  else if constexpr (std::is_same_v<N, double>)
    return C3DE_F64;
  else if constexpr (std::is_same_v<N, std::uint8_t>)
    return C3DE_U8;
  else if constexpr (std::is_same_v<N, std::int32_t>)
    return C3DE_I32;
  else if constexpr (std::is_same_v<N, std::uint32_t>)
    return C3DE_U32;
  else if constexpr (std::is_same_v<N, std::uint64_t>)
    return C3DE_U64;
  else
    return 0u;
}();

[[nodiscard]] constexpr std::uint64_t dtypeSize(std::uint32_t dtype) noexcept {
  switch (dtype) {
    case C3DE_U8: return 1;
    case C3DE_F32:
    case C3DE_I32:
    case C3DE_U32: return 4;
    case C3DE_F64:
    case C3DE_U64: return 8;
    default: return 0;
  }
}

/// Rows of N numbers T that begin at each element of the span: rows<double, 3>(positions) for any 3-vector type whose
/// first bytes are its numbers.
template <class T, std::uint32_t N, class Row, std::size_t Extent>
[[nodiscard]] c3de_view rows(std::span<Row, Extent> values) noexcept {
  static_assert(kDtype<T> != 0, "one of float, double, uint8, int32, uint32, uint64");
  static_assert(sizeof(Row) >= N * sizeof(T) && std::is_trivially_copyable_v<std::remove_cv_t<Row>>);
  return {values.data(), values.size(), N, kDtype<T>, static_cast<std::int64_t>(sizeof(Row))};
}
template <class T, std::uint32_t N, class Container>
[[nodiscard]] c3de_view rows(const Container &values) noexcept {
  return rows<T, N>(std::span(values));
}
/// The same, writable.
template <class T, std::uint32_t N, class Row, std::size_t Extent>
[[nodiscard]] c3de_mview mutableRows(std::span<Row, Extent> values) noexcept {
  static_assert(!std::is_const_v<Row>);
  static_assert(sizeof(Row) >= N * sizeof(T) && std::is_trivially_copyable_v<Row>);
  return {values.data(), values.size(), N, kDtype<T>, static_cast<std::int64_t>(sizeof(Row))};
}

/// One number per row.
template <class T>
[[nodiscard]] c3de_view scalars(std::span<const T> values) noexcept {
  return rows<T, 1>(values);
}

/// Rows as the host or another plugin lent them; row i begins at operator[](i) and need not be tight.
template <class T, std::uint32_t N>
class Rows {
 public:
  using Byte = std::conditional_t<std::is_const_v<T>, const unsigned char, unsigned char>;
  Rows() noexcept = default;
  Rows(T *data, std::size_t count, std::ptrdiff_t stride) noexcept
      : data_(reinterpret_cast<Byte *>(data)), count_(count), stride_(stride) {}
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] T *operator[](std::size_t i) const noexcept {
    return reinterpret_cast<T *>(data_ + static_cast<std::ptrdiff_t>(i) * stride_);
  }

 private:
  Byte *data_ = nullptr;
  std::size_t count_ = 0;
  std::ptrdiff_t stride_ = 0;
};

namespace detail {
template <class View>
[[nodiscard]] Result<void> checkView(const View &view, std::uint32_t comps, std::string_view what) {
  const std::string name(what);
  const std::uint64_t element = dtypeSize(view.dtype);
  if (element == 0) return Failure{C3DE_E_ARG, name + ": dtype " + std::to_string(view.dtype) + " is not known"};
  if (view.comps != comps)
    return Failure{C3DE_E_ARG,
                   name + ": " + std::to_string(view.comps) + " numbers per row, expected " + std::to_string(comps)};
  if (view.count > 0 && !view.data) return Failure{C3DE_E_ARG, name + ": data is null"};
  if (view.stride != 0 && view.stride < static_cast<std::int64_t>(comps * element))
    return Failure{C3DE_E_ARG, name + ": stride " + std::to_string(view.stride) + " is below the row's " +
                                   std::to_string(comps * element) + " bytes"};
  if (view.stride % static_cast<std::int64_t>(element) != 0 ||
      reinterpret_cast<std::uintptr_t>(view.data) % element != 0)
    return Failure{C3DE_E_ARG, name + ": rows are not aligned to " + std::to_string(element) + " bytes"};
  return {};
}
}  // namespace detail

/// Checks a view and gives its rows without copying. `what` names it in the failure.
template <class T, std::uint32_t N>
[[nodiscard]] Result<Rows<const T, N>> asRows(const c3de_view &view, std::string_view what) {
  if (auto checked = detail::checkView(view, N, what); !checked) return checked.failure();
  if (view.dtype != kDtype<T>)
    return Failure{C3DE_E_ARG, std::string(what) + ": dtype " + std::to_string(view.dtype) + ", expected " +
                                   std::to_string(kDtype<T>)};
  return Rows<const T, N>(static_cast<const T *>(view.data), static_cast<std::size_t>(view.count),
                          view.stride ? static_cast<std::ptrdiff_t>(view.stride) : std::ptrdiff_t{N * sizeof(T)});
}
template <class T, std::uint32_t N>
[[nodiscard]] Result<Rows<T, N>> asMutableRows(const c3de_mview &view, std::string_view what) {
  if (auto checked = detail::checkView(view, N, what); !checked) return checked.failure();
  if (view.dtype != kDtype<T>)
    return Failure{C3DE_E_ARG, std::string(what) + ": dtype " + std::to_string(view.dtype) + ", expected " +
                                   std::to_string(kDtype<T>)};
  return Rows<T, N>(static_cast<T *>(view.data), static_cast<std::size_t>(view.count),
                    view.stride ? static_cast<std::ptrdiff_t>(view.stride) : std::ptrdiff_t{N * sizeof(T)});
}

/// Copies positions (f32 or f64, comps 3) into doubles.
[[nodiscard]] inline Result<std::vector<Vec3>> readVec3(const c3de_view &view, std::string_view what) {
  std::vector<Vec3> out;
  if (view.dtype == C3DE_F32) {
    auto in = asRows<float, 3>(view, what);
    if (!in) return in.failure();
    out.resize(in->size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {(*in)[i][0], (*in)[i][1], (*in)[i][2]};
  } else {
    auto in = asRows<double, 3>(view, what);
    if (!in) return in.failure();
    out.resize(in->size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {(*in)[i][0], (*in)[i][1], (*in)[i][2]};
  }
  return out;
}

/// Copies index rows (u32, comps 3).
[[nodiscard]] inline Result<std::vector<std::array<std::uint32_t, 3>>> readTriangles(const c3de_view &view,
                                                                                     std::string_view what) {
  auto in = asRows<std::uint32_t, 3>(view, what);
  if (!in) return in.failure();
  std::vector<std::array<std::uint32_t, 3>> out(in->size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {(*in)[i][0], (*in)[i][1], (*in)[i][2]};
  return out;
}

}  // namespace c3de::sdk
