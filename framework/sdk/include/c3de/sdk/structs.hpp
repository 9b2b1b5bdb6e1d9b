// SPDX-License-Identifier: Apache-2.0
// What others hand over by pointer: structs that may be shorter than those of today, and places for results.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "c3de/sdk/result.hpp"

namespace c3de::sdk {

/// What a caller points to. Throws Error (C3DE_E_ARG) where he does not.
template <class T>
[[nodiscard]] T &notNull(T *pointer, const char *name) {
  if (!pointer) throw Error(C3DE_E_ARG, std::string(name) + " is null");
  return *pointer;
}

/// A copy of a struct that begins with its size; members that the caller does not know are zero. Throws Error
/// (C3DE_E_ARG).
template <class T>
[[nodiscard]] T readStruct(const T *in, const char *name) {
  if (notNull(in, name).size < sizeof in->size) throw Error(C3DE_E_ARG, std::string(name) + " has no size");
  T value{};
  std::memcpy(&value, in, std::min<std::size_t>(in->size, sizeof value));
  return value;
}

/// As many members as the caller knows; `size` stays as he has set it. Throws Error (C3DE_E_ARG).
template <class T>
void writeStruct(T *out, const T &value, const char *name) {
  const std::uint32_t size = notNull(out, name).size;
  if (size < sizeof size) throw Error(C3DE_E_ARG, std::string(name) + " has no size");
  std::memcpy(out, &value, std::min<std::size_t>(size, sizeof value));
  out->size = size;
}

}  // namespace c3de::sdk
