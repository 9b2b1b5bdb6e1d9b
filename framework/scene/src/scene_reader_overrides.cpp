// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <optional>

#include "c3de/core/text.h"

namespace c3de::scene {

namespace {

template <class T>
std::string nameOrNumber(const T &element, std::size_t number) {
  return element.name.empty() ? std::to_string(number) : element.name;
}

/// The remainder of the key after the prefix, if it has it.
std::optional<std::string> keyUnder(std::string_view prefix, const std::string &key) {
  if (key.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return key.substr(prefix.size());
}

/// The element that "name.key" or "number.key" refers to, and the key; names may contain dots.
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
  for (T &element : elements)
    if (!element.name.empty()) consider(element, element.name);
  for (std::size_t i = 0; best == nullptr && i < elements.size(); ++i) consider(elements[i], std::to_string(i));
  if (best != nullptr) key = rest.substr(bestLength + 1);
  return best;
}

/// Names of the sliding pieces, then of the rest; empty: the body is not cut.
std::vector<std::string> namesOfAllPieces(const SceneBody &body) {
  std::vector<std::string> names = namesOfPieces(body);
  if (!names.empty()) names.push_back(nameOfRest(body));
  return names;
}

/// The settings of the piece that "piece.key" refers to, and the key, which may be missing; names may contain dots.
/// Null: there is no such piece.
ScenePiece *findPiece(SceneBody &body, const std::string &rest, std::string &key) {
  ScenePiece *best = nullptr;
  const std::vector<std::string> names = namesOfAllPieces(body);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string label = names[i].substr(body.name.size() + 1);
    const auto found = rest == label ? std::optional<std::string>("") : keyUnder(label + ".", rest);
    if (!found || (best && found->size() >= key.size())) continue;
    best = i < body.volume.slides.size() ? &body.volume.slides[i] : &body.volume.rest;
    key = *found;
  }
  return best;
}

std::string noElement(const std::vector<std::string> &names, const std::string &what, const std::string &name) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return "says no key of " + what + " '" + name + "'";
  const std::string nearest = nearestName(name, names);
  return "there is no " + what + " '" + name + "'; " + (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
         (names.empty() ? "the scene has none" : "accepted: " + joined(names));
}

template <class T>
std::string noElement(const std::vector<T> &elements, const std::string &what, const std::string &rest) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < elements.size(); ++i) names.push_back(nameOrNumber(elements[i], i));
  return noElement(names, what, rest.substr(0, rest.find('.')));
}

}  // namespace

bool SceneReader::readOverride(const std::string &path, const TomlValue &value, std::string_view assignment) {
  override_ = path;
  assignment_ = assignment;
  const std::size_t dot = path.find('.');
  const std::string first = path.substr(0, dot);
  const std::string rest = dot == std::string::npos ? std::string() : path.substr(dot + 1);
  if (path == "title") return readText(path, value, scene_.title);
  if (rest.empty()) return refusePath(path);
  if (path == "simulator.class") return readSimulatorClass(value);
  if (first == "world" || first == "solver" || first == "view") return store(scene_.world, path, value) && checkBox();
  if (first == "accuracy") return overrideAccuracyTarget(path, value);
  if (first == "body") return overrideBody(rest, value);
  if (first == "fix") return overrideFix(rest, value);
  if (first == "load") return overrideLoad(rest, value);
  if (first == "obstacle") return overrideObstacle(rest, value);
  if (first == "probe") return overrideProbe(rest, value);
  if (first == "contact") return overrideContact(path, rest, value);
  if (first == "probe_tool") return overrideProbeTool(rest, value);
  if (first == "grasp") return overrideGrasp(rest, value);
  if (first == "attachment") return overrideAttachment(rest, value);
  return refusePath(path);
}

bool SceneReader::overrideAccuracyTarget(const std::string &path, const TomlValue &value) {
  if (isTargetKey(path))
    std::erase_if(scene_.world, [](const SceneValue &other) { return isTargetKey(other.value.id); });
  return store(scene_.world, path, value);
}

