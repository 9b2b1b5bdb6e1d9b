// SPDX-License-Identifier: Apache-2.0
#include "measured_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace c3de::registration {
namespace {

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Indices of points, each position once, in their order.
std::vector<std::size_t> differentPoints(const std::vector<Vec3> &points) {
  std::vector<std::size_t> order(points.size()), out;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return points[a] < points[b]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i == 0 || points[order[i]] != points[order[i - 1]]) out.push_back(order[i]);
  std::sort(out.begin(), out.end());
  return out;
}

Expected<void> checkPairs(const std::vector<LandmarkPair> &pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!std::isfinite(norm(pairs[i].body_mm)) || !std::isfinite(norm(pairs[i].measured_mm)))
      return fail(ErrorCode::usage, fmt::format("landmark pair {} has a coordinate that is not finite", i + 1));
  return {};
}

}  // namespace

double medianExtent(const std::vector<Vec3> &points) {
  Vec3 middle{};
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (const Vec3 &p : points) values.push_back(p[a]);
    middle[a] = medianOf(std::move(values));
  }
  std::vector<double> away;
  for (const Vec3 &p : points) away.push_back(norm(p - middle));
  return 2.0 * medianOf(std::move(away));
}

Expected<void> checkFinite(const std::vector<Vec3> &points, const char *what) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!std::isfinite(x))
        return fail(ErrorCode::usage, fmt::format("{} {} is ({:g}, {:g}, {:g}); accepted: finite coordinates in mm",
                                                  what, i + 1, points[i][0], points[i][1], points[i][2]));
  return {};
}

Expected<void> checkExtent(double points_mm, const TargetSurface &target) {
  constexpr double kSmallest = 1.0 / 100.0, kLargest = 20.0;
  const double body_mm = medianExtent(target.samples().points), ratio = points_mm / body_mm;
  if (ratio >= kSmallest && ratio <= kLargest) return {};
  const std::string sizes =
      fmt::format("the measured points extend over {:.3g} mm and the body over {:.3g} mm", points_mm, body_mm);
  if (ratio < kSmallest && ratio > 1e-4)
    return fail(ErrorCode::usage, sizes + "; if they are in metres, multiply them by 1000; accepted: points in mm");
  if (ratio < kSmallest) return fail(ErrorCode::usage, sizes + "; accepted: points on a surface of a hundredth of it");
  return fail(ErrorCode::usage,
              fmt::format("{}; accepted: points in mm, of at most {:g} times the extent of the body", sizes, kLargest));
}

Expected<CheckedInput> checkInput(const TargetSurface &target, const MeasuredSurface &measured,
                                  const RegistrationOptions &options) {
  if (!(options.noise_mm > 0.0) || !std::isfinite(options.noise_mm))
    return fail(ErrorCode::usage, fmt::format("noise is {:g} mm; accepted: a number above 0, mm", options.noise_mm));
  if (!(options.pointsPerPair > 0.0) || !std::isfinite(options.pointsPerPair))
    return fail(ErrorCode::usage,
                fmt::format("the weight of a landmark is {:g} points; accepted: above 0", options.pointsPerPair));
  if (auto good = checkFinite(measured.points_mm, "measured point"); !good) return tl::unexpected(good.error());
  if (!measured.normals.empty() && measured.normals.size() != measured.points_mm.size())
    return fail(ErrorCode::usage, fmt::format("{} normals for {} measured points; accepted: none or as many",
                                              measured.normals.size(), measured.points_mm.size()));
  if (auto good = checkFinite(measured.normals, "normal"); !good) return tl::unexpected(good.error());
  if (auto good = checkPairs(measured.pairs); !good) return tl::unexpected(good.error());

  CheckedInput out;
  const std::vector<std::size_t> different = differentPoints(measured.points_mm);
  const std::size_t same = measured.points_mm.size() - different.size();
  if (different.size() < kFewestSurfacePoints)
    return fail(ErrorCode::usage,
                fmt::format("{} measured point{}{}; accepted: at least {} on the surface of the body", different.size(),
                            different.size() == 1 ? "" : "s",
                            same > 0 ? fmt::format(" besides {} at equal positions", same) : "", kFewestSurfacePoints));
  if (same > 0)
    out.warnings.push_back(fmt::format("{} of {} measured points are at the position of another and count once", same,
                                       measured.points_mm.size()));
  out.points.areNormalsOriented = measured.areNormalsOriented;
  for (const std::size_t i : different) {
    out.points.points.push_back(measured.points_mm[i]);
    if (!measured.normals.empty()) out.points.normals.push_back(measured.normals[i]);
  }
  out.points.pairs = measured.pairs;
  out.points.pairWeight = options.pointsPerPair;
  out.extent_mm = medianExtent(out.points.points);
  if (auto good = checkExtent(out.extent_mm, target); !good) return tl::unexpected(good.error());
  if (!target.isClosed())
    out.warnings.emplace_back("the surface of the body is open: points beyond its borders count as outliers");
  return out;
}

}  // namespace c3de::registration
