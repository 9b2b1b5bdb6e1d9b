// SPDX-License-Identifier: Apache-2.0
// The order and position of slices: which are evenly spaced, can be resampled, or do not form a volume.
#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"
#include "dicom/dicom_series.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

/// Positions in files are rounded to some micrometres; closer ones are the same position.
constexpr double kSamePlace_mm = 0.01;

struct Placed {
  SliceRef ref;
  Vec3 position;
  double along;  ///< mm along the normal
};

std::string rounded(double x) { return formatNumber(std::round(x * 1000.0) / 1000.0); }

class Planner {
 public:
  Planner(const DicomFolder &folder, const DicomStack &stack, const std::filesystem::path &preferred, std::size_t time)
      : folder_(folder), stack_(stack), preferred_(time == 0 ? preferred : std::filesystem::path()), time_(time) {}

  /// Positions of the slices, mm along the normal; empty where they do not form a row.
  std::vector<double> places() {
    std::vector<double> along;
    if (!sortSlices() || !dropCopies()) return along;
    for (const Placed &slice : placed_) along.push_back(slice.along);
    return along;
  }

  Expected<StackPlan> plan() {
    for (const SliceRef &ref : stack_.slices)
      for (const std::string &notice : file(ref).notices) note(notice);
    const DicomFrame &first = frame(stack_.slices.front());
    if (!first.spaced) note("The files give no pixel spacing: 1 mm is taken.");
    if (!first.oriented || !first.position) note("The files do not say where the image lies in the patient.");
    if (auto done = sortSlices(); !done) return tl::unexpected(done.error());
    if (auto done = dropCopies(); !done) return tl::unexpected(done.error());
    if (auto done = space(); !done) return tl::unexpected(done.error());
    for (const Placed &slice : placed_) out_.slices.push_back(slice.ref);
    return std::move(out_);
  }

 private:
  [[nodiscard]] const DicomFile &file(const SliceRef &ref) const { return folder_.files[ref.file]; }
  [[nodiscard]] const DicomFrame &frame(const SliceRef &ref) const { return file(ref).frames[ref.frame]; }
  void note(const std::string &text) {
    if (std::find(out_.notices.begin(), out_.notices.end(), text) == out_.notices.end()) out_.notices.push_back(text);
  }
  [[nodiscard]] tl::unexpected<Error> refused(const std::string &what) const {
    return refuse(file(stack_.slices.front()).path, what);
  }

  /// Order of pictures at one position: the requested file first, then by time, echo, acquisition, number.
  [[nodiscard]] bool earlier(const SliceRef &a, const SliceRef &b) const {
    const bool pa = file(a).path == preferred_, pb = file(b).path == preferred_;
    if (pa != pb) return pa;
    if (file(a).order != file(b).order) return file(a).order < file(b).order;
    if (a.file != b.file) return a.file < b.file;
    return frame(a).time < frame(b).time;
  }

  Expected<void> sortSlices() {
    const DicomFrame &first = frame(stack_.slices.front());
    normal_ = cross(first.alongRow, first.alongColumn);
    const bool isTimeSeries = file(stack_.slices.front()).isTimeSeries,
               known = first.position.has_value() && !isTimeSeries;
    std::vector<SliceRef> order = stack_.slices;
    std::stable_sort(order.begin(), order.end(), [&](const SliceRef &a, const SliceRef &b) { return earlier(a, b); });
    double step = first.sliceStep;
    if (isTimeSeries) {
      step = 0.0;  // one position
      note("The " + std::to_string(order.size()) + " frames have no positions (a cine loop): each is a time point.");
    } else if (!known && order.size() > 1) {
      if (step == 0.0) step = 1.0;
      note("The slices have no positions: they are stacked in the order of their numbers, " + rounded(step) +
           " mm apart.");
      // The requested file comes first among equals only.
      std::stable_sort(order.begin(), order.end(),
                       [&](const SliceRef &a, const SliceRef &b) { return file(a).order < file(b).order; });
    }
    for (std::size_t n = 0; n < order.size(); ++n) {
      const Vec3 from = isTimeSeries ? first.position.value_or(Vec3{}) : Vec3{};
      const Vec3 position = known ? *frame(order[n]).position : from + (static_cast<double>(n) * step) * normal_;
      placed_.push_back({order[n], position, dot(position, normal_)});
    }
    std::stable_sort(placed_.begin(), placed_.end(),
                     [](const Placed &a, const Placed &b) { return a.along < b.along; });
    return {};
  }

