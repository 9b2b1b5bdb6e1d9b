// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/imaging/still.h"
#include "c3de/scene/materials.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// What a scene or a person wants to stay, for one image. Automatic: bone and air of a computed tomography, by
/// Hounsfield units (also one whose file does not say its unit, but that has air of less than -900), and labels of what
/// is proposed as rigid (MaterialPreset::isRigid).
/// @param labels  null: none; then labels are not asked for
/// Errors: usage, a label that the map does not have, with those it has.
[[nodiscard]] Expected<imaging::StillRule> stillRuleOf(const scene::SceneStill &wanted, const imaging::Volume &image,
                                                       const imaging::LabelMap *labels,
                                                       const scene::MaterialLibrary &materials);

}  // namespace c3de::session
