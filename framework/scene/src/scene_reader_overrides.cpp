// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "scene_fields.h"

namespace c3de::scene {

namespace {

/// Contact pairs have no name.
template <class T>
std::string nameOf(const T &element) {
  if constexpr (requires { element.name; })
    return element.name;
  else
    return {};
}

template <class T>
std::string nameOrNumber(const T &element, std::size_t number) {
  return nameOf(element).empty() ? std::to_string(number) : nameOf(element);
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
    if (!nameOf(element).empty()) consider(element, nameOf(element));
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
  if (std::find(names.begin(), names.end(), name) != names.end()) return "has no key for " + what + " '" + name + "'";
  return "there is no " + what + " '" + name + "'; " + (names.empty() ? "the scene has none" : suggestion(name, names));
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
  if (path == "title") return read(path, value, scene_.title);
  if (rest.empty()) return refusePath(path);
  if (path == "simulator.class") return readSimulatorClass(value);
  if (first == "world" || first == "solver" || first == "view") return read(path, value, scene_.world) && checkBox();
  if (first == "accuracy") return overrideAccuracyTarget(path, value);
  if (first == "body") return overrideBody(rest, value);
  if (first == "contact") return overrideContact(path, rest, value);
  if (first == "match") return overrideMatch(rest, value);
  bool isSet = false;
  const bool isKnown = anyTable([&](const auto &table) {
    if (table.key != first) return false;
    isSet = overrideElement(table, rest, value);
    return true;
  });
  return isKnown ? isSet : refusePath(path);
}

bool SceneReader::overrideAccuracyTarget(const std::string &path, const TomlValue &value) {
  if (isTargetKey(path))
    std::erase_if(scene_.world, [](const SceneValue &other) { return isTargetKey(other.value.id); });
  return read(path, value, scene_.world);
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
  if (scene_.match) add("match", kMatchFields.keys());
  (void)anyTable([&](const auto &table) {
    if (table.key == kBodyTable.key) return false;
    std::vector<std::string> keys;
    for (const auto &field : table.fields)
      if (field.rules.onCommandLine == Override::suggested) keys.push_back(field.key);
    const auto &elements = scene_.*table.list;
    for (std::size_t i = 0; i < elements.size(); ++i) add(table.key + "." + nameOrNumber(elements[i], i), keys);
    return false;
  });
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
  if (key == "material.preset") return readMaterial(key, value, body->params);
  if (keyUnder("material.", key)) return read(key, value, body->params);
  if (const auto member = keyUnder("sampling.", key)) return readSamplingKey(*body, *member, value);
  if (keyUnder("surroundings.", key)) return read(key, value, body->params);
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
  if (!readField(kBodyTable, key, value, *body)) return false;
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
  if (key == "velocity") return read(key, value, piece.velocity_m_s.emplace());
  if (key == C3DE_PARAM_ID_RIGID || key == C3DE_PARAM_ID_FREE) return read(key, value, params);
  if (key == "material" || key == "material.preset") return readMaterial(key, value, params);
  const auto sampling = keyUnder("sampling.", key);
  if (keyUnder("material.", key) || keyUnder("surroundings.", key) || (sampling && *sampling != "refine"))
    return read(key, value, params);
  return refuse(
      0, (key.empty() ? "has no key for a piece of '" + body.name + "'"
                      : "'" + key + "' applies to the whole of '" + body.name + "' and cannot be set for a piece") +
             "; accepted: material, material.…, sampling.… except refine, surroundings.…, velocity, rigid, "
             "free");
}

bool SceneReader::overrideSlides(SceneBody &body, const TomlValue &value) {
  const std::vector<SceneSlidingPart> before = body.volume.slides;
  const std::vector<std::string> names = namesOfPieces(body);
  if (!readSlides("slides", value, body.volume)) return false;
  // Settings of a piece stay with its name.
  const std::vector<std::string> now = namesOfPieces(body);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].isEmpty()) continue;
    const auto found = std::find(now.begin(), now.end(), names[i]);
    if (found == now.end())
      return refuse(0, noElement(now, "piece", names[i]) + "; an [[attachment]] or --set refers to it");
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
    if (*key == "region") return read(*key, value, body.parts[i].region);
    if (*key == "material" || *key == "material.preset") return readMaterial(*key, value, body.parts[i].params);
    if (keyUnder("material.", *key)) return read(*key, value, body.parts[i].params);
    return refuseKey(0, *key, "a part of a body", {"region", "material"});
  }
  return refuse(0, "there is no such part; the body '" + body.name + "' has " + std::to_string(body.parts.size()) +
                       "; accepted: body." + body.name + ".parts.NUMBER.material.…, numbers from 0");
}

template <class Table>
bool SceneReader::overrideElement(const SceneTable<Table> &table, const std::string &rest, const TomlValue &value) {
  std::string key;
  constexpr bool kIsAttachment = std::is_same_v<Table, SceneAttachment>;
  Table *element = findElement(scene_.*table.list, rest, key);
  if (element == nullptr)
    return refuse(0, noElement(scene_.*table.list, table.what, rest) +
                         (kIsAttachment ? "; what holds all of a body where it is in the scan is "
                                          "body.NAME.surroundings.stiffness"
                                        : ""));
  if (const auto *field = table.find(key); field != nullptr && field->rules.onCommandLine == Override::refused)
    return refuse(0, (kIsAttachment ? "what an attachment joins" : "the " + key + " of a " + table.what) +
                         " cannot be changed here");
  if constexpr (std::is_same_v<Table, SceneLoad>)
    if (!replaceLoad(*element, key)) return false;
  return readField(table, key, value, *element) && checkBodyNames() && checkMeasurements() &&
         (table.check == nullptr || (this->*table.check)(*element));
}

// Of force and pressure, the override takes precedence.
bool SceneReader::replaceLoad(SceneLoad &load, const std::string &key) {
  if (key == "pressure") load.force_N.reset();
  if (key == "force") {
    load.pressure_Pa.reset();
    load.follower = true;
  }
  return key != "follower" || load.pressure_Pa || refuse(0, "follower is for a pressure; the load has a force");
}

bool SceneReader::overrideContact(const std::string &path, const std::string &rest, const TomlValue &value) {
  const auto pair = keyUnder("pair.", rest);
  if (!pair) return read(path, value, scene_.world);
  for (std::size_t i = 0; i < scene_.contactPairs.size(); ++i)
    if (const auto key = keyUnder(std::to_string(i) + ".", *pair))
      return readField(kContactPairTable, *key, value, scene_.contactPairs[i]) && checkPairs();
  return refuse(0, "there is no such pair; the scene has " + std::to_string(scene_.contactPairs.size()) +
                       "; accepted: contact.pair.NUMBER.friction, contact.pair.NUMBER.enabled, numbers from 0");
}

}  // namespace c3de::scene
