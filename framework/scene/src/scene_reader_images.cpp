// SPDX-License-Identifier: Apache-2.0
// [image], and bodies that are made from a volume.
#include <fmt/format.h>

#include <cmath>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kImageKeys{"file", "series", "time", "labels", "warp", "rim", "still"};
const std::vector<std::string> kStillKeys{"labels", "above", "below", "outside"};
const char *const kStill =
    "\"auto\" (bone and air), \"nothing\", \"outside\" (all outside of the bodies), or a table such as "
    "{ labels = [\"rib*\"], above = 200, below = -400 }";
const std::vector<std::string> kMendKeys{"opening", "closing", "largest", "fill_holes"};

}  // namespace

bool isLabelNumber(double number) {
  return number >= 1.0 && number <= 9007199254740992.0 && number == std::floor(number);
}

std::string labelText(double number) {
  return number <= kLargestLabel ? formatNumber(number) : fmt::format("label {:.0f}", number);
}

bool SceneReader::readImageFile(const std::string &key, const TomlValue &value, std::filesystem::path &out) {
  std::string text;
  if (!readText(key, value, text)) return false;
  const std::filesystem::path path = namedFile(scene_.source.parent_path(), text).lexically_normal();
  std::error_code code;
  if (text.empty()) return refuse(value.line, key + " is empty; accepted: an image file or DICOM folder");
  if (!std::filesystem::exists(path, code))
    return refuse(value.line, key + " '" + text + "' does not exist; it is looked for at " + path.string());
  if (const std::string instead = describeNonFile(path); !instead.empty() && !std::filesystem::is_directory(path, code))
    return refuse(value.line, key + " '" + text + "' " + instead + "; accepted: an image file or DICOM folder");
  out = path;
  return true;
}

bool SceneReader::readTime(const TomlValue &value, std::size_t &out) {
  const char *const accepted = "a whole number from 0: a time point of the file";
  double number = 0.0;
  if (!readNumber("time", accepted, value, number)) return false;
  if (number != std::floor(number) || !(number >= 0.0 && number <= 1e6))
    return refuse(value.line, "time is " + formatNumber(number) + "; accepted: " + accepted);
  out = static_cast<std::size_t>(number);
  return true;
}

bool SceneReader::readSeries(const TomlValue &value, std::string &out) {
  const char *const accepted =
      "the identifier, the description or the number of a DICOM series, with a part behind it as in \"4#2\" (c3de info "
      "lists them)";
  if (value.isNumber() && value.num == std::floor(value.num) && value.num >= 0.0 && value.num < 1e9) {
    out = std::to_string(static_cast<long long>(value.num));
    return true;
  }
  if (value.kind != TomlValue::Kind::text || value.text.empty())
    return refuse(value.line, "series is " +
                                  (value.isNumber()                      ? formatNumber(value.num)
                                   : value.kind == TomlValue::Kind::text ? "empty"
                                                                         : value.kindName()) +
                                  "; accepted: " + accepted);
  out = value.text;
  return true;
}

bool SceneReader::readImage(const TomlValue &table) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "'image' is " + table.kindName() + "; accepted: a table, [image]");
  SceneImage image;
  image.line = table.line;
  for (const auto &[key, value] : table.entries) {
    if (key == "file") {
      if (!readImageFile(key, value, image.file)) return false;
    } else if (key == "time") {
      if (!readTime(value, image.time)) return false;
    } else if (key == "series") {
      if (!readSeries(value, image.series)) return false;
    } else if (key == "labels") {
      image.labels.emplace_back();
      if (!readImageFile(key, value, image.labels.back())) return false;
    } else if (key == "warp") {
      if (!readBool(key, value, image.warp)) return false;
    } else if (key == "rim") {
      if (!readNumber(key, "0 mm and more", value, image.rim_mm)) return false;
      if (image.rim_mm < 0.0)
        return refuse(value.line, "rim is " + formatNumber(image.rim_mm) + "; accepted: 0 mm and more");
    } else if (key == "still") {
      if (!readFixedRegions(value, image.still)) return false;
    } else {
      return refuseKey(value.line, key, "[image]", kImageKeys);
    }
  }
  if (!image.still.labels.empty() && image.labels.empty())
    return refuse(table.line, "[image] still names labels, and there is no 'labels', the file they are in");
  if (image.file.empty()) return refuse(table.line, "[image] has no 'file'; accepted: an image file or DICOM folder");
  scene_.image = std::move(image);
  return true;
}

