// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

struct PresentBodies {
  imaging::WorldBox box;    ///< around the skins of the bodies
  double spacing_mm = 0.0;  ///< the finest of all bodies
};
/// [sim]
[[nodiscard]] PresentBodies presentBodies(const c3de_simulator_v1 *table, c3de_object *simulator);
/// The bodies in the reference configuration, on the grid of an image: kBodyVoxel and, for rigid tissue, kRigidVoxel.
/// Null where the simulator lends no skins, or memory is insufficient.
/// @param tissues  of the bodies with a tissue map, whose voxels are used instead of their skins; null: there are none
/// [sim]
[[nodiscard]] std::shared_ptr<imaging::Mask> referenceBodies(c3de_object *simulator,
                                                             const imaging::VolumeGeometry &image,
                                                             const std::vector<TissueVoxels> *tissues = nullptr);
/// Reads displacements and gaps. False where the simulator does not provide them, or fails. [sim]
[[nodiscard]] bool readDisplacement(const c3de_simulator_v1 *table, c3de_object *simulator, double rim_mm,
                                    imaging::DisplacementGrid &grid);

}  // namespace c3de::session
