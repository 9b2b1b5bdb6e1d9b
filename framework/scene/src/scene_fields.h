// SPDX-License-Identifier: Apache-2.0
// The keys of a table of the scene as data, and how SceneReader reads and SceneWriter writes them. The tables are in
// scene_tables.cpp.
#pragma once

#include <algorithm>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/text.h"
#include "scene_reader.h"
#include "scene_writer.h"
#include "toml_text.h"

namespace c3de::scene {

/// A number with its range, which is also stated in messages.
struct NumberReader {
  std::string accepted;  ///< range and unit
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool isAbove = false;  ///< `low` itself is refused
  double factor = 1.0;   ///< from the unit of the key to that of the member

  bool operator()(SceneReader &reader, const std::string &key, const TomlValue &value, double &out) const {
    double number = 0.0;
    if (!reader.readNumber(key, accepted, value, number)) return false;
    if (number < low || number > high || (isAbove && number == low))
      return reader.refuse(value.line, key + " is " + formatNumber(number) + "; accepted: " + accepted);
    out = factor * number;
    return true;
  }
  /// The shortest number in the unit of the key that is read as `value`; the nearest if none is.
  [[nodiscard]] double inverse(double value) const;
};

inline constexpr double kMetresPerMillimetre = 1e-3;
inline NumberReader above0(const std::string &unit, double factor = 1.0) {
  return {.accepted = "a number above 0, " + unit, .low = 0.0, .isAbove = true, .factor = factor};
}
inline NumberReader atLeast0(const std::string &unit, double factor = 1.0) {
  return {.accepted = "a number of at least 0, " + unit, .low = 0.0, .factor = factor};
}
inline NumberReader frictionNumber() { return {.accepted = "a number from 0 to 10", .low = 0.0, .high = 10.0}; }
inline NumberReader lengthNumber() { return {.accepted = "a length in mm, 0 or more", .low = 0.0}; }
inline constexpr const char *kStiffnessUnit = "Pa/m (stress per displacement)";
inline constexpr const char *kToolPath = "at least two places, [{ time = 0, at = [x, y, z] }, …] in s and m";

/// A direction of any length but 0.
struct DirectionReader {
  const char *accepted;
  bool operator()(SceneReader &reader, const std::string &key, const TomlValue &value, Vec3 &out) const {
    if (!reader.read(key, value, out)) return false;
    return out != Vec3{} || reader.refuse(value.line, key + " is [0, 0, 0]; accepted: " + accepted);
  }
};

/// Whether `--set` changes a key: suggested for unknown paths as well, accepted, or refused.
enum class Override { suggested, accepted, refused };

struct FieldRules {
  Override onCommandLine;
  std::string required;  ///< the accepted value of a key that must exist; empty: it may be missing

  FieldRules(Override rule = Override::suggested, std::string accepted = {})
      : onCommandLine(rule), required(std::move(accepted)) {}
};
inline FieldRules required(std::string accepted, Override onCommandLine = Override::suggested) {
  return {onCommandLine, std::move(accepted)};
}

template <class T>
T &contentOf(T &value) {
  return value;
}
template <class T>
T &contentOf(std::optional<T> &value) {
  return value ? *value : value.emplace();
}
template <class T>
const T &contentOf(const std::optional<T> &value) {
  static const T kDefault{};
  return value ? *value : kDefault;
}

template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

/// A reader with its inverse, where the type of the member does not determine both.
template <class Read, class Write>
struct Codec {
  Read read;
  Write write;
};
template <class Read, class Write>
Codec(Read, Write) -> Codec<Read, Write>;

/// A member of a member; optional members are created.
template <class Outer, class Inner>
auto in(Outer outer, Inner inner) {
  return [ outer, inner ](auto &table) -> auto & { return std::invoke(inner, contentOf(std::invoke(outer, table))); };
}

/// One key of a table.
template <class Table>
struct Field {
  using Read = std::function<bool(SceneReader &, const std::string &key, const TomlValue &, Table &)>;
  using Write = std::function<std::optional<TomlValue>(SceneWriter &, const std::string &key, const Table &)>;
  std::string key;
  FieldRules rules;
  Read read;
  Write write;               ///< none: the key is left out
  bool isParameter = false;  ///< its values are SceneValues with ids that begin with the key