  /// Keeps one picture for each position. Several at every position are volumes in time (or echoes, or weightings); the
  /// one for time_ is used.
  Expected<void> dropCopies() {
    std::vector<std::vector<Placed>> places;
    for (const Placed &slice : placed_) {
      if (places.empty() || slice.along - places.back().front().along > kSamePlace_mm) places.emplace_back();
      places.back().push_back(slice);
    }
    std::size_t least = placed_.size(), most = 0, copies = 0;
    placed_.clear();
    for (std::vector<Placed> &place : places) {
      for (const Placed &slice : place)
        if (norm(slice.position - place.front().position) > kSamePlace_mm)
          return refused("slices at " + rounded(slice.along) + " mm along their normal lie side by side, " +
                         rounded(norm(slice.position - place.front().position)) + " mm apart: they make no volume");
      std::stable_sort(place.begin(), place.end(),
                       [&](const Placed &a, const Placed &b) { return earlier(a.ref, b.ref); });
      std::vector<Placed> distinct;
      for (const Placed &slice : place) {
        const bool copy = std::any_of(distinct.begin(), distinct.end(), [&](const Placed &other) {
          return !file(slice.ref).instance.empty() && file(slice.ref).instance == file(other.ref).instance &&
                 slice.ref.file != other.ref.file;
        });
        if (copy)
          ++copies;
        else
          distinct.push_back(slice);
      }
      least = std::min(least, distinct.size());
      most = std::max(most, distinct.size());
      placed_.push_back(distinct[std::min(time_, distinct.size() - 1)]);
    }
    if (copies > 0) note(std::to_string(copies) + " pictures are copies of others in the folder and are left out.");
    if (most > 1 && least != most)
      return refused("at some places there is one slice, at others there are up to " + std::to_string(most) +
                     ": which of them belong together is not known");
    if (time_ >= most)
      return refused("time " + std::to_string(time_) + " is asked for; there " +
                     (most == 1
                          ? "is one time point (0)"
                          : "are " + std::to_string(most) + " time points (0 … " + std::to_string(most - 1) + ")"));
    out_.times = most;
    if (most > 1 && time_ == 0 && preferred_.empty())
      note("There are " + std::to_string(most) +
           " pictures at every position (several volumes): the first of each is read.");
    else if (most > 1)
      note("There are " + std::to_string(most) + " pictures at every position (several volumes): " +
           (time_ > 0 ? "time " + std::to_string(time_) + " of 0 … " + std::to_string(most - 1) + " is read."
                      : "that of the named file, otherwise the first, is read."));
    return {};
  }

  Expected<void> space() {
    const DicomFile &head = file(placed_.front().ref);
    const DicomFrame &first = frame(placed_.front().ref);
    const Vec3 i = first.columnStep * first.alongRow, j = first.rowStep * first.alongColumn;
    const std::size_t n = placed_.size();
    ImageHeader header;
    header.path = head.path;
    Vec3 k;
    Vec3 origin = placed_.front().position;
    std::size_t count = n;
    if (n == 1) {
      const double step = first.sliceStep > 0.0 ? first.sliceStep : 1.0;
      if (first.sliceStep <= 0.0) note("The image is a single slice without a thickness: 1 mm is taken.");
      k = step * normal_;
      out_.at = {0.0};
    } else {
      const auto steps = evenSteps();
      if (!steps) return tl::unexpected(steps.error());
      count = steps->count;
      const Vec3 whole = placed_.back().position - origin, along = (1.0 / norm(whole)) * whole;
      k = steps->step * along;
      origin = origin + steps->from * along;
    }
    if (const auto set = setSize(
            header, {static_cast<double>(head.columns), static_cast<double>(head.rows), static_cast<double>(count)});
        !set)
      return set;
    if (const auto set = setAffine(header, i, j, k, origin); !set) return set;
    out_.geometry = header.geometry;
    const double tilt = std::acos(std::min(1.0, std::abs(dot(k, normal_)) / norm(k))) * 180.0 / 3.14159265358979323846;
    // 0.05 degrees move slices by less than a tenth of a pixel over a hand's breadth.
    if (tilt > 0.05)
      note("The slices are tilted by " + formatNumber(std::round(tilt * 10.0) / 10.0) +
           " degrees relative to the stacking direction (gantry tilt): the sheared grid is retained.");
    return {};
  }

