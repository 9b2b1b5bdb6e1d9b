// SPDX-License-Identifier: Apache-2.0
// Draft: stiffness from measured curves, for simulators that answer iface/identification.h.
#pragma once

#include "c3de/abi/iface/identification.h"
#include "c3de/sdk/ids.hpp"
#include "c3de/sdk/structs.hpp"

namespace c3de::sdk {

template <>
inline constexpr std::string_view kTableId<c3de_identification_v0>{C3DE_IFACE_IDENTIFICATION_ID};

namespace detail {

template <>
struct MinimumSize<c3de_fit_request> {
  static constexpr std::uint64_t value = 80;
  static constexpr const char *name = "c3de_fit_request";
};
template <>
struct MinimumSize<c3de_fit_result> {
  static constexpr std::uint64_t value = 40;
  static constexpr const char *name = "c3de_fit_result";
};
template <>
struct MinimumSize<c3de_sensitivity_request> {
  static constexpr std::uint64_t value = 32;
  static constexpr const char *name = "c3de_sensitivity_request";
};

}  // namespace detail
}  // namespace c3de::sdk