bool SceneReader::readFixedRegions(const TomlValue &value, SceneFixedRegions &out) {
  SceneFixedRegions still;
  if (value.kind == TomlValue::Kind::text) {
    still.isAutomatic = value.text == "auto";
    still.outside = value.text == "outside";
    if (!still.isAutomatic && !still.outside && value.text != "nothing")
      return refuse(value.line, "still is \"" + value.text + "\"; accepted: " + kStill);
    out = still;
    return true;
  }
  if (value.kind != TomlValue::Kind::table || value.entries.empty())
    return refuse(value.line, "still is " +
                                  (value.kind == TomlValue::Kind::table ? "an empty table" : value.kindName()) +
                                  "; accepted: " + kStill);
  still.isAutomatic = false;
  for (const auto &[key, member] : value.entries) {
    if (key == "above" || key == "below") {
      double limit = 0.0;
      if (!readNumber("still." + key, "a value of the image", member, limit)) return false;
      (key == "above" ? still.above : still.below) = limit;
    } else if (key == "outside") {
      if (!readBool("still.outside", member, still.outside)) return false;
    } else if (key == "labels") {
      if (member.kind != TomlValue::Kind::array || member.items.empty())
        return refuse(member.line,
                      "still.labels is " + member.kindName() +
                          "; accepted: names of labels ('*' for any text) or their numbers, [\"rib*\", 5]");
      for (const TomlValue &label : member.items) {
        const bool isNumber = label.isNumber() && isLabelNumber(label.num);
        if (!isNumber && (label.kind != TomlValue::Kind::text || label.text.empty()))
          return refuse(label.line, "a label of still.labels is " +
                                        (label.isNumber() ? formatNumber(label.num) : label.kindName()) +
                                        "; accepted: a name ('*' for any text), or a whole number from 1");
        still.labels.push_back(isNumber ? labelText(label.num) : label.text);
      }
    } else {
      return refuseKey(member.line, key, "still", kStillKeys);
    }
  }
  if (still.above && still.below && !(*still.above > *still.below))
    return refuse(value.line, "still: above " + formatNumber(*still.above) + " and below " +
                                  formatNumber(*still.below) +
                                  " leave nothing that moves; accepted: above greater than below");
  out = still;
  return true;
}

bool SceneReader::readThreshold(const TomlValue &value, std::optional<std::array<double, 2>> &out) {
  if (!value.isNumbers(2))
    return refuse(value.line, "threshold is " + value.kindName() + "; accepted: two numbers [lowest, highest]");
  const double low = value.items[0].num, high = value.items[1].num;
  if (std::isnan(low) || std::isnan(high))
    return refuse(value.line, "threshold is " + value.shown() + "; accepted: two numbers [lowest, highest]");
  if (low > high)
    return refuse(value.line, "threshold: " + formatNumber(low) + " and " + formatNumber(high) +
                                  " leave nothing; accepted: [lowest, highest]");
  out = {low, high};
  return true;
}

