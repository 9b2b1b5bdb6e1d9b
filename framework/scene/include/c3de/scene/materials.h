// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::scene {

/// A named tissue: default values, the range found in the literature, and their sources.
struct MaterialPreset {
  std::string name;
  double density = 0.0;                                   ///< kg/m³
  double youngsModulus = 0.0;                             ///< Pa
  double youngsModulusMin = 0.0, youngsModulusMax = 0.0;  ///< Pa
  double poissonRatio = 0.0;
  double poissonRatioMin = 0.0, poissonRatioMax = 0.0;
  bool isRigid = false;  ///< organs of it are proposed as rigid: they do not deform compared with soft tissue
  std::string evidence;  ///< the measurement that the values are based on
  std::string source;
  std::string note;
};

/// The presets that a scene may refer to, in the order of the file (resources/materials.toml).
class MaterialLibrary {
 public:
  /// Errors (ErrorCode::input) name file and line: malformed TOML, a missing or unknown key, a value outside its range.
  [[nodiscard]] static Expected<MaterialLibrary> load(const std::filesystem::path &file);

  /// Null if there is none of that name.
  [[nodiscard]] const MaterialPreset *find(std::string_view name) const;
  [[nodiscard]] const std::vector<MaterialPreset> &presets() const { return presets_; }
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::vector<MaterialPreset> presets_;
};

}  // namespace c3de::scene
