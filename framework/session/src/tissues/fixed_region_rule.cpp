// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/fixed_region_rule.h"

#include <algorithm>

#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/imaging/statistics.h"
#include "c3de/scene/material_names.h"

namespace c3de::session {
namespace {

constexpr double kBone_HU = 200.0, kAir_HU = -400.0;  // soft tissue is between them
constexpr double kMinOfTomography = -900.0;

}  // namespace

Expected<imaging::FixedRegionRule> fixedRegionRuleOf(const scene::SceneFixedRegions &wanted,
                                                     const imaging::Volume &image, const imaging::LabelMap *labels,
                                                     const scene::MaterialLibrary &materials) {
  imaging::FixedRegionRule rule;
  rule.outside = wanted.outside;
  if (rule.outside) return rule;
  rule.above = wanted.above;
  rule.below = wanted.below;
  if (wanted.isAutomatic) {
    if (image.unit == "HU" || (image.unit.empty() && imaging::robustRange(image).min <= kMinOfTomography)) {
      rule.above = kBone_HU;
      rule.below = kAir_HU;
    }
    for (std::size_t i = 0; labels != nullptr && i < labels->labels.size(); ++i) {
      const scene::MaterialPreset *preset = scene::presetForOrgan(materials, labels->labels[i].name);
      if (preset != nullptr && preset->isRigid) rule.labels.push_back(labels->labels[i].value);
    }
  }
  if (labels == nullptr) return rule;
  for (const std::string &name : wanted.labels) {
    const std::size_t before = rule.labels.size();
    std::vector<std::string> names;
    for (const imaging::LabelMap::Label &label : labels->labels) {
      if (imaging::matchesLabel(name, label)) rule.labels.push_back(label.value);
      names.push_back(label.name);
    }
    if (rule.labels.size() > before) continue;
    const std::string nearest = nearestName(name, names);
    std::string known;
    for (const std::string &one : names) known += (known.empty() ? "" : ", ") + one;
    return fail(ErrorCode::usage, "still: there is no label '" + name + "'; " +
                                      (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                      "there are: " + (known.empty() ? "none" : known));
  }
  return rule;
}

}  // namespace c3de::session
