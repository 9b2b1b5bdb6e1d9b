// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/geometry/vtk_writer.h"

namespace c3de::session {

/// The state of a body for exchange with other programs: LPS millimetres, arrays named with their units.
struct BodyState {
  std::string name;
  /// The points that carry the mass: "displacement [mm]", then the fields of the simulator, "name [unit]".
  geometry::PointCloud inside;
  geometry::TriangleMesh skin;                   ///< at present; no triangles where the simulator lends none
  std::vector<geometry::PointArray> skinArrays;  ///< "displacement [mm]"
};

enum class BodyParts { skin, skinAndInside };

/// The present state of every body, in the order of the simulator. Call on the thread that steps it, between two steps.
/// @param takeError  returns the text of the last failed call; may be empty. Errors: ErrorCode::plugin.
[[nodiscard]] Expected<std::vector<BodyState>> readBodyStates(c3de_object *simulator, BodyParts parts,
                                                              const std::function<std::string()> &takeError);

}  // namespace c3de::session
