// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "c3de/scene/materials.h"

namespace c3de::scene {

/// The tissue that the name of a label denotes. Labels with the same `name` are one tissue.
struct NamedTissue {
  std::string_view name;                   ///< display name: "kidney", "bone", "air"
  const MaterialPreset *preset = nullptr;  ///< in the library; null: empty (air)
  std::string_view remark{};               ///< the assumption where the tissue has no own preset; otherwise empty

  [[nodiscard]] bool isEmpty() const { return preset == nullptr; }
  [[nodiscard]] bool isRigid() const { return preset != nullptr && preset->isRigid; }
};

/// The tissue denoted by the name of a label: "kidney_left", "Left Kidney" -> kidney, "vertebrae_L1" -> bone,
/// "Left-Lateral-Ventricle" -> fluid, "trachea" -> air. Covers the classes of TotalSegmentator, the usual brain
/// parcellations (FreeSurfer, SynthSeg, FAST, SPM), and plain words. Matches whole words, case-insensitively; the name
/// of a preset denotes that preset. A name with a word for something else (lesion, cyst, implant, …) does not denote
/// the organ. None: unknown, or its preset is not in the library.
[[nodiscard]] std::optional<NamedTissue> tissueOf(const MaterialLibrary &materials, std::string_view label);

/// The preset of that tissue; null: unknown, or empty.
[[nodiscard]] const MaterialPreset *presetForOrgan(const MaterialLibrary &materials, std::string_view organ);

/// Message about an unknown name: what is accepted, and the nearest known name.
[[nodiscard]] std::string unknownTissue(std::string_view label);

}  // namespace c3de::scene
