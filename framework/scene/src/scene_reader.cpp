// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>

#include "c3de/core/text.h"
#include "scene_fields.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kRootKeys{"format",    "title",    "image",   "world",      "solver",   "view",
                                         "body",      "fix",      "load",    "attachment", "obstacle", "probe",
                                         "simulator", "accuracy", "contact", "probe_tool", "grasp",    "landmark",
                                         "distance",  "angle",    "match"};
const std::vector<std::string> kAccuracyTargets{C3DE_PARAM_ID_ERROR_PERCENT, C3DE_PARAM_ID_ERROR_MM,
                                                C3DE_PARAM_ID_BUDGET_MS};

}  // namespace

bool isTargetKey(const std::string &id) {
  return std::find(kAccuracyTargets.begin(), kAccuracyTargets.end(), id) != kAccuracyTargets.end();
}

std::string joined(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string suggestion(const std::string &name, const std::vector<std::string> &known) {
  const std::string nearest = nearestName(name, known);
  return (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + joined(known);
}

bool SceneReader::refuse(int line, const std::string &what) {
  if (!error_.message.empty()) return false;
  if (override_.empty())
    error_ = {ErrorCode::input, scene_.where(line) + ": " + displayMessage(what)};
  else
    error_ = {ErrorCode::usage, displayMessage("--set " + override_ + ": " + what)};
  return false;
}

bool SceneReader::refuseKey(int line, const std::string &key, const std::string &place,
                            const std::vector<std::string> &known) {
  return refuse(line, "unknown key '" + key + "' in " + place + "; " + suggestion(key, known));
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
      if (!read(key, value, scene_.title)) return false;
    } else if (key == "simulator") {
      if (!readSimulator(value)) return false;
    } else if (key == "image") {
      if (!readImage(value)) return false;
    } else if (key == "match") {
      if (!readMatch(value)) return false;
    } else if (key == "contact") {
      if (!readContact(value)) return false;
    } else if (key == "world" || key == "solver" || key == "view" || key == "accuracy") {
      if (value.kind != TomlValue::Kind::table)
        return refuse(value.line, "'" + key + "' is " + value.kindName() + "; accepted: a table, [" + key + "]");
      if (!readWorld(key, value)) return false;
    } else {
      bool isRead = false;
      const bool isKnown = key.find('.') == std::string::npos && anyTable([&](const auto &table) {
                             if (table.key != key) return false;
                             isRead = readTables(table, value);
                             return true;
                           });
      if (!isKnown) return refuseKey(value.line, key, "the scene", kRootKeys);
      if (!isRead) return false;
    }
  }
  if (scene_.bodies.empty()) return refuse(1, "the scene has no [[body]]; at least one is needed");
  if (scene_.title.empty()) scene_.title = scene_.source.stem().string();
  return checkBox() && checkAccuracyTarget() && checkBodyNames() && checkMeasurements() && attachBodies() &&
         checkAttachments() && checkPairs() && checkMatch();
}

bool SceneReader::readWorld(const std::string &prefix, const TomlValue &table) {
  for (const auto &[key, value] : table.entries) {
    if (prefix + "." + key == "world.box" && value.kind != TomlValue::Kind::table)
      return refuse(value.line,
                    "world.box is " + value.kindName() + "; accepted: { min = [x, y, z], max = [x, y, z] }");
    if (!read(prefix + "." + key, value, scene_.world)) return false;
  }
  return true;
}

bool SceneReader::readSimulator(const TomlValue &table) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "'simulator' is " + table.kindName() + "; accepted: a table, [simulator] class = \"…\"");
  for (const auto &[key, value] : table.entries) {
    if (key != "class") return refuseKey(value.line, key, "[simulator]", {"class"});
    if (!readSimulatorClass(value)) return false;
  }
  return true;
}

bool SceneReader::readSimulatorClass(const TomlValue &value) {
  if (!read("class", value, scene_.simulatorClass)) return false;
  if (scene_.simulatorClass.empty())
    return refuse(value.line, "class is empty; accepted: the id of a class that simulates, `c3de plugins` lists them");
  scene_.simulatorLine = override_.empty() ? value.line : 0;
  return true;
}

bool SceneReader::checkBody(const TomlValue &keys, SceneBody &body) {
  if (!checkSource(keys, body) || !checkTissues(keys, body) || !checkPlacement(keys, body.placement)) return false;
  if (!body.name.empty()) return true;
  const auto isTaken = [&](const SceneBody &other) { return other.name == body.name; };
  const std::string stem = !body.mesh.empty()               ? body.mesh.stem().string()
                           : !body.volume.labelName.empty() ? body.volume.labelName
                                                            : body.volume.file.stem().stem().string();
  body.name = stem;
  for (int i = 2; std::any_of(scene_.bodies.begin(), scene_.bodies.end(), isTaken); ++i)
    body.name = stem + "-" + std::to_string(i);
  return true;
}

