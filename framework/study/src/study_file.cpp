// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/study_file.h"
#include "c3de/core/file_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/scene/toml_document.h"

namespace c3de::study {
namespace {

using scene::TomlValue;

const std::vector<std::string> kEnergies{"elastic", "kinetic", "stabilisation", "gravity", "attachment", "supports"};
const std::vector<std::string> kKinds{"formula", "finite_elements", "measurement"};
const std::vector<std::string> kComponents{"x", "y", "z", "magnitude"};

std::string listOf(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Converts TOML to a Study. Functions return false after the first error, which is stored.
class Reader {
 public:
  explicit Reader(Study &study) : study_(study) {}
  [[nodiscard]] bool read(const TomlValue &root);
  [[nodiscard]] const Error &error() const { return error_; }

 private:
  bool refuse(int line, const std::string &what) {
    error_ = {ErrorCode::input, study_.where(line) + ": " + what};
    return false;
  }
  bool refuseKey(const TomlValue::Entry &entry, const std::string &place, const std::vector<std::string> &known) {
    const std::string nearest = nearestName(entry.key, known);
    return refuse(entry.value.line, "unknown key '" + displayText(entry.key) + "' in " + place + "; " +
                                        (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                        "accepted: " + listOf(known));
  }
  bool keysAre(const TomlValue &table, const std::string &place, const std::vector<std::string> &known) {
    if (table.kind != TomlValue::Kind::table)
      return refuse(table.line, place + " is " + table.kindName() + "; accepted: a table with " + listOf(known));
    for (const TomlValue::Entry &entry : table.entries)
      if (std::find(known.begin(), known.end(), entry.key) == known.end()) return refuseKey(entry, place, known);
    return true;
  }
  bool text(const std::string &key, const TomlValue &value, std::string &out) {
    if (value.kind != TomlValue::Kind::text || value.text.empty() || displayText(value.text) != value.text)
      return refuse(value.line, key + " is " + value.shown() + "; accepted: text on one line");
    out = value.text;
    return true;
  }
  bool number(const std::string &key, const TomlValue &value, double least, double &out, bool isOpen = false) {
    if (value.isNumber() && std::isfinite(value.num) && (isOpen ? value.num > least : value.num >= least)) {
      out = value.num;
      return true;
    }
    return refuse(value.line, key + " = " + value.shown() + "; accepted: a number " + (isOpen ? "above " : "from ") +
                                  formatNumber(least));
  }
  template <class T>
  bool whole(const std::string &key, const TomlValue &value, double least, double most, T &out) {
    if (value.kind == TomlValue::Kind::integer && value.num >= least && value.num <= most) {
      out = static_cast<T>(value.num);
      return true;
    }
    return refuse(value.line, key + " = " + value.shown() + "; accepted: a whole number from " + formatNumber(least) +
                                  " to " + formatNumber(most));
  }
  bool oneOf(const std::string &key, const TomlValue &value, const std::vector<std::string> &known, std::string &out) {
    if (value.kind == TomlValue::Kind::text && std::find(known.begin(), known.end(), value.text) != known.end()) {
      out = value.text;
      return true;
    }
    const std::string nearest = value.kind == TomlValue::Kind::text ? nearestName(value.text, known) : "";
    return refuse(value.line, key + " = " + value.shown() + "; " +
                                  (nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ") +
                                  "accepted: " + listOf(known));
  }
  bool file(const std::string &key, const TomlValue &value, std::filesystem::path &out) {
    std::string name;
    if (!text(key, value, name)) return false;
    out = normalPath(joinedPath(study_.source.parent_path(), name));
    std::error_code code;
    if (std::filesystem::is_regular_file(out, code)) return true;
    return refuse(value.line, key + ": " + out.string() + ": no such file");
  }

  bool run(const TomlValue &table);
  bool plugins(const TomlValue &value);
  bool oneCase(const TomlValue &table);
  bool quantity(const TomlValue &value, Quantity &out);
  bool reference(const TomlValue &table, const Quantity &quantity, Reference &out);
  bool richardson(const TomlValue &table, Reference &out);
  bool grids(const TomlValue &value, std::vector<Grid> &out);
  bool grid(const TomlValue &table, Grid &out);
  bool parameters(const std::string &prefix, const TomlValue::Entry &entry, std::vector<StudyParameter> &out);
  bool settings(const std::string &prefix, const TomlValue &table, std::vector<Setting> &out);
  bool valueOf(const std::string &name, const TomlValue &value, std::string &out);
  bool valuesOf(const TomlValue &value, StudyParameter &out);
  bool checkLever(const StudyParameter &parameter);
  bool contradiction(const std::vector<StudyParameter> &parameters);

  Study &study_;
  Error error_;
};

bool Reader::read(const TomlValue &root) {
  if (!keysAre(root, "the study", {"format", "title", "run", "case", "grid"})) return false;
  const TomlValue *format = root.find("format");
  if (format == nullptr) return refuse(1, "the study has no 'format'; accepted: format = 1");
  if (format->kind != TomlValue::Kind::integer || format->num != 1.0)
    return refuse(format->line, "format = " + format->shown() + " is not served; accepted: format = 1");
  study_.title = study_.source.stem().string();
  if (const TomlValue *title = root.find("title"); title && !text("title", *title, study_.title)) return false;
  if (const TomlValue *table = root.find("run"); table && !run(*table)) return false;
  const TomlValue *cases = root.find("case");
  if (cases == nullptr || cases->kind != TomlValue::Kind::array || cases->items.empty())
    return refuse(cases ? cases->line : 1,
                  "the study has no case; accepted: [[case]] tables with name, scene, quantity");
  for (const TomlValue &table : cases->items)
    if (!oneCase(table)) return false;
  std::vector<Grid> shared;
  if (const TomlValue *value = root.find("grid"); value && !grids(*value, shared)) return false;
  for (Case &one : study_.cases) {
    one.grids.insert(one.grids.end(), shared.begin(), shared.end());
    if (one.grids.empty())
      return refuse(one.line, "nothing is varied in case '" + one.name + "'; accepted: a [[grid]] or [[case.grid]]");
  }
  return true;
}

bool Reader::run(const TomlValue &table) {
  if (!keysAre(table, "[run]", {"repeat", "jobs", "time_limit", "seed", "samples", "plugins"})) return false;
  for (const auto &[key, value] : table.entries) {
    if (key == "repeat" && !whole(key, value, 1, 1000, study_.repeat)) return false;
    if (key == "jobs" && !whole(key, value, 1, 4096, study_.jobs.emplace())) return false;
    if (key == "time_limit" && !number(key, value, 0.0, study_.timeLimit_s, true)) return false;
    if (key == "seed" && !whole(key, value, 0, 9007199254740992.0, study_.seed)) return false;
    if (key == "samples" && !whole(key, value, 10, 50000, study_.samples)) return false;
    if (key == "plugins" && !plugins(value)) return false;
  }
  return true;
}

/// A name refers to the plugins that come with the program for studies; a path with a folder is relative to the study.
bool Reader::plugins(const TomlValue &value) {
  const char *accepted = "accepted: a list of names, as [\"baselines\"], or of files";
  if (value.kind != TomlValue::Kind::array) return refuse(value.line, "plugins = " + value.shown() + "; " + accepted);
  for (const TomlValue &item : value.items) {
    std::string name;
    if (!text("plugins", item, name)) return false;
    const bool isFile = name.find_first_of("/\\") != std::string::npos || name.ends_with(pluginExtension());
    const std::filesystem::path plugin =
        isFile ? joinedPath(study_.source.parent_path(), name)
               : executablePath().parent_path() / ".." / "lib" / "c3de" / "study" / (name + pluginExtension());
    study_.plugins.push_back(normalPath(plugin));
    std::error_code code;
    if (!std::filesystem::is_regular_file(study_.plugins.back(), code))
      return refuse(item.line, "plugins: " + study_.plugins.back().string() + ": no such file; " + accepted);
  }
  return true;
}

bool Reader::oneCase(const TomlValue &table) {
  Case one;
  one.line = table.line;
  if (!keysAre(table, "[[case]]", {"name", "scene", "until", "steps", "set", "quantity", "reference", "grid"}))
    return false;
  for (const char *key : {"name", "scene", "quantity", "reference"})
    if (table.find(key) == nullptr)
      return refuse(table.line,
                    std::string("the case has no '") + key + "'; accepted: name, scene, quantity and [case.reference]");
  if (!text("name", *table.find("name"), one.name)) return false;
  for (const Case &other : study_.cases)
    if (other.name == one.name)
      return refuse(table.line, "a second case is named '" + one.name + "'; names of cases have to differ");
  // The name is part of file names.
  if (one.name.find_first_of("/\\:*?\"<>|") != std::string::npos || one.name.front() == '.')
    return refuse(table.find("name")->line, "name = \"" + one.name + "\"; accepted: a name that a file can have");
  if (one.name == "overview")
    return refuse(table.find("name")->line,
                  "name = \"overview\" is that of the picture of all cases; accepted: another");
  if (!file("scene", *table.find("scene"), one.scene)) return false;
  for (const auto &[key, value] : table.entries) {
    if (key == "until" && !number(key, value, 0.0, one.until_s.emplace(), true)) return false;
    if (key == "steps" && !whole(key, value, 1, 1e12, one.steps.emplace())) return false;
    if (key == "set" && !settings("", value, one.set)) return false;
    if (key == "grid" && !grids(value, one.grids)) return false;
  }
  if (one.until_s && one.steps)
    return refuse(table.find("steps")->line, "the case has 'until' and 'steps'; accepted: one of them");
  if (!quantity(*table.find("quantity"), one.quantity)) return false;
  if (!reference(*table.find("reference"), one.quantity, one.reference)) return false;
  study_.cases.push_back(std::move(one));
  return true;
}

bool Reader::quantity(const TomlValue &value, Quantity &out) {
  const std::string accepted =
      "accepted: { probe = NAME, component = \"z\" }, { reaction = NUMBER, component = \"y\" }, { torque = NUMBER, "
      "component = "
      "\"y\" }, { frequency = PROBE, component = \"x\" }, { energy = \"elastic\" }, \"field\" or \"surface\"";
  out.line = value.line;
  if (value.kind == TomlValue::Kind::text && (value.text == "field" || value.text == "surface")) {
    out.kind = value.text == "field" ? Quantity::Kind::field : Quantity::Kind::surface;
    return true;
  }
  if (value.kind != TomlValue::Kind::table) return refuse(value.line, "quantity is " + value.shown() + "; " + accepted);
  if (!keysAre(value, "quantity", {"probe", "reaction", "torque", "frequency", "energy", "component"})) return false;
  const TomlValue *component = value.find("component");
  if (value.entries.size() != (component ? 2u : 1u) || (component && value.entries.size() < 2))
    return refuse(value.line, "quantity must name exactly one quantity; " + accepted);
  for (const auto &[key, is] : value.entries) {
    if (key == "component") continue;
    const bool isEnergy = key == "energy";
    if (isEnergy == (component != nullptr))
      return refuse(value.line, std::string("quantity has ") + (isEnergy ? "a" : "no") + " 'component'; " + accepted);
    out.kind = key == "probe"       ? Quantity::Kind::probe
               : key == "reaction"  ? Quantity::Kind::reaction
               : key == "torque"    ? Quantity::Kind::torque
               : key == "frequency" ? Quantity::Kind::frequency
                                    : Quantity::Kind::energy;
    if (isEnergy && !oneOf("energy", is, kEnergies, out.name)) return false;
    if ((key == "probe" || key == "frequency") && !text(key, is, out.name)) return false;
    if ((key == "reaction" || key == "torque") && !whole(key, is, 0, 1e6, out.fix)) return false;
  }
  if (component == nullptr) return true;
  auto known = kComponents;
  if (out.kind == Quantity::Kind::frequency) known.pop_back();
  std::string name;
  if (!oneOf("component", *component, known, name)) return false;
  out.component = static_cast<std::size_t>(std::find(known.begin(), known.end(), name) - known.begin());
  return true;
}

bool Reader::reference(const TomlValue &table, const Quantity &quantity, Reference &out) {
  out.line = table.line;
  if (!keysAre(table, "[case.reference]", {"value", "file", "richardson", "uncertainty", "kind", "source"}))
    return false;
  const TomlValue *value = table.find("value"), *file = table.find("file"), *refined = table.find("richardson");
  if ((value != nullptr) + (file != nullptr) + (refined != nullptr) != 1)
    return refuse(table.line, "the reference has " +
                                  std::string(value || file || refined ? "several sources" : "no source") +
                                  "; accepted: one of value = …, file = …, richardson = { lever, values }");
  if (refined != nullptr) {
    out.source = Reference::Source::richardson;
    out.kind = "richardson";
    for (const char *key : {"uncertainty", "kind", "source"})
      if (const TomlValue *extra = table.find(key))
        return refuse(extra->line,
                      std::string("'") + key + "' applies to a value or a file; richardson computes its own");
    return richardson(*refined, out);
  }
  for (const char *key : {"uncertainty", "kind", "source"})
    if (table.find(key) == nullptr)
      return refuse(table.line, std::string("the reference has no '") + key + "'; accepted: uncertainty (" +
                                    (file ? "m" : "in the unit of the value") + "), kind (" + listOf(kKinds) +
                                    ") and source (where it can be looked up)");
  if (!number("uncertainty", *table.find("uncertainty"), 0.0, out.uncertainty) ||
      !oneOf("kind", *table.find("kind"), kKinds, out.kind) || !text("source", *table.find("source"), out.from))
    return false;
  if (file != nullptr) {
    out.source = Reference::Source::file;
    if (!quantity.isField())
      return refuse(file->line,
                    "a file of displacements is a reference for the quantities \"field\" and \"surface\"; "
                    "accepted for " +
                        quantity.shown() + ": value or richardson");
    return this->file("file", *file, out.file);
  }
  if (quantity.isField())
    return refuse(value->line, "a number is no reference for a field; accepted: file or richardson");
  if (!value->isNumber() || !std::isfinite(value->num))
    return refuse(value->line, "value = " + value->shown() + "; accepted: a number in " + quantity.unit());
  if (value->num == 0.0)
    return refuse(value->line,
                  "value = 0: errors are shares of it; accepted: a number other than 0, or the quantity \"surface\", "
                  "whose errors are in mm");
  out.value = value->num;
  return true;
}

bool Reader::richardson(const TomlValue &table, Reference &out) {
  if (!keysAre(table, "richardson", {"lever", "values", "set", "share"})) return false;
  const TomlValue *parameter = table.find("lever"), *values = table.find("values");
  if (parameter == nullptr || values == nullptr)
    return refuse(table.line, std::string("richardson has no '") + (parameter ? "values" : "lever") +
                                  "'; accepted: { lever = \"spacing\", values = [a, b, c] }");
  if (!text("lever", *parameter, out.parameter.name)) return false;
  out.parameter.line = parameter->line;
  const std::vector<std::string> refinable{"spacing", "count", "dt", "substeps"};
  if (!out.parameter.isPath() && std::find(refinable.begin(), refinable.end(), out.parameter.name) == refinable.end())
    return refuse(parameter->line, "lever = " + parameter->shown() + " cannot be extrapolated; accepted: " +
                                       listOf(refinable) + ", or a scene path with a number that goes to 0");
  if (!values->isNumbers(3) ||
      std::any_of(values->items.begin(), values->items.end(), [](const TomlValue &v) { return !(v.num > 0.0); }))
    return refuse(values->line,
                  "values = " + values->shown() + "; accepted: three numbers above 0, from coarse to fine");
  if (!valuesOf(*values, out.parameter)) return false;
  const bool grows = out.parameter.name == "count" || out.parameter.name == "substeps";
  for (std::size_t i = 1; i < 3; ++i)
    if (grows ? values->items[i].num <= values->items[i - 1].num : values->items[i].num >= values->items[i - 1].num)
      return refuse(values->line, "values = " + values->shown() + " do not go from coarse to fine; accepted for '" +
                                      out.parameter.name + "': numbers that " + (grows ? "grow" : "fall"));
  if (const TomlValue *share = table.find("share"); share && !number("share", *share, 0.0, out.share, true))
    return false;
  if (const TomlValue *set = table.find("set")) {
    if (set->kind != TomlValue::Kind::table)
      return refuse(set->line, "set is " + set->kindName() + "; accepted: a table of scene paths");
    return settings("", *set, out.set);
  }
  return true;
}

bool Reader::grids(const TomlValue &value, std::vector<Grid> &out) {
  if (value.kind != TomlValue::Kind::array)
    return refuse(value.line, "grid is " + value.kindName() + "; accepted: [[grid]] tables");
  for (const TomlValue &table : value.items)
    if (!grid(table, out.emplace_back())) return false;
  return true;
}

bool Reader::grid(const TomlValue &table, Grid &out) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "grid is " + table.kindName() + "; accepted: a table of study parameters");
  out.line = table.line;
  for (const TomlValue::Entry &entry : table.entries) {
    if (entry.key == "label") {
      if (!text("label", entry.value, out.label)) return false;
    } else if (!parameters("", entry, out.parameters)) {
      return false;
    }
  }
  if (out.parameters.empty())
    return refuse(table.line,
                  "the grid has no study parameter; accepted: " + listOf(parameterNames()) + ", or a scene path");
  return contradiction(out.parameters);
}

/// A dotted key without quotes is a table of tables.
bool Reader::parameters(const std::string &prefix, const TomlValue::Entry &entry, std::vector<StudyParameter> &out) {
  const std::string name = prefix + entry.key;
  if (entry.value.kind == TomlValue::Kind::table) {
    for (const TomlValue::Entry &inner : entry.value.entries)
      if (!parameters(name + ".", inner, out)) return false;
    return true;
  }
  StudyParameter parameter{name, {}, entry.value.line};
  if (!checkLever(parameter) || !valuesOf(entry.value, parameter)) return false;
  out.push_back(std::move(parameter));
  return true;
}

bool Reader::checkLever(const StudyParameter &parameter) {
  const auto &known = parameterNames();
  if (parameter.isPath() || std::find(known.begin(), known.end(), parameter.name) != known.end()) return true;
  std::vector<std::string> all = known;
  all.emplace_back("label");
  const std::string nearest = nearestName(parameter.name, all);
  return refuse(parameter.line, "unknown study parameter '" + displayText(parameter.name) + "'; " +
                                    (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: label, " +
                                    listOf(known) + ", or a scene path in quotes such as \"solver.damping\"");
}

bool Reader::contradiction(const std::vector<StudyParameter> &parameters) {
  const std::array<std::array<const char *, 2>, 5> same{{{"spacing", "count"},
                                                         {"neighbours", "support"},
                                                         {"dt", "substeps"},
                                                         {"dt", "solver.dt"},
                                                         {"substeps", "solver.dt"}}};
  const auto find = [&](const std::string &name) {
    return std::find_if(parameters.begin(), parameters.end(),
                        [&](const StudyParameter &parameter) { return parameter.name == name; });
  };
  for (const auto &[a, b] : same)
    if (find(a) != parameters.end() && find(b) != parameters.end())
      return refuse(std::max(find(a)->line, find(b)->line), std::string("the grid has '") + a + "' and '" + b +
                                                                "', which are equivalent; accepted: one of them");
  return true;
}

bool Reader::valuesOf(const TomlValue &value, StudyParameter &out) {
  if (value.kind != TomlValue::Kind::array) return valueOf(out.name, value, out.values.emplace_back());
  if (value.items.empty())
    return refuse(value.line, out.name + " is an empty list; accepted: a value, or a list of at least one");
  for (const TomlValue &item : value.items) {
    std::string text;
    if (!valueOf(out.name, item, text)) return false;
    if (std::find(out.values.begin(), out.values.end(), text) != out.values.end())
      return refuse(value.line, out.name + " has the value " + text + " twice; accepted: values that differ");
    out.values.push_back(std::move(text));
  }
  return true;
}

bool Reader::valueOf(const std::string &name, const TomlValue &value, std::string &out) {
  const auto accepted = [&](const std::string &what) {
    return refuse(value.line, name + " = " + value.shown() + "; accepted: " + what);
  };
  const auto isWhole = [&](double most) {
    return value.kind == TomlValue::Kind::integer && value.num >= 1.0 && value.num <= most;
  };
  if (name == "threads" && !isWhole(1024)) return accepted("whole numbers from 1 to 1024");
  if (name == "substeps" && !isWhole(1e9)) return accepted("whole numbers from 1: steps of 1/60 s");
  if (name == "simulator" && value.kind != TomlValue::Kind::text) return accepted("the id of a class that simulates");
  switch (value.kind) {
    case TomlValue::Kind::boolean:
    case TomlValue::Kind::integer:
    case TomlValue::Kind::number: out = value.shown(); return true;
    case TomlValue::Kind::text:
      if (displayText(value.text) != value.text || value.text.find_first_of("\"\\") != std::string::npos)
        return accepted("text on one line without quotes");
      out = value.shown();
      return true;
    case TomlValue::Kind::array:
      for (const TomlValue &item : value.items)
        if (!item.isNumber()) return accepted("numbers, texts, true, false, and lists of numbers");
      for (const TomlValue &item : value.items) out += (out.empty() ? "[" : ",") + formatNumber(item.num);
      out += out.empty() ? "[]" : "]";
      return true;
    default: return accepted("numbers, texts, true, false, and lists of numbers");
  }
}

bool Reader::settings(const std::string &prefix, const TomlValue &table, std::vector<Setting> &out) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "set is " + table.kindName() + "; accepted: a table of scene paths");
  for (const TomlValue::Entry &entry : table.entries) {
    const std::string path = prefix + entry.key;
    if (entry.value.kind == TomlValue::Kind::table) {
      if (!settings(path + ".", entry.value, out)) return false;
      continue;
    }
    Setting setting{path, {}, entry.value.line};
    if (!valueOf(path, entry.value, setting.value)) return false;
    out.push_back(std::move(setting));
  }
  return true;
}

}  // namespace

std::string Quantity::unit() const {
  switch (kind) {
    case Kind::probe: return "m";
    case Kind::reaction: return "N";
    case Kind::torque: return "N m";
    case Kind::frequency: return "Hz";
    case Kind::energy: return "J";
    case Kind::field: return "1";
    case Kind::surface: return "mm";
  }
  return {};
}

std::string Quantity::shown() const {
  const std::string axis = kComponents[component];
  switch (kind) {
    case Kind::probe: return "displacement " + axis + " of probe '" + name + "'";
    case Kind::reaction: return "force " + axis + " of support " + std::to_string(fix);
    case Kind::torque: return "torque " + axis + " of support " + std::to_string(fix);
    case Kind::frequency: return "first frequency of probe '" + name + "', " + axis;
    case Kind::energy: return name + " energy";
    case Kind::field: return "displacement over the volume";
    case Kind::surface: return "displacement of the skin";
  }
  return {};
}

std::string Study::where(int line) const {
  return line > 0 ? source.string() + ":" + std::to_string(line) : source.string();
}

const std::vector<std::string> &parameterNames() {
  static const std::vector<std::string> names{"spacing",   "count",         "neighbours", "support", "evaluation",
                                              "law",       "poisson_ratio", "integrator", "dt",      "substeps",
                                              "precision", "threads",       "simulator"};
  return names;
}

Expected<Study> parseStudy(std::string_view text, const std::filesystem::path &source) {
  const auto root = scene::parseToml(text, source.string());
  if (!root) return tl::unexpected(root.error());
  Study study;
  study.source = source;
  Reader reader(study);
  if (!reader.read(*root)) return tl::unexpected(reader.error());
  return study;
}

Expected<Study> loadStudy(const std::filesystem::path &file) {
  const auto text = scene::readTextFile(file);
  if (!text) return tl::unexpected(text.error());
  return parseStudy(*text, file);
}

}  // namespace c3de::study
