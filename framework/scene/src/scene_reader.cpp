// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kBodyKeys{"name", "mesh", "mesh_unit", "position", "rotation_deg",
                                         "scale", "material", "sampling"};
const std::vector<std::string> kObstacleKeys{"name", "mesh", "mesh_unit", "position", "rotation_deg", "scale", "friction"};
const std::vector<std::string> kProbeKeys{"name", "body", "at"};
const std::vector<std::string> kRootKeys{"format", "title", "world", "solver", "body", "obstacle", "probe"};

std::string join(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Formats that say in which unit their numbers are.
bool carriesUnit(const std::filesystem::path &mesh) {
  const std::string extension = mesh.extension().string();
  return extension == ".gltf" || extension == ".glb";
}

std::filesystem::path pathFromUtf8(const std::string &text) {
  return std::filesystem::path(std::u8string(text.begin(), text.end()));
}

bool hasControlCharacter(const std::string &text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

}  // namespace

bool isKnownToTheFormat(std::string_view id) {
  static constexpr std::array kIds{
      "world.gravity",        "world.box.min",           "world.box.max",    "world.box.enabled",
      "solver.integrator",    "solver.dt",               "solver.damping",   "material.law",
      "material.density",     "material.youngs_modulus", "material.poisson_ratio", "material.viscosity",
      "material.plastic",     "material.plastic.yield",  "material.plastic.creep", "material.plastic.max",
      "sampling.spacing",     "sampling.count",          "sampling.neighbours",    "sampling.support",
      "friction"};
  return std::find(kIds.begin(), kIds.end(), id) != kIds.end();
}

bool SceneReader::refuse(int line, const std::string &what) {
  if (!error_.message.empty()) return false;
  if (override_.empty())
    error_ = {ErrorCode::input, scene_.where(line) + ": " + what};
  else
    error_ = {ErrorCode::usage, "--set " + override_ + ": " + what};
  return false;
}

bool SceneReader::refuseKey(int line, const std::string &key, const std::string &place,
                            const std::vector<std::string> &known) {
  const std::string nearest = nearestName(key, known);
  return refuse(line, "unknown key '" + key + "' in " + place + "; " +
                          (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + join(known));
}

bool SceneReader::readScene(const TomlValue &root) {
  const TomlValue *format = root.find("format");
  if (format == nullptr) return refuse(1, "the key 'format' is missing; accepted: format = 1");
  if (format->kind != TomlValue::Kind::integer || format->num != 1.0)
    return refuse(format->line, "format is " + (format->isNumber() ? formatNumber(format->num) : format->kindName()) +
                                    "; accepted: 1");
  for (const auto &[key, value] : root.entries) {
    if (key == "format") continue;
    if (key == "title") {
      if (!readText(key, value, scene_.title)) return false;
    } else if (key == "world" || key == "solver") {
      if (value.kind != TomlValue::Kind::table)
        return refuse(value.line, "'" + key + "' is " + value.kindName() + "; accepted: a table, [" + key + "]");
      if (!readWorld(key, value)) return false;
    } else if (key == "body" || key == "obstacle" || key == "probe") {
      if (!tables(value, key)) return false;
      for (const TomlValue &table : value.items) {
        const bool good = key == "body" ? readBody(table) : key == "obstacle" ? readObstacle(table) : readProbe(table);
        if (!good) return false;
      }
    } else if (key == "fix" || key == "load") {
      return refuse(value.line, "'" + key + "' is not served yet; this version serves: " + join(kRootKeys));
    } else {
      return refuseKey(value.line, key, "the scene", kRootKeys);
    }
  }
  if (scene_.bodies.empty()) return refuse(1, "the scene has no [[body]]; at least one is needed");
  if (scene_.title.empty()) scene_.title = scene_.source.stem().string();
  return checkBox() && checkProbes();
}

bool SceneReader::tables(const TomlValue &value, const std::string &key) {
  const bool good = value.kind == TomlValue::Kind::array &&
                    std::all_of(value.items.begin(), value.items.end(),
                                [](const TomlValue &item) { return item.kind == TomlValue::Kind::table; });
  if (good) return true;
  return refuse(value.line, "'" + key + "' is " + value.kindName() + "; accepted: one or more tables [[" + key + "]]");
}

bool SceneReader::readWorld(const std::string &prefix, const TomlValue &table) {
  for (const auto &[key, value] : table.entries) {
    if (prefix + "." + key == "world.box" && value.kind != TomlValue::Kind::table)
      return refuse(value.line, "world.box is " + value.kindName() + "; accepted: { min = [x, y, z], max = [x, y, z] }");
    if (!store(scene_.world, prefix + "." + key, value)) return false;
  }
  return true;
}

bool SceneReader::readBody(const TomlValue &table) {
  SceneBody body;
  body.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!bodyKey(body, key, value)) return false;
  if (body.mesh.empty()) return refuse(table.line, "the body has no 'mesh'; accepted: a mesh file beside the scene");
  if (!requireUnit(table, body.mesh, body.meshUnit)) return false;
  if (!checkAlternatives(body)) return false;

  const auto taken = [this](const std::string &name) {
    return std::any_of(scene_.bodies.begin(), scene_.bodies.end(),
                       [&](const SceneBody &other) { return other.name == name; });
  };
  if (body.name.empty()) {
    const std::string stem = body.mesh.stem().string();
    body.name = stem;
    for (int i = 2; taken(body.name); ++i) body.name = stem + "-" + std::to_string(i);
  } else if (taken(body.name)) {
    return refuse(table.line, "a second body is named '" + body.name + "'; names of bodies have to differ");
  }
  scene_.bodies.push_back(std::move(body));
  return true;
}

bool SceneReader::readObstacle(const TomlValue &table) {
  SceneObstacle obstacle;
  obstacle.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!obstacleKey(obstacle, key, value)) return false;
  if (obstacle.mesh.empty())
    return refuse(table.line, "the obstacle has no 'mesh'; accepted: a mesh file beside the scene");
  if (!requireUnit(table, obstacle.mesh, obstacle.meshUnit)) return false;
  if (obstacle.name.empty()) obstacle.name = obstacle.mesh.stem().string();
  scene_.obstacles.push_back(std::move(obstacle));
  return true;
}

