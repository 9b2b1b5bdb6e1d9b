// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/imaging/masks.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// Removes voxels outside a region of the scan.
void keepWithin(const scene::SceneRegion &region, imaging::Mask &mask);

}  // namespace c3de::session
