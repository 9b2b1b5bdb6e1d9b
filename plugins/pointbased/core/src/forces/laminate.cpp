// SPDX-License-Identifier: Apache-2.0
#include "forces/laminate.h"

#include <algorithm>
#include <cmath>

#include "forces/point_loops.h"
#include "forces/vector_forces_parts.h"

namespace pointbased::detail {
namespace {

constexpr double kMostJump = 0.7;
constexpr double kLeastWay = 1e-6;  // of a cell, between the middles of two materials
constexpr double kAlike = 1e-6;     // of a modulus

// Across the border: from the middle of one part to that of the other, by the extents of both, which a skin may cut.
Vec3 normalOf(const StencilSet &s, std::size_t one, std::size_t two) {
  const CellShape *a = s.shapeOf(one), *b = s.shapeOf(two);
  if (a == nullptr || b == nullptr) return Vec3::Zero();
  const double edge = 0.25 / a->gradient, v = s.volumes[one], w = s.volumes[two];
  const Vec3 way = 2.0 * edge * edge * (a->first - b->first);  // m
  const Vec3 extent =
      (v * s.variances[one] + w * s.variances[two]) / (v + w) + v * w / ((v + w) * (v + w)) * way.cwiseAbs2();
  if (!(way.norm() > kLeastWay * edge) || !(extent.minCoeff() > 0.0)) return Vec3::Zero();
  return way.cwiseQuotient(extent).normalized();
}

}  // namespace

Laminates findLaminates(const StencilSet &s, const Constitution &constitution) {
  Laminates out;
  if (s.materials.empty() || !s.isLattice() || !s.reference.empty() || constitution.remembers()) return out;
  const auto sameCell = [&](std::size_t q, std::size_t p) {
    return p < s.pointCount() && std::ranges::equal(s.phyxels.row(q), s.phyxels.row(p));
  };
  for (std::size_t q = 0; q + 1 < s.pointCount();) {
    std::size_t end = q + 1;
    while (sameCell(q, end)) ++end;
    const Material &one = materialOfPoint(constitution, s, q), &two = materialOfPoint(constitution, s, end - 1);
    if (end - q == 2 && kernelKnows(one) && kernelKnows(two)) {
      const double v = s.volumes[q], w = s.volumes[q + 1], ofOne = v / (v + w), ofTwo = w / (v + w);
      const double l1 = one.lambda() + one.volumeStiffness, l2 = two.lambda() + two.volumeStiffness;
      const double mu = ofTwo * one.mu() + ofOne * two.mu(), lambda = ofTwo * l1 + ofOne * l2;
      const bool isAlike =
          std::abs(one.mu() - two.mu()) <= kAlike * mu && std::abs(l1 - l2) <= kAlike * (lambda + 2.0 * mu);
      const Vec3 normal = isAlike ? Vec3(Vec3::Zero()) : normalOf(s, q, q + 1);
      if (normal != Vec3::Zero() && lambda + 2.0 * mu > 0.0) {
        if (out.of.empty()) out.of.assign(s.pointCount(), Laminates::kNone);
        Laminate laminate;
        laminate.normal = normal;
        laminate.shear = 2.0 * (one.mu() - two.mu()) / mu;
        laminate.trace = (l1 - l2) / (lambda + 2.0 * mu);
        laminate.across = 2.0 * (one.mu() - two.mu()) / (lambda + 2.0 * mu);
        laminate.limit = std::max(ofOne, ofTwo) / kMostJump;
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
          laminate.share = k == 0 ? ofTwo : -ofOne;
          out.of[q + k] = static_cast<Index>(out.all.size());
          out.all.push_back(laminate);
        }
      }
    }
    q = end;
  }
  return out;
}

Mat3 materialGradient(const Laminate &laminate, const Mat3 &axes, const Mat3 &F, bool isLinear) {
  const Mat3 own = axes.transpose() * F * axes;
  const Vec3 &n = laminate.normal;
  const Mat3 E = isLinear ? Mat3(0.5 * (own + own.transpose()) - Mat3::Identity())
                          : Mat3(0.5 * (own.transpose() * own - Mat3::Identity()));
  const Vec3 En = E * n;
  const double nEn = n.dot(En);
  const Vec3 b = -(laminate.shear * (En - nEn * n) + (laminate.trace * E.trace() + laminate.across * nEn) * n);
  const Vec3 y = isLinear ? b : Vec3(own * b / std::sqrt(1.0 + laminate.limit * laminate.limit * b.squaredNorm()));
  return F + laminate.share * (axes * y) * (axes * n).transpose();
}

}  // namespace pointbased::detail