bool SceneReader::readProbe(const TomlValue &table) {
  SceneProbe probe;
  probe.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!probeKey(probe, key, value)) return false;
  if (table.find("at") == nullptr)
    return refuse(table.line, "the probe has no 'at'; accepted: a material point [x, y, z] in m");
  if (probe.name.empty()) probe.name = "probe-" + std::to_string(scene_.probes.size() + 1);
  for (const SceneProbe &other : scene_.probes)
    if (other.name == probe.name)
      return refuse(table.line, "a second probe is named '" + probe.name + "'; names of probes have to differ");
  scene_.probes.push_back(std::move(probe));
  return true;
}

bool SceneReader::checkProbes() {
  std::vector<std::string> names;
  for (const SceneBody &body : scene_.bodies) names.push_back(body.name);
  for (SceneProbe &probe : scene_.probes) {
    if (probe.body.empty() && names.size() == 1) probe.body = names.front();
    if (std::find(names.begin(), names.end(), probe.body) != names.end()) continue;
    if (probe.body.empty()) return refuse(probe.line, "the probe has no 'body'; accepted: " + join(names));
    const std::string nearest = nearestName(probe.body, names);
    return refuse(probe.line, "there is no body '" + probe.body + "'; " +
                                  (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + join(names));
  }
  return true;
}

bool SceneReader::checkBox() {
  const SceneValue *min = nullptr, *max = nullptr, *any = nullptr;
  for (const SceneValue &value : scene_.world) {
    if (value.value.id.rfind("world.box.", 0) == 0) any = &value;
    if (value.value.id == "world.box.min") min = &value;
    if (value.value.id == "world.box.max") max = &value;
  }
  if (any == nullptr) return true;
  if (min == nullptr || max == nullptr) {
    const int line = any->line;
    return refuse(line, std::string("world.box has no '") + (min == nullptr ? "min" : "max") +
                            "'; accepted: { min = [x, y, z], max = [x, y, z] }");
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (min->value.type == C3DE_PARAM_VEC3 && max->value.type == C3DE_PARAM_VEC3 &&
        !(min->value.vec[axis] < max->value.vec[axis]))
      return refuse(max->line, "world.box: min " + min->value.display() + " and max " + max->value.display() +
                                   " leave no room; accepted: min below max in x, y and z");
  const bool said = std::any_of(scene_.world.begin(), scene_.world.end(),
                                [](const SceneValue &value) { return value.value.id == "world.box.enabled"; });
  if (!said) {
    ParameterValue enabled;
    enabled.id = "world.box.enabled";
    enabled.type = C3DE_PARAM_BOOL;
    enabled.num = 1.0;
    put(scene_.world, enabled, min->line);
  }
  return true;
}

bool SceneReader::bodyKey(SceneBody &body, const std::string &key, const TomlValue &value) {
  if (key == "name") {
    if (!readText(key, value, body.name)) return false;
    if (body.name.empty() || hasControlCharacter(body.name))
      return refuse(value.line, "name is \"" + body.name + "\"; accepted: text of at least one character on one line");
    return true;
  }
  if (key == "mesh") return meshKey(key, value, body.mesh);
  if (key == "mesh_unit") return unitKey(key, value, body.meshUnit);
  if (key == "material") return materialKey(body, value);
  if (key == "sampling") {
    if (value.kind != TomlValue::Kind::table)
      return refuse(value.line, "sampling is " + value.kindName() + "; accepted: a table such as { spacing = 0.01 }");
    return store(body.params, key, value);
  }
  if (key == "position" || key == "rotation_deg" || key == "scale") return placementKey(body.placement, key, value);
  if (key == "volume" || key == "label" || key == "threshold")
    return refuse(value.line, "'" + key + "' is not served yet; this version serves: " + join(kBodyKeys));
  return refuseKey(value.line, key, "[[body]]", kBodyKeys);
}

bool SceneReader::obstacleKey(SceneObstacle &obstacle, const std::string &key, const TomlValue &value) {
  if (key == "name") return readText(key, value, obstacle.name);
  if (key == "mesh") return meshKey(key, value, obstacle.mesh);
  if (key == "mesh_unit") return unitKey(key, value, obstacle.meshUnit);
  if (key == "friction") return store(obstacle.params, key, value);
  if (key == "position" || key == "rotation_deg" || key == "scale") return placementKey(obstacle.placement, key, value);
  return refuseKey(value.line, key, "[[obstacle]]", kObstacleKeys);
}

bool SceneReader::probeKey(SceneProbe &probe, const std::string &key, const TomlValue &value) {
  if (key == "name") return readText(key, value, probe.name);
  if (key == "body") return readText(key, value, probe.body);
  if (key == "at") return readVec3(key, value, probe.at_m);
  return refuseKey(value.line, key, "[[probe]]", kProbeKeys);
}

bool SceneReader::meshKey(const std::string &key, const TomlValue &value, std::filesystem::path &out) {
  std::string text;
  if (!readText(key, value, text)) return false;
  if (text.empty()) return refuse(value.line, "mesh is empty; accepted: a mesh file");
  const std::filesystem::path path = scene_.source.parent_path() / pathFromUtf8(text);
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return refuse(value.line, "mesh '" + text + "' does not exist; it is looked for at " + path.lexically_normal().string());
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

bool SceneReader::materialKey(SceneBody &body, const TomlValue &value) {
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
                                      (names.empty() ? "no presets are known" : "accepted: " + join(names)));
    }
    const auto number = [&](const char *id, double num) {
      ParameterValue parameter;
      parameter.id = id;
      parameter.num = num;
      put(body.params, parameter, preset->line);
    };
    number("material.density", found->density);
    number("material.youngs_modulus", found->youngsModulus);
    number("material.poisson_ratio", found->poissonRatio);
  }
  for (const auto &[key, member] : value.entries)
    if (key != "preset" && !store(body.params, "material." + key, member)) return false;
  return true;
}

