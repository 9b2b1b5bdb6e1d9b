// SPDX-License-Identifier: Apache-2.0
// Ids of the tables of point_sets.h, for sdk::Ref::query.
#pragma once

#include <c3de/sdk/ids.hpp>

#include "point_sets.h"

namespace c3de::sdk {

template <>
inline constexpr std::string_view kTableId<c3de_phyxel_set_v1>{C3DE_POINTBASED_PHYXEL_SET_ID};
template <>
inline constexpr std::string_view kTableId<c3de_surfel_set_v1>{C3DE_POINTBASED_SURFEL_SET_ID};
template <>
inline constexpr std::string_view kTableId<c3de_pointbased_bodies_v1>{C3DE_POINTBASED_BODIES_ID};

}  // namespace c3de::sdk
