// SPDX-License-Identifier: Apache-2.0
#include "pointbased/displacement_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

constexpr double kReach = 1.1;       // spacings
constexpr double kLeastVolume = 0.02;  // det F: below it a point does not say where anything has come from

// Where an evaluation point stands now; the mean of its phyxels and F carry affine motions exactly.
Vec3 presentPlace(const Body &body, std::size_t q, const Mat3 &F) {
  const RestState &rest = body.rest();
  const StencilSet &s = rest.stencils;
  Vec3 X = Vec3::Zero(), u = Vec3::Zero();
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  if (rest.evaluation == Evaluation::phyxels)
    return rest.origin + rest.pointCentres[q] + body.state().displacements[q];
  for (Index e = first; e < last; ++e) {
    X += rest.positions[s.phyxels.indices[e]];
    u += body.state().displacements[s.phyxels.indices[e]];
  }
  const double part = 1.0 / static_cast<double>(last - first);
  const Vec3 &centre = rest.pointCentres[q];
  return rest.origin + centre + part * u + (F - Mat3::Identity()) * (centre - part * X);
}

// Way of a point from the first reference to this one.
Vec3 carriedBy(const RestState &rest, std::size_t q) {
  Vec3 sum = Vec3::Zero();
  const std::span<const Index> row = rest.stencils.phyxels.row(q);
  for (const Index j : row) sum += rest.carried[j];
  return sum / static_cast<double>(row.size());
}

}  // namespace

DisplacementField::DisplacementField(FieldGrid grid)
    : grid_(grid), toIndex_(grid.steps.inverse()), sums_(grid.count(), Eigen::Vector4d::Zero()) {}

void DisplacementField::add(const Body &body) {
  const RestState &rest = body.rest();
  const double reach = kReach * rest.spacing, inverseSquare = 1.0 / (reach * reach);
  const std::span<const Mat3> gradients = body.gradients();
  const bool renewed = !rest.carried.empty();
  // Rows of the inverse steps: how far an index goes with a way in space.
  const Vec3 indexPerMetre(toIndex_.row(0).norm(), toIndex_.row(1).norm(), toIndex_.row(2).norm());
  for (std::size_t q = 0; q < rest.pointCount(); ++q) {
    // Of a reference that has been renewed F counts from a state nobody keeps: what flows is carried, not turned.
    const Mat3 F = renewed ? Mat3(Mat3::Identity()) : gradients[q];
    if (!(F.determinant() > kLeastVolume) || !F.allFinite()) continue;
    const Mat3 back = F.inverse();
    const Vec3 x = presentPlace(body, q, F);
    const Vec3 X = rest.origin + rest.pointCentres[q] - (renewed ? carriedBy(rest, q) : Vec3(Vec3::Zero()));
    const Vec3 middle = toIndex_ * (x - grid_.origin);
    // |F dX| is at most the root of the sum of squares times |dX|.
    const Vec3 half = F.norm() * reach * indexPerMetre;
    std::array<std::int64_t, 3> low{}, high{};
    bool any = true;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      const auto most = static_cast<double>(grid_.size[i]) - 1.0;
      const double from = std::ceil(middle[a] - half[a]), to = std::floor(middle[a] + half[a]);
      any = any && from <= most && to >= 0.0;
      low[i] = static_cast<std::int64_t>(std::clamp(from, 0.0, most));
      high[i] = static_cast<std::int64_t>(std::clamp(to, 0.0, most));
    }
    if (!any) continue;
    for (std::int64_t k = low[2]; k <= high[2]; ++k)
      for (std::int64_t j = low[1]; j <= high[1]; ++j) {
        const Vec3 start = grid_.origin + grid_.steps.col(1) * static_cast<double>(j) +
                           grid_.steps.col(2) * static_cast<double>(k);
        const std::size_t row = grid_.size[0] * (static_cast<std::size_t>(j) + grid_.size[1] * static_cast<std::size_t>(k));
        for (std::int64_t i = low[0]; i <= high[0]; ++i) {
          const Vec3 place = start + grid_.steps.col(0) * static_cast<double>(i);
          const Vec3 away = back * (place - x);
          const double left = 1.0 - away.squaredNorm() * inverseSquare;
          if (!(left > 0.0)) continue;
          const double w = left * left;
          addTo(row + static_cast<std::size_t>(i), w, place - X - away, reach);
        }
      }
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
  Eigen::Vector4d &first = sums_[p];
  if (agrees(first)) return join(first);
  std::vector<Eigen::Vector4d> &others = others_[p];
  for (Eigen::Vector4d &sum : others)
    if (agrees(sum)) return join(sum);
  join(others.emplace_back(Eigen::Vector4d::Zero()));
}

Eigen::Vector4d DisplacementField::heaviest(std::size_t p) const {
  Eigen::Vector4d most = sums_[p];
  if (others_.empty()) return most;
  if (const auto found = others_.find(p); found != others_.end())
    for (const Eigen::Vector4d &sum : found->second)
      if (sum[3] > most[3]) most = sum;
  return most;
}

void DisplacementField::write(double rim, std::span<float> out) const {
  const std::size_t n = grid_.count();
  std::vector<Vec3> u(n, Vec3::Zero());
  std::vector<std::int32_t> layer(n, -1);  // steps from the border; -1: not reached
  std::vector<std::size_t> front;
  for (std::size_t p = 0; p < n; ++p) {
    const Eigen::Vector4d sum = heaviest(p);
    if (!(sum[3] > 1e-6)) continue;
    u[p] = sum.head<3>() / sum[3];
    layer[p] = 0;
  }
  const double step = std::min({grid_.steps.col(0).norm(), grid_.steps.col(1).norm(), grid_.steps.col(2).norm()});
  const auto layers = static_cast<std::int32_t>(std::clamp(std::round(rim / step), 0.0, 4096.0));
  const std::array<std::size_t, 3> stride{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  const auto forNeighbours = [&](std::size_t p, const auto &visit) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t at = p / stride[a] % grid_.size[a];
      if (at > 0) visit(p - stride[a]);
      if (at + 1 < grid_.size[a]) visit(p + stride[a]);
    }
  };
  // Layer by layer outwards, each the mean of what lies nearer.
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

}  // namespace pointbased