  /// @param member  a pointer to the member, or `in`; its type determines what is accepted
  template <class Member>
  requires std::invocable<Member, Table &> Field(std::string name, Member member, FieldRules rule = {})
      : Field(
            std::move(name), member,
            [](SceneReader &reader, const std::string &id, const TomlValue &value, auto &out) {
              return reader.read(id, value, out);
            },
            std::move(rule)) {}
  /// @param reader  a member function of SceneReader, a NumberReader, a function with the parameters of those, or a
  ///                Codec of it
  template <class Member, class Reader>
  requires(std::invocable<Member, Table &> && !std::convertible_to<Reader, FieldRules>)
      Field(std::string name, Member member, Reader reader, FieldRules rule = {})
      : Field(std::move(name), member, Codec{reader, writerFor(reader)}, std::move(rule)) {}
  template <class Member, class ReadContent, class WriteContent>
  requires std::invocable<Member, Table &> Field(std::string name, Member member,
                                                 Codec<ReadContent, WriteContent> codec, FieldRules rule = {})
      : key(std::move(name)), rules(std::move(rule)),
        read([member, codec](SceneReader &self, const std::string &id, const TomlValue &value, Table &table) {
          return std::invoke(codec.read, self, id, value, contentOf(std::invoke(member, table)));
        }) {
    isParameter = std::is_same_v<std::remove_cvref_t<std::invoke_result_t<Member, Table &>>, std::vector<SceneValue>>;
    // Missing: an optional member without a value, and a default of a key that may be missing.
    write = [member, codec, reads = read, isRequired = !rules.required.empty()](
                SceneWriter &self, const std::string &id, const Table &table) -> std::optional<TomlValue> {
      const auto &value = std::invoke(member, table);
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (kIsOptional<Value>)
        if (!value) return std::nullopt;
      std::optional<TomlValue> out = std::invoke(codec.write, self, id, contentOf(value));
      if (!out) return out;
      if constexpr (!kIsOptional<Value>) {
        static const Table kDefault{};
        const auto fallback = std::invoke(codec.write, self, id, contentOf(std::invoke(member, kDefault)));
        if (!isRequired && fallback && areEqual(*fallback, *out)) return std::nullopt;
      }
      Table scratch;
      return std::is_same_v<Value, std::filesystem::path> ||
                     self.accepts([&](SceneReader &reader) { return reads(reader, id, *out, scratch); })
                 ? out
                 : std::nullopt;
    };
  }
  /// @param whole  reads into more than one member
  template <class ReadWhole, class WriteWhole>
  Field(std::string name, Codec<ReadWhole, WriteWhole> whole, FieldRules rule = {})
      : key(std::move(name)), rules(std::move(rule)), read(whole.read), write(whole.write) {}

 private:
  template <class Reader>
  static auto writerFor(const Reader &reader) {
    if constexpr (std::is_same_v<Reader, NumberReader>)
      return [reader](SceneWriter &self, const std::string &id, double value) {
        return self.write(id, reader.inverse(value));
      };
    else
      return [](SceneWriter &self, const std::string &id, const auto &value) { return self.write(id, value); };
  }
};

template <class Table>
struct Fields {
  std::string place;                 ///< in messages about unknown keys
  std::string owner;                 ///< in messages about missing keys
  std::vector<Field<Table>> fields;  ///< in the order of messages
  std::string prefix = {};           ///< of keys in messages

  [[nodiscard]] const Field<Table> *find(const std::string &key) const {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto &field) { return field.key == key; });
    return found == fields.end() ? nullptr : &*found;
  }
  [[nodiscard]] std::vector<std::string> keys() const {
    std::vector<std::string> names;
    for (const Field<Table> &field : fields) names.push_back(field.key);
    return names;
  }
};

/// A [[table]] of the scene.
template <class Table>
struct SceneTable : Fields<Table> {
  std::string key, what;
  std::vector<Table> SceneFile::*list;
  std::string plural;                                              ///< names have to differ; empty: they need not
  std::string defaultName;                                         ///< with a number; empty: none
  bool (SceneReader::*checkFile)(const TomlValue &keys, Table &);  ///< before names are checked; may be null
  bool (SceneReader::*check)(const Table &);                       ///< after an override as well; may be null

  SceneTable(std::string id, std::string noun, std::vector<Table> SceneFile::*rows, std::string nouns,
             std::string first, std::vector<Field<Table>> keys,
             bool (SceneReader::*ofFile)(const TomlValue &, Table &) = nullptr,
             bool (SceneReader::*always)(const Table &) = nullptr)
      : Fields<Table>{"[[" + id + "]]", "the " + noun, std::move(keys)}, key(std::move(id)), what(std::move(noun)),
        list(rows), plural(std::move(nouns)), defaultName(std::move(first)), checkFile(ofFile), check(always) {}
};

