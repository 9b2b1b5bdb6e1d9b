// SPDX-License-Identifier: Apache-2.0
#include "pointbased/displacement_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/contact_skin.h"
#include "discretisation/interpolation_at.h"

namespace pointbased {
namespace {

constexpr double kReach = 1.1;  // spacings
constexpr double kMinWeight = 1e-6;
constexpr double kBeyondGrid = 1000.0;          // m; finite, so that interpolated values are finite as well
constexpr double kHeldWeight = 1e6;             // of points held by supports, relative to those across a border
constexpr double kSliver = 0.25, kWhole = 0.5;  // of the volume of its phyxels: F of its surroundings, its own F
constexpr double kMinVolume = 0.02;             // det F: points below are too compressed to map positions back

// Current position of an evaluation point. The mean of its phyxels would be wrong: phyxels connected only to a sliver
// are light and may be a decimetre away from what they hardly carry.
Vec3 presentPlace(const Body &body, std::size_t q, const Interpolation &points) {
  const RestState &rest = body.rest();
  const std::span<const Vec3> u = body.state().displacements;
  return rest.origin + rest.pointCentres[q] +
         (rest.evaluation == Evaluation::phyxels ? u[q] : detail::fieldAt(points, q, u));
}

// F around each point. F of a sliver in its cell does not represent its surroundings; the means at its phyxels do.
// Clouds have no slivers.
std::vector<Mat3> gradientsAround(const Body &body, const Interpolation &points) {
  const RestState &rest = body.rest();
  const std::span<const Mat3> own = body.gradients();
  std::vector<Mat3> out(own.begin(), own.end());
  if (rest.evaluation == Evaluation::phyxels) return out;
  std::vector<Mat3> means(rest.phyxelCount());
  phyxelGradients(rest, own, means);
  for (std::size_t q = 0; q < out.size(); ++q) {
    Mat3 around = Mat3::Zero();
    double carried = 0.0;
    for (Index e = points.phyxels.offsets[q]; e < points.phyxels.offsets[q + 1]; ++e) {
      const Index j = points.phyxels.indices[e];
      around += points.weights[e] * means[j];
      carried += points.weights[e] * (rest.volumes[j] - (rest.supportVolumes.empty() ? 0.0 : rest.supportVolumes[j]));
    }
    const double part = rest.stencils.volumes[q] / carried;
    const double share = std::clamp((part - kSliver) / (kWhole - kSliver), 0.0, 1.0);
    if (carried > 0.0 && share < 1.0) out[q] = share * own[q] + (1.0 - share) * around;
  }
  return out;
}

// Displacement of a point from the first reference to the current one.
Vec3 carriedBy(const RestState &rest, std::size_t q) {
  Vec3 sum = Vec3::Zero();
  const std::span<const Index> row = rest.stencils.phyxels.row(q);
  for (const Index j : row) sum += rest.referenceShift[j];
  return sum / static_cast<double>(row.size());
}

}  // namespace

DisplacementField::DisplacementField(FieldGrid grid, bool withGaps)
    : grid_(grid), toIndex_(grid.steps.inverse()), now_(grid.count(), Eigen::Vector4d::Zero()),
      material_(withGaps ? grid.count() : 0, Eigen::Vector4d::Zero()) {}

/// Visits the grid points within `half` (in indices) of a position: visit(number, position).
template <class Visit>
void DisplacementField::visitPoints(const Vec3 &centre, const Vec3 &half, const Visit &visit) const {
  const Vec3 middle = toIndex_ * (centre - grid_.origin);
  std::array<std::size_t, 3> low{}, high{};
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const auto most = static_cast<double>(grid_.size[i]) - 1.0;
    const double from = std::ceil(middle[a] - half[a]), to = std::floor(middle[a] + half[a]);
    if (!(from <= most && to >= 0.0)) return;
    low[i] = static_cast<std::size_t>(std::clamp(from, 0.0, most));
    high[i] = static_cast<std::size_t>(std::clamp(to, 0.0, most));
  }
  for (std::size_t k = low[2]; k <= high[2]; ++k)
    for (std::size_t j = low[1]; j <= high[1]; ++j) {
      const Vec3 start =
          grid_.origin + grid_.steps.col(1) * static_cast<double>(j) + grid_.steps.col(2) * static_cast<double>(k);
      const std::size_t row = grid_.size[0] * (j + grid_.size[1] * k);
      for (std::size_t i = low[0]; i <= high[0]; ++i)
        visit(row + i, Vec3(start + grid_.steps.col(0) * static_cast<double>(i)));
    }
}

