// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"

namespace c3de::scene {
namespace {

/// Formats that say in which unit their numbers are.
bool carriesUnit(const std::filesystem::path &mesh) {
  const std::string extension = mesh.extension().string();
  return extension == ".gltf" || extension == ".glb";
}

}  // namespace

std::filesystem::path pathFromUtf8(const std::string &text) {
  return std::filesystem::path(std::u8string(text.begin(), text.end()));
}

bool isKnownToTheFormat(std::string_view id) {
  static constexpr std::array kIds{"world.gravity",
                                   "world.box.min",
                                   "world.box.max",
                                   "world.box.enabled",
                                   "solver.integrator",
                                   "solver.dt",
                                   "solver.damping",
                                   "solver.tolerance_mm",
                                   "solver.load_steps",
                                   "solver.preconditioner",
                                   "solver.precision",
                                   "solver.sleep",
                                   "view.surface",
                                   "view.points",
                                   "view.colour",
                                   "view.range",
                                   "material.law",
                                   "material.density",
                                   "material.youngs_modulus",
                                   "material.poisson_ratio",
                                   "material.viscosity",
                                   "material.volume_stiffness",
                                   "material.plastic",
                                   "material.plastic.yield",
                                   "material.plastic.creep",
                                   "material.plastic.creep_time",
                                   "material.plastic.max",
                                   "material.prony1.share",
                                   "material.prony1.time",
                                   "material.prony2.share",
                                   "material.prony2.time",
                                   "sampling.evaluation",
                                   "sampling.spacing",
                                   "sampling.count",
                                   "sampling.neighbours",
                                   "sampling.support",
                                   "sampling.stabilisation",
                                   "sampling.surface_spacing",
                                   "sampling.jitter",
                                   "surroundings.stiffness",
                                   "surroundings.tangential",
                                   "surroundings.retardation_time",
                                   "rigid",
                                   "friction",
                                   "restitution"};
  return std::find(kIds.begin(), kIds.end(), id) != kIds.end();
}

bool SceneReader::meshKey(const std::string &key, const TomlValue &value, std::filesystem::path &out) {
  std::string text;
  if (!readText(key, value, text)) return false;
  if (text.empty()) return refuse(value.line, "mesh is empty; accepted: a mesh file");
  const std::filesystem::path path = scene_.source.parent_path() / pathFromUtf8(text);
  std::error_code code;
  if (std::filesystem::is_directory(path, code))
    return refuse(value.line, "mesh '" + text + "' is a folder; accepted: a mesh file");
  if (!std::filesystem::exists(path, code))
    return refuse(value.line,
                  "mesh '" + text + "' does not exist; it is looked for at " + path.lexically_normal().string());
  out = path.lexically_normal();
  return true;
}

bool SceneReader::unitKey(const std::string &key, const TomlValue &value, geometry::LengthUnit &out) {
  std::string text;
  if (!readText(key, value, text)) return false;
  const auto unit = parseLengthUnit(text);
  if (!unit) return refuse(value.line, key + ": " + unit.error().message);
  out = *unit;
  return true;
}

bool SceneReader::placementKey(ScenePlacement &placement, const std::string &key, const TomlValue &value) {
  if (key == "position") return readVec3(key, value, placement.position_m);
  if (key == "rotation_deg") return readVec3(key, value, placement.rotation_deg);
  if (!value.isNumber()) return refuse(value.line, "scale is " + value.kindName() + "; accepted: a number above 0");
  if (!std::isfinite(value.num) || value.num <= 0.0)
    return refuse(value.line, "scale is " + formatNumber(value.num) + "; accepted: a number above 0");
  placement.scale = value.num;
  return true;
}

bool SceneReader::readMaterial(std::vector<SceneValue> &params, const TomlValue &value) {
  if (value.kind != TomlValue::Kind::text && value.kind != TomlValue::Kind::table)
    return refuse(value.line, "material is " + value.kindName() +
                                  "; accepted: the name of a preset, or a table such as { youngs_modulus = 1e4 }");
  // The preset first, so that what stands beside it counts.
  const TomlValue *preset = value.kind == TomlValue::Kind::text ? &value : value.find("preset");
  if (preset != nullptr) {
    std::string name;
    if (!readText("preset", *preset, name)) return false;
    const MaterialPreset *found = materials_ != nullptr ? materials_->find(name) : nullptr;
    if (found == nullptr) {
      const std::vector<std::string> names = materials_ != nullptr ? materials_->names() : std::vector<std::string>();
      const std::string nearest = nearestName(name, names);
      return refuse(preset->line, "there is no material '" + name + "'; " +
                                      (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                      (names.empty() ? "no presets are known" : "accepted: " + joined(names)));
    }
    const auto number = [&](const char *id, double num) {
      ParameterValue parameter;
      parameter.id = id;
      parameter.num = num;
      put(params, parameter, preset->line);
    };
    number("material.density", found->density);
    number("material.youngs_modulus", found->youngsModulus);
    number("material.poisson_ratio", found->poissonRatio);
  }
  for (const auto &[key, member] : value.entries)
    if (key != "preset" && !materialKey(params, key, member)) return false;
  return true;
}

bool SceneReader::materialKey(std::vector<SceneValue> &params, const std::string &key, const TomlValue &value) {
  return key == "prony" ? readProny(params, value) : store(params, "material." + key, value);
}

bool SceneReader::readProny(std::vector<SceneValue> &params, const TomlValue &value) {
  static constexpr std::size_t kTerms = 2;
  const std::string accepted = "one or two terms, [ { share = 0.3, time = 0.1 } ]";
  if (!requireTables("material.prony", accepted, value)) return false;
  if (value.items.size() > kTerms)
    return refuse(value.line,
                  "material.prony has " + std::to_string(value.items.size()) + " terms; accepted: " + accepted);
  // The terms replace what was there: a second one of a preset or of the file must not stay beside a new first one.
  std::erase_if(params, [](const SceneValue &other) { return other.value.id.rfind("material.prony", 0) == 0; });
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    if (!requireKeys("a term of material.prony", "{ share = 0.3, time = 0.1 }", value.items[i], {"share", "time"}) ||
        !store(params, "material.prony" + std::to_string(i + 1), value.items[i]))
      return false;
  }
  return true;
}

bool SceneReader::samplingKey(SceneBody &body, const std::string &key, const TomlValue &value) {
  return key == "refine" ? readRefinements(value, body.refinements) : store(body.params, "sampling." + key, value);
}

bool SceneReader::requireUnit(const TomlValue &table, const std::filesystem::path &mesh, geometry::LengthUnit &unit) {
  if (table.find("mesh_unit") != nullptr) return true;
  if (const auto said = geometry::unitInFile(mesh)) {
    unit = *said;
    return true;
  }
  if (!carriesUnit(mesh))
    return refuse(table.line,
                  "'mesh_unit' is missing; " + mesh.filename().string() +
                      " does not say its unit by a comment such as UNITS=mm; accepted: \"m\", \"mm\", \"cm\"");
  unit = geometry::LengthUnit::metre;
  return true;
}

bool SceneReader::readText(const std::string &key, const TomlValue &value, std::string &out) {
  if (value.kind != TomlValue::Kind::text)
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: text in quotes");
  out = value.text;
  return true;
}

bool SceneReader::readVec3(const std::string &key, const TomlValue &value, Vec3 &out) {
  if (!value.isNumbers(3))
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: three numbers [x, y, z]");
  for (std::size_t i = 0; i < 3; ++i)
    if (!std::isfinite(value.items[i].num))
      return refuse(value.line,
                    key + ": " + formatNumber(value.items[i].num) + " is not accepted; accepted: finite numbers");
  out = {value.items[0].num, value.items[1].num, value.items[2].num};
  return true;
}

bool SceneReader::readNumber(const std::string &key, const std::string &accepted, const TomlValue &value, double &out) {
  if (!value.isNumber()) return refuse(value.line, key + " is " + value.kindName() + "; accepted: " + accepted);
  if (!std::isfinite(value.num))
    return refuse(value.line, key + " is " + formatNumber(value.num) + "; accepted: " + accepted);
  out = value.num;
  return true;
}

bool SceneReader::readBool(const std::string &key, const TomlValue &value, bool &out) {
  if (value.kind != TomlValue::Kind::boolean)
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: true, false");
  out = value.num != 0.0;
  return true;
}

bool SceneReader::requireTables(const std::string &place, const std::string &accepted, const TomlValue &value) {
  const bool good = value.kind == TomlValue::Kind::array &&
                    std::all_of(value.items.begin(), value.items.end(),
                                [](const TomlValue &item) { return item.kind == TomlValue::Kind::table; });
  return good || refuse(value.line, place + " is " + value.kindName() + "; accepted: " + accepted);
}

bool SceneReader::requireKeys(const std::string &place, const std::string &accepted, const TomlValue &value,
                              const std::vector<std::string> &keys) {
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line, place + " is " + value.kindName() + "; accepted: " + accepted);
  for (const auto &[key, member] : value.entries)
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) return refuseKey(member.line, key, place, keys);
  for (const std::string &key : keys)
    if (value.find(key) == nullptr) return refuse(value.line, place + " has no '" + key + "'; accepted: " + accepted);
  return true;
}