  /// The evenly spaced slices of the volume, mm along the row of the existing ones.
  struct Steps {
    std::size_t count = 0;
    double step = 0.0, from = 0.0;
  };

  /// As many slices as exist, or more where some are missing or unevenly spaced.
  Expected<Steps> evenSteps() {
    const std::size_t n = placed_.size();
    const Vec3 origin = placed_.front().position, whole = placed_.back().position - origin;
    const double length = norm(whole);
    const DicomFrame &first = frame(placed_.front().ref);
    if (std::abs(dot(whole, normal_)) < 0.1 * length)
      return refused("the slices lie beside each other, not one behind the other");
    std::vector<double> along(n), gaps;
    double sideways = 0.0, uneven = 0.0;
    const double mean = length / static_cast<double>(n - 1);
    for (std::size_t s = 0; s < n; ++s) {
      const Vec3 d = placed_[s].position - origin;
      along[s] = dot(d, whole) / length;
      sideways = std::max(sideways, norm(d - (along[s] / length) * whole));
      uneven = std::max(uneven, std::abs(along[s] - mean * static_cast<double>(s)));
      if (s > 0) gaps.push_back(along[s] - along[s - 1]);
    }
    if (sideways > std::max(0.1 * std::min(first.rowStep, first.columnStep), kSamePlace_mm))
      return refused("the slices are shifted sideways by up to " + rounded(sideways) +
                     " mm and not in a straight row: they make no volume");
    const auto report = [&](double step) {
      for (const double a : along) out_.at.push_back(a / step);
    };
    // Rounded positions and table feed amount to a hundredth of the step.
    if (uneven <= std::max(0.01 * mean, kSamePlace_mm)) {
      report(mean);
      for (std::size_t s = 0; s < n; ++s) out_.at[s] = static_cast<double>(s);
      return Steps{n, mean, 0.0};
    }
    if (const auto blocks = blocksIn(along); !blocks.empty()) return stepsOfBlocks(blocks, along);
    std::vector<double> sorted = gaps;
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[(sorted.size() - 1) / 2], least = sorted.front(), most = sorted.back();
    const double step = least < 0.5 * median ? least : median;
    if (most > 4.5 * median)
      return refused("between two slices there are " + rounded(most) + " mm, elsewhere " + rounded(median) +
                     ": more than three slices are missing in a row");
    const double count = std::round(length / step) + 1.0;
    if (count > 4.0 * static_cast<double>(n))
      return refused("the slices lie too unevenly, " + rounded(least) + " to " + rounded(most) +
                     " mm apart, to be resampled");
    const bool whole_gaps = std::all_of(
        gaps.begin(), gaps.end(), [&](double gap) { return std::abs(gap / median - std::round(gap / median)) < 0.02; });
    const auto slices = static_cast<std::size_t>(count);
    if (whole_gaps)
      note(std::to_string(slices - n) + " slices are missing (" + rounded(most) +
           " mm between two of them, elsewhere " + rounded(median) +
           "): they are interpolated between their neighbours.");
    else
      note("The slices lie unevenly, " + rounded(least) + " to " + rounded(most) + " mm apart: they are resampled to " +
           rounded(length / (count - 1.0)) + " mm by interpolation between neighbours.");
    out_.resampled = true;
    report(length / (count - 1.0));
    return Steps{slices, length / (count - 1.0), 0.0};
  }

