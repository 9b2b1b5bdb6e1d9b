// SPDX-License-Identifier: Apache-2.0
#include "pointbased/interpolation.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/expects.h"
#include "base/point_tree.h"
#include "base/polar.h"
#include "discretisation/interpolation_at.h"
#include "discretisation/moment.h"
#include "pointbased/neighborhood.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr std::size_t kGrain = 128;

// A point whose distance from its fit exceeds the width of the fit gets more phyxels, until they span space or reach
// this number. From far outside, the nearest phyxels of a body are the skin of one side, which does not determine the
// stretch across it.
constexpr std::size_t kMaxPhyxelsPerPoint = 128;

// By reference, because a std::function of a lambda with large captures allocates.
template <class Point>
void loop(const ParallelFor &parallelFor, std::size_t n, const Point &point) {
  const auto range = [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) point(p);
  };
  parallelFor(n, kGrain, std::cref(range));
}

struct Fit {
  std::vector<Index> phyxels;
  std::vector<double> weights;
  std::vector<Vec3> gradients;
  MomentInverse moment;
  Vec3 offset = Vec3::Zero();
  double width = 0.0;  // m, rms extent of the phyxels
};

// Affine functions through the weighted mean of the phyxels:
//   A = Σ w (X - X̄)(X - X̄)^T,   ∇φ_j = w_j A^+ (X_j - X̄),   φ_j = w_j + ∇φ_j · (X_p - X̄),   Σ w = 1
void fit(const Vec3 &point, std::span<const Vec3> X, std::span<const double> squared, Fit &out) {
  const std::size_t k = out.phyxels.size();
  out.weights.resize(k);
  out.gradients.resize(k);

  // The weight of the nearest must not vanish: if all are equally far, the support is wider than that by the margin.
  const double support = kSupportMargin * std::sqrt(squared[k - 1]);
  double sum = 0.0;
  for (std::size_t e = 0; e < k; ++e) {
    out.weights[e] = support > 0.0 ? kernelWeight(std::sqrt(squared[e]), support) : 1.0;
    sum += out.weights[e];
  }

  // Relative to the nearest phyxel, so that coincident phyxels span exactly nothing.
  const Vec3 anchor = X[out.phyxels[0]];
  Vec3 mean = Vec3::Zero();
  for (std::size_t e = 0; e < k; ++e) {
    out.weights[e] /= sum;
    mean += out.weights[e] * (X[out.phyxels[e]] - anchor);
  }
  Mat3 A = Mat3::Zero();
  for (std::size_t e = 0; e < k; ++e) {
    const Vec3 d = X[out.phyxels[e]] - anchor - mean;
    A += out.weights[e] * d * d.transpose();
  }
  out.moment = invertMoment(A);
  out.width = std::sqrt(A.trace());

  const Vec3 arm = point - anchor - mean;
  out.offset = point - anchor;
  for (std::size_t e = 0; e < k; ++e) {
    const Vec3 d = X[out.phyxels[e]] - anchor;
    out.gradients[e] = out.weights[e] * (out.moment.inverse * (d - mean));
    out.weights[e] += out.gradients[e].dot(arm);
    out.offset -= out.weights[e] * d;
  }
}

}  // namespace