bool SceneReader::store(std::vector<SceneValue> &values, const std::string &id, const TomlValue &value) {
  if (value.kind == TomlValue::Kind::table) {
    if (value.entries.empty()) return refuse(value.line, id + " is an empty table; accepted: what stands under " + id);
    for (const auto &[key, member] : value.entries)
      if (!store(values, id + "." + key, member)) return false;
    return true;
  }
  ParameterValue parameter;
  if (!toParameter(value, id, parameter))
    return refuse(value.line, id + " is " + value.kindName() + "; accepted: a number, text, true, false or [x, y, z]");
  put(values, parameter, value.line);
  return true;
}

void SceneReader::put(std::vector<SceneValue> &values, ParameterValue value, int line) {
  // Of two ways to say the same thing, the override is what counts.
  static constexpr std::array<std::array<const char *, 2>, 2> kAlternatives{
      {{"sampling.spacing", "sampling.count"}, {"sampling.neighbours", "sampling.support"}}};
  if (!override_.empty())
    for (const auto &alternatives : kAlternatives) {
      const auto isOneOf = [&alternatives](const std::string &id) {
        return std::find(alternatives.begin(), alternatives.end(), id) != alternatives.end();
      };
      if (isOneOf(value.id)) std::erase_if(values, [&](const SceneValue &other) { return isOneOf(other.value.id); });
    }

  const SceneValue stored{std::move(value), override_.empty() ? line : 0, override_};
  for (SceneValue &present : values) {
    if (present.value.id != stored.value.id) continue;
    present = stored;
    return;
  }
  values.push_back(stored);
}

bool SceneReader::checkAlternatives(const SceneBody &body) {
  const auto find = [&](const char *id) {
    return std::find_if(body.params.begin(), body.params.end(), [&](const SceneValue &v) { return v.value.id == id; });
  };
  const auto both = [&](const char *a, const char *b) {
    return find(a) != body.params.end() && find(b) != body.params.end();
  };
  if (both("sampling.spacing", "sampling.count"))
    return refuse(find("sampling.count")->line, "sampling has spacing and count; accepted: one of them");
  if (both("sampling.neighbours", "sampling.support"))
    return refuse(find("sampling.support")->line, "sampling has neighbours and support; accepted: one of them");
  return true;
}

}  // namespace c3de::scene
