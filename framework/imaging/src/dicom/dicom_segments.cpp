// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "formats/image_header.h"
#include "formats/label_table.h"
#include "formats/voxel_reader.h"

namespace c3de::imaging {
namespace {

std::string rounded(double x) { return formatNumber(std::round(x * 1000.0) / 1000.0); }

/// Label maps in which each voxel holds one segment, as many as the overlaps require.
class Layers {
 public:
  Layers(const std::filesystem::path &path, const SegmentGrid &grid, const DicomPixels &pixels,
         const ReadOptions &options)
      : path_(path), grid_(grid), pixels_(pixels), options_(options), each_(pixels.rows * pixels.columns) {}

  /// @param slices  of the stack that contain the segment, with the frame of each
  Expected<void> add(std::uint16_t segment, const std::vector<std::pair<std::size_t, std::size_t>> &slices,
                     double least) {
    return std::visit(
        [&](const auto &all) -> Expected<void> {
          const auto isIn = [&](std::size_t frame, std::size_t p) {
            return static_cast<double>(all[frame * each_ + p]) >= least;
          };
          const auto isFree = [&](const std::vector<std::uint16_t> &layer) {
            for (const auto &place : slices)
              for (std::size_t p = 0; p < each_; ++p)
                if (isIn(place.second, p) && layer[grid_.k[place.first] * each_ + p] != 0) return false;
            return true;
          };
          std::size_t layer = 0;
          while (layer < layers_.size() && !isFree(layers_[layer])) ++layer;
          if (auto room = allocateLayer(layer); !room) return room;
          for (const auto &[slice, frame] : slices)
            for (std::size_t p = 0; p < each_; ++p)
              if (isIn(frame, p)) layers_[layer][grid_.k[slice] * each_ + p] = segment;
          return {};
        },
        pixels_.voxels);
  }
  /// For frames that hold the segment numbers themselves.
  Expected<void> addNumbers(std::size_t slice, std::size_t frame) {
    if (auto room = allocateLayer(0); !room) return room;
    return std::visit(
        [&](const auto &all) -> Expected<void> {
          for (std::size_t p = 0; p < each_; ++p) {
            const auto value = static_cast<double>(all[frame * each_ + p]);
            if (!(value >= 0.0 && value <= 65535.0))
              return refuse(path_, "holds the segment number " + formatNumber(value) + "; accepted are 0 to 65535");
            layers_[0][grid_.k[slice] * each_ + p] = static_cast<std::uint16_t>(value);
          }
          return {};
        },
        pixels_.voxels);
  }
  [[nodiscard]] std::vector<std::vector<std::uint16_t>> &all() { return layers_; }
  /// Voxels that belong to more than one segment.
  [[nodiscard]] std::size_t overlap() const {
    std::size_t sum = 0;
    for (std::size_t v = 0; layers_.size() > 1 && v < layers_.front().size(); ++v)
      sum +=
          std::count_if(layers_.begin(), layers_.end(), [v](const auto &layer) { return layer[v] != 0; }) > 1 ? 1 : 0;
    return sum;
  }

 private:
  Expected<void> allocateLayer(std::size_t layer) {
    if (layer < layers_.size()) return {};
    const auto one = static_cast<double>(grid_.geometry.voxelCount());
    const double bytes = 2.0 * one + (options_.memoryLimit > 0 ? 2.0 * one * static_cast<double>(layers_.size()) : 0.0);
    if (const auto fits = checkMemory(path_, bytes, options_.memoryLimit); !fits) return fits;
    layers_.emplace_back(grid_.geometry.voxelCount());
    return {};
  }