Interpolation bindToCloud(std::span<const Vec3> points, std::span<const Vec3> phyxelPositions,
                          const ParallelFor &parallelFor) {
  Interpolation binding;
  binding.positions.assign(points.begin(), points.end());
  const std::size_t n = points.size(), phyxelCount = phyxelPositions.size();
  binding.phyxels.offsets.assign(n + 1, 0);
  if (n == 0 || phyxelCount == 0) return binding;

  std::vector<Fit> fits(n);
  const PointTree tree(phyxelPositions);
  parallelFor(n, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared;
    for (std::size_t p = begin; p < end; ++p) {
      Fit &f = fits[p];
      const std::size_t most = std::min(kMaxPhyxelsPerPoint, phyxelCount);
      std::size_t count = std::min(kPhyxelsPerPoint, phyxelCount);
      while (true) {
        f.phyxels.resize(count);
        squared.resize(count);
        tree.nearest(points[p], count, f.phyxels.data(), squared.data());
        fit(points[p], phyxelPositions, squared, f);
        if (f.moment.rank == 3 || count == most || !(f.offset.norm() > f.width)) break;
        count = std::min(2 * count, most);
      }
    }
  });

  // Stored contiguously, in one array each.
  bool deficient = false;
  for (std::size_t p = 0; p < n; ++p) {
    binding.phyxels.offsets[p + 1] = binding.phyxels.offsets[p] + static_cast<Index>(fits[p].phyxels.size());
    deficient = deficient || fits[p].moment.rank < 3;
  }
  const std::size_t entries = binding.phyxels.offsets[n];
  binding.phyxels.indices.reserve(entries);
  binding.weights.reserve(entries);
  binding.gradients.reserve(entries);
  if (deficient) {
    binding.rank.resize(n);
    binding.frameOf.assign(n, StencilSet::kNoFrame);
  }
  for (std::size_t p = 0; p < n; ++p) {
    const Fit &f = fits[p];
    binding.phyxels.indices.insert(binding.phyxels.indices.end(), f.phyxels.begin(), f.phyxels.end());
    binding.weights.insert(binding.weights.end(), f.weights.begin(), f.weights.end());
    binding.gradients.insert(binding.gradients.end(), f.gradients.begin(), f.gradients.end());
    if (!deficient) continue;
    binding.rank[p] = static_cast<std::uint8_t>(f.moment.rank);
    if (f.moment.rank == 3) continue;
    binding.frameOf[p] = static_cast<Index>(binding.frames.size());
    binding.frames.push_back(f.moment.frame);
    binding.offsets.push_back(f.offset);
  }
  return binding;
}

void interpolateDisplacements(const Interpolation &binding, std::span<const Vec3> /*phyxelPositions*/,
                              std::span<const Vec3> displacements, std::span<Vec3> out,
                              const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(out.size() == binding.count(), "one result per point");
  loop(parallelFor, binding.count(), [&](std::size_t p) {
    const bool turns = rankOf(binding, p) < 3;
    out[p] =
        displacementAt(binding, p, displacements, turns ? gradientAt(binding, p, displacements) : Mat3::Identity());
  });
}

void interpolateField(const Interpolation &binding, std::span<const Vec3> field, std::span<Vec3> out,
                      const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(out.size() == binding.count(), "one result per point");
  loop(parallelFor, binding.count(), [&](std::size_t p) { out[p] = fieldAt(binding, p, field); });
}

void interpolateGradients(const Interpolation &binding, std::span<const Vec3> displacements, std::span<Mat3> out,
                          const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(out.size() == binding.count(), "one result per point");
  loop(parallelFor, binding.count(), [&](std::size_t p) { out[p] = gradientAt(binding, p, displacements); });
}

void spreadForces(const Interpolation &binding, std::span<const Vec3> pointForces, std::span<Vec3> forces) {
  POINTBASED_EXPECTS(pointForces.size() == binding.count(), "one force per point");
  for (std::size_t p = 0; p < binding.count(); ++p) spreadForce(binding, p, pointForces[p], forces);
}

void updateSurfels(const Interpolation &binding, std::span<const Vec3> restNormals,
                   std::span<const Vec3> phyxelPositions, std::span<const Vec3> displacements,
                   std::span<Vec3> positions, std::span<Vec3> normals, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(positions.size() == binding.count(), "one position per surfel");
  POINTBASED_EXPECTS(normals.empty() || (normals.size() == binding.count() && restNormals.size() == binding.count()),
                     "one normal per surfel, and one at rest, or none");
  if (normals.empty()) {
    interpolateDisplacements(binding, phyxelPositions, displacements, positions, parallelFor);
    loop(parallelFor, binding.count(), [&](std::size_t p) { positions[p] += binding.positions[p]; });
    return;
  }
  loop(parallelFor, binding.count(), [&](std::size_t p) {
    const Mat3 F = gradientAt(binding, p, displacements);
    positions[p] = binding.positions[p] + displacementAt(binding, p, displacements, F);
    const Vec3 n = cofactor(F) * restNormals[p];
    const double length = n.norm();
    normals[p] = length > 0.0 ? Vec3(n / length) : restNormals[p];
  });
}

}  // namespace pointbased
