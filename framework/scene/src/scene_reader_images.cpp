// SPDX-License-Identifier: Apache-2.0
// [image], and bodies that are made from a volume.
#include <fmt/format.h>

#include <cmath>

#include "c3de/core/file_path.h"
#include "c3de/core/input_file.h"
#include "scene_fields.h"

namespace c3de::scene {
namespace {

const char *const kStill =
    "\"auto\" (bone and air), \"nothing\", \"outside\" (all outside of the bodies), or a table such as "
    "{ labels = [\"rib*\"], above = 200, below = -400 }";

bool readFixedLabels(SceneReader &reader, const std::string &key, const TomlValue &value,
                     std::vector<std::string> &out) {
  if (value.kind != TomlValue::Kind::array || value.items.empty())
    return reader.refuse(value.line, key + " is " + value.kindName() +
                                         "; accepted: names of labels ('*' for any text) or their numbers, "
                                         "[\"rib*\", 5]");
  for (const TomlValue &label : value.items) {
    const bool isNumber = label.isNumber() && isLabelNumber(label.num);
    if (!isNumber && (label.kind != TomlValue::Kind::text || label.text.empty()))
      return reader.refuse(label.line, "a label of " + key + " is " +
                                           (label.isNumber() ? formatNumber(label.num) : label.kindName()) +
                                           "; accepted: a name ('*' for any text), or a whole number from 1");
    out.push_back(isNumber ? labelText(label.num) : label.text);
  }
  return true;
}

bool readLabelFile(SceneReader &reader, const std::string &key, const TomlValue &value, SceneImage &out) {
  return reader.read(key, value, out.labels.emplace_back());
}

}  // namespace

const Fields<SceneImage> kImageFields{"[image]",
                                      "[image]",
                                      {{"file", &SceneImage::file},
                                       {"series", &SceneImage::series, &SceneReader::readSeries},
                                       {"time", &SceneImage::time},
                                       {"labels", Codec{&readLabelFile, &SceneWriter::labelFileOf}},
                                       {"warp", &SceneImage::warp},
                                       {"rim", &SceneImage::rim_mm, NumberReader{"0 mm and more", 0.0}},
                                       {"still", &SceneImage::still}}};
const Fields<SceneFixedRegions> kFixedRegionFields{
    "still",
    "still",
    {{"labels", &SceneFixedRegions::labels, &readFixedLabels},
     {"above", &SceneFixedRegions::above, NumberReader{"a value of the image"}},
     {"below", &SceneFixedRegions::below, NumberReader{"a value of the image"}},
     {"outside", &SceneFixedRegions::outside}},
    "still."};
const Fields<imaging::MaskCleanUp> kMendFields{"mend",
                                               "mend",
                                               {{"opening", &imaging::MaskCleanUp::opening_mm, lengthNumber()},
                                                {"closing", &imaging::MaskCleanUp::closing_mm, lengthNumber()},
                                                {"largest", &imaging::MaskCleanUp::largest},
                                                {"fill_holes", &imaging::MaskCleanUp::fillHoles}},
                                               "mend."};

bool isLabelNumber(double number) {
  return number >= 1.0 && number <= 9007199254740992.0 && number == std::floor(number);
}

std::string labelText(double number) {
  return number <= kLargestLabel ? formatNumber(number) : fmt::format("label {:.0f}", number);
}

bool SceneReader::read(const std::string &key, const TomlValue &value, std::filesystem::path &out) {
  std::string text;
  if (!read(key, value, text)) return false;
  const std::filesystem::path path = normalPath(namedFile(scene_.source.parent_path(), text));
  std::error_code code;
  if (text.empty()) return refuse(value.line, key + " is empty; accepted: an image file or DICOM folder");
  out = path;
  if (!checksFiles_) return true;
  if (!std::filesystem::exists(path, code))
    return refuse(value.line, key + " '" + text + "' does not exist; it is looked for at " + path.string());
  if (const std::string instead = describeNonFile(path); !instead.empty() && !std::filesystem::is_directory(path, code))
    return refuse(value.line, key + " '" + text + "' " + instead + "; accepted: an image file or DICOM folder");
  return true;
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::size_t &out) {
  const char *const accepted = "a whole number from 0: a time point of the file";
  double number = 0.0;
  if (!readNumber("time", accepted, value, number)) return false;
  if (number != std::floor(number) || !(number >= 0.0 && number <= 1e6))
    return refuse(value.line, "time is " + formatNumber(number) + "; accepted: " + accepted);
  out = static_cast<std::size_t>(number);
  return true;
}

bool SceneReader::readSeries(const std::string &, const TomlValue &value, std::string &out) {
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
  if (!readFields(kImageFields, table, image)) return false;
  if (!image.still.labels.empty() && image.labels.empty())
    return refuse(table.line, "[image] still names labels, but 'labels', their file, is missing");
  if (image.file.empty()) return refuse(table.line, "[image] has no 'file'; accepted: an image file or DICOM folder");
  scene_.image = std::move(image);
  return true;
}

bool SceneReader::read(const std::string &, const TomlValue &value, SceneFixedRegions &out) {
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
  if (!readFields(kFixedRegionFields, value, still)) return false;
  if (still.above && still.below && !(*still.above > *still.below))
    return refuse(value.line, "still: above " + formatNumber(*still.above) + " and below " +
                                  formatNumber(*still.below) +
                                  " select nothing that moves; accepted: above greater than below");
  out = still;
  return true;
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::array<double, 2> &out) {
  if (!value.isNumbers(2))
    return refuse(value.line, "threshold is " + value.kindName() + "; accepted: two numbers [lowest, highest]");
  const double low = value.items[0].num, high = value.items[1].num;
  if (std::isnan(low) || std::isnan(high))
    return refuse(value.line, "threshold is " + value.shown() + "; accepted: two numbers [lowest, highest]");
  if (low > high)
    return refuse(value.line, "threshold: " + formatNumber(low) + " and " + formatNumber(high) +
                                  " select nothing; accepted: [lowest, highest]");
  out = {low, high};
  return true;
}

bool SceneReader::readLabelOf(const std::string &key, const TomlValue &value, SceneVolume &volume) {
  if (value.kind == TomlValue::Kind::text) {
    if (value.text.empty()) return refuse(value.line, "label is empty; accepted: the number or the name of a label");
    volume.label.reset();
    return read(key, value, volume.labelName);
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

bool SceneReader::read(const std::string &key, const TomlValue &value, imaging::MaskCleanUp &out) {
  if (value.kind != TomlValue::Kind::table)
    return refuse(value.line,
                  key + " is " + value.kindName() + "; accepted: a table such as { largest = true, closing = 2 }");
  return readFields(kMendFields, value, out);
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
                    "the body has no 'mesh'; accepted: a mesh file (path relative to the scene's folder), or a "
                    "'volume' with a 'label' or a 'threshold'");
    return requireUnit(table, body.mesh, body.meshUnit);
  }
  if (!body.mesh.empty()) return refuse(table.line, "the body has a 'mesh' and a 'volume'; accepted: one of them");
  if (table.find("mesh_unit") != nullptr)
    return refuse(table.find("mesh_unit")->line,
                  "'mesh_unit' belongs to a body with a 'mesh'; volumes state their own voxel size");
  if (volume.hasTissues()) return true;
  if (byLabel == volume.threshold.has_value())
    return refuse(table.line,
                  std::string("the body has a 'volume' and ") +
                      (byLabel ? "both 'label' and 'threshold'" : "neither 'label' nor 'threshold'") +
                      "; accepted: label = 5, label = \"liver\", threshold = [lowest, highest], or tissues = [ … ]");
  return true;
}

}  // namespace c3de::scene