bool SceneReader::volumeKey(SceneVolume &volume, const std::string &key, const TomlValue &value) {
  const auto length = [&](const std::string &name, const TomlValue &number, double &out) {
    if (!readNumber(name, "a length in mm, 0 or more", number, out)) return false;
    return out >= 0.0 ||
           refuse(number.line, name + " is " + formatNumber(out) + "; accepted: a length in mm, 0 or more");
  };
  if (key == "volume") return readImageFile(key, value, volume.file);
  if (key == "time") return readTime(value, volume.time);
  if (key == "series") return readSeries(value, volume.series);
  if (key == "edge_length") return length(key, value, volume.edgeLength_mm);
  if (key == "region") return readRegion(value, volume.region.emplace());
  if (key == "label") {
    if (value.kind == TomlValue::Kind::text) {
      if (value.text.empty()) return refuse(value.line, "label is empty; accepted: the number or the name of a label");
      volume.label.reset();
      return readText(key, value, volume.labelName);
    }
    double number = 0.0;
    if (!readNumber(key, "the number or the name of a label", value, number)) return false;
    if (!isLabelNumber(number))
      return refuse(value.line,
                    "label is " + formatNumber(number) + "; accepted: a whole number from 1, or the name of a label");
    volume.label.reset();
    volume.labelName.clear();
    if (number > kLargestLabel)
      volume.labelName = labelText(number);
    else
      volume.label = static_cast<std::uint16_t>(number);
    return true;
  }
  if (key == "threshold") return readThreshold(value, volume.threshold);
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line,
                  "mend is " + value.kindName() + "; accepted: a table such as { largest = true, closing = 2 }");
  for (const auto &[member, memberValue] : value.entries) {
    bool good = false;
    if (member == "opening")
      good = length("mend.opening", memberValue, volume.mend.opening_mm);
    else if (member == "closing")
      good = length("mend.closing", memberValue, volume.mend.closing_mm);
    else if (member == "largest")
      good = readBool("mend.largest", memberValue, volume.mend.largest);
    else if (member == "fill_holes")
      good = readBool("mend.fill_holes", memberValue, volume.mend.fillHoles);
    else
      return refuseKey(memberValue.line, member, "mend", kMendKeys);
    if (!good) return false;
  }
  return true;
}

bool SceneReader::checkSource(const TomlValue &table, SceneBody &body) {
  const SceneVolume &volume = body.volume;
  const bool byLabel = volume.label || !volume.labelName.empty();
  if (volume.file.empty()) {
    for (const char *key : {"tissues", "background", "slides", "slide_friction"})
      if (const TomlValue *stray = table.find(key); stray != nullptr)
        return refuse(stray->line, std::string("'") + key + "' belongs to a body with a 'volume', a label map");
    if (const TomlValue *stray = table.find("label"); stray != nullptr)
      return refuse(stray->line, "'label' belongs to a body with a 'volume'");
    for (const char *key : {"series", "threshold", "time", "mend", "edge_length", "region"})
      if (const TomlValue *stray = table.find(key); stray != nullptr)
        return refuse(stray->line, std::string("'") + key + "' belongs to a body with a 'volume'");
    if (body.mesh.empty())
      return refuse(table.line,
                    "the body has no 'mesh'; accepted: a mesh file beside the scene, or a 'volume' with a 'label' "
                    "or a 'threshold'");
    return requireUnit(table, body.mesh, body.meshUnit);
  }
  if (!body.mesh.empty()) return refuse(table.line, "the body has a 'mesh' and a 'volume'; accepted: one of them");
  if (table.find("mesh_unit") != nullptr)
    return refuse(table.find("mesh_unit")->line,
                  "'mesh_unit' belongs to a body with a 'mesh'; volumes say their millimetres");
  if (volume.hasTissues()) return true;
  if (byLabel == volume.threshold.has_value())
    return refuse(table.line,
                  std::string("the body has a 'volume' and ") +
                      (byLabel ? "both 'label' and 'threshold'" : "neither 'label' nor 'threshold'") +
                      "; accepted: label = 5, label = \"liver\", threshold = [lowest, highest], or tissues = [ … ]");
  return true;
}

}  // namespace c3de::scene
