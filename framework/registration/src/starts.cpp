// SPDX-License-Identifier: Apache-2.0
#include "starts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "c3de/geometry/rigid_fit.h"
#include "motions.h"
#include "point_tree.h"

namespace c3de::registration {
namespace {

constexpr std::size_t kSurfaceAnchors = 256, kFewerAnchors = 128, kPointAnchors = 6, kTurns = 24, kRotations = 576;
constexpr std::size_t kFirstPoints = 16, kAllPoints = 64;

/// A measured point with the direction of its normal.
struct Anchor {
  Vec3 point{}, normal{};
  double flatness = 0.0;  ///< 0: all neighbours are in a plane
};

Vec3 meanOf(const std::vector<Vec3> &points) {
  Vec3 sum{};
  for (const Vec3 &p : points) sum = sum + p;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

Anchor anchorAt(const MovingPoints &moving, const PointTree &tree, std::size_t i) {
  std::array<std::uint32_t, 24> indices{};
  std::array<double, 24> squared{};
  const std::size_t wanted = std::clamp<std::size_t>(moving.points.size() / 20, 6, indices.size());
  const std::size_t count = tree.nearest(moving.points[i], wanted, indices.data(), squared.data());
  Anchor out;
  for (std::size_t k = 0; k < count; ++k)
    out.point = out.point + (1.0 / static_cast<double>(count)) * moving.points[indices[k]];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 d = moving.points[indices[k]] - out.point;
    const Eigen::Vector3d v(d[0], d[1], d[2]);
    spread += v * v.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  const Eigen::Vector3d n = eigen.eigenvectors().col(0);
  out.normal = {n[0], n[1], n[2]};
  // Relative to the middle spread: neighbours in a line define no plane.
  out.flatness = eigen.eigenvalues()[0] / std::max(eigen.eigenvalues()[1], 1e-12);
  if (!moving.normals.empty()) out.normal = moving.normals[i];
  return out;
}

/// Flat neighbourhoods that are far from each other. Outliers have none.
std::vector<Anchor> anchorsOf(const MovingPoints &moving, double apart_mm) {
  const PointTree tree(moving.points);
  std::vector<Anchor> all, out;
  for (const std::size_t i : shuffledIndices(moving.points.size(), 200)) all.push_back(anchorAt(moving, tree, i));
  std::stable_sort(all.begin(), all.end(), [](const Anchor &a, const Anchor &b) { return a.flatness < b.flatness; });
  for (double least = apart_mm; out.size() < kPointAnchors && least > 0.1 * apart_mm; least *= 0.5)
    for (const Anchor &one : all)
      if (out.size() < kPointAnchors &&
          std::all_of(out.begin(), out.end(), [&](const Anchor &o) { return norm(o.point - one.point) > least; }))
        out.push_back(one);
  return out;
}

/// All motions that are rated, each computed from its number.
class Hypotheses {
 public:
  Hypotheses(const TargetSurface &target, const MovingPoints &moving, double extent_mm)
      : moving_(moving), anchors_(anchorsOf(moving, 0.25 * extent_mm)), rotations_(uniformRotations(kRotations)),
        signs_(moving.areNormalsOriented && !moving.normals.empty() ? 1 : 2), centroid_(meanOf(moving.points)),
        centre_(target.centre()) {
    const SurfaceSamples &samples = target.samples();
    for (const std::size_t i : spreadIndices(samples.points, kSurfaceAnchors)) {
      surface_.points.push_back(samples.points[i]);
      surface_.normals.push_back(samples.normals[i]);
    }
    for (std::size_t k = 0; k < kTurns; ++k)
      turns_.push_back(2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(kTurns));
    byNormals_ = anchors_.size() * surface_.points.size() * kTurns * signs_;
    fewer_ = std::min(kFewerAnchors, surface_.points.size());
    byRotations_ = std::min<std::size_t>(2, anchors_.size()) * fewer_ * rotations_.size();
  }

  [[nodiscard]] std::size_t count() const { return byNormals_ + byRotations_ + rotations_.size(); }

  [[nodiscard]] Mat4 operator[](std::size_t i) const {
    if (i < byNormals_) {
      const std::size_t sign = i % signs_, turn = i / signs_ % kTurns, rest = i / (signs_ * kTurns);
      const std::size_t s = rest % surface_.points.size();
      const Anchor &anchor = anchors_[rest / surface_.points.size()];
      const Vec3 &to = surface_.normals[s];
      const Mat4 aligned = rotationBetween((sign == 0 ? 1.0 : -1.0) * anchor.normal, to);
      return withPoint(multiply(rotationOf(turns_[turn] * to), aligned), anchor.point, surface_.points[s]);
    }
    i -= byNormals_;
    if (i < byRotations_) {
      const std::size_t rest = i / rotations_.size();
      return withPoint(rotations_[i % rotations_.size()], anchors_[rest / fewer_].point,
                       surface_.points[rest % fewer_]);
    }
    // A surface that was measured as a whole has its centroid where the body has it.
    return withPoint(rotations_[i - byRotations_], centroid_, centre_);
  }

 private:
  const MovingPoints &moving_;
  std::vector<Anchor> anchors_;
  std::vector<Mat4> rotations_;
  std::size_t signs_;
  Vec3 centroid_, centre_;
  SurfaceSamples surface_;
  std::vector<double> turns_;
  std::size_t byNormals_ = 0, byRotations_ = 0, fewer_ = 0;
};

/// Mean of min(distance, reach), which far points do not dominate.
double coarseCost(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m, std::size_t count) {
  double sum = 0.0;
  const double reach = target.reach_mm();
  for (std::size_t i = 0; i < std::min(count, moving.points.size()); ++i) {
    const Foot foot = target.near(transformPoint(m, moving.points[i]));
    double d = foot.isFound ? std::min(foot.distance, reach) : reach;
    if (foot.isFound && !moving.normals.empty()) {
      const double along = dot(turned(m, moving.normals[i]), foot.normal);
      if ((moving.areNormalsOriented ? along : std::abs(along)) < 0.0) d = reach;
    }
    sum += d;
  }
  for (const LandmarkPair &pair : moving.pairs)
    sum += moving.pairWeight * std::min(reach, norm(transformPoint(m, pair.measured_mm) - pair.body_mm));
  return sum;
}

/// The numbers with the smallest costs, in the order of cost and number.
std::vector<std::size_t> bestOf(const std::vector<float> &costs, const std::vector<std::size_t> &numbers,
                                std::size_t count) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  count = std::min(count, order.size());
  const auto isBetter = [&](std::size_t a, std::size_t b) {
    return costs[a] < costs[b] || (costs[a] == costs[b] && a < b);
  };
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), isBetter);
  order.resize(count);
  for (std::size_t &o : order) o = numbers.empty() ? o : numbers[o];
  return order;
}

}  // namespace

