// SPDX-License-Identifier: Apache-2.0
#include "commands/info_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <sstream>

#include "c3de/core/text.h"
#include "c3de/imaging/reading.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;
using imaging::SeriesInfo;
using imaging::Volume;
using imaging::VolumeGeometry;

/// @param parts  1000: to three decimals
double rounded(double x, double parts) { return std::round(x * parts) / parts + 0.0; }

/// A float holds seven digits; further digits are noise of slope and intercept.
std::string shortNumber(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.7g", x);
  return text.data();
}

std::string sizeText(const std::array<std::size_t, 3> &size) {
  return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]);
}

/// Direction in which an index axis increases, the nearest one first: "L", or "LA" if oblique.
std::string directionLetters(Vec3 axis) {
  axis = (1.0 / norm(axis)) * axis;
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::abs(axis[a]) > std::abs(axis[b]); });
  std::string letters;
  for (const std::size_t a : order)
    if (letters.empty() || std::abs(axis[a]) > 0.05) letters += axis[a] >= 0.0 ? "LPS"[a] : "RAI"[a];  // three degrees
  return letters;
}

Json orientationOf(const VolumeGeometry &g) {
  Json all = Json::array();
  for (std::size_t a = 0; a < 3; ++a)
    all.push_back(directionLetters({g.indexToWorld[4 * a], g.indexToWorld[4 * a + 1], g.indexToWorld[4 * a + 2]}));
  return all;
}

/// Smallest and largest value; none if no voxel is a finite number.
std::optional<std::pair<double, double>> rangeOf(const Volume &volume) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  std::visit(
      [&](const auto &all) {
        for (const auto v : all)
          if (const auto x = static_cast<double>(v); std::isfinite(x)) lo = std::min(lo, x), hi = std::max(hi, x);
      },
      volume.voxels);
  if (lo > hi) return std::nullopt;
  const double a = volume.slope * lo + volume.intercept, b = volume.slope * hi + volume.intercept;
  return std::pair{std::min(a, b), std::max(a, b)};
}

/// How a scene specifies a series: by its number if that is unique, otherwise by its identifier.
std::string inScene(const SeriesInfo &info, const std::vector<SeriesInfo> &list) {
  if (info.isSegmentation) return "labels = \"its file\"";
  const auto alike = std::count_if(
      list.begin(), list.end(), [&](const SeriesInfo &other) { return !other.isPart && other.number == info.number; });
  const std::size_t part = info.id.rfind('#');
  if (info.number.empty() || alike != 1 || info.number.find_first_not_of("0123456789") != std::string::npos)
    return "series = \"" + info.id + "\"";
  return part == std::string::npos ? "series = " + info.number
                                   : "series = \"" + info.number + info.id.substr(part) + "\"";
}

void describeSeries(const std::vector<SeriesInfo> &list, bool patientNames, Described &out) {
  std::ostringstream text;
  text << list.size() << " series:\n";
  out.json["series"] = Json::array();
  for (const SeriesInfo &info : list) {
    Json json{{"id", info.id},
              {"number", info.number},
              {"times", info.times},
              {"part", info.isPart},
              {"segmentation", info.isSegmentation},
              {"modality", info.modality},
              {"description", info.description},
              {"size", info.size},
              {"files", info.files},
              {"orientation", info.orientation},
              {"folder", info.folder.string()}};
    text << "  " << info.id << "\n    " << (info.isPart ? "part: " : "")
         << (info.modality.empty() ? "" : info.modality + " ") << sizeText(info.size)
         << (info.orientation.empty() ? "" : " " + info.orientation) << ", " << info.files
         << (info.files == 1 ? " file" : " files");
    if (!info.number.empty()) text << ", number " << info.number;
    if (!info.description.empty()) text << ", \"" << info.description << "\"";
    if (info.times > 1) text << ", " << info.times << " time points";
    text << "\n    in a scene: " << inScene(info, list);
    if (!info.refusal.empty()) {
      json["refused_because"] = info.refusal;
      text << "\n    not read: " << info.refusal;
    }
    if (patientNames) {
      json["patient_name"] = info.patientName;
      text << "\n    patient: " << (info.patientName.empty() ? "not named" : info.patientName);
    }
    text << "\n";
    out.json["series"].push_back(std::move(json));
  }
  out.text += text.str();
}

