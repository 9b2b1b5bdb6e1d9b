// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues.
#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/scene/material_names.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kTissueKeys{"label", "material", "rigid",  "empty", "name",  "threshold",
                                           "image", "margin",   "region", "show",  "colour"};
const std::vector<std::string> kBackgroundKeys{"material", "image", "from", "to", "series", "time"};
constexpr std::size_t kRequired = 4;  // of them
const char *const kTissue = "[ { label = \"liver\", material = \"liver\" }, { label = \"vertebrae*\", rigid = true } ]";
const char *const kBackground = "{ material = \"fat\", image = \"ct.nii.gz\", from = -150, to = 250 }";
const char *const kSlides =
    "[\"liver\", \"lung*\", 5]; labels in brackets are one piece, [[\"liver\", \"gallbladder\"]]";
constexpr std::size_t kMaxSlides = 254;  // the index of a piece is a byte
const char *const kLabel = "the name of a label ('*' for any text), its number, or a list of them";
constexpr std::size_t kMaxNames = 3;
const char *const kRule =
    "a label, or a name with a threshold of values or a margin around tissues before it, "
    "{ name = \"bone\", image = \"ct.nii.gz\", threshold = [250, 3000], rigid = true }";

}  // namespace

bool SceneReader::readLabel(const std::string &place, const TomlValue &value, std::string &out) {
  const bool isNumber = value.isNumber() && isLabelNumber(value.num);
  if (!isNumber && (value.kind != TomlValue::Kind::text || value.text.empty()))
    return refuse(value.line,
                  place + (value.isNumber() ? formatNumber(value.num) : value.kindName()) + "; accepted: " + kLabel);
  out = isNumber ? labelText(value.num) : value.text;
  return true;
}

bool SceneReader::readLabelNames(const TomlValue &value, SceneTissue &out) {
  const bool isList = value.kind == TomlValue::Kind::array;
  if (isList && value.items.empty())
    return refuse(value.line, std::string("tissues: label is an empty list; accepted: ") + kLabel);
  for (const TomlValue &one : isList ? value.items : std::vector<TomlValue>{value}) {
    std::string name;
    if (!readLabel("tissues: label is ", one, name)) return false;
    out.wanted.push_back(std::move(name));
    if (out.wanted.size() <= kMaxNames) out.label += (out.label.empty() ? "" : ", ") + out.wanted.back();
  }
  if (out.wanted.size() > kMaxNames) out.label += " and " + std::to_string(out.wanted.size() - kMaxNames) + " more";
  return true;
}

bool SceneReader::checkRule(const TomlValue &table, SceneTissue &tissue) {
  const SceneTissueRule &rule = *tissue.rule;
  if (table.find("label") != nullptr)
    return refuse(table.line,
                  "the tissue has a label and a threshold, margin, region or name; accepted: " + std::string(kRule));
  if (!rule.threshold && rule.margin_mm == 0.0)
    return refuse(table.line,
                  "the tissue has neither 'label' nor 'threshold' nor 'margin'; accepted: " + std::string(kRule));
  if (tissue.label.empty()) return refuse(table.line, "a tissue without a label has no 'name'");
  if (!rule.image.empty() && !rule.threshold)
    return refuse(table.find("image")->line, "'image' belongs to a 'threshold', whose values it has");
  tissue.wanted = {tissue.label};
  return true;
}

bool SceneReader::readColour(const std::string &key, const TomlValue &value, Vec3 &out) {
  if (!readVec3(key, value, out)) return false;
  if (std::all_of(out.begin(), out.end(), [](double c) { return c >= 0.0 && c <= 1.0; })) return true;
  return refuse(value.line, key + " is (" + formatNumber(out[0]) + ", " + formatNumber(out[1]) + ", " +
                                formatNumber(out[2]) + "); accepted: red, green and blue from 0 to 1");
}

bool SceneReader::readTissue(const TomlValue &table, SceneTissue &out) {
  SceneTissue tissue;
  const auto rule = [&]() -> SceneTissueRule & { return tissue.rule ? *tissue.rule : tissue.rule.emplace(); };
  tissue.line = table.line;
  for (const auto &[key, member] : table.entries) {
    if (key == "label") {
      if (!readLabelNames(member, tissue)) return false;
    } else if (key == "rigid") {
      if (!readBool("tissues: rigid", member, tissue.isRigid)) return false;
    } else if (key == "empty") {
      if (!readBool("tissues: empty", member, tissue.isEmpty)) return false;
    } else if (key == "show") {
      if (!readBool("tissues: show", member, tissue.isShown)) return false;
    } else if (key == "colour") {
      if (!readColour("tissues: colour", member, tissue.colour.emplace())) return false;
    } else if (key == "name") {
      (void)rule();
      if (!readName(member, tissue.label)) return false;
    } else if (key == "threshold") {
      if (!readThreshold(member, rule().threshold)) return false;
    } else if (key == "image") {
      if (!readImageFile("tissues: image", member, rule().image)) return false;
    } else if (key == "region") {
      if (!readRegion(member, rule().region.emplace())) return false;
    } else if (key == "margin") {
      if (!readNumber("tissues: margin", "a length in mm above 0", member, rule().margin_mm)) return false;
      if (!(rule().margin_mm > 0.0))
        return refuse(member.line,
                      "tissues: margin is " + formatNumber(rule().margin_mm) + "; accepted: a length in mm above 0");
    } else if (key == "material") {
      if (!readMaterial(tissue.params, member)) return false;
      const TomlValue *preset = member.kind == TomlValue::Kind::text ? &member : member.find("preset");
      if (preset != nullptr) tissue.preset = preset->text;
    } else {
      return refuseKey(member.line, key, "an entry of tissues", kTissueKeys);
    }
  }
  if (tissue.rule && !checkRule(table, tissue)) return false;
  if (tissue.wanted.empty()) return refuse(table.line, std::string("a tissue has no 'label'; accepted: ") + kLabel);
  const bool hasMaterial = table.find("material") != nullptr;
  if (hasMaterial && tissue.isRigid)
    return refuse(table.line, "the tissue '" + tissue.label + "' has a material and is rigid; accepted: one of them");
  if (tissue.isEmpty && (hasMaterial || tissue.isRigid))
    return refuse(table.line, "the tissue '" + tissue.label + "' is empty and " +
                                  (hasMaterial ? "has a material" : "rigid") + "; accepted: one of them");
  tissue.isMaterialByName = !hasMaterial && !tissue.isRigid && !tissue.isEmpty;
  for (const std::string &name : tissue.wanted) {
    const bool isFullName = name.find('*') == std::string::npos && name.find_first_not_of("0123456789") != name.npos;
    if (tissue.isMaterialByName && isFullName && (materials_ == nullptr || !tissueOf(*materials_, name)))
      return refuse(table.line, unknownTissue(name));
  }
  out = std::move(tissue);
  return true;
}

