// SPDX-License-Identifier: Apache-2.0
// Draft: bodies matched to measured points, for simulators that answer iface/matching.h.
#pragma once

#include "c3de/abi/iface/matching.h"
#include "c3de/sdk/ids.hpp"
#include "c3de/sdk/structs.hpp"

namespace c3de::sdk {

template <>
inline constexpr std::string_view kTableId<c3de_matching_v0>{C3DE_IFACE_MATCHING_ID};

namespace detail {

template <>
struct MinimumSize<c3de_match_landmark> {
  static constexpr std::uint64_t value = 64;
  static constexpr const char *name = "c3de_match_landmark";
};
template <>
struct MinimumSize<c3de_match_request> {
  static constexpr std::uint64_t value = 184;
  static constexpr const char *name = "c3de_match_request";
};
template <>
struct MinimumSize<c3de_match_result> {
  static constexpr std::uint64_t value = 272;
  static constexpr const char *name = "c3de_match_result";
};

}  // namespace detail
}  // namespace c3de::sdk
