// SPDX-License-Identifier: Apache-2.0
#include "forces/laminate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "forces/point_loops.h"
#include "forces/vector_forces_parts.h"

namespace pointbased::detail {
namespace {

constexpr double kMostJump = 0.7;
constexpr double kLeastWay = 1e-6;  // of a cell, between the middles of two materials
constexpr double kAlike = 1e-6;     // of a modulus

// Some of the points of a cell, taken as one material: sums weighted by volume until they are divided.
struct Layer {
  double volume = 0.0, mu = 0.0, lambda = 0.0;
  Vec3 middle = Vec3::Zero(), squares = Vec3::Zero();  // m, m²: means of place and of its squares

  void add(const StencilSet &s, std::size_t q, const Material &material) {
    const CellShape &shape = *s.shapeOf(q);
    const double edge = 0.25 / shape.gradient, v = s.volumes[q];
    const Vec3 place = 2.0 * edge * edge * shape.first;
    volume += v;
    mu += v * material.mu();
    lambda += v * (material.lambda() + material.volumeStiffness);
    middle += v * place;
    squares += v * (s.variances[q] + place.cwiseAbs2());
  }
  void divide() {
    mu /= volume;
    lambda /= volume;
    middle /= volume;
    squares /= volume;
  }
};

// Across the border: from the middle of one layer to that of the other, by the extents of both, which a skin may cut.
Vec3 normalOf(const Layer &one, const Layer &two, double edge) {
  const double all = one.volume + two.volume;
  const Vec3 way = one.middle - two.middle, middle = (one.volume * one.middle + two.volume * two.middle) / all,
             extent = (one.volume * one.squares + two.volume * two.squares) / all - middle.cwiseAbs2();
  if (!(way.norm() > kLeastWay * edge) || !(extent.minCoeff() > 0.0)) return Vec3::Zero();
  return way.cwiseQuotient(extent).normalized();
}

// Of points of a cell, softest first: how many are the softer layer, up to the widest gap between their moduli.
std::size_t softerOf(const Constitution &constitution, const StencilSet &s, std::span<const Index> points) {
  std::size_t count = 1;
  double widest = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k)
    if (const double gap =
            materialOfPoint(constitution, s, points[k]).mu() / materialOfPoint(constitution, s, points[k - 1]).mu();
        gap > widest) {
      widest = gap;
      count = k;
    }
  return count;
}

}  // namespace

Laminates findLaminates(const StencilSet &s, const Constitution &constitution) {
  Laminates out;
  if (s.materials.empty() || !s.isLattice() || !s.reference.empty() || constitution.remembers()) return out;
  const auto muOf = [&](Index q) { return materialOfPoint(constitution, s, q).mu(); };
  std::vector<Index> points;
  for (Index q = 0; q < s.pointCount(); q += static_cast<Index>(points.size())) {
    points.assign(1, q);
    while (points.back() + 1 < s.pointCount() && std::ranges::equal(s.phyxels.row(q), s.phyxels.row(points.back() + 1)))
      points.push_back(points.back() + 1);
    if (points.size() == 1 || !std::ranges::all_of(points, [&](Index p) {
          return kernelKnows(materialOfPoint(constitution, s, p)) && s.shapeOf(p) != nullptr;
        }))
      continue;
    std::ranges::stable_sort(points, {}, muOf);
    const std::size_t softer = softerOf(constitution, s, points);
    std::array<Layer, 2> layers;
    for (std::size_t k = 0; k < points.size(); ++k)
      layers[k < softer ? 0 : 1].add(s, points[k], materialOfPoint(constitution, s, points[k]));
    for (Layer &layer : layers) layer.divide();
    const auto &[one, two] = layers;
    const double ofOne = one.volume / (one.volume + two.volume), ofTwo = 1.0 - ofOne;
    const double mu = ofTwo * one.mu + ofOne * two.mu, lambda = ofTwo * one.lambda + ofOne * two.lambda,
                 wave = lambda + 2.0 * mu;
    if (!(wave > 0.0) ||
        (std::abs(one.mu - two.mu) <= kAlike * mu && std::abs(one.lambda - two.lambda) <= kAlike * wave))
      continue;
    Laminate laminate;
    laminate.normal = normalOf(one, two, 0.25 / s.shapeOf(q)->gradient);
    if (laminate.normal == Vec3::Zero()) continue;
    laminate.shear = 2.0 * (one.mu - two.mu) / mu;
    laminate.trace = (one.lambda - two.lambda) / wave;
    laminate.across = 2.0 * (one.mu - two.mu) / wave;
    laminate.limit = std::max(ofOne, ofTwo) / kMostJump;
    if (out.of.empty()) out.of.assign(s.pointCount(), Laminates::kNone);
    for (std::size_t k = 0; k < points.size(); ++k) {
      laminate.share = k < softer ? ofTwo : -ofOne;
      out.of[points[k]] = static_cast<Index>(out.all.size());
      out.all.push_back(laminate);
    }
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