std::vector<Mat4> startsOf(const TargetSurface &target, const MovingPoints &all, std::size_t count, ThreadPool *pool) {
  const MovingPoints moving = all.subset(shuffledIndices(all.points.size(), kAllPoints));
  std::vector<double> away;
  const Vec3 middle = meanOf(moving.points);
  for (const Vec3 &p : moving.points) away.push_back(norm(p - middle));
  std::nth_element(away.begin(), away.begin() + static_cast<std::ptrdiff_t>(away.size() / 2), away.end());
  const double extent = 2.0 * away[away.size() / 2];

  const Hypotheses hypotheses(target, all, extent);
  std::vector<float> costs(hypotheses.count());
  inParallel(pool, costs.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      costs[i] = static_cast<float>(coarseCost(target, moving, hypotheses[i], kFirstPoints));
  });
  const std::vector<std::size_t> promising = bestOf(costs, {}, costs.size() / 20);
  costs.assign(promising.size(), 0.0f);
  inParallel(pool, promising.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      costs[i] = static_cast<float>(coarseCost(target, moving, hypotheses[promising[i]], kAllPoints));
  });
  std::vector<Mat4> out;
  if (all.pairs.size() >= geometry::kFewestRigidPairs) {
    std::vector<Vec3> from, to;
    for (const LandmarkPair &pair : all.pairs) from.push_back(pair.measured_mm), to.push_back(pair.body_mm);
    if (const auto fit = geometry::fitRigid(from, to)) out.push_back(fit->fixedFromMoving);
  }
  for (const std::size_t number : bestOf(costs, promising, promising.size())) {
    if (out.size() >= count) break;
    const Mat4 m = hypotheses[number];
    const auto isNear = [&](const Mat4 &other) { return distanceOf(m, other, moving.points) < 0.15 * extent; };
    if (std::none_of(out.begin(), out.end(), isNear)) out.push_back(m);
  }
  return out;
}

}  // namespace c3de::registration