void DisplacementField::add(const Body &body, const Interpolation &points) {
  if (!body.rigid()) addHeld(body);
  const RestState &rest = body.rest();
  // Smaller cells are closer together, and their F applies over a shorter distance.
  const std::vector<double> spacings = rest.evaluation == Evaluation::phyxels
                                           ? std::vector<double>(rest.pointCount(), rest.spacing)
                                           : detail::spacingsAt(points, rest.positions, rest.spacing);
  const bool renewed = !rest.referenceShift.empty();
  const std::vector<Mat3> gradients = renewed ? std::vector<Mat3>() : gradientsAround(body, points);
  // Row norms of the inverse steps: change of an index per metre.
  const Vec3 indexPerMetre(toIndex_.row(0).norm(), toIndex_.row(1).norm(), toIndex_.row(2).norm());
  for (std::size_t q = 0; q < rest.pointCount(); ++q) {
    // After rereferencing F counts from an intermediate state that is not stored. Flowing material is shifted, not
    // rotated.
    const Mat3 F = renewed ? Mat3(Mat3::Identity()) : gradients[q];
    if (!(F.determinant() > kMinVolume) || !F.allFinite()) continue;
    const Mat3 back = F.inverse();
    const Vec3 x = presentPlace(body, q, points);
    const Vec3 X = rest.origin + rest.pointCentres[q] - (renewed ? carriedBy(rest, q) : Vec3(Vec3::Zero()));
    const double reach = kReach * spacings[q], inverseSquare = 1.0 / (reach * reach);
    // Bounding box of the ball deformed by F, with a tolerance for rounding. Points outside have no weight.
    const Vec3 half = (1.0 + 1e-9) * reach * (toIndex_ * F).rowwise().norm();
    visitPoints(x, half, [&](std::size_t p, const Vec3 &place) {
      const Vec3 away = back * (place - x);
      const double left = 1.0 - away.squaredNorm() * inverseSquare;
      if (left > 0.0) addTo(p, left * left, place - X - away, reach);
    });
    if (material_.empty()) continue;
    visitPoints(X, reach * indexPerMetre, [&](std::size_t p, const Vec3 &place) {
      const Vec3 away = place - X;
      const double left = 1.0 - away.squaredNorm() * inverseSquare;
      if (!(left > 0.0)) return;
      material_[p].head<3>() += left * left * (x + F * away - place);
      material_[p][3] += left * left;
    });
  }
}

// Adds grid points in the region of a fix and within a spacing of a phyxel.
void DisplacementField::addHeld(const Body &body) {
  const RestState &rest = body.rest();
  const Vec3 half = rest.spacing * Vec3(toIndex_.row(0).norm(), toIndex_.row(1).norm(), toIndex_.row(2).norm());
  Index present = StencilSet::kNoFrame;
  RigidMotion motion;
  // Most grid points are near several phyxels of a fix; the region is tested once per point.
  std::vector<Index> seen(grid_.count(), present), seenInReference(material_.size(), present);
  const auto isNew = [&present](Index &one) { return std::exchange(one, present) != present; };
  for (const auto &[phyxel, fix] : body.phyxelsNearSupports()) {
    if (fix != present) motion = body.supportMotion(present = fix);
    const Region &region = rest.conditions.fixes[fix].region;
    const Vec3 &X = rest.positions[phyxel];
    visitPoints(rest.origin + X + motion.displacementOf(X), half, [&](std::size_t p, const Vec3 &place) {
      if (now_[p][3] >= kHeldWeight || !isNew(seen[p])) return;
      const Vec3 x = place - rest.origin;
      const Vec3 from = motion.rotation.transpose() * (x - motion.centre - motion.displacement) + motion.centre;
      if (contains(region, rest.origin + from)) addTo(p, kHeldWeight, x - from, kReach * rest.spacing);
    });
    if (material_.empty()) continue;
    visitPoints(rest.origin + X, half, [&](std::size_t p, const Vec3 &place) {
      if (material_[p][3] >= kHeldWeight || !isNew(seenInReference[p]) || !contains(region, place)) return;
      material_[p].head<3>() += kHeldWeight * motion.displacementOf(place - rest.origin);
      material_[p][3] += kHeldWeight;
    });
  }
}

void DisplacementField::addTo(std::size_t p, double w, const Vec3 &u, double reach) {
  const auto agrees = [&](const Eigen::Vector4d &sum) {
    const double part = reach * sum[3];
    return (u * sum[3] - sum.head<3>()).squaredNorm() <= part * part;
  };
  const auto join = [&](Eigen::Vector4d &sum) {
    sum.head<3>() += w * u;
    sum[3] += w;
  };
  Eigen::Vector4d &first = now_[p];
  if (agrees(first)) return join(first);
  std::vector<Eigen::Vector4d> &others = others_[p];
  for (Eigen::Vector4d &sum : others)
    if (agrees(sum)) return join(sum);
  join(others.emplace_back(Eigen::Vector4d::Zero()));
}

