// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/abi/iface/simulator.h"

namespace c3de::scene {

/// A sink that appends a simulator's output to a text, which must outlive it. Reports running out of memory.
[[nodiscard]] inline c3de_sink sinkInto(std::string &text) {
  c3de_sink sink{};
  sink.self = &text;
  sink.put = [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
    try {
      static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
      return C3DE_OK;
    } catch (...) {
      return C3DE_E_NOMEM;
    }
  };
  return sink;
}

}  // namespace c3de::scene
