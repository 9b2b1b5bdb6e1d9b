// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/imaging/displacement.h"

namespace c3de::session {

/// A scalar quantity that a simulator provides at each of its points.
struct PointField {
  std::string name, unit;
  friend bool operator==(const PointField &, const PointField &) = default;
};

/// The tissue fields requested for an image.
struct RequestedFields {
  bool any = false;  ///< det F and the field; otherwise nothing
  std::string name;  ///< of a PointField; empty: the first
  friend bool operator==(const RequestedFields &, const RequestedFields &) = default;
};

/// The fields of all bodies, in the order of the simulator; without mass and volume, which describe points and not
/// tissue. [sim]
[[nodiscard]] std::vector<PointField> pointFields(const c3de_simulator_v1 *table, c3de_object *simulator);
/// Resamples the fields to the grid of a displacement. Fields that the simulator does not provide are omitted. [sim]
void addFields(const c3de_simulator_v1 *table, c3de_object *simulator, const RequestedFields &wanted,
               imaging::DisplacementGrid &grid);

}  // namespace c3de::session
