// SPDX-License-Identifier: Apache-2.0
#include "scene_writer.h"

#include <algorithm>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "scene_fields.h"
#include "toml_text.h"

namespace c3de::scene {
namespace {

/// Two keys for the same quantity: an override replaces the value of the file.
constexpr const char *kAlternatives[][2] = {{C3DE_PARAM_ID_SPACING, C3DE_PARAM_ID_COUNT},
                                            {"sampling.neighbours", "sampling.support"}};

bool isInTable(const std::string &prefix, const SceneValue &value) { return value.value.id.rfind(prefix, 0) == 0; }

bool areSame(const SceneValue &a, const SceneValue &b) {
  return a.value.id == b.value.id && a.value.type == b.value.type && a.value.num == b.value.num &&
         a.value.text == b.value.text && a.value.vec == b.value.vec && a.isOptional == b.isOptional;
}

/// Whether each value of one is in the other.
bool areSame(const std::vector<SceneValue> &a, const std::vector<SceneValue> &b) {
  return a.size() == b.size() && std::all_of(a.begin(), a.end(), [&](const SceneValue &one) {
           return std::any_of(b.begin(), b.end(), [&](const SceneValue &other) { return areSame(one, other); });
         });
}

std::vector<SceneValue> materialIn(std::vector<SceneValue> params) {
  std::erase_if(params, [](const SceneValue &value) { return !isInTable("material.", value); });
  return params;
}

bool isOfTissue(const ScenePart &part) { return part.region.kind == SceneRegion::Kind::voxels; }

void dropReplaced(std::vector<SceneValue> &params) {
  for (const auto &alternatives : kAlternatives) {
    const auto at = [&](const char *id) {
      return std::find_if(params.begin(), params.end(), [&](const SceneValue &value) { return value.value.id == id; });
    };
    const auto one = at(alternatives[0]), other = at(alternatives[1]);
    if (one == params.end() || other == params.end() || one->overridePath.empty() == other->overridePath.empty())
      continue;
    params.erase(one->overridePath.empty() ? one : other);
  }
}

/// Whether a key of the table is read into parameters of this id.
template <class Table>
bool isParameter(const Fields<Table> &table, const std::string &id) {
  const Field<Table> *field = table.find(id.substr(0, id.find('.')));
  return field != nullptr && field->isParameter;
}

void simplify(ScenePlacement &placement) {
  if (placement.matrix) placement = {{}, {}, 1.0, placement.matrix};
}

void simplify(SceneMotion &motion) {
  if (motion.quaternion) motion.rotation_deg = {};
}

}  // namespace

TomlValue SceneWriter::writeScene(const SceneFile &scene) {
  TomlValue root;
  root.entries.push_back({"format", *write("format", std::size_t{1})});
  const auto add = [](TomlValue &table, const char *key, Written value) {
    if (value) table.entries.push_back({key, std::move(*value)});
  };
  if (!scene.title.empty()) add(root, "title", write("title", scene.title));
  if (scene.bodies.empty()) refuse("it has no body; accepted: one at least");
  if (!scene.simulatorClass.empty()) {
    TomlValue simulator;
    add(simulator, "class", write("class", scene.simulatorClass));
    root.entries.push_back({"simulator", std::move(simulator)});
  }
  place_ = "[image]";
  if (scene.image) root.entries.push_back({"image", writeFields(kImageFields, *scene.image)});
  place_ = "[match]";
  if (scene.match) root.entries.push_back({"match", writeFields(kMatchFields, *scene.match)});
  place_ = "scene";
  writeWorld(scene.world, root);
  (void)anyTable([&](const auto &table) {
    TomlValue list = writeTable(table, scene);
    if (table.key == kAttachmentTable.key) writeLayers(scene, list);
    if (list.items.empty()) return false;
    const std::size_t dot = table.key.find('.');
    const std::string first = table.key.substr(0, dot);
    if (dot == std::string::npos) {
      root.entries.push_back({first, std::move(list)});
      return false;
    }
    if (root.find(first) == nullptr) root.entries.push_back({first, TomlValue()});
    for (TomlValue::Entry &entry : root.entries)
      if (entry.key == first) entry.value.entries.push_back({table.key.substr(dot + 1), std::move(list)});
    return false;
  });
  return root;
}

void SceneWriter::writeWorld(const std::vector<SceneValue> &world, TomlValue &root) {
  static const std::vector<std::string> kSections{"world", "solver", "view", "accuracy", "contact"};
  const std::string pairs = kContactPairTable.key;
  for (const SceneValue &value : world) {
    const std::string section = value.value.id.substr(0, value.value.id.find('.'));
    const bool isPair = value.value.id == pairs || isInTable(pairs + ".", value);
    if (isPair || section == value.value.id ||
        std::find(kSections.begin(), kSections.end(), section) == kSections.end())
      refuse("'" + value.value.id + "' is no value of a scene; accepted: values of " + joined(kSections));
  }
  for (const std::string &section : kSections)
    if (Written values = write(section, world)) root.entries.push_back({section, std::move(*values)});
}

template <class Table>
TomlValue SceneWriter::writeTable(const SceneTable<Table> &table, const SceneFile &scene) {
  const std::vector<Table> &list = scene.*table.list;
  TomlValue tables = tomlList({});
  for (std::size_t i = 0; i < list.size(); ++i) {
    place_ = table.what + " " + std::to_string(i);
    if constexpr (requires { list[i].name; }) {
      constexpr bool kMayBeNameless = std::is_same_v<Table, SceneFix> || std::is_same_v<Table, SceneLoad>;
      if (!list[i].name.empty())
        place_ = table.what + " '" + list[i].name + "'";
      else if (!kMayBeNameless)
        refuse("it has no name");
    }
    tables.items.push_back(writeFields(table, simplified(list[i])));
    TomlValue &keys = tables.items.back();
    // The reader requires these also where they have no effect.
    if constexpr (std::is_same_v<Table, SceneObstacle>)
      if (list[i].motion && !list[i].motion->quaternion && keys.find("displacement") == nullptr &&
          keys.find("motion_rotation_deg") == nullptr)
        keys.entries.push_back({"displacement", *write("displacement", Vec3{})});
    if constexpr (std::is_same_v<Table, SceneContactPair>)
      if (list[i].enabled && !list[i].friction) keys.entries.push_back({"enabled", *write("enabled", true)});
  }
  place_ = "scene";
  return tables;
}

void SceneWriter::writeLayers(const SceneFile &scene, TomlValue &attachments) {
  for (const SceneBody &body : scene.bodies) {
    place_ = "body '" + body.name + "'";
    writeLayer(body.name, body.params, attachments);
    const auto writePiece = [&](const std::string &name, const ScenePiece &piece) {
      place_ = "piece '" + name + "'";
      if (piece.velocity_m_s) refuse("its velocity cannot be written; a scene file has one for the whole body");
      for (const SceneValue &value : piece.params)
        if (!isInTable("surroundings.", value))
          refuse("'" + value.value.id + "' cannot be written; a scene file has it for the whole body");
      writeLayer(name, piece.params, attachments);
    };
    const std::vector<std::string> pieces = namesOfPieces(body);
    for (std::size_t i = 0; i < pieces.size(); ++i) writePiece(pieces[i], body.volume.slides[i]);
    if (!body.volume.rest.isEmpty()) writePiece(nameOfRest(body), body.volume.rest);
  }
  place_ = "scene";
}

void SceneWriter::writeLayer(const std::string &body, const std::vector<SceneValue> &params, TomlValue &attachments) {
  const Written layer = write("surroundings", params);
  if (!layer) return;
  TomlValue keys;
  keys.entries.push_back({"bodies", *write("bodies", std::array<std::string, 2>{body, kSurroundingsName})});
  for (const TomlValue::Entry &entry : layer->entries) {
    const std::string &key = entry.key;
    const TomlValue &value = entry.value;
    if (std::find(kSurroundingsKeys.begin(), kSurroundingsKeys.end(), key) == kSurroundingsKeys.end()) {
      refuse("'surroundings." + key + "' is no value of an attachment");
      return;
    }
    SceneAttachment scratch;
    if (!accepts([&](SceneReader &reader) { return kAttachmentTable.find(key)->read(reader, key, value, scratch); }))
      return;
    keys.entries.push_back({key, value});
  }
  if (keys.find("stiffness") == nullptr) refuse("'surroundings." + keys.entries.back().key + "' without a stiffness");
  attachments.items.push_back(std::move(keys));
}

void SceneWriter::checkBody(const SceneBody &body) {
  const SceneVolume &volume = body.volume;
  const bool isResolved = volume.isSettled || volume.ruled || volume.cut || volume.piece != 0 || body.rigidTissue;
  if (isResolved) {
    refuse(std::string(volume.cut || volume.piece != 0 ? "it is a piece of a body that has been cut"
                       : volume.ruled                  ? "the rules of its tissues have been applied to a map"
                                                       : "its label map has been resolved") +
           "; accepted: the scene as it was before");
    return;
  }
  for (const SceneValue &value : body.params) {
    const std::string &id = value.value.id;
    const bool isValue =
        isInTable("material.", value) || isInTable("surroundings.", value) ||
        (isInTable("sampling.", value) && id != "sampling.refine" && !isInTable("sampling.refine.", value));
    if (!isValue && !isParameter(kBodyTable, id)) refuse("'" + id + "' is no value of a body");
  }
  if (body.mesh.empty() && volume.file.empty() && !volume.mask) refuse("it has neither a mesh nor a volume");
  if (!volume.overridesOfParts.empty())
    refuse("'" + volume.overridesOfParts.front() + "' is for a part that exists once the label map has been read");
  if (!volume.hasTissues()) return;
  const std::vector<SceneValue> own = materialIn(body.params);
  const auto first = std::find_if(body.parts.begin(), body.parts.end(), isOfTissue);
  const bool isOfFirst = areSame(own, first == body.parts.end() ? std::vector<SceneValue>() : first->params);
  if (!volume.background && !isOfFirst)
    refuse("its material outside of its tissues" + (own.empty() ? std::string() : ", '" + own.front().value.id + "',") +
           " is not that of the first tissue; a scene file has a material for each tissue");
}

SceneBody SceneWriter::simplified(const SceneBody &body) {
  checkBody(body);
  SceneBody out = body;
  SceneVolume &volume = out.volume;
  simplify(out.placement);
  dropReplaced(out.params);
  if (out.mesh.empty()) out.meshUnit.reset();
  if (volume.slides.empty()) volume.slidingFriction = kSlideFriction;
  if (!volume.mask) return out;
  const std::string name = nameOfMask_ ? nameOfMask_(body) : std::string();
  if (name.empty()) refuse("its voxels are in memory only; accepted: the name of a volume file");
  if (volume.hasTissues()) refuse("it has tissues, and its voxels are in memory only");
  volume.file = folder_ / pathFromText(name);
  volume.label = std::uint16_t{1};
  volume.labelName.clear();
  volume.threshold.reset();
  volume.series.clear();
  volume.time = 0;
  return out;
}

SceneFix SceneWriter::simplified(const SceneFix &fix) {
  SceneFix out = fix;
  simplify(out.motion);
  return out;
}

SceneObstacle SceneWriter::simplified(const SceneObstacle &obstacle) {
  SceneObstacle out = obstacle;
  simplify(out.placement);
  if (out.motion) simplify(*out.motion);
  for (const SceneValue &value : out.params)
    if (!isParameter(kObstacleTable, value.value.id)) refuse("'" + value.value.id + "' is no value of an obstacle");
  return out;
}

SceneAttachment SceneWriter::simplified(const SceneAttachment &attachment) {
  if (attachment.names[1] == kSurroundingsName && !attachment.region && attachment.tearsAt_Pa == 0.0)
    refuse("it is of all of the surface and does not tear; a scene file has that as a value of the body");
  return attachment;
}

SceneContactPair SceneWriter::simplified(const SceneContactPair &pair) {
  if (pair.fits) refuse("it is of pieces of a body that has been cut; accepted: the scene as it was before");
  return pair;
}

SceneWriter::Written SceneWriter::materialOf(const std::string &key, const SceneBody &body) {
  return body.volume.hasTissues() ? Written() : writeMaterial(key, body.params);
}

SceneWriter::Written SceneWriter::partsOf(const std::string &key, const SceneBody &body) {
  std::vector<ScenePart> parts = body.parts;
  if (body.volume.hasTissues()) std::erase_if(parts, isOfTissue);
  return write(key, parts);
}

SceneWriter::Written SceneWriter::samplingOf(const std::string &key, const SceneBody &body) {
  Written written = write(key, body.params);
  const Written refine = write("sampling.refine", body.refinements);
  if (refine && !written) written.emplace();
  if (refine) written->entries.push_back({"refine", *refine});
  return written;
}

SceneWriter::Written SceneWriter::labelOf(const std::string &key, const SceneVolume &volume) {
  if (!volume.labelName.empty()) return write(key, volume.labelName);
  return volume.label ? write(key, std::size_t{*volume.label}) : std::nullopt;
}

SceneWriter::Written SceneWriter::tissuesOf(const std::string &, const SceneBody &body) {
  const SceneVolume &volume = body.volume;
  if (volume.usesKnownTissues)
    return volume.tissues.empty() ? tomlString("known") : refuse("its tissues are known and listed");
  if (volume.tissues.empty()) return std::nullopt;
  TomlValue list = tomlList({});
  auto part = body.parts.begin();
  for (SceneTissue tissue : volume.tissues) {
    if (!volume.isOpen() && !tissue.isRigid && !tissue.isEmpty) {
      part = std::find_if(part, body.parts.end(), isOfTissue);
      if (part == body.parts.end()) return refuse("tissue '" + tissue.label + "' has no part");
      tissue.params = (part++)->params;
    }
    list.items.push_back(writeFields(kTissueFields, tissue));
  }
  return list;
}

SceneWriter::Written SceneWriter::backgroundOf(const std::string &, const SceneBody &body) {
  return body.volume.background ? Written(writeFields(kBackgroundFields, body)) : std::nullopt;
}

SceneWriter::Written SceneWriter::materialOfBackground(const std::string &, const SceneBody &body) {
  return writeMaterial("material", body.params).value_or(TomlValue());
}

SceneWriter::Written SceneWriter::slidesOf(const std::string &key, const SceneVolume &volume) {
  TomlValue list = tomlList({});
  for (const SceneSlidingPart &slide : volume.slides) {
    const Written names = write(key, slide.names);
    if (!names) return refuse("a piece of slides names no label");
    list.items.push_back(names->items.size() == 1 ? names->items.front() : *names);
  }
  return list.items.empty() ? Written() : list;
}

SceneWriter::Written SceneWriter::labelNamesOf(const std::string &key, const SceneTissue &tissue) {
  if (tissue.rule) return std::nullopt;
  const Written names = write(key, tissue.wanted);
  if (!names) return refuse("tissue '" + tissue.label + "' names no label");
  return names->items.size() == 1 ? names->items.front() : names;
}

SceneWriter::Written SceneWriter::materialOfTissue(const std::string &, const SceneTissue &tissue) {
  if (tissue.isRigid || tissue.isEmpty || tissue.isMaterialByName) return std::nullopt;
  TomlValue material = writeMaterial("material", tissue.params).value_or(TomlValue());
  // Its name is kept; all of its values follow.
  if (!tissue.preset.empty()) material.entries.insert(material.entries.begin(), {"preset", tomlString(tissue.preset)});
  return material;
}

SceneWriter::Written SceneWriter::nameOfRule(const std::string &key, const SceneTissue &tissue) {
  return tissue.rule ? write(key, tissue.label) : std::nullopt;
}

SceneWriter::Written SceneWriter::labelFileOf(const std::string &key, const SceneImage &image) {
  if (image.labels.size() > 1)
    return refuse("it has " + std::to_string(image.labels.size()) + " label maps; accepted: one");
  return image.labels.empty() ? std::nullopt : write(key, image.labels.front());
}

Expected<std::string> sceneText(const SceneFile &scene, const std::filesystem::path &folder,
                                const std::function<std::string(const SceneBody &)> &nameOfMask) {
  SceneWriter writer(folder, nameOfMask);
  const TomlValue root = writer.writeScene(scene);
  if (writer.error()) return tl::unexpected(*writer.error());
  std::string text = tomlText(root);
  const auto again = parseToml(text, "the text of the scene");
  if (!again) return fail(ErrorCode::output, again.error().message);
  if (!areEqual(root, *again)) return fail(ErrorCode::output, "scene: its values cannot be written as TOML");
  return text;
}

}  // namespace c3de::scene
