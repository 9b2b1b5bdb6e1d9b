// SPDX-License-Identifier: Apache-2.0
// What others hand over by pointer: structs that may be shorter than those of today, and places for results.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "c3de/abi/c3de.h"
#include "c3de/abi/first_sizes.h"
#include "c3de/sdk/result.hpp"

namespace c3de::sdk {

/// What a caller points to. Throws Error (C3DE_E_ARG) where he does not.
template <class T>
[[nodiscard]] T &notNull(T *pointer, const char *name) {
  if (!pointer) throw Error(C3DE_E_ARG, std::string(name) + " is null");
  return *pointer;
}

namespace detail {

template <class T>
struct MinimumSize;

#define C3DE_SDK_FIRST_SIZE(T, bytes)                             \
  template <>                                                     \
  struct MinimumSize<T> {                                         \
    static constexpr std::uint64_t value = bytes;                 \
    static constexpr const char *name = #T;                       \
    static_assert(sizeof(void *) != 8 || sizeof(T) >= bytes, #T); \
  };

C3DE_FIRST_SIZES(C3DE_SDK_FIRST_SIZE)

#undef C3DE_SDK_FIRST_SIZE

/// The size that a struct says; refused below that of its first revision.
template <class T>
[[nodiscard]] std::uint32_t sizeOrThrow(const T *in, const std::string &name) {
  std::uint32_t size = 0;
  std::memcpy(&size, &notNull(in, name.c_str()), sizeof size);
  if (size < MinimumSize<T>::value)
    throw Error(C3DE_E_ARG, name + ": its member size is " + std::to_string(size) + ", needed are at least " +
                                std::to_string(MinimumSize<T>::value) + " (" + MinimumSize<T>::name + ")");
  return size;
}

}  // namespace detail

/// A copy of a struct that begins with its size; members that the caller does not know are zero. Throws Error
/// (C3DE_E_ARG), also where it is smaller than its first revision.
/// @param name  for the message
template <class T>
[[nodiscard]] T readStruct(const T *in, const std::string &name) {
  const std::uint32_t size = detail::sizeOrThrow(in, name);
  T value{};
  std::memcpy(&value, in, std::min<std::size_t>(size, sizeof value));
  return value;
}

/// The same of element i of an array with a stride in bytes (0: tight, in the size of the other side).
template <class T>
[[nodiscard]] T readElement(const T *first, std::uint64_t i, std::uint64_t stride, const std::string &name) {
  const std::uint64_t step = stride != 0 ? stride : detail::sizeOrThrow(first, name + " 0");
  if (step < detail::MinimumSize<T>::value)
    throw Error(C3DE_E_ARG, name + ": the stride is " + std::to_string(step) + ", needed are at least " +
                                std::to_string(detail::MinimumSize<T>::value) + " (" + detail::MinimumSize<T>::name +
                                ")");
  const auto *at = reinterpret_cast<const unsigned char *>(&notNull(first, name.c_str())) + i * step;
  return readStruct(reinterpret_cast<const T *>(at), name + " " + std::to_string(i));
}

/// As many members as the caller knows; `size` stays as he has set it. Throws Error (C3DE_E_ARG) as readStruct().
template <class T>
void writeStruct(T *out, const T &value, const std::string &name) {
  const std::uint32_t size = detail::sizeOrThrow(out, name);
  std::memcpy(out, &value, std::min<std::size_t>(size, sizeof value));
  out->size = size;
}

}  // namespace c3de::sdk
