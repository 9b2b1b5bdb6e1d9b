// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues of which some labels slide. Private to the session.
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/preparation.h"

namespace c3de::session {

/// Each body with labels that slide becomes its pieces, the rest first: of the same tissues, with their share of the
/// count of points (sliding ones have the spacing of the rest in its place when they are built). Fixes, loads and
/// refinements of the body go to the pieces that their regions meet (a force by the voxels of each there), probes and
/// grasps to the nearest piece, contact pairs to all, attachments to the rest. Pieces touch each other with
/// SceneVolume::slideFriction where no pair says another one, and fit as they lie.
/// @param took  reading and masks are added
/// Errors begin with the place in the scene: nothing is left of what slides, or beside it, those of readers.
[[nodiscard]] Expected<void> cutSlides(scene::SceneFile &scene, BodySources &sources, const ProgressFn &progress,
                                       Preparation &took);

/// The voxels of a piece.
[[nodiscard]] PickedVoxels pieceOf(const scene::SceneCut &cut, std::uint8_t piece);

}  // namespace c3de::session
