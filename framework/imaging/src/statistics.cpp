// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace c3de::imaging {
namespace {

struct StoredRange {
  double min = 0.0, max = 0.0, low = 0.0, high = 0.0;
};

/// The bins, from the lowest on, below which `count` voxels lie.
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

}  // namespace

ValueRange robustRange(const Volume &volume, double clipped) {
  const StoredRange stored = std::visit([&](const auto &all) { return rangeOf(all, clipped); }, volume.voxels);
  const auto value = [&](double v) { return volume.slope * v + volume.intercept; };
  ValueRange range{value(stored.min), value(stored.max), value(stored.low), value(stored.high)};
  if (volume.slope < 0.0) {
    std::swap(range.min, range.max);
    std::swap(range.low, range.high);
  }
  if (!(range.low < range.high)) {
    // One value fills nearly all of it: take what there is, else anything around it.
    range.low = range.min;
    range.high = range.max > range.min ? range.max : range.min + 1.0;
  }
  return range;
}

}  // namespace c3de::imaging
