// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues.
#include <cmath>

#include "c3de/core/text.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kTissueKeys{"label", "material", "rigid"};
const std::vector<std::string> kBackgroundKeys{"material", "image", "from", "to"};
const char *const kTissue = "[ { label = \"liver\", material = \"liver\" }, { label = \"vertebrae*\", rigid = true } ]";
const char *const kBackground = "{ material = \"fat\", image = \"ct.nii.gz\", from = -150, to = 250 }";
const char *const kLabel = "the name of a label ('*' for any text), or its number, 1 … 65535";

}  // namespace

bool SceneReader::readTissues(const TomlValue &value, std::vector<SceneTissue> &out) {
  if (!requireTables("tissues", kTissue, value)) return false;
  if (value.items.empty()) return refuse(value.line, std::string("tissues is empty; accepted: ") + kTissue);
  std::vector<SceneTissue> tissues;
  for (const TomlValue &table : value.items) {
    SceneTissue tissue;
    tissue.line = table.line;
    for (const auto &[key, member] : table.entries) {
      if (key == "label") {
        const bool isNumber =
            member.isNumber() && member.num == std::floor(member.num) && member.num >= 1.0 && member.num <= 65535.0;
        if (!isNumber && (member.kind != TomlValue::Kind::text || member.text.empty()))
          return refuse(member.line, "tissues: label is " +
                                         (member.isNumber() ? formatNumber(member.num) : member.kindName()) +
                                         "; accepted: " + kLabel);
        tissue.label = isNumber ? formatNumber(member.num) : member.text;
      } else if (key == "rigid") {
        if (!readBool("tissues: rigid", member, tissue.isRigid)) return false;
      } else if (key == "material") {
        if (!readMaterial(tissue.params, member)) return false;
      } else {
        return refuseKey(member.line, key, "an entry of tissues", kTissueKeys);
      }
    }
    if (tissue.label.empty()) return refuse(table.line, std::string("a tissue has no 'label'; accepted: ") + kLabel);
    if (tissue.isRigid == (table.find("material") != nullptr))
      return refuse(table.line,
                    "the tissue '" + tissue.label + "' has " +
                        (tissue.isRigid ? "a material and is rigid" : "neither a material nor rigid = true") +
                        "; accepted: one of them");
    tissues.push_back(std::move(tissue));
  }
  out = std::move(tissues);
  return true;
}

bool SceneReader::readBackground(const TomlValue &value, SceneBody &body) {
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line, "background is " + value.kindName() + "; accepted: " + kBackground);
  SceneBackground background;
  for (const auto &[key, member] : value.entries) {
    if (key == "material") {
      if (!readMaterial(body.params, member)) return false;
    } else if (key == "image") {
      if (!readImageFile("background: image", member, background.image)) return false;
    } else if (key == "from" || key == "to") {
      if (!readNumber("background: " + key, "a value of the image", member,
                      key == "from" ? background.from : background.to))
        return false;
    } else {
      return refuseKey(member.line, key, "background", kBackgroundKeys);
    }
  }
  for (const std::string &key : kBackgroundKeys)
    if (value.find(key) == nullptr)
      return refuse(value.line, "background has no '" + key + "'; accepted: " + kBackground);
  if (!(background.from <= background.to))
    return refuse(value.line, "background: from " + formatNumber(background.from) + " to " +
                                  formatNumber(background.to) + " leaves nothing; accepted: from below to");
  body.volume.background = std::move(background);
  return true;
}

bool SceneReader::checkTissues(const TomlValue &table, SceneBody &body) {
  const SceneVolume &volume = body.volume;
  if (volume.tissues.empty()) {
    if (volume.background)
      return refuse(table.find("background")->line,
                    std::string("'background' belongs to a body with 'tissues'; accepted: tissues = ") + kTissue);
    return true;
  }
  for (const char *key : {"label", "threshold", "material", "rigid", "free"})
    if (const TomlValue *stray = table.find(key); stray != nullptr)
      return refuse(stray->line, std::string("the body has 'tissues' and '") + key +
                                     "'; accepted: a material, or rigid = true, for each tissue");
  std::vector<ScenePart> parts;
  for (const SceneTissue &tissue : volume.tissues) {
    if (tissue.isRigid) continue;
    ScenePart part;
    part.region.kind = SceneRegion::Kind::voxels;
    part.params = tissue.params;
    part.line = tissue.line;
    parts.push_back(std::move(part));
  }
  if (parts.empty() && !volume.background)
    return refuse(table.find("tissues")->line,
                  "all tissues are rigid, so nothing of the body can move; accepted: one "
                  "tissue at least with a material, or a 'background'");
  // Where no part is, the body is of its background.
  if (!volume.background)
    body.params.insert(body.params.end(), parts.front().params.begin(), parts.front().params.end());
  body.parts.insert(body.parts.begin(), parts.begin(), parts.end());
  return true;
}

}  // namespace c3de::scene