Eigen::Vector4d DisplacementField::heaviest(std::size_t p) const {
  Eigen::Vector4d most = now_[p];
  if (others_.empty()) return most;
  if (const auto found = others_.find(p); found != others_.end())
    for (const Eigen::Vector4d &sum : found->second)
      if (sum[3] > most[3]) most = sum;
  return most;
}

void DisplacementField::write(double falloff, std::span<float> out) const {
  const std::size_t n = grid_.count();
  std::vector<Vec3> u(n, Vec3::Zero());
  std::vector<std::int32_t> layer(n, -1);  // steps from the border; -1: not reached
  std::vector<std::size_t> front;
  for (std::size_t p = 0; p < n; ++p) {
    const Eigen::Vector4d sum = heaviest(p);
    if (!(sum[3] > kMinWeight)) continue;
    u[p] = sum.head<3>() / sum[3];
    layer[p] = 0;
  }
  const double step = std::min({grid_.steps.col(0).norm(), grid_.steps.col(1).norm(), grid_.steps.col(2).norm()});
  const auto layers = static_cast<std::int32_t>(std::clamp(std::round(falloff / step), 0.0, 4096.0));
  const std::array<std::size_t, 3> stride{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  const auto forNeighbours = [&](std::size_t p, const auto &visit) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t at = p / stride[a] % grid_.size[a];
      if (at > 0) visit(p - stride[a]);
      if (at + 1 < grid_.size[a]) visit(p + stride[a]);
    }
  };
  // Extrapolates outwards layer by layer; each value is the mean of its neighbours in inner layers.
  std::vector<std::size_t> next;
  for (std::int32_t l = 1; l < layers; ++l) {
    next.clear();
    const auto reach = [&](std::size_t p) {
      forNeighbours(p, [&](std::size_t other) {
        if (layer[other] >= 0) return;
        layer[other] = l;
        next.push_back(other);
      });
    };
    if (l == 1) {
      for (std::size_t p = 0; p < n; ++p)
        if (layer[p] == 0) reach(p);
    } else {
      for (const std::size_t p : front) reach(p);
    }
    for (const std::size_t p : next) {
      Vec3 sum = Vec3::Zero();
      double count = 0.0;
      forNeighbours(p, [&](std::size_t other) {
        if (layer[other] < 0 || layer[other] >= l) return;
        sum += u[other];
        count += 1.0;
      });
      u[p] = sum / count;
    }
    std::swap(front, next);
  }
  for (std::size_t p = 0; p < n; ++p) {
    double part = layer[p] < 0 ? 0.0 : 1.0;
    if (layer[p] > 0) {
      const double t = static_cast<double>(layer[p]) / static_cast<double>(layers);
      part = 1.0 - t * t * (3.0 - 2.0 * t);
    }
    for (int a = 0; a < 3; ++a) out[3 * p + static_cast<std::size_t>(a)] = static_cast<float>(part * u[p][a]);
  }
}

void DisplacementField::writeGaps(std::span<const float> u, std::span<float> out) const {
  const std::array<std::size_t, 3> stride{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  // Distance between x and the current position of the material at X, if X is in a body.
  const auto gapAt = [&](const Vec3 &x, const Vec3 &X) {
    const Vec3 index = toIndex_ * (X - grid_.origin);
    std::array<std::size_t, 3> base{};
    Vec3 t;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      const auto most = static_cast<double>(grid_.size[i]) - 1.0;
      if (!(index[a] >= -1e-6 && index[a] <= most + 1e-6)) return kBeyondGrid;
      const double within = std::clamp(index[a], 0.0, most);
      base[i] = std::min(static_cast<std::size_t>(within), grid_.size[i] > 1 ? grid_.size[i] - 2 : 0);
      t[a] = within - static_cast<double>(base[i]);
    }
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (unsigned corner = 0; corner < 8; ++corner) {
      double part = 1.0;
      std::size_t p = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool far = (corner >> a & 1U) != 0;
        part *= far ? t[static_cast<int>(a)] : 1.0 - t[static_cast<int>(a)];
        p += (base[a] + (far ? 1 : 0)) * stride[a];
      }
      if (part > 0.0) sum += part * material_[p];
    }
    return sum[3] > kMinWeight ? (X + sum.head<3>() / sum[3] - x).norm() : 0.0;
  };
  for (std::size_t p = 0; p < grid_.count(); ++p) {
    out[p] = 0.0F;
    if (now_[p][3] > kMinWeight) continue;
    const Vec3 x = grid_.origin + grid_.steps * Vec3(static_cast<double>(p % grid_.size[0]),
                                                     static_cast<double>(p / stride[1] % grid_.size[1]),
                                                     static_cast<double>(p / stride[2]));
    out[p] = static_cast<float>(gapAt(x, x - Vec3(u[3 * p], u[3 * p + 1], u[3 * p + 2])));
  }
}

}  // namespace pointbased
