// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/materials.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/core/text.h"
#include "c3de/scene/toml_document.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kKeys{
    "density", "youngs_modulus", "youngs_modulus_range", "poisson_ratio", "poisson_ratio_range", "evidence", "source",
    "note",    "rigid"};

/// The error in the preset, if any.
std::optional<std::string> readPreset(const TomlValue &table, MaterialPreset &preset, int &line) {
  const auto number = [&](const char *key, double &out) {
    const TomlValue *value = table.find(key);
    if (value == nullptr || !value->isNumber()) return false;
    out = value->num;
    return true;
  };
  const auto range = [&](const char *key, double &min, double &max) {
    const TomlValue *value = table.find(key);
    if (value == nullptr || !value->isNumbers(2)) return false;
    min = value->items[0].num;
    max = value->items[1].num;
    return true;
  };
  for (const auto &[key, value] : table.entries) {
    line = value.line;
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
      const std::string nearest = nearestName(key, kKeys);
      return "unknown key '" + key + "'" + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
    }
    if (key == "rigid") {
      if (value.kind != TomlValue::Kind::boolean) return "rigid is " + value.kindName() + "; accepted: true, false";
      preset.isRigid = value.num != 0.0;
    }
    if (value.kind != TomlValue::Kind::text) continue;
    if (key == "evidence") preset.evidence = value.text;
    if (key == "source") preset.source = value.text;
    if (key == "note") preset.note = value.text;
  }
  line = table.line;
  if (!number("density", preset.density) || !number("youngs_modulus", preset.youngsModulus) ||
      !number("poisson_ratio", preset.poissonRatio) ||
      !range("youngs_modulus_range", preset.youngsModulusMin, preset.youngsModulusMax) ||
      !range("poisson_ratio_range", preset.poissonRatioMin, preset.poissonRatioMax))
    return "needed are density, youngs_modulus and poisson_ratio as numbers, and youngs_modulus_range and "
           "poisson_ratio_range as [min, max]";
  if (!(preset.density > 0.0) || !std::isfinite(preset.density)) return "density has to be above 0 kg/m³";
  if (!(preset.youngsModulus > 0.0 && preset.youngsModulusMin <= preset.youngsModulus &&
        preset.youngsModulus <= preset.youngsModulusMax))
    return "youngs_modulus has to be above 0 Pa and within its range";
  if (!(preset.poissonRatio > -1.0 && preset.poissonRatio < 0.5 && preset.poissonRatioMin <= preset.poissonRatio &&
        preset.poissonRatio <= preset.poissonRatioMax))
    return "poisson_ratio has to be below 0.5 and within its range";
  return std::nullopt;
}

}  // namespace

Expected<MaterialLibrary> MaterialLibrary::load(const std::filesystem::path &file) {
  const auto text = readTextFile(file);
  if (!text) return tl::unexpected(text.error());
  const auto root = parseToml(*text, file.string());
  if (!root) return tl::unexpected(root.error());
  MaterialLibrary library;
  for (const auto &[name, table] : root->entries) {
    int line = table.line;
    MaterialPreset preset;
    preset.name = name;
    std::optional<std::string> wrong = "'" + name + "' is " + table.kindName() + "; accepted: a table [" + name + "]";
    if (table.kind == TomlValue::Kind::table) wrong = readPreset(table, preset, line);
    if (wrong)
      return fail(ErrorCode::input,
                  file.string() + ":" + std::to_string(line) + ": " + displayMessage(name + ": " + *wrong));
    library.presets_.push_back(std::move(preset));
  }
  return library;
}

const MaterialPreset *MaterialLibrary::find(std::string_view name) const {
  for (const MaterialPreset &preset : presets_)
    if (preset.name == name) return &preset;
  return nullptr;
}

std::vector<std::string> MaterialLibrary::names() const {
  std::vector<std::string> names;
  for (const MaterialPreset &preset : presets_) names.push_back(preset.name);
  return names;
}

}  // namespace c3de::scene
