// SPDX-License-Identifier: Apache-2.0
#include "logic/tissue_choice.h"

#include <algorithm>
#include <array>
#include <utility>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/text.h"

namespace c3de::ui {
namespace {

const ParameterValue *valueOf(const registry::ParameterSet &set, const std::string &id) {
  for (std::size_t i = 0; i < set.decls.size() && i < set.values.size(); ++i)
    if (set.decls[i].id == id) return &set.values[i];
  return nullptr;
}

bool isOf(const registry::ParameterSet &set, const scene::MaterialPreset &preset) {
  const std::vector<ParameterValue> wanted = tissueValues(set, preset);
  return !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), [&](const ParameterValue &value) {
    const ParameterValue *now = valueOf(set, value.id);
    return now && now->type != C3DE_PARAM_TEXT && now->num == value.num;
  });
}

}  // namespace

std::string TissueChoice::texts() const {
  std::string all;
  for (const std::string &name : names) all += name + '\n';
  return all;
}

std::vector<ParameterValue> tissueValues(const registry::ParameterSet &set, const scene::MaterialPreset &preset) {
  const std::array<std::pair<const char *, double>, 5> all{
      {{C3DE_PARAM_ID_DENSITY, preset.density},
       {C3DE_PARAM_ID_YOUNGS_MODULUS, preset.youngsModulus},
       {C3DE_PARAM_ID_YOUNGS_MODULUS_LOW, preset.youngsModulusMin},
       {C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH, preset.youngsModulusMax},
       {C3DE_PARAM_ID_POISSON_RATIO, preset.poissonRatio}}};
  std::vector<ParameterValue> values;
  for (const auto &[id, number] : all) {
    if (!valueOf(set, id)) continue;
    ParameterValue value;
    value.id = id;
    value.type = C3DE_PARAM_F64;
    value.num = number;
    values.push_back(std::move(value));
  }
  return values;
}

TissueChoice tissueChoiceOf(const registry::ParameterSet &set, const scene::MaterialLibrary &library) {
  TissueChoice out;
  out.names.emplace_back("custom");
  for (const scene::MaterialPreset &preset : library.presets()) {
    out.names.push_back(preset.name);
    if (out.index == 0 && isOf(set, preset)) out.index = static_cast<std::uint32_t>(out.names.size() - 1);
  }
  out.tooltip = "Sets density, Young's modulus with its range, and Poisson's ratio to literature values";
  if (out.index == 0) return out;
  const scene::MaterialPreset &chosen = library.presets()[out.index - 1];
  out.tooltip += "\n\nYoung's modulus " + formatNumber(1e-3 * chosen.youngsModulusMin) + " … " +
                 formatNumber(1e-3 * chosen.youngsModulusMax) + " kPa\n" + chosen.evidence;
  if (!chosen.source.empty()) out.tooltip += " (" + chosen.source + ")";
  return out;
}

}  // namespace c3de::ui