  const std::filesystem::path &path_;
  const SegmentGrid &grid_;
  const DicomPixels &pixels_;
  const ReadOptions &options_;
  std::size_t each_;
  std::vector<std::vector<std::uint16_t>> layers_;
};

/// The labels that occur, with names and colours from the file.
std::vector<LabelMap::Label> labelsIn(const std::vector<std::uint16_t> &voxels, const DicomSegmentation &said) {
  std::vector<bool> occurs(65536, false);
  for (const std::uint16_t label : voxels) occurs[label] = true;
  std::vector<LabelMap::Label> labels;
  for (std::size_t value = 1; value < occurs.size(); ++value) {
    if (!occurs[value]) continue;
    LabelMap::Label label{static_cast<std::uint16_t>(value), "label " + std::to_string(value),
                          distinctColour(value - 1)};
    const auto known = std::find_if(said.segments.begin(), said.segments.end(),
                                    [&](const DicomSegment &one) { return one.number == value; });
    if (known != said.segments.end() && !known->name.empty()) label.name = known->name;
    if (known != said.segments.end() && known->coloured) label.colour = known->colour;
    labels.push_back(label);
  }
  return labels;
}

std::string layersText(const std::vector<LabelMap> &layers, std::size_t overlap) {
  std::string text = "Segments overlap (in " + std::to_string(overlap) + " voxels): they lie in " +
                     std::to_string(layers.size()) + " layers, each a label map of its own:";
  for (std::size_t n = 0; n < layers.size() && n < 12; ++n) {
    text += std::string(n == 0 ? " " : "; ");
    for (std::size_t l = 0; l < layers[n].labels.size() && l < 12; ++l)
      text += (l == 0 ? "" : ", ") + layers[n].labels[l].name;
  }
  return text + ".";
}

}  // namespace

std::array<float, 3> colourOfLab(const std::vector<std::uint16_t> &lab) {
  const double light = lab[0] / 65535.0 * 100.0, a = lab[1] / 65535.0 * 255.0 - 128.0,
               b = lab[2] / 65535.0 * 255.0 - 128.0;
  const auto inverse = [](double t) { return t > 6.0 / 29.0 ? t * t * t : 3.0 * 36.0 / 841.0 * (t - 4.0 / 29.0); };
  const double fy = (light + 16.0) / 116.0;
  const double x = 0.9642 * inverse(fy + a / 500.0), y = inverse(fy), z = 0.8249 * inverse(fy - b / 200.0);
  // XYZ under D50 to linear sRGB, whose white is D65 (Bradford; ICC.1:2022 annex E and IEC 61966-2-1).
  const std::array<double, 3> rgb{3.1338561 * x - 1.6168667 * y - 0.4906146 * z,
                                  -0.9787684 * x + 1.9161415 * y + 0.0334540 * z,
                                  0.0719453 * x - 0.2289914 * y + 1.4052427 * z};
  std::array<float, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(std::clamp(rgb[c], 0.0, 1.0));
  return out;
}

std::optional<DicomSegmentation> segmentationOf(const DicomSet &set) {
  DicomSegmentation out;
  const std::string type = set.text(0x00620001);
  if (type == "FRACTIONAL") {
    out.kind = DicomSegmentation::Kind::fractional;
    out.most = std::max<double>(1.0, static_cast<double>(set.number(0x0062000e)));
  } else if (type == "LABELMAP") {
    out.kind = DicomSegmentation::Kind::labels;
  } else if (type != "BINARY") {
    return std::nullopt;
  }
  for (const DicomSet &item : set.items(0x00620002)) {
    DicomSegment segment;
    segment.number = static_cast<std::uint16_t>(item.number(0x00620004));
    segment.name = item.name(0x00620005);
    if (const auto lab = item.words(0x0062000d); lab.size() == 3)
      segment.coloured = true, segment.colour = colourOfLab(lab);
    if (segment.number > 0) out.segments.push_back(segment);
  }
  return out;
}

Expected<SegmentGrid> gridOfSegments(const DicomFolder &folder, const DicomStack &stack) {
  const DicomFile &file = folder.files[stack.slices.front().file];
  const DicomFrame &first = file.frames[stack.slices.front().frame];
  if (!first.position || !first.oriented)
    return refuse(file.path, "is a segmentation whose frames have no place in the patient");
  const Vec3 normal = cross(first.alongRow, first.alongColumn);
  constexpr double kSamePlace_mm = 0.01;
  std::vector<double> along;
  Vec3 origin = *first.position;
  double sideways = 0.0;
  for (const SliceRef &ref : stack.slices) {
    const Vec3 position = *file.frames[ref.frame].position, d = position - *first.position;
    along.push_back(dot(d, normal));
    sideways = std::max(sideways, norm(d - along.back() * normal));
    if (along.back() < dot(origin - *first.position, normal)) origin = position;
  }
  if (sideways > std::max(0.1 * std::min(first.rowStep, first.columnStep), kSamePlace_mm))
    return refuse(file.path,
                  "its frames are shifted sideways by up to " + rounded(sideways) + " mm: they make no volume");
  std::vector<double> places = along;
  std::sort(places.begin(), places.end());
  double least = 0.0;
  for (std::size_t n = 1; n < places.size(); ++n)
    if (const double gap = places[n] - places[n - 1]; gap > kSamePlace_mm)
      least = least == 0.0 ? gap : std::min(least, gap);
  const auto fits = [&](double step) {
    return step > kSamePlace_mm && std::all_of(along.begin(), along.end(), [&](double at) {
             const double index = (at - places.front()) / step;
             return std::abs(index - std::round(index)) < 0.1;  // positions and steps are rounded
           });
  };
  double step = least > 0.0 && !fits(first.sliceStep) ? least : first.sliceStep;
  if (step <= 0.0) step = 1.0;
  if (!fits(step))
    return refuse(file.path, "its frames lie unevenly, at least " + rounded(least) +
                                 " mm apart and not at multiples of it: they make no grid");
  // The stated step may be rounded; over many slices the positions are more accurate.
  const double steps = std::round((places.back() - places.front()) / step);
  if (steps >= 1.0) step = (places.back() - places.front()) / steps;
  ImageHeader header;
  header.path = file.path;
  if (const auto set =
          setSize(header, {static_cast<double>(file.columns), static_cast<double>(file.rows), steps + 1.0});
      !set)
    return tl::unexpected(set.error());
  if (const auto set = setAffine(header, first.columnStep * first.alongRow, first.rowStep * first.alongColumn,
                                 step * normal, origin);
      !set)
    return tl::unexpected(set.error());
  SegmentGrid out;
  out.geometry = header.geometry;
  for (const double at : along) out.k.push_back(static_cast<std::size_t>(std::lround((at - places.front()) / step)));
  return out;
}

Expected<LoadedLabels> readSegments(const DicomFolder &folder, const DicomStack &stack, const ReadOptions &options) {
  const DicomFile &file = folder.files[stack.slices.front().file];
  const auto grid = gridOfSegments(folder, stack);
  if (!grid) return tl::unexpected(grid.error());
  const double decoded =
      static_cast<double>(file.rows * file.columns * file.frames.size()) * std::max(8u, file.bits) / 8.0;
  const double needed = 1.2 * decoded + 2.0 * static_cast<double>(grid->geometry.voxelCount());
  if (const auto fits = checkMemory(file.path, needed, options.memoryLimit); !fits) return tl::unexpected(fits.error());
  if (!shouldContinue(options.progress, 0.0, "Decoding segments")) return cancelled(file.path);
  const auto pixels = decodeDicom(file.path);
  if (!pixels) return tl::unexpected(pixels.error());
  if (pixels->columns != file.columns || pixels->rows != file.rows || pixels->frames < file.frames.size())
    return refuse(file.path, "its pixels are not as many as its header says");

  const DicomSegmentation &said = *file.segmentation;
  LoadedLabels out;
  out.notices = file.notices;
  Layers layers(file.path, *grid, *pixels, options);
  try {
    if (said.kind == DicomSegmentation::Kind::labels) {
      for (std::size_t s = 0; s < stack.slices.size(); ++s)
        if (const auto added = layers.addNumbers(s, stack.slices[s].frame); !added)
          return tl::unexpected(added.error());
    } else {
      std::map<std::uint16_t, std::vector<std::pair<std::size_t, std::size_t>>> slicesOf;
      for (std::size_t s = 0; s < stack.slices.size(); ++s)
        slicesOf[file.frames[stack.slices[s].frame].segment].emplace_back(s, stack.slices[s].frame);
      if (slicesOf.contains(0)) return refuse(file.path, "is a segmentation with frames that belong to no segment");
      const double least = said.kind == DicomSegmentation::Kind::binary ? 1.0 : 0.5 * said.most;
      std::size_t done = 0;
      for (const auto &[segment, slices] : slicesOf) {
        if (!shouldContinue(options.progress, static_cast<double>(done++) / static_cast<double>(slicesOf.size()),
                            "Placing segments"))
          return cancelled(file.path);
        if (const auto added = layers.add(segment, slices, least); !added) return tl::unexpected(added.error());
      }
      if (said.kind == DicomSegmentation::Kind::fractional)
        out.notices.push_back("The segmentation holds fractions: a voxel belongs to a segment from one half on.");
    }
  } catch (const std::bad_alloc &) {
    return refuse(file.path, "reading needs more memory than the machine gives");
  }
  const std::size_t overlap = layers.overlap();
  std::vector<LabelMap> maps;
  for (std::vector<std::uint16_t> &voxels : layers.all()) {
    std::vector<LabelMap::Label> labels = labelsIn(voxels, said);
    maps.push_back({grid->geometry, std::move(voxels), std::move(labels)});
  }
  if (maps.size() > 1) out.notices.push_back(layersText(maps, overlap));
  out.labels = std::move(maps.front());
  out.layers.assign(std::make_move_iterator(maps.begin() + 1), std::make_move_iterator(maps.end()));
  return out;
}

}  // namespace c3de::imaging
