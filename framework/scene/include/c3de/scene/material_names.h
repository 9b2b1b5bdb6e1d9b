// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "c3de/scene/materials.h"

namespace c3de::scene {

/// What the name of a label is known as. Labels of one `name` are one tissue.
struct NamedTissue {
  std::string_view name;                   ///< for people: "kidney", "bone", "air"
  const MaterialPreset *preset = nullptr;  ///< of the library; null: it is empty (air)
  std::string_view remark{};               ///< what is assumed where the tissue has no preset of its own; else empty

  [[nodiscard]] bool isEmpty() const { return preset == nullptr; }
  [[nodiscard]] bool isRigid() const { return preset != nullptr && preset->isRigid; }
};

/// The tissue of what a label map calls by a name: "kidney_left", "Left Kidney" -> kidney, "vertebrae_L1" -> bone,
/// "Left-Lateral-Ventricle" -> fluid, "trachea" -> air. It knows the classes of TotalSegmentator, the usual
/// parcellations of brains (FreeSurfer, SynthSeg, FAST, SPM), and plain words. By whole words, upper and lower case
/// alike; a preset's own name is that preset. What has a word of its own in the name (lesion, cyst, implant, …) is not
/// the organ. None: it is not known, or its preset is not in the library.
[[nodiscard]] std::optional<NamedTissue> tissueOf(const MaterialLibrary &materials, std::string_view label);

/// Its preset; null: it is not known, or empty.
[[nodiscard]] const MaterialPreset *presetForOrgan(const MaterialLibrary &materials, std::string_view organ);

/// What to say of a name that is not known: what is accepted, and the nearest that is known.
[[nodiscard]] std::string unknownTissue(std::string_view label);

}  // namespace c3de::scene
