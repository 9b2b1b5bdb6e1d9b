// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kBodyKeys{
    "name",     "mesh",       "mesh_unit", "position",         "rotation_deg",  "scale",  "material",
    "sampling", "parts",      "velocity",  "angular_velocity", "volume",        "series", "time",
    "label",    "threshold",  "mend",      "edge_length",      "rigid",         "free",   "matrix",
    "tissues",  "background", "region",    "slides",           "slide_friction"};
const std::vector<std::string> kObstacleKeys{
    "name",        "mesh",         "mesh_unit",           "position", "rotation_deg", "scale",  "friction",
    "restitution", "displacement", "motion_rotation_deg", "centre",   "ramp",         "matrix", "motion_quaternion"};
const std::vector<std::string> kProbeKeys{"name", "body", "at"};
const std::vector<std::string> kRootKeys{"format",    "title",    "image",   "world",      "solver",   "view",
                                         "body",      "fix",      "load",    "attachment", "obstacle", "probe",
                                         "simulator", "accuracy", "contact", "probe_tool", "grasp"};
const std::vector<std::string> kAccuracyTargets{C3DE_PARAM_ID_ERROR_PERCENT, C3DE_PARAM_ID_ERROR_MM,
                                                C3DE_PARAM_ID_BUDGET_MS};
const char *const kMotionRotation = "motion_rotation_deg";
const char *const kMotionQuaternion = "motion_quaternion";

bool isPlacement(const std::string &key) {
  return key == "position" || key == "rotation_deg" || key == "scale" || key == "matrix";
}

bool hasControlCharacter(const std::string &text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

}  // namespace

bool isTargetKey(const std::string &id) {
  return std::find(kAccuracyTargets.begin(), kAccuracyTargets.end(), id) != kAccuracyTargets.end();
}