extern const SceneTable<SceneBody> kBodyTable;
extern const SceneTable<SceneFix> kFixTable;
extern const SceneTable<SceneLoad> kLoadTable;
extern const SceneTable<SceneObstacle> kObstacleTable;
extern const SceneTable<SceneProbe> kProbeTable;
extern const SceneTable<SceneLandmark> kLandmarkTable;
extern const SceneTable<SceneDistance> kDistanceTable;
extern const SceneTable<SceneAngle> kAngleTable;
extern const SceneTable<SceneAttachment> kAttachmentTable;
extern const SceneTable<SceneContactPair> kContactPairTable;
extern const SceneTable<SceneProbeTool> kProbeToolTable;
extern const SceneTable<SceneGrasp> kGraspTable;

/// Tables in tables.
extern const Fields<SceneImage> kImageFields;
extern const Fields<SceneFixedRegions> kFixedRegionFields;
extern const Fields<SceneMatch> kMatchFields;
extern const Fields<imaging::MaskCleanUp> kMendFields;
extern const Fields<SceneTissue> kTissueFields;
extern const Fields<SceneBody> kBackgroundFields;
extern const Fields<SceneToolWaypoint> kToolWaypointFields;
extern const Fields<SceneGraspWaypoint> kGraspWaypointFields;

/// Keys of an [[attachment]] of all of a surface to the surroundings, which are parameters of its body.
inline constexpr std::array<const char *, 3> kSurroundingsKeys{"stiffness", "tangential", "retardation_time"};

/// Calls `visit` with each table until it returns true.
template <class Visit>
bool anyTable(const Visit &visit) {
  return visit(kBodyTable) || visit(kFixTable) || visit(kLoadTable) || visit(kObstacleTable) || visit(kProbeTable) ||
         visit(kLandmarkTable) || visit(kDistanceTable) || visit(kAngleTable) || visit(kAttachmentTable) ||
         visit(kContactPairTable) || visit(kProbeToolTable) || visit(kGraspTable);
}

template <class Table>
bool SceneReader::readField(const Fields<Table> &fields, const std::string &key, const TomlValue &value, Table &out) {
  const auto *field = fields.find(key);
  return field != nullptr ? field->read(*this, fields.prefix + key, value, out)
                          : refuseKey(value.line, key, fields.place, fields.keys());
}

template <class Table>
bool SceneReader::readFields(const Fields<Table> &fields, const TomlValue &keys, Table &out) {
  for (const auto &[key, value] : keys.entries)
    if (!readField(fields, key, value, out)) return false;
  for (const auto &field : fields.fields)
    if (!field.rules.required.empty() && keys.find(field.key) == nullptr)
      return refuse(keys.line, fields.owner + " has no '" + field.key + "'; accepted: " + field.rules.required);
  return true;
}

template <class Table>
bool SceneReader::readTable(const SceneTable<Table> &table, const TomlValue &keys) {
  std::vector<Table> &list = scene_.*table.list;
  Table one;
  one.line = keys.line;
  if (!readFields(table, keys, one)) return false;
  if (table.checkFile != nullptr && !(this->*table.checkFile)(keys, one)) return false;
  if constexpr (requires { one.name; }) {
    if (one.name.empty() && !table.defaultName.empty())
      one.name = table.defaultName + "-" + std::to_string(list.size() + 1);
    const auto isNamesake = [&](const Table &other) { return other.name == one.name; };
    if (!one.name.empty() && !table.plural.empty() && std::any_of(list.begin(), list.end(), isNamesake))
      return refuse(keys.line, "a second " + table.what + " is named '" + one.name + "'; names of " + table.plural +
                                   " have to differ");
  }
  if (table.check != nullptr && !(this->*table.check)(one)) return false;
  list.push_back(std::move(one));
  return true;
}

template <class Table>
bool SceneReader::readTables(const SceneTable<Table> &table, const TomlValue &value) {
  if (!requireTables("'" + table.key + "'", "one or more tables " + table.place, value)) return false;
  return std::all_of(value.items.begin(), value.items.end(),
                     [&](const TomlValue &keys) { return readTable(table, keys); });
}

template <class Table>
TomlValue SceneWriter::writeFields(const Fields<Table> &fields, const Table &table) {
  TomlValue keys;
  for (const Field<Table> &field : fields.fields)
    if (std::optional<TomlValue> value = field.write(*this, fields.prefix + field.key, table))
      keys.entries.push_back({field.key, std::move(*value)});
  return keys;
}

}  // namespace c3de::scene