  /// One grid for blocks of different spacing: that of the finest block, whose slices are unchanged, over the whole
  /// length.
  Expected<Steps> stepsOfBlocks(const std::vector<SliceBlock> &blocks, const std::vector<double> &along) {
    std::string said;
    const SliceBlock *finest = &blocks.front();
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const SliceBlock &block = blocks[b];
      if (block.spacing_mm < finest->spacing_mm * (1.0 - 1e-3)) finest = &block;
      said += (b == 0 ? "" : ", ") + std::to_string(block.count) + " slices " + rounded(block.spacing_mm) + " mm apart";
      if (b + 1 == blocks.size()) break;
      const double gap = along[blocks[b + 1].first] - along[block.first + block.count - 1];
      said += ", then " + rounded(gap) + " mm";
      if (gap > 4.5 * std::max(block.spacing_mm, blocks[b + 1].spacing_mm))
        return refused("the slices lie in " + std::to_string(blocks.size()) + " blocks with " + rounded(gap) +
                       " mm between two of them, too far to be interpolated; each block can be read by itself as a "
                       "part of its series (#1, #2, …)");
    }
    const double step = finest->spacing_mm, anchor = along[finest->first];
    const auto below = static_cast<std::size_t>(std::lround(anchor / step)),
               above = static_cast<std::size_t>(std::lround((along.back() - anchor) / step));
    const double count = static_cast<double>(below + above + 1);
    if (count > 20.0 * static_cast<double>(along.size()))
      return refused("the slices lie in blocks from " + rounded(step) + " mm apart, which would need " +
                     formatNumber(count) +
                     " slices; each block can be read by itself as a part of its series (#1, #2, …)");
    note("The slices lie in " + std::to_string(blocks.size()) + " blocks: " + said +
         ". They are one volume, resampled to " + rounded(step) +
         " mm by interpolation between neighbours; each block can be opened by itself as a part of the series (#1, #2, "
         "…).");
    const double from = anchor - static_cast<double>(below) * step;
    for (const double a : along) out_.at.push_back((a - from) / step);
    out_.resampled = true;
    return Steps{below + above + 1, step, from};
  }

  const DicomFolder &folder_;
  const DicomStack &stack_;
  std::filesystem::path preferred_;
  std::size_t time_;
  Vec3 normal_{};
  std::vector<Placed> placed_;
  StackPlan out_;
};

}  // namespace

std::vector<SliceBlock> blocksIn(const std::vector<double> &along) {
  std::vector<SliceBlock> blocks;
  const auto same = [](double a, double b) { return std::abs(a - b) <= std::max(0.01 * a, 2.0 * kSamePlace_mm); };
  for (std::size_t at = 0; at < along.size();) {
    std::size_t end = at + 1;
    while (end < along.size() && same(along[at + 1] - along[at], along[end] - along[end - 1])) ++end;
    if (end - at < 3) return {};
    blocks.push_back({at, end - at, (along[end - 1] - along[at]) / static_cast<double>(end - at - 1)});
    at = end;
  }
  if (blocks.size() < 2) return {};
  // Equal blocks a few spacings apart are one row with missing slices.
  const double spacing = blocks.front().spacing_mm;
  const bool isRow = std::all_of(blocks.begin(), blocks.end(), [&](const SliceBlock &block) {
    const double steps = (along[block.first] - along.front()) / spacing;
    return same(block.spacing_mm, spacing) && std::abs(steps - std::round(steps)) < 0.02;
  });
  return isRow ? std::vector<SliceBlock>() : blocks;
}

std::vector<DicomStack> blocksOf(const DicomFolder &folder, const DicomStack &stack) {
  std::vector<DicomStack> out;
  if (stack.slices.size() < 6) return out;
  const std::vector<double> along = Planner(folder, stack, {}, 0).places();
  for (const SliceBlock &block : blocksIn(along)) {
    DicomStack &part = out.emplace_back();
    part.info = stack.info;
    for (const SliceRef &ref : stack.slices) {
      const DicomFrame &frame = folder.files[ref.file].frames[ref.frame];
      if (!frame.position) return {};
      const double at = dot(*frame.position, cross(frame.alongRow, frame.alongColumn));
      if (at > along[block.first] - kSamePlace_mm && at < along[block.first + block.count - 1] + kSamePlace_mm)
        part.slices.push_back(ref);
    }
  }
  return out;
}

Expected<StackPlan> planStack(const DicomFolder &folder, const DicomStack &stack,
                              const std::filesystem::path &preferred, std::size_t time) {
  return Planner(folder, stack, preferred, time).plan();
}

}  // namespace c3de::imaging
