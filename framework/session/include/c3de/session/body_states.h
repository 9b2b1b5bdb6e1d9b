// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/draft/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/geometry/vtk_writer.h"

namespace c3de::session {

/// What can be said of a body to other programs: LPS millimetres, arrays named with their units.
struct BodyState {
  std::string name;
  /// "displacement [mm]", "velocity [m/s]", "mass [kg]", "volume [m^3]" (at rest), "deformation_gradient [1]",
  /// "strain_green [1]", "stress_pk2 [Pa]", "stress_vm [Pa]" (von Mises, of the Cauchy stress); without those that the
  /// simulator does not offer.
  geometry::PointCloud phyxels;
  geometry::TriangleMesh skin;                   ///< as it lies now; without triangles where the simulator lends none
  std::vector<geometry::PointArray> skinArrays;  ///< "displacement [mm]"
};

enum class BodyParts { skin, skinAndPhyxels };

/// The present state of every body, in the order of the simulator. On the thread that steps it, between two steps.
/// @param takeError  the text that the last failing call left; may be empty. Errors: ErrorCode::plugin.
[[nodiscard]] Expected<std::vector<BodyState>> readBodyStates(c3de_object *simulator, BodyParts parts,
                                                              const std::function<std::string()> &takeError);

}  // namespace c3de::session
