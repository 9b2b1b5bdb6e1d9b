// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "scene_fields.h"

namespace c3de::scene {
namespace {

TomlValue numberOf(double number, TomlValue::Kind kind = TomlValue::Kind::number) {
  TomlValue out;
  out.kind = kind;
  out.num = number;
  return out;
}

template <class Items>
TomlValue numbersOf(const Items &items) {
  TomlValue out;
  out.kind = TomlValue::Kind::array;
  for (const double item : items) out.items.push_back(numberOf(item));
  return out;
}

TomlValue tomlTable(std::vector<TomlValue::Entry> entries) {
  TomlValue out;
  out.entries = std::move(entries);
  return out;
}

bool isBelow(const std::string &table, const std::string &id) {
  return id.size() > table.size() && id.compare(0, table.size(), table) == 0 && id[table.size()] == '.';
}

/// Tables "term1" … "termN" become a list "term", as SceneReader numbers the tables of lists.
void foldLists(TomlValue &table) {
  // Keys whose lists, or tables, are not parameters.
  static const std::vector<std::string> kReserved{"box", "pair", "preset", "refine", kOptionalKey};
  std::map<std::string, std::map<std::size_t, const TomlValue *>> lists;
  for (auto &[key, value] : table.entries) {
    if (value.kind != TomlValue::Kind::table) continue;
    foldLists(value);
    const std::size_t digits = key.find_last_not_of("0123456789") + 1;
    if (digits == 0 || digits == key.size() || key[digits] == '0' || key.size() - digits > 4) continue;
    lists[key.substr(0, digits)][std::stoul(key.substr(digits))] = &value;
  }
  std::vector<TomlValue::Entry> folded;
  for (const auto &[name, items] : lists) {
    const bool isComplete = items.begin()->first == 1 && items.rbegin()->first == items.size();
    if (!isComplete || table.find(name) != nullptr ||
        std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end())
      continue;
    TomlValue list = tomlList({});
    for (const auto &item : items) list.items.push_back(*item.second);
    folded.push_back({name, std::move(list)});
  }
  for (TomlValue::Entry &list : folded) {
    std::vector<std::string> items;
    for (std::size_t i = 1; i <= list.value.items.size(); ++i) items.push_back(list.key + std::to_string(i));
    const auto isItem = [&](const TomlValue::Entry &entry) {
      return std::find(items.begin(), items.end(), entry.key) != items.end();
    };
    const auto first = std::find_if(table.entries.begin(), table.entries.end(), isItem);
    *first = std::move(list);
    table.entries.erase(std::remove_if(first, table.entries.end(), isItem), table.entries.end());
  }
}

}  // namespace

double NumberReader::inverse(double value) const {
  const double nearest = value / factor;
  double best = nearest;
  std::string shortest;
  for (double number : {nearest, std::nextafter(nearest, -HUGE_VAL), std::nextafter(nearest, HUGE_VAL)}) {
    if (factor * number != value) continue;
    const std::string text = formatNumber(number);
    if (!shortest.empty() && text.size() >= shortest.size()) continue;
    shortest = text;
    best = number;
  }
  return best;
}

SceneWriter::SceneWriter(const std::filesystem::path &folder, std::function<std::string(const SceneBody &)> nameOfMask)
    : nameOfMask_(std::move(nameOfMask)) {
  std::error_code code;
  folder_ = normalPath(absolutePath(folder.empty() ? std::filesystem::current_path(code) : folder, code));
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
}

SceneWriter::Written SceneWriter::refuse(const std::string &what) {
  if (!error_) error_ = Error{ErrorCode::output, displayMessage(place_ + ": " + what)};
  return std::nullopt;
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::string &text) {
  if (!isUtf8(text)) return refuse(key + " is \"" + text + "\", which is not UTF-8; accepted: UTF-8");
  return tomlString(text);
}

SceneWriter::Written SceneWriter::write(const std::string &, bool flag) {
  return numberOf(flag ? 1.0 : 0.0, TomlValue::Kind::boolean);
}
SceneWriter::Written SceneWriter::write(const std::string &, double number) { return numberOf(number); }
SceneWriter::Written SceneWriter::write(const std::string &, std::size_t number) {
  return numberOf(static_cast<double>(number), TomlValue::Kind::integer);
}
SceneWriter::Written SceneWriter::write(const std::string &, const Vec3 &vector) { return numbersOf(vector); }
SceneWriter::Written SceneWriter::write(const std::string &, const std::array<double, 2> &range) {
  return numbersOf(range);
}
SceneWriter::Written SceneWriter::write(const std::string &, const std::array<double, 4> &quaternion) {
  return numbersOf(quaternion);
}

SceneWriter::Written SceneWriter::write(const std::string &, const Mat4 &matrix) {
  TomlValue rows = tomlList({});
  for (std::size_t r = 0; r < 4; ++r)
    rows.items.push_back(numbersOf(std::array{matrix[r], matrix[4 + r], matrix[8 + r], matrix[12 + r]}));
  return rows;
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::vector<std::string> &names) {
  if (names.empty()) return std::nullopt;
  TomlValue list = tomlList({});
  for (const std::string &name : names)
    if (Written text = write(key, name)) list.items.push_back(std::move(*text));
  return list;
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::array<std::string, 2> &names) {
  return write(key, std::vector<std::string>(names.begin(), names.end()));
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::array<std::string, 3> &names) {
  return write(key, std::vector<std::string>(names.begin(), names.end()));
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::filesystem::path &path) {
  if (path.empty()) return std::nullopt;
  std::error_code code;
  std::filesystem::path whole = normalPath(absolutePath(path, code));
  if (code) return refuse(key + ": '" + pathText(path) + "' has no absolute path: " + code.message());
  const std::filesystem::path below = relativePath(whole, folder_);
  if (!below.empty() && *below.begin() != "..") whole = below;
  return write(key, genericPathText(whole));
}

SceneWriter::Written SceneWriter::write(const std::string &, const geometry::LengthUnit &unit) {
  for (const char *name : {"m", "mm", "cm"})
    if (parseLengthUnit(name).value() == unit) return tomlString(name);
  return refuse("mesh_unit has no name");
}

SceneWriter::Written SceneWriter::write(const std::string &key, const SceneRegion &region) {
  switch (region.kind) {
    case SceneRegion::Kind::everywhere: return tomlTable({{"everywhere", numberOf(1.0, TomlValue::Kind::boolean)}});
    case SceneRegion::Kind::box:
      return tomlTable({{"box", tomlTable({{"min", numbersOf(region.a)}, {"max", numbersOf(region.b)}})}});
    case SceneRegion::Kind::sphere:
      return tomlTable({{"sphere", tomlTable({{"centre", numbersOf(region.a)}, {"radius", numberOf(region.radius)}})}});
    case SceneRegion::Kind::halfSpace:
      return tomlTable({{"half_space", tomlTable({{"point", numbersOf(region.a)}, {"normal", numbersOf(region.b)}})}});
    case SceneRegion::Kind::voxels: break;
  }
  return refuse(key + " are voxels, which a scene file cannot contain");
}

SceneWriter::Written SceneWriter::write(const std::string &, const std::vector<ScenePart> &parts) {
  TomlValue list = tomlList({});
  for (const ScenePart &part : parts) {
    const Written region = write("region of a part", part.region), material = writeMaterial("material", part.params);
    if (region) list.items.push_back(tomlTable({{"region", *region}, {"material", material.value_or(TomlValue())}}));
  }
  return list.items.empty() ? Written() : list;
}

SceneWriter::Written SceneWriter::write(const std::string &key, const std::vector<SceneRefinement> &refinements) {
  TomlValue list = tomlList({});
  for (const SceneRefinement &one : refinements)
    if (const Written region = write("region of " + key, one.region))
      list.items.push_back(tomlTable({{"region", *region}, {"spacing", numberOf(one.spacing_m)}}));
  return list.items.empty() ? Written() : list;
}

SceneWriter::Written SceneWriter::write(const std::string &, const imaging::MaskCleanUp &mend) {
  return writeFields(kMendFields, mend);
}

SceneWriter::Written SceneWriter::write(const std::string &, const SceneFixedRegions &still) {
  for (const char *name : {"auto", "outside", "nothing"}) {
    SceneFixedRegions named;
    named.isAutomatic = name == std::string("auto");
    named.outside = name == std::string("outside");
    if (still == named) return tomlString(name);
  }
  if (still.isAutomatic) return refuse("still is automatic and more");
  return writeFields(kFixedRegionFields, still);
}

template <class Table>
SceneWriter::Written SceneWriter::writePath(const Fields<Table> &fields, const std::vector<Table> &path) {
  if (path.empty()) return std::nullopt;
  TomlValue list = tomlList({});
  for (const Table &place : path) list.items.push_back(writeFields(fields, place));
  return list;
}

SceneWriter::Written SceneWriter::write(const std::string &, const std::vector<SceneToolWaypoint> &path) {
  return writePath(kToolWaypointFields, path);
}

SceneWriter::Written SceneWriter::write(const std::string &, const std::vector<SceneGraspWaypoint> &path) {
  return writePath(kGraspWaypointFields, path);
}

void SceneWriter::put(TomlValue &table, const std::string &rest, const SceneValue &value) {
  const std::size_t dot = rest.find('.');
  const std::string key = rest.substr(0, dot);
  auto found =
      std::find_if(table.entries.begin(), table.entries.end(), [&](const auto &one) { return one.key == key; });
  if (found != table.entries.end() && (dot == std::string::npos || found->value.kind != TomlValue::Kind::table)) {
    refuse("'" + value.value.id + "' is a value and a table, or is there twice; a scene file says one");
    return;
  }
  if (dot != std::string::npos) {
    if (found == table.entries.end()) found = table.entries.insert(found, {key, TomlValue()});
    return put(found->value, rest.substr(dot + 1), value);
  }
  const ParameterValue &parameter = value.value;
  switch (parameter.type) {
    case C3DE_PARAM_BOOL: table.entries.push_back({key, *write(key, parameter.num != 0.0)}); break;
    case C3DE_PARAM_I64:
      table.entries.push_back(
          {key, numberOf(parameter.num + 0.0,
                         parameter.num == std::floor(parameter.num) && std::abs(parameter.num) <= 9223372036854775808.0
                             ? TomlValue::Kind::integer
                             : TomlValue::Kind::number)});
      break;
    case C3DE_PARAM_F64: table.entries.push_back({key, numberOf(parameter.num)}); break;
    case C3DE_PARAM_VEC3: table.entries.push_back({key, numbersOf(parameter.vec)}); break;
    default:
      if (Written text = write(parameter.id, parameter.text)) table.entries.push_back({key, std::move(*text)});
  }
}

SceneWriter::Written SceneWriter::write(const std::string &id, const std::vector<SceneValue> &values) {
  TomlValue holder;
  for (const SceneValue &value : values) {
    if (value.value.id != id && !isBelow(id, value.value.id)) continue;
    if (value.isOptional)
      return refuse("'" + value.value.id + "' is optional; accepted: optional values of a material");
    put(holder, value.value.id, value);
  }
  if (holder.entries.empty()) return std::nullopt;
  foldLists(holder);
  return holder.entries.size() == 1 ? Written(std::move(holder.entries.front().value)) : std::nullopt;
}

SceneWriter::Written SceneWriter::writeMaterial(const std::string &key, const std::vector<SceneValue> &params) {
  std::vector<SceneValue> firm, optional;
  for (const SceneValue &value : params) {
    for (const char *reserved : {"preset", kOptionalKey})
      if (const std::string id = key + "." + reserved; value.value.id == id || isBelow(id, value.value.id))
        return refuse("'" + value.value.id + "' is no value of a material");
    (value.isOptional ? optional : firm).push_back(value);
    (value.isOptional ? optional : firm).back().isOptional = false;
  }
  Written written = write(key, firm);
  const Written weak = write(key, optional);
  if (weak && !written) written.emplace();
  if (weak) written->entries.push_back({kOptionalKey, *weak});
  return written;
}

}  // namespace c3de::scene
