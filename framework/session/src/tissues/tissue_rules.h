// SPDX-License-Identifier: Apache-2.0
// Tissues defined by image values and distances. Private to the session.
#pragma once

#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

class BodySources;

/// Determines the voxels that the rules of a body's tissues select, in order, from those that labels of tissues and
/// earlier rules leave. Assigns each of these tissues a label in a layer after the others, and stores all layers in the
/// volume.
/// @param layers  of the label map, with the labels of the other tissues; empty: no tissue uses labels
/// Errors begin with the location in the scene: files that cannot be read, a rule that selects nothing, cancelled.
[[nodiscard]] Expected<void> applyRules(const scene::SceneFile &scene, scene::SceneBody &body,
                                        std::vector<imaging::LabelMap> layers, BodySources &sources,
                                        const ProgressFn &progress);

}  // namespace c3de::session
