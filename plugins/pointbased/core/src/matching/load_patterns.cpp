// SPDX-License-Identifier: Apache-2.0
#include "matching/load_patterns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "body/rest_skin.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kSites = 48;
constexpr double kWidth = 0.6;     // of a traction (standard deviation), over the distance between sites
constexpr double kReach = 3.0;     // standard deviations
constexpr double kPerWidth = 2.5;  // samples of the skin along a width
constexpr std::array<std::array<Eigen::Index, 2>, 6> kStresses{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

// Samples that are far from each other: each is the farthest from those before.
std::vector<std::size_t> farthest(const std::vector<Vec3> &points, std::size_t count) {
  std::vector<double> squared(points.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> out;
  while (out.size() < std::min(count, points.size())) {
    const auto next = static_cast<std::size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
    out.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i)
      squared[i] = std::min(squared[i], (points[i] - points[next]).squaredNorm());
  }
  return out;
}

double areaOf(const Surface &skin) {
  double area = 0.0;
  for (const auto &[a, b, c] : skin.triangles)
    area += 0.5 * (skin.positions[b] - skin.positions[a]).cross(skin.positions[c] - skin.positions[a]).norm();
  return area;
}

}  // namespace

LoadPatterns::LoadPatterns(const RestState &rest) : phyxels_(rest.phyxelCount()) {
  const Surface skin = skinOf(rest);
  const double area = areaOf(skin);
  double volume = 0.0;
  for (const double v : rest.volumes) volume += v;
  bodyForce_.resize(phyxels_);
  for (std::size_t i = 0; i < phyxels_; ++i) bodyForce_[i] = area / 3.0 * rest.volumes[i] / volume;
  for (std::vector<Vec3> &stress : stresses_) stress.assign(phyxels_, Vec3::Zero());
  if (!(area > 0.0)) return;
  const double width = kWidth * std::sqrt(area / kSites);
  const SurfacePoints samples = sampleSurface(skin, width / kPerWidth, EverywhereRegion{});
  const Interpolation binding = rest.bind(samples.positions, samples.normals);
  addSites(rest, samples, binding, area);
  std::vector<Vec3> tractions(samples.count());
  for (std::size_t s = 0; s < stresses_.size(); ++s) {
    const auto [i, j] = kStresses[s];
    for (std::size_t p = 0; p < samples.count(); ++p) {
      Vec3 traction = Vec3::Zero();
      traction[i] = samples.areas[p] * samples.normals[p][j];
      traction[j] = samples.areas[p] * samples.normals[p][i];
      tractions[p] = traction;
    }
    spreadForces(binding, tractions, stresses_[s]);
  }
}

void LoadPatterns::addSites(const RestState &rest, const SurfacePoints &samples, const Interpolation &binding,
                            double area) {
  const double width = kWidth * std::sqrt(area / kSites);
  std::vector<Vec3> tractions(samples.count()), spread;
  for (const std::size_t site : farthest(samples.positions, kSites)) {
    for (std::size_t p = 0; p < samples.count(); ++p) {
      const double squared = (samples.positions[p] - samples.positions[site]).squaredNorm() / (width * width);
      // Of a thin body the two sides are near each other, and their loads are not.
      const double facing = std::max(0.0, samples.normals[p].dot(samples.normals[site]));
      tractions[p] = squared < kReach * kReach ? Vec3(samples.areas[p] * facing * std::exp(-0.5 * squared), 0.0, 0.0)
                                               : Vec3(Vec3::Zero());
    }
    spread.assign(rest.phyxelCount(), Vec3::Zero());
    spreadForces(binding, tractions, spread);
    std::vector<double> &one = sites_.emplace_back(phyxels_);
    for (std::size_t i = 0; i < phyxels_; ++i) one[i] = spread[i][0];
  }
}

void LoadPatterns::forces(std::size_t pattern, std::span<Vec3> out) const {
  const std::size_t atSites = 3 * sites_.size();
  if (pattern >= atSites + 3) {
    const std::vector<Vec3> &stress = stresses_[pattern - atSites - 3];
    std::copy(stress.begin(), stress.end(), out.begin());
    return;
  }
  const std::vector<double> &sizes = pattern < atSites ? sites_[pattern / 3] : bodyForce_;
  const Vec3 along = Vec3::Unit(static_cast<Eigen::Index>(pattern % 3));
  for (std::size_t i = 0; i < phyxels_; ++i) out[i] = sizes[i] * along;
}

}  // namespace pointbased::detail
