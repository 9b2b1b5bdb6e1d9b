// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues.
#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/scene/material_names.h"
#include "scene_fields.h"

namespace c3de::scene {
namespace {

const char *const kTissue = "[ { label = \"liver\", material = \"liver\" }, { label = \"vertebrae*\", rigid = true } ]";
const char *const kBackground = "{ material = \"fat\", image = \"ct.nii.gz\", from = -150, to = 250 }";
const char *const kSlides =
    "[\"liver\", \"lung*\", 5]; labels in brackets are one piece, [[\"liver\", \"gallbladder\"]]";
constexpr std::size_t kMaxSlides = 254;  // the index of a piece is a byte
const char *const kLabel = "the name of a label ('*' for any text), its number, or a list of them";
constexpr std::size_t kMaxNames = 3;
const char *const kRule =
    "a label, or a name with a threshold of values or a margin around earlier tissues, "
    "{ name = \"bone\", image = \"ct.nii.gz\", threshold = [250, 3000], rigid = true }";

bool readTissueName(SceneReader &reader, const std::string &key, const TomlValue &value, SceneTissue &tissue) {
  (void)contentOf(tissue.rule);
  return reader.readName(key, value, tissue.label);
}

bool readTissueMaterial(SceneReader &reader, const std::string &key, const TomlValue &value, SceneTissue &tissue) {
  if (!reader.readMaterial(key, value, tissue.params)) return false;
  const TomlValue *preset = value.kind == TomlValue::Kind::text ? &value : value.find("preset");
  if (preset != nullptr) tissue.preset = preset->text;
  return true;
}

auto background(auto member) { return in(in(&SceneBody::volume, &SceneVolume::background), member); }

bool readBackgroundMaterial(SceneReader &reader, const std::string &key, const TomlValue &value, SceneBody &body) {
  return reader.readMaterial(key, value, body.params);
}

}  // namespace

const Fields<SceneTissue> kTissueFields{
    "an entry of tissues",
    "a tissue",
    {{"label", Codec{&SceneReader::readLabelNames, &SceneWriter::labelNamesOf}},
     {"material", Codec{&readTissueMaterial, &SceneWriter::materialOfTissue}},
     {"rigid", &SceneTissue::isRigid},
     {"empty", &SceneTissue::isEmpty},
     {"name", Codec{&readTissueName, &SceneWriter::nameOfRule}},
     {"threshold", in(&SceneTissue::rule, &SceneTissueRule::threshold)},
     {"image", in(&SceneTissue::rule, &SceneTissueRule::image)},
     {"margin", in(&SceneTissue::rule, &SceneTissueRule::margin_mm),
      NumberReader{.accepted = "a length in mm above 0", .low = 0.0, .isAbove = true}},
     {"region", in(&SceneTissue::rule, &SceneTissueRule::region)},
     {"show", &SceneTissue::isShown},
     {"colour", &SceneTissue::colour, &SceneReader::readColour}},
    "tissues: "};

const Fields<SceneBody> kBackgroundFields{
    "background",
    "background",
    {{"material", Codec{&readBackgroundMaterial, &SceneWriter::materialOfBackground}, required(kBackground)},
     {"image", background(&SceneBackground::image), required(kBackground)},
     {"from", background(&SceneBackground::from), NumberReader{"a value of the image"}, required(kBackground)},
     {"to", background(&SceneBackground::to), NumberReader{"a value of the image"}, required(kBackground)},
     {"series", background(&SceneBackground::series), &SceneReader::readSeries},
     {"time", background(&SceneBackground::time)}},
    "background: "};

bool SceneReader::readLabel(const std::string &place, const TomlValue &value, std::string &out) {
  const bool isNumber = value.isNumber() && isLabelNumber(value.num);
  if (!isNumber && (value.kind != TomlValue::Kind::text || value.text.empty()))
    return refuse(value.line,
                  place + (value.isNumber() ? formatNumber(value.num) : value.kindName()) + "; accepted: " + kLabel);
  out = isNumber ? labelText(value.num) : value.text;
  return true;
}

bool SceneReader::readLabelNames(const std::string &, const TomlValue &value, SceneTissue &out) {
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
    return refuse(table.find("image")->line, "'image' requires a 'threshold', whose values it provides");
  tissue.wanted = {tissue.label};
  return true;
}

bool SceneReader::readColour(const std::string &key, const TomlValue &value, Vec3 &out) {
  if (!read(key, value, out)) return false;
  if (std::all_of(out.begin(), out.end(), [](double c) { return c >= 0.0 && c <= 1.0; })) return true;
  return refuse(value.line, key + " is (" + formatNumber(out[0]) + ", " + formatNumber(out[1]) + ", " +
                                formatNumber(out[2]) + "); accepted: red, green and blue from 0 to 1");
}

bool SceneReader::readTissue(const TomlValue &table, SceneTissue &out) {
  SceneTissue tissue;
  tissue.line = table.line;
  if (!readFields(kTissueFields, table, tissue)) return false;
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

bool SceneReader::readTissues(const std::string &, const TomlValue &value, SceneVolume &out) {
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

bool SceneReader::readBackground(const std::string &, const TomlValue &value, SceneBody &body) {
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line, "background is " + value.kindName() + "; accepted: " + kBackground);
  if (!readFields(kBackgroundFields, value, body)) return false;
  const SceneBackground &background = *body.volume.background;
  return background.from <= background.to ||
         refuse(value.line, "background: from " + formatNumber(background.from) + " to " + formatNumber(background.to) +
                                " leaves nothing; accepted: from below to");
}

bool SceneReader::readSlides(const std::string &, const TomlValue &value, SceneVolume &out) {
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
