// SPDX-License-Identifier: Apache-2.0
// The order and place of slices: what is even, what can be resampled, what makes no volume.
#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"
#include "dicom_series.h"
#include "image_header.h"

namespace c3de::imaging {
namespace {

/// Positions in files are rounded to some micrometres; what lies nearer is the same place.
constexpr double kSamePlace_mm = 0.01;

struct Placed {
  SliceRef ref;
  Vec3 position;
  double along;  ///< mm along the normal
};

std::string rounded(double x) { return formatNumber(std::round(x * 1000.0) / 1000.0); }

class Planner {
 public:
  Planner(const DicomFolder &folder, const DicomStack &stack, const std::filesystem::path &preferred)
      : folder_(folder), stack_(stack), preferred_(preferred) {}

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
  [[nodiscard]] tl::unexpected<Error> refused(const std::string &what) const { return refuse(file(stack_.slices.front()).path, what); }

  /// Which of two pictures at one place comes first: the file that was asked for, then time, echo, acquisition, number.
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
    const bool known = first.position.has_value();
    std::vector<SliceRef> order = stack_.slices;
    std::stable_sort(order.begin(), order.end(), [&](const SliceRef &a, const SliceRef &b) { return earlier(a, b); });
    double step = first.sliceStep;
    if (!known && order.size() > 1) {
      if (step == 0.0) step = 1.0;
      note("The slices have no positions: they are laid in the order of their numbers, " + rounded(step) + " mm apart.");
      // The file that was asked for comes first among equals only.
      std::stable_sort(order.begin(), order.end(), [&](const SliceRef &a, const SliceRef &b) { return file(a).order < file(b).order; });
    }
    for (std::size_t n = 0; n < order.size(); ++n) {
      const Vec3 position = known ? *frame(order[n]).position : (static_cast<double>(n) * step) * normal_;
      placed_.push_back({order[n], position, dot(position, normal_)});
    }
    std::stable_sort(placed_.begin(), placed_.end(), [](const Placed &a, const Placed &b) { return a.along < b.along; });
    return {};
  }

  /// One picture for each place. Several at every place are volumes in time (or echoes, or weightings): the first is taken.
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
      std::stable_sort(place.begin(), place.end(), [&](const Placed &a, const Placed &b) { return earlier(a.ref, b.ref); });
      std::vector<Placed> distinct;
      for (const Placed &slice : place) {
        const bool copy = std::any_of(distinct.begin(), distinct.end(), [&](const Placed &other) {
          return !file(slice.ref).instance.empty() && file(slice.ref).instance == file(other.ref).instance && slice.ref.file != other.ref.file;
        });
        if (copy) ++copies;
        else distinct.push_back(slice);
      }
      least = std::min(least, distinct.size());
      most = std::max(most, distinct.size());
      placed_.push_back(distinct.front());
    }
    if (copies > 0) note(std::to_string(copies) + " pictures are copies of others in the folder and are left out.");
    if (most > 1 && least != most)
      return refused("at some places there is one slice, at others there are up to " + std::to_string(most) +
                     ": which of them belong together is not known");
    if (most > 1) note("There are " + std::to_string(most) + " pictures at every place (several volumes): the first of each is read.");
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
    std::size_t count = n;
    if (n == 1) {
      const double step = first.sliceStep > 0.0 ? first.sliceStep : 1.0;
      if (first.sliceStep <= 0.0) note("The image is a single slice without a thickness: 1 mm is taken.");
      k = step * normal_;
      out_.at = {0.0};
    } else {
      const auto counted = evenSteps();
      if (!counted) return tl::unexpected(counted.error());
      count = *counted;
      k = (1.0 / static_cast<double>(count - 1)) * (placed_.back().position - placed_.front().position);
    }
    if (const auto set = setSize(header, {static_cast<double>(head.columns), static_cast<double>(head.rows), static_cast<double>(count)}); !set) return set;
    if (const auto set = setAffine(header, i, j, k, placed_.front().position); !set) return set;
    out_.geometry = header.geometry;
    const double tilt = std::acos(std::min(1.0, std::abs(dot(k, normal_)) / norm(k))) * 180.0 / 3.14159265358979323846;
    // 0.05 degrees move slices by less than a tenth of a pixel over a hand's breadth.
    if (tilt > 0.05) note("The slices are tilted by " + formatNumber(std::round(tilt * 10.0) / 10.0) + " degrees against their row (gantry tilt): the grid is kept sheared, as it was acquired.");
    return {};
  }

  /// How many even slices the volume has: as many as there are, or more where some are missing or uneven.
  Expected<std::size_t> evenSteps() {
    const std::size_t n = placed_.size();
    const Vec3 origin = placed_.front().position, whole = placed_.back().position - origin;
    const double length = norm(whole);
    const DicomFrame &first = frame(placed_.front().ref);
    if (std::abs(dot(whole, normal_)) < 0.1 * length) return refused("the slices lie beside each other, not one behind the other");
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
      return refused("the slices are shifted sideways by up to " + rounded(sideways) + " mm and not in a straight row: they make no volume");
    const auto report = [&](double step) {
      for (const double a : along) out_.at.push_back(a / step);
    };
    // A hundredth of the step is what rounded positions and table feed amount to.
    if (uneven <= std::max(0.01 * mean, kSamePlace_mm)) {
      report(mean);
      for (std::size_t s = 0; s < n; ++s) out_.at[s] = static_cast<double>(s);
      return n;
    }
    std::vector<double> sorted = gaps;
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[(sorted.size() - 1) / 2], least = sorted.front(), most = sorted.back();
    const double step = least < 0.5 * median ? least : median;
    if (most > 4.5 * median)
      return refused("between two slices there are " + rounded(most) + " mm, elsewhere " + rounded(median) + ": more than three slices are missing in a row");
    const double count = std::round(length / step) + 1.0;
    if (count > 4.0 * static_cast<double>(n))
      return refused("the slices lie too unevenly, " + rounded(least) + " to " + rounded(most) + " mm apart, to be resampled");
    const bool whole_gaps = std::all_of(gaps.begin(), gaps.end(), [&](double gap) { return std::abs(gap / median - std::round(gap / median)) < 0.02; });
    const auto slices = static_cast<std::size_t>(count);
    if (whole_gaps)
      note(std::to_string(slices - n) + " slices are missing (" + rounded(most) + " mm between two of them, elsewhere " + rounded(median) +
           "): they are interpolated between their neighbours.");
    else
      note("The slices lie unevenly, " + rounded(least) + " to " + rounded(most) + " mm apart: they are resampled to " +
           rounded(length / (count - 1.0)) + " mm by interpolation between neighbours.");
    out_.resampled = true;
    report(length / (count - 1.0));
    return slices;
  }

  const DicomFolder &folder_;
  const DicomStack &stack_;
  const std::filesystem::path &preferred_;
  Vec3 normal_{};
  std::vector<Placed> placed_;
  StackPlan out_;
};

}  // namespace

Expected<StackPlan> planStack(const DicomFolder &folder, const DicomStack &stack, const std::filesystem::path &preferred) {
  return Planner(folder, stack, preferred).plan();
}

}  // namespace c3de::imaging
