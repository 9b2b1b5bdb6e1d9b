// SPDX-License-Identifier: Apache-2.0
// Contact of a body's soft tissue with its own rigid tissue. Private to the core.
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace pointbased::detail {

/// The voxels of each static fix as an obstacle for the soft tissue of the body. Contact points that are in them at
/// rest, or that only held phyxels carry, are part of them. Only for lattices: contact points of clouds are chosen
/// again with every renewed reference.
[[nodiscard]] std::vector<Obstacle> rigidTissuesOf(const Body &body);

/// Depth of the displayed skin in voxels of these fixes, m; skin that is part of them is not counted.
/// @param skin  scratch
[[nodiscard]] double depthInRigidTissue(const Body &body, std::vector<Vec3> &skin, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
