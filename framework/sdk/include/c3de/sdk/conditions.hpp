// SPDX-License-Identifier: Apache-2.0
// Draft: supports and loads set while a simulation runs, for simulators that answer iface/conditions.h.
#pragma once

#include "c3de/abi/iface/conditions.h"
#include "c3de/sdk/ids.hpp"
#include "c3de/sdk/structs.hpp"

namespace c3de::sdk {

template <>
inline constexpr std::string_view kTableId<c3de_conditions_v0>{C3DE_IFACE_CONDITIONS_ID};

namespace detail {

template <>
struct MinimumSize<c3de_sim_condition> {
  static constexpr std::uint64_t value = 112;
  static constexpr const char *name = "c3de_sim_condition";
};
template <>
struct MinimumSize<c3de_sim_condition_state> {
  static constexpr std::uint64_t value = 40;
  static constexpr const char *name = "c3de_sim_condition_state";
};

}  // namespace detail
}  // namespace c3de::sdk