bool SceneReader::refusePath(const std::string &path) {
  // The simulator decides which other keys exist under world, solver, view, material and sampling.
  std::vector<std::string> known{"title",
                                 "simulator.class",
                                 C3DE_PARAM_ID_GRAVITY,
                                 C3DE_PARAM_ID_BOX_MIN,
                                 C3DE_PARAM_ID_BOX_MAX,
                                 "solver.…",
                                 C3DE_PARAM_ID_DAMPING,
                                 "view.…",
                                 C3DE_PARAM_ID_ERROR_PERCENT,
                                 C3DE_PARAM_ID_ERROR_MM,
                                 C3DE_PARAM_ID_BUDGET_MS,
                                 C3DE_PARAM_ID_CONTACT_ENABLED,
                                 C3DE_PARAM_ID_CONTACT_SELF,
                                 C3DE_PARAM_ID_CONTACT_FRICTION};
  std::string list = joined(known);
  const auto add = [&](const std::string &element, const std::vector<std::string> &keys) {
    list += ", " + element + "." + (keys.size() == 1 ? keys.front() : "…");
    for (const std::string &key : keys) known.push_back(element + "." + key);
  };
  for (const SceneBody &body : scene_.bodies) {
    add("body." + body.name, {C3DE_PARAM_ID_DENSITY, C3DE_PARAM_ID_YOUNGS_MODULUS, C3DE_PARAM_ID_POISSON_RATIO,
                              C3DE_PARAM_ID_SPACING, C3DE_PARAM_ID_COUNT, C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS,
                              C3DE_PARAM_ID_RIGID, C3DE_PARAM_ID_FREE, "position", "rotation_deg", "matrix", "scale"});
    for (const std::string &piece : namesOfAllPieces(body))
      add("body." + piece, {C3DE_PARAM_ID_DENSITY, C3DE_PARAM_ID_YOUNGS_MODULUS, C3DE_PARAM_ID_POISSON_RATIO,
                            C3DE_PARAM_ID_SPACING, C3DE_PARAM_ID_COUNT, C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS,
                            C3DE_PARAM_ID_RIGID, C3DE_PARAM_ID_FREE, "velocity"});
  }
  for (std::size_t i = 0; i < scene_.fixes.size(); ++i)
    add("fix." + nameOrNumber(scene_.fixes[i], i),
        {"displacement", "rotation_deg", "centre", "ramp", "region", "body"});
  for (std::size_t i = 0; i < scene_.loads.size(); ++i)
    add("load." + nameOrNumber(scene_.loads[i], i), {"force", "pressure", "follower", "ramp", "region", "body"});
  for (const SceneObstacle &obstacle : scene_.obstacles)
    add("obstacle." + obstacle.name, {C3DE_PARAM_ID_FRICTION, C3DE_PARAM_ID_RESTITUTION, "displacement", "ramp",
                                      "position", "rotation_deg", "scale"});
  for (const SceneProbe &probe : scene_.probes) add("probe." + probe.name, {"at"});
  for (const SceneAttachment &attachment : scene_.attachments)
    add("attachment." + attachment.name, {"stiffness", "tangential", "within_mm", "region", "tears_at"});
  for (std::size_t i = 0; i < scene_.contactPairs.size(); ++i)
    add("contact.pair." + std::to_string(i), {"friction", "enabled"});
  for (const SceneProbeTool &tool : scene_.probeTools)
    add("probe_tool." + tool.name, {"radius_mm", "length_mm", "friction", "path"});
  for (const SceneGrasp &grasp : scene_.grasps)
    add("grasp." + grasp.name, {"at", "axis", "jaw_mm", "opening_mm", "closed_mm", "force_limit", "path"});
  const std::string nearest = nearestName(path, known);
  return refuse(
      0, "there is no such path; " + (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "accepted: " + list);
}

bool SceneReader::overrideBody(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneBody *body = findElement(scene_.bodies, rest, key);
  if (body == nullptr) return refuse(0, noElement(referableNames(scene_), "body", rest.substr(0, rest.find('.'))));
  std::string keyOfPiece;
  if (ScenePiece *piece = findPiece(*body, key, keyOfPiece)) return overridePiece(*body, *piece, keyOfPiece, value);
  if (key == "name") return refuse(0, "the name of a body cannot be changed here");
  if (key == "material.preset") return readMaterial(body->params, value);
  if (keyUnder("material.", key)) return store(body->params, key, value);
  if (const auto member = keyUnder("sampling.", key)) return samplingKey(*body, *member, value);
  if (keyUnder("surroundings.", key)) return store(body->params, key, value);
  if (const auto member = keyUnder("parts.", key)) {
    if (!body->volume.isOpen()) return overridePart(*body, *member, value);
    body->volume.overridesOfParts.push_back(assignment_);
    return true;
  }
  // The properties of tissues depend on the whole table.
  const bool hasTissues = body->volume.hasTissues();
  const bool isOfPieces = !body->volume.slides.empty() && (key == C3DE_PARAM_ID_RIGID || key == C3DE_PARAM_ID_FREE);
  if (key == "tissues" || key == "background" ||
      (hasTissues && (key == "parts" || key == "label" || key == "threshold" || key == "rigid" || key == "free")))
    return refuse(0, "'" + key + "' of " + (hasTissues ? "a body with tissues" : "a body") +
                         " cannot be changed here, only in the scene; accepted of tissues: "
                         "parts.NUMBER.material.…, in the order of those that are not rigid" +
                         (isOfPieces ? "; of pieces: PIECE." + key + ", pieces: " + joined(namesOfAllPieces(*body))
                                     : std::string()));
  const bool isOfVolume = key == "volume" || key == "label" || key == "threshold" || key == "mend" ||
                          key == "edge_length" || key == "region";
  if (isOfVolume && body->volume.file.empty())
    return refuse(0, "'" + key + "' belongs to a body with a 'volume'; this one has a 'mesh'");
  if ((key == "mesh" || key == "mesh_unit") && body->mesh.empty())
    return refuse(0, "'" + key + "' belongs to a body with a 'mesh'; this one has a 'volume'");
  if ((key == "slides" || key == "slide_friction") && !hasTissues)
    return refuse(0, "'" + key + "' belongs to a body with 'tissues'");
  if (key == "slides") return overrideSlides(*body, value);
  if (const std::size_t dot = key.find('.'); dot != std::string::npos && !body->volume.slides.empty())
    return refuse(0, noElement(namesOfAllPieces(*body), "piece", body->name + "." + key.substr(0, dot)) +
                         "; keys of '" + body->name + "': material.…, sampling.…, surroundings.…, parts.…");
  if (!bodyKey(*body, key, value)) return false;
  // Of two alternatives, the override takes precedence.
  if (key == "label") body->volume.threshold.reset();
  if (key == "threshold") {
    body->volume.label.reset();
    body->volume.labelName.clear();
  }
  return true;
}

bool SceneReader::overridePiece(const SceneBody &body, ScenePiece &piece, const std::string &key,
                                const TomlValue &value) {
  std::vector<SceneValue> &params = piece.params;
  if (key == "velocity") return readVec3(key, value, piece.velocity_m_s.emplace());
  if (key == C3DE_PARAM_ID_RIGID || key == C3DE_PARAM_ID_FREE) return store(params, key, value);
  if (key == "material" || key == "material.preset") return readMaterial(params, value);
  const auto sampling = keyUnder("sampling.", key);
  if (keyUnder("material.", key) || keyUnder("surroundings.", key) || (sampling && *sampling != "refine"))
    return store(params, key, value);
  return refuse(0, (key.empty() ? "says no key of a piece of '" + body.name + "'"
                                : "'" + key + "' is of all of '" + body.name + "' and cannot be changed for a piece") +
                       "; accepted: material, material.…, sampling.… but refine, surroundings.…, velocity, rigid, "
                       "free");
}

bool SceneReader::overrideSlides(SceneBody &body, const TomlValue &value) {
  const std::vector<SceneSlidingPart> before = body.volume.slides;
  const std::vector<std::string> names = namesOfPieces(body);
  if (!readSlides(value, body.volume)) return false;
  // Settings of a piece stay with its name.
  const std::vector<std::string> now = namesOfPieces(body);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].isEmpty()) continue;
    const auto found = std::find(now.begin(), now.end(), names[i]);
    if (found == now.end())
      return refuse(0, noElement(now, "piece", names[i]) + "; an [[attachment]] or --set speaks of it");
    static_cast<ScenePiece &>(body.volume.slides[static_cast<std::size_t>(found - now.begin())]) = before[i];
  }
  return checkBodyNames() && checkAttachments() && checkPairs();
}

