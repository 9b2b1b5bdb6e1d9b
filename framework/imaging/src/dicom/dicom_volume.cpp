// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "dicom/dicom_mosaic.h"
#include "dicom/dicom_series.h"
#include "formats/image_header.h"
#include "formats/voxel_reader.h"

namespace c3de::imaging {
namespace {

/// Copies slices to their position in the volume, from whatever type a file decodes to.
template <class T>
class Builder {
 public:
  Builder(const DicomFolder &folder, const StackPlan &plan, bool values)
      : folder_(folder), plan_(plan), values_(values) {
    slice_ = plan.geometry.size[0] * plan.geometry.size[1];
    stack_.resize(slice_ * plan.slices.size());
  }

  Expected<Voxels> build(const ReadOptions &options) {
    // File by file, so that a file with many frames is decoded once.
    std::vector<std::size_t> order(plan_.slices.size());
    for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return plan_.slices[a].file < plan_.slices[b].file; });
    DicomPixels pixels;
    std::size_t decoded = folder_.files.size();
    for (std::size_t n = 0; n < order.size(); ++n) {
      const SliceRef ref = plan_.slices[order[n]];
      const DicomFile &file = folder_.files[ref.file];
      if (!shouldContinue(options.progress, static_cast<double>(n) / static_cast<double>(order.size()),
                          "Decoding slices"))
        return cancelled(file.path);
      if (decoded != ref.file) {
        auto read = decodeDicom(file.path);
        if (!read) return tl::unexpected(read.error());
        pixels = std::move(*read);
        decoded = ref.file;
        if (file.tiles > 0 && !splitTiles(file, pixels))
          return refuse(file.path, "its mosaic does not have the tiles that its header says");
        if (pixels.columns != file.columns || pixels.rows != file.rows || pixels.frames < file.frames.size())
          return refuse(file.path, "its pixels are not as many as its header says");
      }
      const auto copied = std::visit([&](const auto &from) { return copy(from, ref, order[n]); }, pixels.voxels);
      if (!copied) return tl::unexpected(copied.error());
      if (!pixels.colours.empty()) {
        colours_.resize(slice_ * plan_.slices.size(), Rgba{0, 0, 0, 255});
        std::copy_n(pixels.colours.begin() + static_cast<std::ptrdiff_t>(ref.frame * slice_), slice_,
                    colours_.begin() + static_cast<std::ptrdiff_t>(order[n] * slice_));
      }
    }
    if (!plan_.resampled) return Voxels(std::move(stack_));
    if (!colours_.empty()) colours_ = resample(colours_);
    return Voxels(resample(stack_));
  }
  [[nodiscard]] std::vector<Rgba> takeColours() { return std::move(colours_); }

 private:
  template <class S>
  Expected<void> copy(const std::vector<S> &from, const SliceRef &ref, std::size_t slice) {
    const DicomFile &file = folder_.files[ref.file];
    const DicomFrame &frame = file.frames[ref.frame];
    const S *source = from.data() + ref.frame * slice_;
    T *target = stack_.data() + slice * slice_;
    for (std::size_t p = 0; p < slice_; ++p) {
      if (values_) {
        target[p] = static_cast<T>(frame.slope * static_cast<double>(source[p]) + frame.intercept);
        continue;
      }
      target[p] = static_cast<T>(source[p]);
      if constexpr (!std::is_same_v<S, T>)
        if (static_cast<double>(target[p]) != static_cast<double>(source[p]))
          return refuse(file.path, "pixel " + std::to_string(p) + " decodes to " + std::to_string(source[p]) +
                                       ", which its stated type cannot hold");
    }
    return {};
  }

  template <class S>
  static S between(const S &a, const S &b, double w) {
    const double value = (1.0 - w) * static_cast<double>(a) + w * static_cast<double>(b);
    return static_cast<S>(std::is_integral_v<S> ? std::round(value) : value);
  }
  static Rgba between(const Rgba &a, const Rgba &b, double w) {
    Rgba out{};
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = between(a[c], b[c], w);
    return out;
  }
  template <class S>
  std::vector<S> resample(const std::vector<S> &stack) const {
    std::vector<S> out(plan_.geometry.voxelCount());
    std::size_t below = 0;
    for (std::size_t k = 0; k < plan_.geometry.size[2]; ++k) {
      const auto at = static_cast<double>(k);
      while (below + 2 < plan_.at.size() && plan_.at[below + 1] <= at) ++below;
      const double w = std::clamp((at - plan_.at[below]) / (plan_.at[below + 1] - plan_.at[below]), 0.0, 1.0);
      const S *a = stack.data() + below * slice_, *b = a + slice_;
      for (std::size_t p = 0; p < slice_; ++p) out[k * slice_ + p] = between(a[p], b[p], w);
    }
    return out;
  }