bool SceneReader::requireUnit(const TomlValue &table, const std::filesystem::path &mesh, geometry::LengthUnit &unit) {
  if (table.find("mesh_unit") != nullptr) return true;
  if (!carriesUnit(mesh))
    return refuse(table.line, "'mesh_unit' is missing; " + mesh.extension().string() +
                                  " files do not say their unit; accepted: \"m\", \"mm\", \"cm\"");
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
      return refuse(value.line, key + ": " + formatNumber(value.items[i].num) + " is not accepted; accepted: finite numbers");
  out = {value.items[0].num, value.items[1].num, value.items[2].num};
  return true;
}

bool SceneReader::store(std::vector<SceneValue> &values, const std::string &id, const TomlValue &value) {
  if (value.kind == TomlValue::Kind::table) {
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
    for (const auto &[a, b] : kAlternatives)
      if (value.id == a || value.id == b)
        std::erase_if(values, [&](const SceneValue &other) { return other.value.id == a || other.value.id == b; });

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

bool SceneReader::readOverride(const std::string &path, const TomlValue &value) {
  override_ = path;
  const std::size_t dot = path.find('.');
  const std::string first = path.substr(0, dot);
  const std::string rest = dot == std::string::npos ? std::string() : path.substr(dot + 1);
  if (path == "title") return readText(path, value, scene_.title);
  if (!rest.empty()) {
    if (first == "world" || first == "solver") return store(scene_.world, path, value) && checkBox();
    if (first == "body") return overrideBody(rest, value);
    if (first == "obstacle") return overrideObstacle(rest, value);
    if (first == "probe") return overrideProbe(rest, value);
  }
  std::vector<std::string> known{"title", "world.gravity", "world.box.min", "world.box.max", "solver.integrator",
                                 "solver.dt", "solver.damping"};
  std::string list = join(known);
  for (const SceneBody &body : scene_.bodies) {
    list += ", body." + body.name + ".…";
    for (const char *id : {"material.law", "material.density", "material.youngs_modulus", "material.poisson_ratio",
                           "sampling.spacing", "sampling.count", "position", "rotation_deg", "scale"})
      known.push_back("body." + body.name + "." + id);
  }
  for (const SceneObstacle &obstacle : scene_.obstacles) {
    list += ", obstacle." + obstacle.name + ".…";
    known.push_back("obstacle." + obstacle.name + ".friction");
  }
  for (const SceneProbe &probe : scene_.probes) {
    list += ", probe." + probe.name + ".at";
    known.push_back("probe." + probe.name + ".at");
  }
  const std::string nearest = nearestName(path, known);
  return refuse(0, "there is no such path; " + (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                       "accepted: " + list);
}

namespace {

/// The element that "name.key" or "number.key" speaks of, and the key; names may contain dots.
template <class T>
T *findElement(std::vector<T> &elements, const std::string &rest, std::string &key) {
  T *best = nullptr;
  std::size_t bestLength = 0;
  const auto consider = [&](T &element, const std::string &name) {
    if (rest.size() <= name.size() + 1 || rest.compare(0, name.size(), name) != 0 || rest[name.size()] != '.') return;
    if (best != nullptr && name.size() <= bestLength) return;
    best = &element;
    bestLength = name.size();
  };
  for (T &element : elements) consider(element, element.name);
  for (std::size_t i = 0; best == nullptr && i < elements.size(); ++i) consider(elements[i], std::to_string(i));
  if (best != nullptr) key = rest.substr(bestLength + 1);
  return best;
}

template <class T>
std::string noElement(const std::vector<T> &elements, const std::string &what, const std::string &rest) {
  std::vector<std::string> names;
  for (const T &element : elements) names.push_back(element.name);
  const std::string name = rest.substr(0, rest.find('.'));
  if (std::find(names.begin(), names.end(), name) != names.end()) return "says no key of " + what + " '" + name + "'";
  const std::string nearest = nearestName(name, names);
  return "there is no " + what + " '" + name + "'; " + (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
         (names.empty() ? "the scene has none" : "accepted: " + join(names));
}

}  // namespace

bool SceneReader::overrideBody(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneBody *body = findElement(scene_.bodies, rest, key);
  if (body == nullptr) return refuse(0, noElement(scene_.bodies, "body", rest));
  if (key == "name") return refuse(0, "the name of a body cannot be changed here");
  if (key.rfind("material.preset", 0) == 0) return materialKey(*body, value);
  if (key.rfind("material.", 0) == 0 || key.rfind("sampling.", 0) == 0) return store(body->params, key, value);
  return bodyKey(*body, key, value);
}

bool SceneReader::overrideObstacle(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneObstacle *obstacle = findElement(scene_.obstacles, rest, key);
  if (obstacle == nullptr) return refuse(0, noElement(scene_.obstacles, "obstacle", rest));
  return obstacleKey(*obstacle, key, value);
}

bool SceneReader::overrideProbe(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneProbe *probe = findElement(scene_.probes, rest, key);
  if (probe == nullptr) return refuse(0, noElement(scene_.probes, "probe", rest));
  return probeKey(*probe, key, value) && checkProbes();
}

}  // namespace c3de::scene
