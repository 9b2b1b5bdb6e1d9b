// SPDX-License-Identifier: Apache-2.0
// Rigid tissue of a body, as its own soft tissue meets it. Private to the core.
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace pointbased::detail {

/// The voxels of each fix that stands still, which soft tissue of the body does not enter; points of contact that lie
/// in them at rest, or that held phyxels alone carry, are part of them. Of lattices: points of contact of clouds are chosen anew with a reference.
[[nodiscard]] std::vector<Obstacle> rigidTissuesOf(const Body &body);

/// How deep the skin, as it is drawn, is in voxels of these fixes, m; skin that is part of them counts for nothing.
/// @param skin  scratch
[[nodiscard]] double depthInRigidTissue(const Body &body, std::vector<Vec3> &skin, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
