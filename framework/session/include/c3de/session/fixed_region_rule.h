// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/imaging/fixed_regions.h"
#include "c3de/scene/materials.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The fixed regions that a scene or a user requests, for one image. Automatic: bone and air of a computed tomography,
/// by Hounsfield units (also for a file that states no unit but has air below -900), and labels that are proposed as
/// rigid (MaterialPreset::isRigid).
/// @param labels  null: none; requested labels are then ignored
/// Errors: usage, a label that the map does not have; lists the available ones.
[[nodiscard]] Expected<imaging::FixedRegionRule> fixedRegionRuleOf(const scene::SceneFixedRegions &wanted,
                                                                   const imaging::Volume &image,
                                                                   const imaging::LabelMap *labels,
                                                                   const scene::MaterialLibrary &materials);

}  // namespace c3de::session