bool SceneReader::readTissues(const TomlValue &value, SceneVolume &out) {
  if (value.kind == TomlValue::Kind::text) {
    if (value.text != "known")
      return refuse(value.line, "tissues is \"" + value.text + "\"; accepted: \"known\", or a list such as " + kTissue);
    out.usesKnownTissues = true;
    return true;
  }
  if (!requireTables("tissues", std::string("\"known\", or ") + kTissue, value)) return false;
  if (value.items.empty())
    return refuse(value.line, std::string("tissues is empty; accepted: \"known\", or ") + kTissue);
  std::vector<SceneTissue> tissues(value.items.size());
  for (std::size_t i = 0; i < tissues.size(); ++i)
    if (!readTissue(value.items[i], tissues[i])) return false;
  out.tissues = std::move(tissues);
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
    } else if (key == "series") {
      if (!readSeries(member, background.series)) return false;
    } else if (key == "time") {
      if (!readTime(member, background.time)) return false;
    } else {
      return refuseKey(member.line, key, "background", kBackgroundKeys);
    }
  }
  for (std::size_t i = 0; i < kRequired; ++i)
    if (value.find(kBackgroundKeys[i]) == nullptr)
      return refuse(value.line, "background has no '" + kBackgroundKeys[i] + "'; accepted: " + kBackground);
  if (!(background.from <= background.to))
    return refuse(value.line, "background: from " + formatNumber(background.from) + " to " +
                                  formatNumber(background.to) + " leaves nothing; accepted: from below to");
  body.volume.background = std::move(background);
  return true;
}

bool SceneReader::readSlides(const TomlValue &value, SceneVolume &out) {
  if (value.kind != TomlValue::Kind::array || value.items.empty())
    return refuse(value.line, "slides is " +
                                  (value.kind == TomlValue::Kind::array ? "an empty list" : value.kindName()) +
                                  "; accepted: a list, " + kSlides);
  if (value.items.size() > kMaxSlides)
    return refuse(value.line, "slides has " + std::to_string(value.items.size()) + " entries; accepted: up to " +
                                  std::to_string(kMaxSlides));
  std::vector<SceneSlidingPart> slides;
  std::vector<std::string> seen;
  for (const TomlValue &entry : value.items) {
    const bool isList = entry.kind == TomlValue::Kind::array;
    if (isList && entry.items.empty())
      return refuse(entry.line, std::string("an entry of slides is an empty list; accepted: ") + kSlides);
    SceneSlidingPart slide;
    for (std::size_t i = 0; i < (isList ? entry.items.size() : 1); ++i) {
      const TomlValue &label = isList ? entry.items[i] : entry;
      std::string name;
      if (!readLabel("slides: a label is ", label, name)) return false;
      if (std::find(seen.begin(), seen.end(), name) != seen.end())
        return refuse(label.line, "slides names '" + name + "' twice; accepted: each label once");
      seen.push_back(name);
      slide.names.push_back(std::move(name));
    }
    slides.push_back(std::move(slide));
  }
  out.slides = std::move(slides);
  return true;
}

bool SceneReader::checkTissues(const TomlValue &table, SceneBody &body) {
  const SceneVolume &volume = body.volume;
  if (!volume.hasTissues()) {
    for (const char *key : {"background", "slides", "slide_friction"})
      if (const TomlValue *stray = table.find(key); stray != nullptr)
        return refuse(stray->line, std::string("'") + key +
                                       "' belongs to a body with 'tissues'; accepted: tissues = \"known\", or " +
                                       kTissue);
    return true;
  }
  if (const TomlValue *friction = table.find("slide_friction"); friction != nullptr && volume.slides.empty())
    return refuse(friction->line,
                  std::string("'slide_friction' belongs to a body with 'slides'; accepted: slides = ") + kSlides);
  for (const char *key : {"label", "threshold", "material", "rigid", "free"})
    if (const TomlValue *stray = table.find(key); stray != nullptr)
      return refuse(stray->line, std::string("the body has 'tissues' and '") + key +
                                     "'; accepted: a material, or rigid = true, for each tissue");
  // Parts that depend on names are created after the labels have been read.
  if (volume.isOpen()) return true;
  if (const auto made = makeTissueParts(body); !made) return refuse(table.find("tissues")->line, made.error().message);
  return true;
}

}  // namespace c3de::scene
