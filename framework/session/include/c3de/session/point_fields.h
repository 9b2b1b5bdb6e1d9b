// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/imaging/displacement.h"

namespace c3de::session {

/// A quantity of one number that a simulator has at each of its points.
struct PointField {
  std::string name, unit;
  friend bool operator==(const PointField &, const PointField &) = default;
};

/// What of the tissue is wanted in an image.
struct FieldsWanted {
  bool any = false;  ///< det F, and the field; else nothing
  std::string name;  ///< of a PointField; empty: the first
  friend bool operator==(const FieldsWanted &, const FieldsWanted &) = default;
};

/// Those of all bodies, in the order of the simulator; without mass and volume, which tell of points and not of tissue.
/// [sim]
[[nodiscard]] std::vector<PointField> pointFields(const c3de_simulator_v1 *table, c3de_object *simulator);
/// Lays them over the grid of a displacement that was read. What the simulator does not tell is left out. [sim]
void addFields(const c3de_simulator_v1 *table, c3de_object *simulator, const FieldsWanted &wanted,
               imaging::DisplacementGrid &grid);

}  // namespace c3de::session
