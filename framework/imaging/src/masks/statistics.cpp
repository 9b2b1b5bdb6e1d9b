// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

namespace c3de::imaging {
namespace {

struct StoredRange {
  double min = 0.0, max = 0.0, low = 0.0, high = 0.0;
};

/// The first bin at which the cumulative count exceeds `count`.
std::size_t binAt(const std::vector<std::size_t> &bins, double count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    sum += static_cast<double>(bins[i]);
    if (sum > count) return i;
  }
  return bins.size() - 1;
}

template <class T>
StoredRange rangeOf(const std::vector<T> &voxels, double clipped) {
  constexpr bool isSmall = std::is_integral_v<T> && sizeof(T) <= 2;
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const T v : voxels) {
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(v)) continue;
    min = std::min(min, static_cast<double>(v));
    max = std::max(max, static_cast<double>(v));
  }
  if (!(min < max)) return min == max ? StoredRange{min, max, min, max} : StoredRange{};

  const double width = isSmall ? 1.0 : (max - min) / 4096.0;
  std::vector<std::size_t> bins(isSmall ? static_cast<std::size_t>(max - min) + 1 : 4097, 0);
  std::size_t counted = 0;
  for (const T v : voxels) {
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(v)) continue;
    ++bins[static_cast<std::size_t>((static_cast<double>(v) - min) / width)];
    ++counted;
  }
  const double share = std::clamp(clipped, 0.0, 0.5) * static_cast<double>(counted);
  const double low = min + width * static_cast<double>(binAt(bins, share));
  std::reverse(bins.begin(), bins.end());
  const double high = min + width * static_cast<double>(bins.size() - 1 - binAt(bins, share));
  return {min, max, low, std::min(high, max)};
}

/// Histogram of voxel values, 10 HU per bin from -1100 to 3100; values below and above are in the first and last bin.
struct HounsfieldBins {
  static constexpr double kFirst = -1100.0, kWidth = 10.0;
  std::array<double, 422> counts{};
  double below = 0.0, total = 0.0;  ///< voxels below kFirst; all finite ones
  double padding = 0.0;             ///< part of `below` with the lowest value of all
  [[nodiscard]] static std::size_t binOf(double hu) {
    return static_cast<std::size_t>(std::clamp((hu - kFirst) / kWidth + 1.0, 0.0, 421.0));
  }
  [[nodiscard]] double between(double from, double to) const {
    double sum = 0.0;
    for (std::size_t b = binOf(from); b < binOf(to); ++b) sum += counts[b];
    return sum;
  }
  /// The value below which this share of the voxels between two values is.
  [[nodiscard]] double quantile(double from, double to, double share) const {
    const double wanted = share * between(from, to);
    double sum = 0.0;
    for (std::size_t b = binOf(from); b < binOf(to); ++b) {
      sum += counts[b];
      if (sum > wanted) return kFirst + kWidth * (static_cast<double>(b) - 0.5);
    }
    return to;
  }
};

HounsfieldBins hounsfieldBins(const Volume &volume) {
  HounsfieldBins bins;
  double lowest = std::numeric_limits<double>::infinity();
  std::visit(
      [&](const auto &all) {
        for (const auto voxel : all) {
          const double value = volume.slope * static_cast<double>(voxel) + volume.intercept;
          if (!std::isfinite(value)) continue;
          bins.counts[HounsfieldBins::binOf(value)] += 1.0;
          bins.total += 1.0;
          if (value >= HounsfieldBins::kFirst) continue;
          bins.below += 1.0;
          if (value < lowest) lowest = value, bins.padding = 0.0;
          if (value == lowest) bins.padding += 1.0;
        }
      },
      volume.voxels);
  return bins;
}

// Limits that exclude lung and air, and metal, HU.
constexpr double kTissue = -300.0, kMetal = 2000.0;

bool isLikelyHounsfield(const Volume &volume, const HounsfieldBins &bins) {
  if (volume.unit == "HU") return true;
  if (!volume.unit.empty() || !volume.colours.empty() || bins.below - bins.padding > 1e-3 * bins.total) return false;
  const double air = bins.between(-1100.0, -850.0) + bins.padding, tissue = bins.between(kTissue, kMetal);
  const double soft = bins.between(-150.0, 200.0);
  return air > 0.01 * bins.total && tissue > 0.01 * bins.total && soft > 0.5 * tissue &&
         bins.between(kMetal, 3100.0) < 0.05 * bins.total;
}

}  // namespace

bool isLikelyHounsfield(const Volume &volume) { return isLikelyHounsfield(volume, hounsfieldBins(volume)); }

ValueRange robustRange(const Volume &volume, double clipped) {
  const StoredRange stored = std::visit([&](const auto &all) { return rangeOf(all, clipped); }, volume.voxels);
  const auto value = [&](double v) { return volume.slope * v + volume.intercept; };
  ValueRange range{value(stored.min), value(stored.max), value(stored.low), value(stored.high)};
  if (volume.slope < 0.0) {
    std::swap(range.min, range.max);
    std::swap(range.low, range.high);
  }
  if (!volume.colours.empty()) {
    range.low = 0.0, range.high = 255.0;
    return range;
  }
  const HounsfieldBins bins = hounsfieldBins(volume);
  if (isLikelyHounsfield(volume, bins) && bins.between(kTissue, kMetal) > 1e-3 * bins.total) {
    range.low = std::max(bins.quantile(kTissue, kMetal, 0.01), -200.0);
    range.high = std::clamp(bins.quantile(kTissue, kMetal, 0.98), 250.0, 1000.0);
  }
  if (!(range.low < range.high)) {
    // One value fills nearly the whole image: use the full range, otherwise any range around it.
    range.low = range.min;
    range.high = range.max > range.min ? range.max : range.min + 1.0;
  }
  return range;
}

std::vector<std::uint64_t> histogramOf(const Volume &volume, double low, double high, std::size_t bins) {
  if (!(low < high) || bins == 0) return {};
  std::vector<std::uint64_t> counts(bins, 0);
  const double perBin = static_cast<double>(bins) / (high - low);
  std::visit(
      [&](const auto &voxels) {
        for (const auto v : voxels) {
          const double value = volume.slope * static_cast<double>(v) + volume.intercept;
          if (!(value >= low && value <= high)) continue;
          ++counts[std::min(bins - 1, static_cast<std::size_t>((value - low) * perBin))];
        }
      },
      volume.voxels);
  return counts;
}

}  // namespace c3de::imaging
