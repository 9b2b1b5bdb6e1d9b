// SPDX-License-Identifier: Apache-2.0
// Converts the tissues of a body to the materials of its parts.
#include <algorithm>
#include <utility>

#include "c3de/scene/material_names.h"
#include "scene_reader.h"

namespace c3de::scene {

bool SceneVolume::isOpen() const {
  return !isSettled && (usesKnownTissues || std::any_of(tissues.begin(), tissues.end(), [](const SceneTissue &tissue) {
                          return tissue.isMaterialByName;
                        }));
}

bool SceneVolume::usesLabels() const {
  return usesKnownTissues ||
         std::any_of(tissues.begin(), tissues.end(), [](const SceneTissue &tissue) { return !tissue.rule; });
}

std::vector<std::string> namesOfPieces(const SceneBody &body) {
  std::vector<std::string> names;
  for (const SceneSlidingPart &slide : body.volume.slides) {
    std::string label = slide.names.front();
    std::erase(label, '*');
    const std::size_t first = label.find_first_not_of("_- "), last = label.find_last_not_of("_- ");
    label = first == std::string::npos ? "piece" : label.substr(first, last - first + 1);
    std::string name = body.name + "." + label;
    for (int i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i)
      name = body.name + "." + label + "-" + std::to_string(i);
    names.push_back(std::move(name));
  }
  return names;
}

std::string nameOfRest(const SceneBody &body) {
  const std::vector<std::string> names = namesOfPieces(body);
  std::string name = body.name + ".rest";
  for (int i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i)
    name = body.name + ".rest-" + std::to_string(i);
  return name;
}

namespace {

bool isUnder(const char *table, const SceneValue &value) { return value.value.id.rfind(table, 0) == 0; }

void replace(std::vector<SceneValue> &values, const std::vector<SceneValue> &own) {
  std::erase_if(values, [&](const SceneValue &value) {
    return std::any_of(own.begin(), own.end(), [&](const SceneValue &one) { return one.value.id == value.value.id; });
  });
  values.insert(values.end(), own.begin(), own.end());
}

/// The piece with its own settings applied.
SceneBody bodyWith(SceneBody piece, const ScenePiece &said) {
  std::vector<SceneValue> own = said.params;
  for (SceneValue &value : own) value.isPieceOverride = true;
  piece.volume.slides.clear();
  replace(piece.params, own);
  std::erase_if(own, [](const SceneValue &value) { return !isUnder("material.", value); });
  for (ScenePart &part : piece.parts)
    if (part.region.kind == SceneRegion::Kind::voxels) replace(part.params, own);
  piece.velocity_m_s = said.velocity_m_s.value_or(piece.velocity_m_s);
  return piece;
}

}  // namespace

SceneBody bodyOfPiece(const SceneBody &body, std::size_t slide) {
  SceneBody piece = body;
  piece.name = namesOfPieces(body)[slide];
  piece.volume.piece = static_cast<std::uint8_t>(slide + 1);
  std::erase_if(piece.params, [](const SceneValue &value) { return isUnder("surroundings.", value); });
  return bodyWith(std::move(piece), body.volume.slides[slide]);
}

SceneBody bodyOfRest(const SceneBody &body) { return bodyWith(body, body.volume.rest); }

std::vector<std::string> namesOfBodies(const SceneFile &scene) {
  std::vector<std::string> names;
  for (const SceneBody &body : scene.bodies) {
    names.push_back(body.name);
    for (std::string &piece : namesOfPieces(body)) names.push_back(std::move(piece));
  }
  return names;
}

std::vector<std::string> referableNames(const SceneFile &scene) {
  std::vector<std::string> names = namesOfBodies(scene);
  for (const SceneBody &body : scene.bodies)
    if (!body.volume.slides.empty()) names.push_back(nameOfRest(body));
  return names;
}

std::vector<SceneValue> valuesOf(const MaterialPreset &preset) {
  std::vector<SceneValue> values;
  const auto number = [&](const char *id, double num, bool isOptional) {
    ParameterValue parameter;
    parameter.id = id;
    parameter.num = num;
    values.push_back({std::move(parameter), 0, {}, isOptional});
  };
  number(C3DE_PARAM_ID_DENSITY, preset.density, false);
  number(C3DE_PARAM_ID_YOUNGS_MODULUS, preset.youngsModulus, false);
  number(C3DE_PARAM_ID_POISSON_RATIO, preset.poissonRatio, false);
  // The known range of the modulus, in addition to the value used; not every simulator shows it.
  number(C3DE_PARAM_ID_YOUNGS_MODULUS_LOW, preset.youngsModulusMin, true);
  number(C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH, preset.youngsModulusMax, true);
  return values;
}

bool setMaterialFromName(SceneTissue &tissue, std::string_view label, const MaterialLibrary &materials) {
  const auto named = tissueOf(materials, label);
  if (!named) return false;
  tissue.isMaterialByName = false;
  tissue.isRigid = named->isRigid();
  tissue.isEmpty = named->isEmpty();
  tissue.remark = named->remark;
  if (tissue.isEmpty) return true;
  tissue.preset = named->preset->name;
  if (tissue.isRigid) return true;
  tissue.params = valuesOf(*named->preset);
  for (SceneValue &value : tissue.params) value.line = tissue.line;
  return true;
}

Expected<void> makeTissueParts(SceneBody &body) {
  std::vector<ScenePart> parts;
  for (const SceneTissue &tissue : body.volume.tissues) {
    if (tissue.isRigid || tissue.isEmpty) continue;
    ScenePart part;
    part.name = tissue.label;
    part.region.kind = SceneRegion::Kind::voxels;
    part.params = tissue.params;
    part.line = tissue.line;
    parts.push_back(std::move(part));
  }
  if (parts.empty() && !body.volume.background)
    return fail(ErrorCode::input,
                "all tissues are rigid or empty, so nothing of the body can move; accepted: one tissue at least with a "
                "material, or a 'background'");
  // Outside all parts the body consists of its background. Without one it takes the first part's material; overrides
  // take precedence.
  if (!body.volume.background)
    for (const SceneValue &value : parts.front().params)
      if (std::none_of(body.params.begin(), body.params.end(),
                       [&](const SceneValue &said) { return said.value.id == value.value.id; }))
        body.params.push_back(value);
  body.parts.insert(body.parts.begin(), parts.begin(), parts.end());
  return {};
}

}  // namespace c3de::scene
