// SPDX-License-Identifier: Apache-2.0
// Tissues that are told by values of images and by distances. Private to the session.
#pragma once

#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/masks.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

class BodySources;

/// Takes voxels off that lie outside of a region of the scan.
void keepWithin(const scene::SceneRegion &region, imaging::Mask &mask);

/// Finds what the rules of a body's tissues take, one after the other, of what labels of tissues and rules before them
/// leave: gives those tissues a label each, in a layer behind the others, and the volume all layers.
/// @param layers  of the label map, whose labels the other tissues have; empty: no tissue asks for labels
/// Errors begin with the place in the scene: files that cannot be read, a rule that takes nothing, cancelled.
[[nodiscard]] Expected<void> applyRules(const scene::SceneFile &scene, scene::SceneBody &body,
                                        std::vector<imaging::LabelMap> layers, BodySources &sources,
                                        const ProgressFn &progress);

}  // namespace c3de::session