bool SceneReader::overridePart(SceneBody &body, const std::string &rest, const TomlValue &value) {
  for (std::size_t i = 0; i < body.parts.size(); ++i) {
    const auto key = keyUnder(std::to_string(i) + ".", rest);
    if (!key) continue;
    if (*key == "region" && body.parts[i].region.kind == SceneRegion::Kind::voxels)
      return refuse(0, "this part is a tissue, whose region are its voxels; accepted: material.…");
    if (*key == "region") return readRegion(value, body.parts[i].region);
    if (*key == "material" || *key == "material.preset") return readMaterial(body.parts[i].params, value);
    if (keyUnder("material.", *key)) return store(body.parts[i].params, *key, value);
    return refuseKey(0, *key, "a part of a body", {"region", "material"});
  }
  return refuse(0, "there is no such part; the body '" + body.name + "' has " + std::to_string(body.parts.size()) +
                       "; accepted: body." + body.name + ".parts.NUMBER.material.…, numbers from 0");
}

bool SceneReader::overrideFix(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneFix *fix = findElement(scene_.fixes, rest, key);
  if (fix == nullptr) return refuse(0, noElement(scene_.fixes, "fix", rest));
  if (key == "name") return refuse(0, "the name of a fix cannot be changed here");
  return fixKey(*fix, key, value) && checkBodyNames();
}

