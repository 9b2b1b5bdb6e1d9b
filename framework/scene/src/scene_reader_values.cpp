// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/core/file_path.h"
#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"

namespace c3de::scene {
namespace {

/// Whether an id is under "list1", "list2", …: an entry of a list of tables.
bool isEntryOf(const std::string &id, const std::string &list) {
  if (id.compare(0, list.size(), list) != 0) return false;
  std::size_t end = list.size();
  while (end < id.size() && id[end] >= '0' && id[end] <= '9') ++end;
  return end > list.size() && end < id.size() && id[end] == '.';
}

bool isListOfTables(const TomlValue &value) {
  return value.kind == TomlValue::Kind::array &&
         std::all_of(value.items.begin(), value.items.end(),
                     [](const TomlValue &item) { return item.kind == TomlValue::Kind::table; });
}

}  // namespace

bool SceneReader::readFile(const std::string &key, const char *accepted, const TomlValue &value,
                           std::filesystem::path &out) {
  std::string text;
  if (!read(key, value, text)) return false;
  if (text.empty()) return refuse(value.line, key + " is empty; accepted: " + accepted);
  const std::filesystem::path path = namedFile(scene_.source.parent_path(), text);
  out = normalPath(path);
  if (!checksFiles_) return true;
  std::error_code code;
  if (!std::filesystem::exists(path, code))
    return refuse(value.line, key + " '" + text + "' does not exist; it is looked for at " + normalPath(path).string());
  if (const std::string instead = describeNonFile(path); !instead.empty())
    return refuse(value.line, key + " '" + text + "' " + instead + "; accepted: " + accepted);
  return true;
}

bool SceneReader::readMesh(const std::string &, const TomlValue &value, std::filesystem::path &out) {
  return readFile("mesh", "a mesh file", value, out);
}

bool SceneReader::read(const std::string &key, const TomlValue &value, geometry::LengthUnit &out) {
  std::string text;
  if (!read(key, value, text)) return false;
  const auto unit = parseLengthUnit(text);
  if (!unit) return refuse(value.line, key + ": " + unit.error().message);
  out = *unit;
  return true;
}

bool SceneReader::checkPlacement(const TomlValue &table, const ScenePlacement &placement) {
  if (!placement.matrix) return true;
  for (const char *other : {"position", "rotation_deg", "scale"})
    if (table.find(other) != nullptr)
      return refuse(table.line, std::string("'matrix' and '") + other + "'; accepted: the matrix alone, or without it");
  return true;
}

bool SceneReader::read(const std::string &key, const TomlValue &value, Mat4 &out) {
  const bool isGood =
      value.kind == TomlValue::Kind::array && value.items.size() == 4 &&
      std::all_of(value.items.begin(), value.items.end(), [](const TomlValue &row) {
        return row.isNumbers(4) && std::all_of(row.items.begin(), row.items.end(),
                                               [](const TomlValue &one) { return std::isfinite(one.num); });
      });
  if (!isGood)
    return refuse(value.line,
                  key + " is " + value.kindName() +
                      "; accepted: four rows of four finite numbers, m from the mesh in m, last row 0, 0, 0, 1");
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c) out[4 * c + r] = value.items[r].items[c].num;
  return true;
}

bool SceneReader::readMaterial(const std::string &, const TomlValue &value, std::vector<SceneValue> &params) {
  if (value.kind != TomlValue::Kind::text && value.kind != TomlValue::Kind::table)
    return refuse(value.line, "material is " + value.kindName() +
                                  "; accepted: the name of a preset, or a table such as { youngs_modulus = 1e4 }");
  // The preset first, so that values next to it take precedence.
  const TomlValue *preset = value.kind == TomlValue::Kind::text ? &value : value.find("preset");
  if (preset != nullptr) {
    std::string name;
    if (!read("preset", *preset, name)) return false;
    const MaterialPreset *found = materials_ != nullptr ? materials_->find(name) : nullptr;
    if (found == nullptr) {
      const std::vector<std::string> names = materials_ != nullptr ? materials_->names() : std::vector<std::string>();
      return refuse(preset->line, "there is no material '" + name + "'; " +
                                      (names.empty() ? "no presets are known" : suggestion(name, names)));
    }
    for (const SceneValue &said : valuesOf(*found)) put(params, said.value, preset->line, said.isOptional);
  }
  for (const auto &[key, member] : value.entries)
    if (key != "preset" && key != kOptionalKey && !read("material." + key, member, params)) return false;
  return value.find(kOptionalKey) == nullptr || readOptional(*value.find(kOptionalKey), params);
}