std::string joined(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
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
  const std::string nearest = nearestName(key, known);
  return refuse(line, "unknown key '" + key + "' in " + place + "; " +
                          (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + joined(known));
}

bool SceneReader::readScene(const TomlValue &root) {
  const TomlValue *format = root.find("format");
  if (format == nullptr) return refuse(1, "the key 'format' is missing; accepted: format = 1");
  if (format->kind != TomlValue::Kind::integer || format->num != 1.0)
    return refuse(format->line, "format is " + (format->isNumber() ? formatNumber(format->num) : format->kindName()) +
                                    "; accepted: 1");
  using Read = bool (SceneReader::*)(const TomlValue &);
  const auto readerOf = [](const std::string &key) -> Read {
    if (key == "body") return &SceneReader::readBody;
    if (key == "fix") return &SceneReader::readFix;
    if (key == "load") return &SceneReader::readLoad;
    if (key == "attachment") return &SceneReader::readAttachment;
    if (key == "obstacle") return &SceneReader::readObstacle;
    if (key == "probe") return &SceneReader::readProbe;
    if (key == "probe_tool") return &SceneReader::readProbeTool;
    if (key == "grasp") return &SceneReader::readGrasp;
    return nullptr;
  };
  for (const auto &[key, value] : root.entries) {
    if (key == "format") continue;
    if (key == "title") {
      if (!readText(key, value, scene_.title)) return false;
    } else if (key == "simulator") {
      if (!readSimulator(value)) return false;
    } else if (key == "image") {
      if (!readImage(value)) return false;
    } else if (key == "contact") {
      if (!readContact(value)) return false;
    } else if (key == "world" || key == "solver" || key == "view" || key == "accuracy") {
      if (value.kind != TomlValue::Kind::table)
        return refuse(value.line, "'" + key + "' is " + value.kindName() + "; accepted: a table, [" + key + "]");
      if (!readWorld(key, value)) return false;
    } else if (const auto read = readerOf(key); read != nullptr) {
      if (!tables(value, key)) return false;
      for (const TomlValue &table : value.items)
        if (!(this->*read)(table)) return false;
    } else {
      return refuseKey(value.line, key, "the scene", kRootKeys);
    }
  }
  if (scene_.bodies.empty()) return refuse(1, "the scene has no [[body]]; at least one is needed");
  if (scene_.title.empty()) scene_.title = scene_.source.stem().string();
  return checkBox() && checkAccuracyTarget() && checkBodyNames() && attachBodies() && checkAttachments() &&
         checkPairs();
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
      return refuse(value.line,
                    "world.box is " + value.kindName() + "; accepted: { min = [x, y, z], max = [x, y, z] }");
    if (!store(scene_.world, prefix + "." + key, value)) return false;
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
  if (!readText("class", value, scene_.simulatorClass)) return false;
  if (scene_.simulatorClass.empty())
    return refuse(value.line, "class is empty; accepted: the id of a class that simulates, `c3de plugins` lists them");
  scene_.simulatorLine = override_.empty() ? value.line : 0;
  return true;
}

bool SceneReader::readBody(const TomlValue &table) {
  SceneBody body;
  body.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!bodyKey(body, key, value)) return false;
  if (!checkSource(table, body) || !checkTissues(table, body) || !checkPlacement(table, body.placement)) return false;

  const auto taken = [this](const std::string &name) {
    return std::any_of(scene_.bodies.begin(), scene_.bodies.end(),
                       [&](const SceneBody &other) { return other.name == name; });
  };
  if (body.name.empty()) {
    const std::string stem = !body.mesh.empty()               ? body.mesh.stem().string()
                             : !body.volume.labelName.empty() ? body.volume.labelName
                                                              : body.volume.file.stem().stem().string();
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
  // rotation_deg together with ramp would be mistaken for a rotating motion.
  if (!checkPlacement(table, obstacle.placement)) return false;
  if (obstacle.motion && obstacle.motion->quaternion && table.find(kMotionRotation) != nullptr)
    return refuse(table.line, "the obstacle has 'motion_rotation_deg' and 'motion_quaternion'; accepted: one of them");
  if (obstacle.motion && table.find("displacement") == nullptr && table.find(kMotionRotation) == nullptr &&
      !obstacle.motion->quaternion)
    return refuse(table.line,
                  "the obstacle has 'centre' or 'ramp' and nothing that moves it; accepted: displacement = "
                  "[x, y, z] in m, motion_rotation_deg = [x, y, z]; rotation_deg is how it stands at the start");
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
  const std::string nearest = nearestName(body, names);
  return refuse(line, "there is no body '" + body + "'; " +
                          (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + joined(names));
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
                                   " leave no room; accepted: min below max in x, y and z");
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

bool SceneReader::bodyKey(SceneBody &body, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, body.name);
  if (key == "mesh") return meshKey(key, value, body.mesh);
  if (key == "mesh_unit") return unitKey(key, value, body.meshUnit);
  if (key == "material") return readMaterial(body.params, value);
  if (key == "sampling") {
    if (value.kind != TomlValue::Kind::table)
      return refuse(value.line, "sampling is " + value.kindName() + "; accepted: a table such as { spacing = 0.01 }");
    for (const auto &[member, memberValue] : value.entries)
      if (!samplingKey(body, member, memberValue)) return false;
    return true;
  }
  if (key == C3DE_PARAM_ID_RIGID || key == C3DE_PARAM_ID_FREE) return store(body.params, key, value);
  if (key == "parts") return readParts(value, body.parts);
  if (key == "velocity") return readVec3(key, value, body.velocity_m_s);
  if (key == "angular_velocity") return readVec3(key, value, body.angularVelocity_rad_s);
  if (isPlacement(key)) return placementKey(body.placement, key, value);
  if (key == "tissues") return readTissues(value, body.volume);
  if (key == "background") return readBackground(value, body);
  if (key == "slides") return readSlides(value, body.volume);
  if (key == "slide_friction") return readFriction(key, value, body.volume.slidingFriction);
  if (key == "volume" || key == "series" || key == "time" || key == "label" || key == "threshold" || key == "mend" ||
      key == "edge_length" || key == "region")
    return volumeKey(body.volume, key, value);
  return refuseKey(value.line, key, "[[body]]", kBodyKeys);
}

bool SceneReader::obstacleKey(SceneObstacle &obstacle, const std::string &key, const TomlValue &value) {
  if (key == "name") return readText(key, value, obstacle.name);
  if (key == "mesh") return meshKey(key, value, obstacle.mesh);
  if (key == "mesh_unit") return unitKey(key, value, obstacle.meshUnit);
  if (key == C3DE_PARAM_ID_FRICTION || key == C3DE_PARAM_ID_RESTITUTION) return store(obstacle.params, key, value);
  if (isPlacement(key)) return placementKey(obstacle.placement, key, value);
  if (key == "displacement" || key == kMotionRotation || key == kMotionQuaternion || key == "centre" || key == "ramp") {
    if (!obstacle.motion) obstacle.motion.emplace();
    return motionKey(*obstacle.motion, key, kMotionRotation, value);
  }
  return refuseKey(value.line, key, "[[obstacle]]", kObstacleKeys);
}

bool SceneReader::probeKey(SceneProbe &probe, const std::string &key, const TomlValue &value) {
  if (key == "name") return readText(key, value, probe.name);
  if (key == "body") return readText(key, value, probe.body);
  if (key == "at") return readVec3(key, value, probe.at_m);
  return refuseKey(value.line, key, "[[probe]]", kProbeKeys);
}

bool SceneReader::readName(const TomlValue &value, std::string &out) {
  if (!readText("name", value, out)) return false;
  if (out.empty() || hasControlCharacter(out))
    return refuse(value.line, "name is \"" + out + "\"; accepted: text of at least one character on one line");
  return true;
}

}  // namespace c3de::scene