void describeVolume(const Volume &volume, Described &out) {
  const VolumeGeometry &g = volume.geometry;
  std::ostringstream text;
  const Vec3 spacing = g.spacing();
  Json rows = Json::array();
  for (std::size_t r = 0; r < 4; ++r)
    rows.push_back({g.indexToWorld[r], g.indexToWorld[4 + r], g.indexToWorld[8 + r], g.indexToWorld[12 + r]});
  const Vec3 centre = g.worldAt({0.5 * static_cast<double>(g.size[0] - 1), 0.5 * static_cast<double>(g.size[1] - 1),
                                 0.5 * static_cast<double>(g.size[2] - 1)});
  out.json["type"] = volume.scalarTypeName();
  out.json["size"] = g.size;
  out.json["spacing_mm"] = spacing;
  out.json["orientation"] = orientationOf(g);
  out.json["index_to_world_mm"] = std::move(rows);
  out.json["centre_mm"] = centre;
  out.json["unit"] = volume.unit;
  out.json["slope"] = volume.slope;
  out.json["intercept"] = volume.intercept;
  out.json["bytes"] = volume.bytes();
  out.json["colours"] = !volume.colours.empty();
  text << volume.scalarTypeName() << ", " << sizeText(g.size) << " voxels of " << formatNumber(rounded(spacing[0], 1e4))
       << " x " << formatNumber(rounded(spacing[1], 1e4)) << " x " << formatNumber(rounded(spacing[2], 1e4)) << " mm\n";
  text << "axes to " << out.json["orientation"][0].get<std::string>() << ", "
       << out.json["orientation"][1].get<std::string>() << ", " << out.json["orientation"][2].get<std::string>()
       << "; centre at " << formatNumber(rounded(centre[0], 1e3)) << ", " << formatNumber(rounded(centre[1], 1e3))
       << ", " << formatNumber(rounded(centre[2], 1e3)) << " mm (LPS)";
  if (g.shear() > 1e-3)
    text << "; sheared by "
         << formatNumber(rounded(std::asin(std::min(1.0, g.shear())) * 180.0 / 3.14159265358979323846, 10.0))
         << " degrees";
  text << "\n";
  if (const auto range = rangeOf(volume)) {
    out.json["range"] = {range->first, range->second};
    text << "values " << shortNumber(range->first) << " to " << shortNumber(range->second)
         << (volume.unit.empty() ? "" : " " + volume.unit) << "\n";
  } else {
    out.json["range"] = nullptr;
    text << "no voxel is a finite number\n";
  }
  out.text += text.str();
}

/// The time point, if there are several.
void describeTimes(const imaging::LoadedVolume &loaded, const imaging::ReadOptions &options, Described &out) {
  out.json["time"] = options.time;
  out.json["times"] = loaded.times;
  if (loaded.times > 1)
    out.text += "time point " + std::to_string(options.time) + " of " + std::to_string(loaded.times) + " (0 to " +
                std::to_string(loaded.times - 1) + ")\n";
}

void describeNotices(const std::vector<std::string> &notices, Described &out) {
  out.json["notices"] = notices;
  for (const std::string &notice : notices) out.text += "notice: " + notice + "\n";
}

/// Labels that have names, if the image is a label map with a table.
void describeLabels(const std::filesystem::path &path, Described &out) {
  auto loaded = imaging::readLabelMap(path);
  if (!loaded) return;
  std::vector<std::vector<imaging::LabelMap::Label>> layers{std::move(loaded->labels.labels)};
  for (imaging::LabelMap &layer : loaded->layers) layers.push_back(std::move(layer.labels));
  bool named = false;
  for (const auto &labels : layers)
    named = named || std::any_of(labels.begin(), labels.end(),
                                 [](const auto &label) { return !label.name.starts_with("label "); });
  if (!named) return;
  out.json["labels"] = Json::array();
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    out.text += std::to_string(layers[layer].size()) + (layers[layer].size() == 1 ? " label" : " labels") +
                (layers.size() > 1 ? " in layer " + std::to_string(layer) : "") + ":\n";
    for (const auto &label : layers[layer]) {
      out.json["labels"].push_back(Json{{"value", label.value}, {"name", label.name}});
      if (layers.size() > 1) out.json["labels"].back()["layer"] = layer;
      out.text += "  " + std::to_string(label.value) + "  " + label.name + "\n";
    }
  }
}

}  // namespace

Expected<Described> describeVolume(const std::filesystem::path &path, const imaging::ReadOptions &options) {
  const auto loaded = imaging::readVolume(path, options);
  if (!loaded) return tl::unexpected(loaded.error());
  Described out;
  out.json = Json{{"file", path.string()}, {"kind", "image"}};
  describeVolume(loaded->volume, out);
  describeTimes(*loaded, options, out);
  describeNotices(loaded->notices, out);
  return out;
}

Expected<Described> describeImage(const std::filesystem::path &path, const imaging::ReadOptions &options,
                                  bool patientNames) {
  const auto list = imaging::listSeries(path);
  if (!list) return tl::unexpected(list.error());
  Described out;
  out.json = Json{{"file", path.string()}, {"kind", "image"}};
  std::error_code code;
  // a DICOMDIR also stands for its folder
  const bool folder =
      std::filesystem::is_directory(path, code) ||
      std::none_of(list->begin(), list->end(), [](const SeriesInfo &info) { return info.holdsNamedFile; });
  const bool hasParts = std::any_of(list->begin(), list->end(), [](const SeriesInfo &info) { return info.isPart; });
  if (folder || list->front().files > 1 || hasParts || patientNames) {
    describeSeries(*list, patientNames, out);
    const auto readable = std::count_if(list->begin(), list->end(), [](const SeriesInfo &info) {
      return info.refusal.empty() && !info.isPart && !info.isSegmentation;
    });
    if (folder && options.series.empty() && readable > 1) {
      out.text += "choose one by --series to see more\n";
      return out;
    }
  }
  auto loaded = imaging::readVolume(path, options);
  if (!loaded) return tl::unexpected(loaded.error());
  describeVolume(loaded->volume, out);
  describeTimes(*loaded, options, out);
  describeNotices(loaded->notices, out);
  const bool whole = loaded->volume.voxels.index() < 6;  // integers
  *loaded = {};                                          // the labels are read into separate memory
  if (!folder && whole) describeLabels(path, out);
  return out;
}

}  // namespace c3de::app