// Values that a simulator without them ignores, as the known range of a preset.
bool SceneReader::readOptional(const TomlValue &value, std::vector<SceneValue> &params) {
  std::vector<SceneValue> values;
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line, std::string("material.") + kOptionalKey + " is " + value.kindName() +
                                  "; accepted: a table of values, which simulators that do not have them ignore");
  for (const auto &[key, member] : value.entries)
    if (!read("material." + key, member, values)) return false;
  for (SceneValue &one : values) put(params, std::move(one.value), one.line, true);
  return true;
}

bool SceneReader::readSampling(const std::string &key, const TomlValue &value, SceneBody &body) {
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: a table such as { spacing = 0.01 }");
  return std::all_of(value.entries.begin(), value.entries.end(),
                     [&](const auto &entry) { return readSamplingKey(body, entry.key, entry.value); });
}

bool SceneReader::readSamplingKey(SceneBody &body, const std::string &key, const TomlValue &value) {
  return key == "refine" ? read("sampling.refine", value, body.refinements)
                         : read("sampling." + key, value, body.params);
}

bool SceneReader::requireUnit(const TomlValue &table, const std::filesystem::path &mesh,
                              std::optional<geometry::LengthUnit> &unit) {
  if (table.find("mesh_unit") != nullptr) return true;
  if (!geometry::isMeshFile(mesh)) {  // perhaps a format of a plugin; checked when the file is read
    unit.reset();
    return true;
  }
  if (const auto said = geometry::unitInFile(mesh)) {
    unit = *said;
    return true;
  }
  return refuse(table.line,
                "'mesh_unit' is missing; " + mesh.filename().string() +
                    " does not state its unit in a comment such as UNITS=mm; accepted: \"m\", \"mm\", \"cm\"");
}

bool SceneReader::read(const std::string &key, const TomlValue &value, std::string &out) {
  if (value.kind != TomlValue::Kind::text)
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: text in quotes");
  out = value.text;
  return true;
}

bool SceneReader::read(const std::string &key, const TomlValue &value, Vec3 &out) {
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

bool SceneReader::read(const std::string &key, const TomlValue &value, bool &out) {
  if (value.kind != TomlValue::Kind::boolean)
    return refuse(value.line, key + " is " + value.kindName() + "; accepted: true, false");
  out = value.num != 0.0;
  return true;
}

bool SceneReader::readName(const std::string &, const TomlValue &value, std::string &out) {
  if (!read("name", value, out)) return false;
  const bool hasControlCharacter =
      std::any_of(out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  if (out.empty() || hasControlCharacter)
    return refuse(value.line, "name is \"" + out + "\"; accepted: text of at least one character on one line");
  return true;
}

bool SceneReader::requireTables(const std::string &place, const std::string &accepted, const TomlValue &value) {
  return isListOfTables(value) || refuse(value.line, place + " is " + value.kindName() + "; accepted: " + accepted);
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

bool SceneReader::read(const std::string &id, const TomlValue &value, std::vector<SceneValue> &values) {
  if (value.kind == TomlValue::Kind::table) {
    if (value.entries.empty()) return refuse(value.line, id + " is an empty table; accepted: the keys of " + id);
    for (const auto &[key, member] : value.entries)
      if (!read(id + "." + key, member, values)) return false;
    return true;
  }
  if (isListOfTables(value) && !value.items.empty()) {
    // The list replaces the existing one: a second entry of the file must not remain next to a new first one.
    std::erase_if(values, [&](const SceneValue &other) { return isEntryOf(other.value.id, id); });
    for (std::size_t i = 0; i < value.items.size(); ++i)
      if (!read(id + std::to_string(i + 1), value.items[i], values)) return false;
    return true;
  }
  ParameterValue parameter;
  if (!toParameter(value, id, parameter))
    return refuse(value.line, id + " is " + value.kindName() + "; accepted: a number, text, true, false or [x, y, z]");
  put(values, parameter, value.line);
  return true;
}

void SceneReader::put(std::vector<SceneValue> &values, ParameterValue value, int line, bool isOptional) {
  const SceneValue stored{std::move(value), override_.empty() ? line : 0, override_, isOptional};
  for (SceneValue &present : values) {
    if (present.value.id != stored.value.id) continue;
    present = stored;
    return;
  }
  values.push_back(stored);
}

}  // namespace c3de::scene
