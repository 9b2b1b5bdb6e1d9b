// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues with sliding labels. Private to the session.
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/preparation.h"

namespace c3de::session {

/// Replaces each body with sliding labels by its pieces, the rest first. The pieces have the same tissues and a share
/// of the point count (when built, sliding ones use the spacing of the rest instead). Fixes, loads and refinements of
/// the body apply to the pieces that their regions meet (a force is divided by the voxels of each piece there), probes
/// and grasps to the nearest piece, contact pairs to all, attachments to the rest. Pieces touch each other with
/// SceneVolume::slidingFriction unless a pair specifies another value, and are assumed to fit in their initial positions.
/// @param took  the time for reading and masks is added
/// Errors begin with the location in the scene: no voxel remains of a sliding label or of the rest, and those of
/// readers.
[[nodiscard]] Expected<void> cutSlidingParts(scene::SceneFile &scene, BodySources &sources, const ProgressFn &progress,
                                             Preparation &took);

}  // namespace c3de::session