bool SceneReader::overrideLoad(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneLoad *load = findElement(scene_.loads, rest, key);
  if (load == nullptr) return refuse(0, noElement(scene_.loads, "load", rest));
  if (key == "name") return refuse(0, "the name of a load cannot be changed here");
  // Of force and pressure, the override takes precedence.
  if (key == "pressure") load->force_N.reset();
  if (key == "force") {
    load->pressure_Pa.reset();
    load->follower = true;
  }
  if (key == "follower" && !load->pressure_Pa) return refuse(0, "follower is for a pressure; the load has a force");
  return loadKey(*load, key, value) && checkBodyNames();
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
  return probeKey(*probe, key, value) && checkBodyNames();
}

bool SceneReader::overrideContact(const std::string &path, const std::string &rest, const TomlValue &value) {
  const auto pair = keyUnder("pair.", rest);
  if (!pair) return store(scene_.world, path, value);
  for (std::size_t i = 0; i < scene_.contactPairs.size(); ++i)
    if (const auto key = keyUnder(std::to_string(i) + ".", *pair))
      return contactPairKey(scene_.contactPairs[i], *key, value) && checkPairs();
  return refuse(0, "there is no such pair; the scene has " + std::to_string(scene_.contactPairs.size()) +
                       "; accepted: contact.pair.NUMBER.friction, contact.pair.NUMBER.enabled, numbers from 0");
}

bool SceneReader::overrideAttachment(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneAttachment *attachment = findElement(scene_.attachments, rest, key);
  if (attachment == nullptr)
    return refuse(0, noElement(scene_.attachments, "attachment", rest) +
                         "; what holds all of a body where it is in the scan is body.NAME.surroundings.stiffness");
  if (key == "name" || key == "bodies") return refuse(0, "what an attachment joins cannot be changed here");
  return attachmentKey(*attachment, key, value);
}

bool SceneReader::overrideProbeTool(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneProbeTool *tool = findElement(scene_.probeTools, rest, key);
  if (tool == nullptr) return refuse(0, noElement(scene_.probeTools, "probe tool", rest));
  if (key == "name") return refuse(0, "the name of a probe tool cannot be changed here");
  return probeToolKey(*tool, key, value) && checkAxes(*tool);
}

bool SceneReader::overrideGrasp(const std::string &rest, const TomlValue &value) {
  std::string key;
  SceneGrasp *grasp = findElement(scene_.grasps, rest, key);
  if (grasp == nullptr) return refuse(0, noElement(scene_.grasps, "grasp", rest));
  if (key == "name" || key == "body") return refuse(0, "the " + key + " of a grasp cannot be changed here");
  return graspKey(*grasp, key, value) && checkGrasp(*grasp);
}

}  // namespace c3de::scene
