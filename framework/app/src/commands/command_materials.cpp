// SPDX-License-Identifier: Apache-2.0
// `c3de materials`
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "c3de/core/text.h"
#include "c3de/scene/materials.h"
#include "c3de/session/resources.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;
using scene::MaterialPreset;

Json asJson(const MaterialPreset &preset) {
  return {{"name", preset.name},
          {"youngs_modulus_Pa", preset.youngsModulus},
          {"youngs_modulus_range_Pa", {preset.youngsModulusMin, preset.youngsModulusMax}},
          {"poisson_ratio", preset.poissonRatio},
          {"poisson_ratio_range", {preset.poissonRatioMin, preset.poissonRatioMax}},
          {"density_kg_m3", preset.density},
          {"rigid", preset.isRigid},
          {"evidence", preset.evidence},
          {"source", preset.source},
          {"note", preset.note}};
}

std::string inKilopascals(double value) { return fmt::format("{:.4g}", value / 1e3); }

std::string asRow(const MaterialPreset &preset) {
  return fmt::format("{:<18}{:>10}{:>20}{:>9.4g}{:>10.4g}{}\n", preset.name, inKilopascals(preset.youngsModulus),
                     inKilopascals(preset.youngsModulusMin) + " to " + inKilopascals(preset.youngsModulusMax),
                     preset.poissonRatio, preset.density, preset.isRigid ? "  rigid" : "");
}

std::string asTable(const std::vector<MaterialPreset> &presets) {
  std::string text = fmt::format("{:<18}{:>10}{:>20}{:>9}{:>10}\n", "name", "E [kPa]", "range [kPa]", "nu", "[kg/m3]");
  for (const MaterialPreset &preset : presets) text += asRow(preset);
  return text + "Sources: c3de materials NAME. In a scene: material = \"NAME\".\n";
}

std::string inFull(const MaterialPreset &preset) {
  std::string text = fmt::format(
      "{}\n  Young's modulus  {:.6g} Pa, range {:.6g} to {:.6g} Pa\n  Poisson's ratio  {:.4g}, range {:.4g} to {:.4g}\n"
      "  density          {:.6g} kg/m3\n",
      preset.name, preset.youngsModulus, preset.youngsModulusMin, preset.youngsModulusMax, preset.poissonRatio,
      preset.poissonRatioMin, preset.poissonRatioMax, preset.density);
  if (preset.isRigid) text += "  rigid            recommended for this tissue\n";
  if (!preset.evidence.empty()) text += "  measured         " + preset.evidence + "\n";
  text += "  source           " + (preset.source.empty() ? "none" : preset.source) + "\n";
  if (!preset.note.empty()) text += "  note             " + preset.note + "\n";
  return text;
}

int printMaterials(const std::string &name, bool isJson) {
  const auto library = loadMaterialPresets();
  if (!library) return reportError(library.error());
  if (!name.empty()) {
    const MaterialPreset *preset = library->find(name);
    if (preset == nullptr) {
      const std::vector<std::string> known = library->names();
      const std::string nearest = nearestName(name, known);
      return reportError({ErrorCode::usage, "there is no material '" + displayText(name) + "'; " +
                                                (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                                "c3de materials lists them"});
    }
    printOut(isJson ? asJson(*preset).dump(2) + "\n" : inFull(*preset));
    return kDone;
  }
  if (!isJson) {
    printOut(asTable(library->presets()));
    return kDone;
  }
  Json all = Json::array();
  for (const MaterialPreset &preset : library->presets()) all.push_back(asJson(preset));
  printOut(all.dump(2) + "\n");
  return kDone;
}

Handler declareMaterials(CLI::App &app, CommandLine &line) {
  const auto name = std::make_shared<std::string>();
  app.add_option("NAME", *name, "One preset, with evidence and source");
  app.add_flag("--json", line.json, "As JSON, with units in the names");
  app.footer(
      "Examples:\n"
      "    c3de materials\n"
      "    c3de materials liver\n"
      "    c3de materials --json");
  return [name, &line] { return printMaterials(*name, line.json); };
}

}  // namespace

const Command kMaterialsCommand{"materials", "Material presets: values, ranges and their sources", declareMaterials};

}  // namespace c3de::app