  const DicomFolder &folder_;
  const StackPlan &plan_;
  bool values_;
  std::size_t slice_ = 0;
  std::vector<T> stack_;
  std::vector<Rgba> colours_;
};

template <class T>
Expected<void> buildAs(const DicomFolder &folder, const StackPlan &plan, bool values, const ReadOptions &options,
                       Volume &volume) {
  Builder<T> builder(folder, plan, values);
  auto voxels = builder.build(options);
  if (!voxels) return tl::unexpected(voxels.error());
  volume.voxels = std::move(*voxels);
  volume.colours = builder.takeColours();
  return {};
}

/// In the stored type of the slices; as floats where each has its own scale.
Expected<void> buildVolume(const DicomFolder &folder, const StackPlan &plan, bool same, const ReadOptions &options,
                           Volume &volume) {
  const DicomFile &head = folder.files[plan.slices.front().file];
  if (head.isReal && (head.bits == 64 || !same)) return buildAs<double>(folder, plan, !same, options, volume);
  if (!same || head.isReal) return buildAs<float>(folder, plan, !same, options, volume);
  if (head.bits <= 8)
    return head.isSigned ? buildAs<std::int8_t>(folder, plan, false, options, volume)
                         : buildAs<std::uint8_t>(folder, plan, false, options, volume);
  if (head.bits <= 16)
    return head.isSigned ? buildAs<std::int16_t>(folder, plan, false, options, volume)
                         : buildAs<std::uint16_t>(folder, plan, false, options, volume);
  return head.isSigned ? buildAs<std::int32_t>(folder, plan, false, options, volume)
                       : buildAs<std::uint32_t>(folder, plan, false, options, volume);
}

}  // namespace

Expected<LoadedVolume> readStack(const DicomFolder &folder, const DicomStack &stack, const StackPlan &plan,
                                 const ReadOptions &options) {
  LoadedVolume out;
  out.notices = plan.notices;
  out.times = plan.times;
  const DicomFile &head = folder.files[plan.slices.front().file];
  const DicomFrame &first = head.frames[plan.slices.front().frame];
  bool same = true;
  double largestFile = 0.0;
  for (const SliceRef &ref : plan.slices) {
    const DicomFile &file = folder.files[ref.file];
    const DicomFrame &frame = file.frames[ref.frame];
    same = same && file.bits == head.bits && file.isSigned == head.isSigned && file.isReal == head.isReal &&
           frame.slope == first.slope && frame.intercept == first.intercept;
    std::error_code code;
    const auto onDisk = static_cast<double>(std::filesystem::file_size(file.path, code));
    const double decoded = static_cast<double>(file.rows * file.columns * file.frames.size()) * file.bits / 8.0 *
                           (file.isColoured ? 8.0 : 1.0);
    largestFile = std::max(largestFile, 2.0 * decoded + (code ? 0.0 : onDisk));
  }
  if (!same)
    out.notices.push_back(
        "The slices are scaled each in its own way: values are kept as floating point instead of as stored.");
  const double each = (same          ? std::max(1.0, head.bits / 8.0)
                       : head.isReal ? 8.0
                                     : 4.0) +
                      (head.isColoured ? sizeof(Rgba) : 0);
  const double slices = static_cast<double>(plan.slices.size() + (plan.resampled ? plan.geometry.size[2] : 0));
  const double bytes = each * slices * static_cast<double>(head.rows * head.columns) + largestFile;
  if (const auto fits = checkMemory(head.path, bytes, options.memoryLimit); !fits) return tl::unexpected(fits.error());

  try {
    if (const auto built = buildVolume(folder, plan, same, options, out.volume); !built)
      return tl::unexpected(built.error());
  } catch (const std::bad_alloc &) {
    return refuse(head.path, "reading needs more memory than the machine gives");
  }
  out.volume.geometry = plan.geometry;
  if (same) out.volume.slope = first.slope, out.volume.intercept = first.intercept;
  out.volume.unit = stack.slices.empty() ? "" : head.unit;
  return out;
}

}  // namespace c3de::imaging