bool SceneReader::checkObstacle(const TomlValue &keys, SceneObstacle &obstacle) {
  if (!requireUnit(keys, obstacle.mesh, obstacle.meshUnit)) return false;
  // rotation_deg together with ramp would be mistaken for a rotating motion.
  if (!checkPlacement(keys, obstacle.placement)) return false;
  const bool isRotated = keys.find("motion_rotation_deg") != nullptr;
  if (obstacle.motion && obstacle.motion->quaternion && isRotated)
    return refuse(keys.line, "the obstacle has 'motion_rotation_deg' and 'motion_quaternion'; accepted: one of them");
  if (obstacle.motion && keys.find("displacement") == nullptr && !isRotated && !obstacle.motion->quaternion)
    return refuse(keys.line,
                  "the obstacle has 'centre' or 'ramp' and nothing that moves it; accepted: displacement = "
                  "[x, y, z] in m, motion_rotation_deg = [x, y, z]; rotation_deg is how it stands at the start");
  if (obstacle.name.empty()) obstacle.name = obstacle.mesh.stem().string();
  return true;
}

bool SceneReader::checkBodyNames() {
  const std::vector<std::string> names = referableNames(scene_);
  for (const SceneBody &body : scene_.bodies) {
    if (body.volume.slides.empty()) continue;
    std::vector<std::string> pieces = namesOfPieces(body);
    pieces.push_back(nameOfRest(body));
    for (const std::string &piece : pieces)
      if (std::count(names.begin(), names.end(), piece) > 1)
        return refuse(body.line, "'" + piece + "' is the name of a body and of a piece of '" + body.name +
                                     "'; accepted: names that differ");
  }
  for (SceneFix &fix : scene_.fixes)
    if (!checkBodyName("fix", fix.line, fix.body)) return false;
  for (SceneLoad &load : scene_.loads)
    if (!checkBodyName("load", load.line, load.body)) return false;
  for (SceneProbe &probe : scene_.probes)
    if (!checkBodyName("probe", probe.line, probe.body)) return false;
  for (SceneGrasp &grasp : scene_.grasps)
    if (!checkBodyName("grasp", grasp.line, grasp.body)) return false;
  return true;
}

bool SceneReader::checkBodyName(const std::string &what, int line, std::string &body) {
  const std::vector<std::string> names = referableNames(scene_);
  if (body.empty() && scene_.bodies.size() == 1) body = names.front();
  if (std::find(names.begin(), names.end(), body) != names.end()) return true;
  if (body.empty())
    return refuse(line, "the " + what + " has no 'body', and the scene has " + std::to_string(names.size()) +
                            "; accepted: " + joined(names));
  return refuse(line, "there is no body '" + body + "'; " + suggestion(body, names));
}

bool SceneReader::checkBox() {
  const SceneValue *min = nullptr, *max = nullptr, *any = nullptr;
  for (const SceneValue &value : scene_.world) {
    if (value.value.id.rfind("world.box.", 0) == 0) any = &value;
    if (value.value.id == C3DE_PARAM_ID_BOX_MIN) min = &value;
    if (value.value.id == C3DE_PARAM_ID_BOX_MAX) max = &value;
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
                                   " enclose no space; accepted: min below max in x, y and z");
  const bool said = std::any_of(scene_.world.begin(), scene_.world.end(),
                                [](const SceneValue &value) { return value.value.id == C3DE_PARAM_ID_BOX_ENABLED; });
  if (!said) {
    ParameterValue enabled;
    enabled.id = C3DE_PARAM_ID_BOX_ENABLED;
    enabled.type = C3DE_PARAM_BOOL;
    enabled.num = 1.0;
    put(scene_.world, enabled, min->line);
  }
  return true;
}

// Only one accuracy target is allowed: a second one in the file is an error, one on the command line replaces it.
bool SceneReader::checkAccuracyTarget() {
  const auto isOne = [](const SceneValue &value) { return isTargetKey(value.value.id); };
  const auto first = std::find_if(scene_.world.begin(), scene_.world.end(), isOne);
  if (first == scene_.world.end()) return true;
  const auto second = std::find_if(first + 1, scene_.world.end(), isOne);
  if (second == scene_.world.end()) return true;
  return refuse(second->line, "'" + first->value.id + "' and '" + second->value.id +
                                  "' are two wishes; accepted: one of " + joined(kAccuracyTargets));
}

}  // namespace c3de::scene
