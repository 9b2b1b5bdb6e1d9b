// SPDX-License-Identifier: Apache-2.0
#include "shape/occupancy_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/symmetric_eigen.h"

namespace pointbased::detail {
namespace {

// Fills this close to 0 or 1 are regarded as 0 or 1: single precision.
constexpr double kTiny = 1e-6;
constexpr std::size_t kMaxAcross = 64;  // voxels along the edge of a cube that are integrated individually, at most

bool isFull(float fill) { return static_cast<double>(fill) >= 1.0 - kTiny; }
bool isEmpty(float fill) { return static_cast<double>(fill) <= kTiny; }

// Distance transform along a line of n squared distances with a stride: the lower envelope of their parabolas.
class LineTransform {
 public:
  explicit LineTransform(std::size_t most) : values_(most), tops_(most), borders_(most + 1) {}

  /// @source Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, 2012
  void run(float *line, std::size_t n, std::size_t stride, double spacing) {
    const double s2 = spacing * spacing;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      values_[i] = static_cast<double>(line[i * stride]);
      if (values_[i] >= kFar) continue;
      const auto x = static_cast<double>(i);
      while (count > 0) {
        const auto t = static_cast<double>(tops_[count - 1]);
        const double meet = ((values_[i] - values_[tops_[count - 1]]) / s2 + x * x - t * t) / (2.0 * (x - t));
        if (meet > borders_[count - 1]) {
          borders_[count] = meet;
          break;
        }
        --count;
      }
      if (count == 0) borders_[0] = -1e300;
      tops_[count++] = i;
    }
    if (count == 0) return;
    std::size_t top = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto x = static_cast<double>(i);
      while (top + 1 < count && borders_[top + 1] < x) ++top;
      const double away = x - static_cast<double>(tops_[top]);
      line[i * stride] = static_cast<float>(values_[tops_[top]] + s2 * away * away);
    }
  }

  static constexpr float kFar = 1e30f;

 private:
  std::vector<double> values_;
  std::vector<std::size_t> tops_;
  std::vector<double> borders_;
};

}  // namespace

OccupancyField::OccupancyField(const Occupancy &occupancy, const ParallelFor &parallelFor)
    : steps_(occupancy.steps), toIndex_(occupancy.steps.inverse()),
      spacing_(occupancy.steps.colwise().norm().transpose()) {
  const Mat3 unit = steps_ * spacing_.cwiseInverse().asDiagonal();
  const Mat3 gram = unit.transpose() * unit;
  // Sheared grids: the shortest length that index differences can represent.
  if (!gram.isIdentity(1e-9)) scale_ = std::sqrt(std::max(0.0, symmetricEigen(gram).values[0]));
  crop(occupancy);
  measure(parallelFor);
  buildLevels();
}

void OccupancyField::crop(const Occupancy &occupancy) {
  const Size3 &n = occupancy.size;
  Size3 low = n, high{0, 0, 0};
  double sum = 0.0;
  for (std::size_t k = 0, at = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++at) {
        if (isEmpty(occupancy.fill[at])) continue;
        sum += static_cast<double>(occupancy.fill[at]);
        const Size3 here{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], here[a]);
          high[a] = std::max(high[a], here[a] + 1);
        }
      }
  volume_ = sum * std::abs(steps_.determinant());
  const Vec3 first =
      Vec3(static_cast<double>(low[0]), static_cast<double>(low[1]), static_cast<double>(low[2])) - Vec3::Ones();
  origin_ = occupancy.origin + steps_ * first;
  Level level;
  for (std::size_t a = 0; a < 3; ++a) level.size[a] = high[a] - low[a] + 2;
  level.block = {1, 1, 1};
  level.fill.assign(level.size[0] * level.size[1] * level.size[2], 0.0f);
  min_ = Vec3::Constant(1e300);
  max_ = -min_;
  const Vec3 half = 0.5 * steps_.cwiseAbs().rowwise().sum();
  for (std::size_t k = low[2]; k < high[2]; ++k)
    for (std::size_t j = low[1]; j < high[1]; ++j) {
      const float *row = occupancy.fill.data() + n[0] * (j + n[1] * k);
      float *out = level.fill.data() + level.size[0] * (j - low[1] + 1 + level.size[1] * (k - low[2] + 1)) + 1;
      std::size_t begin = high[0], end = low[0];
      for (std::size_t i = low[0]; i < high[0]; ++i) {
        out[i - low[0]] = isFull(row[i]) ? 1.0f : isEmpty(row[i]) ? 0.0f : row[i];
        if (isEmpty(row[i])) continue;
        begin = std::min(begin, i);
        end = i;
      }
      if (begin > end) continue;
      for (const std::size_t i : {begin, end}) {
        const Vec3 index(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        const Vec3 middle = occupancy.origin + steps_ * index;
        min_ = min_.cwiseMin(middle - half);
        max_ = max_.cwiseMax(middle + half);
      }
    }
  levels_.push_back(std::move(level));
}

void OccupancyField::measure(const ParallelFor &parallelFor) {
  const std::vector<float> &fill = levels_[0].fill;
  const Size3 &n = levels_[0].size;
  const std::size_t total = fill.size(), most = std::max({n[0], n[1], n[2]});
  const auto transform = [&](std::vector<float> &squares) {
    parallelFor(n[1] * n[2], 64, [&](std::size_t begin, std::size_t end) {
      LineTransform line(most);
      for (std::size_t row = begin; row < end; ++row) line.run(squares.data() + n[0] * row, n[0], 1, spacing_[0]);
    });
    parallelFor(n[0] * n[2], 64, [&](std::size_t begin, std::size_t end) {
      LineTransform line(most);
      for (std::size_t c = begin; c < end; ++c)
        line.run(squares.data() + c % n[0] + n[0] * n[1] * (c / n[0]), n[1], n[0], spacing_[1]);
    });
    parallelFor(n[0] * n[1], 64, [&](std::size_t begin, std::size_t end) {
      LineTransform line(most);
      for (std::size_t c = begin; c < end; ++c) line.run(squares.data() + c, n[2], n[0] * n[1], spacing_[2]);
    });
  };
  distances_.assign(total, LineTransform::kFar);
  for (std::size_t v = 0; v < total; ++v)
    if (!isFull(fill[v])) distances_[v] = 0.0f;
  transform(distances_);
  std::vector<float> outside(total, LineTransform::kFar);
  for (std::size_t v = 0; v < total; ++v)
    if (!isEmpty(fill[v])) outside[v] = 0.0f;
  transform(outside);
  const auto scale = static_cast<float>(scale_);
  for (std::size_t v = 0; v < total; ++v) distances_[v] = scale * (std::sqrt(outside[v]) - std::sqrt(distances_[v]));
}

void OccupancyField::buildLevels() {
  const double finest = spacing_.minCoeff();
  for (int l = 1; l < 16; ++l) {
    const Level &from = levels_.back();
    if (std::max({from.size[0], from.size[1], from.size[2]}) <= 4) return;
    const double edge = finest * static_cast<double>(1 << l);
    Level level;
    Size3 merged{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double now = spacing_[static_cast<Eigen::Index>(a)] * static_cast<double>(from.block[a]);
      merged[a] = 2.0 * now <= 1.5 * edge ? 2 : 1;
      level.block[a] = merged[a] * from.block[a];
      level.size[a] = (from.size[a] + merged[a] - 1) / merged[a];
    }
    level.fill.assign(level.size[0] * level.size[1] * level.size[2], 0.0f);
    const float part = 1.0f / static_cast<float>(merged[0] * merged[1] * merged[2]);
    for (std::size_t k = 0, at = 0; k < from.size[2]; ++k)
      for (std::size_t j = 0; j < from.size[1]; ++j) {
        float *row = level.fill.data() + level.size[0] * (j / merged[1] + level.size[1] * (k / merged[2]));
        for (std::size_t i = 0; i < from.size[0]; ++i, ++at) row[i / merged[0]] += part * from.fill[at];
      }
    levels_.push_back(std::move(level));
  }
}

double OccupancyField::fillAt(const Vec3 &x) const {
  const Vec3 index = indexOf(x);
  Size3 v{};
  for (int a = 0; a < 3; ++a) {
    const double nearest = std::floor(index[a] + 0.5);
    if (!(nearest >= 0.0) || nearest >= static_cast<double>(levels_[0].size[static_cast<std::size_t>(a)])) return 0.0;
    v[static_cast<std::size_t>(a)] = static_cast<std::size_t>(nearest);
  }
  return static_cast<double>(levels_[0].fill[offset(v[0], v[1], v[2])]);
}

double OccupancyField::distance(const Vec3 &x) const {
  const Vec3 index = indexOf(x);
  const Size3 &n = levels_[0].size;
  std::array<std::ptrdiff_t, 3> v{};
  Vec3 beyond = Vec3::Zero();  // distance outside of the box of all non-empty voxels, without the empty layer
  bool within = true;
  for (int a = 0; a < 3; ++a) {
    const auto size = static_cast<double>(n[static_cast<std::size_t>(a)]);
    beyond[a] = std::max({0.0, 0.5 - index[a], index[a] - (size - 1.5)});
    const double nearest = std::floor(index[a] + 0.5);
    within = within && nearest >= 0.0 && nearest < size;
    v[static_cast<std::size_t>(a)] = within ? static_cast<std::ptrdiff_t>(nearest) : 0;
  }
  if (!within) return length(beyond);
  const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {
    return levels_[0]
        .fill[offset(static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k))];
  };
  const float own = at(v[0], v[1], v[2]);
  const bool full = isFull(own);
  if (!full && !isEmpty(own)) return 0.0;
  const Vec3 off = index - Vec3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
  const double middles = std::abs(static_cast<double>(distances_[offset(
      static_cast<std::size_t>(v[0]), static_cast<std::size_t>(v[1]), static_cast<std::size_t>(v[2]))]));
  const double halfDiagonal = scale_ * 0.5 * spacing_.norm();
  const double least = std::max({0.0, middles - length(off) - halfDiagonal, length(beyond)});
  if (middles > 2.0 * spacing_.maxCoeff() + halfDiagonal) return least;
  // Exact among the adjacent voxels; others are at least a voxel away.
  double nearest = std::numeric_limits<double>::infinity();
  for (std::ptrdiff_t k = -1; k <= 1; ++k)
    for (std::ptrdiff_t j = -1; j <= 1; ++j)
      for (std::ptrdiff_t i = -1; i <= 1; ++i) {
        const std::array<std::ptrdiff_t, 3> u{v[0] + i, v[1] + j, v[2] + k};
        bool there = true;
        for (std::size_t a = 0; a < 3; ++a) there = there && u[a] >= 0 && u[a] < static_cast<std::ptrdiff_t>(n[a]);
        const float other = there ? at(u[0], u[1], u[2]) : 0.0f;
        if (full ? isFull(other) : isEmpty(other)) continue;
        const auto step = [](std::ptrdiff_t to, double from) {
          return to == 0 ? 0.0 : 0.5 - static_cast<double>(to) * from;
        };
        nearest = std::min(nearest, length(Vec3(step(i, off[0]), step(j, off[1]), step(k, off[2]))));
      }
  const double ring = scale_ * ((Vec3::Constant(1.5) - off.cwiseAbs()).cwiseProduct(spacing_)).minCoeff();
  return std::min(nearest, std::max(least, ring));
}

double OccupancyField::about(const Vec3 &x) const {
  const Vec3 index = indexOf(x);
  const Size3 &n = levels_[0].size;
  Size3 low{};
  Vec3 t;
  for (int a = 0; a < 3; ++a) {
    const auto last = static_cast<double>(n[static_cast<std::size_t>(a)] - 1);
    const double clamped = std::clamp(index[a], 0.0, last);
    const double floored = std::min(std::floor(clamped), last - 1.0);
    low[static_cast<std::size_t>(a)] = static_cast<std::size_t>(floored);
    t[a] = clamped - floored;
  }
  const double half = 0.5 * spacing_.minCoeff();
  double sum = 0.0;
  for (std::size_t c = 0; c < 8; ++c) {
    const std::size_t v = offset(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2));
    const auto d = static_cast<double>(distances_[v]);
    const double value = d > 0.0   ? d - half
                         : d < 0.0 ? d + half
                                   : 2.0 * half * (0.5 - static_cast<double>(levels_[0].fill[v]));
    sum += value * ((c & 1) != 0 ? t[0] : 1.0 - t[0]) * ((c >> 1 & 1) != 0 ? t[1] : 1.0 - t[1]) *
           ((c >> 2) != 0 ? t[2] : 1.0 - t[2]);
  }
  return sum;
}

// For a cube with edges parallel to those of the voxels: exact overlap with each voxel, axis by axis.
double OccupancyField::alongVoxels(const Level &level, const Vec3 &centre, const Mat3 &cube) const {
  std::array<std::array<double, kMaxAcross>, 3> overlaps{};
  std::array<std::size_t, 3> first{}, count{};
  const Vec3 half = 0.5 * cube.cwiseAbs().rowwise().sum();
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto block = static_cast<double>(level.block[axis]);
    // In voxels of this level, from the border of the first one.
    const double from = (centre[a] - half[a] + 0.5) / block, to = (centre[a] + half[a] + 0.5) / block;
    const double begin = std::max(0.0, std::floor(from)),
                 end = std::min(static_cast<double>(level.size[axis]), std::ceil(to));
    if (!(begin < end)) return 0.0;
    first[axis] = static_cast<std::size_t>(begin);
    count[axis] = std::min(kMaxAcross, static_cast<std::size_t>(end - begin));
    for (std::size_t i = 0; i < count[axis]; ++i) {
      const double left = begin + static_cast<double>(i);
      overlaps[axis][i] = std::max(0.0, std::min(to, left + 1.0) - std::max(from, left)) / (to - from);
    }
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < count[2]; ++k)
    for (std::size_t j = 0; j < count[1]; ++j) {
      const float *row = level.fill.data() + first[0] + level.size[0] * (first[1] + j + level.size[1] * (first[2] + k));
      double line = 0.0;
      for (std::size_t i = 0; i < count[0]; ++i) line += overlaps[0][i] * static_cast<double>(row[i]);
      sum += overlaps[1][j] * overlaps[2][k] * line;
    }
  return sum;
}

double OccupancyField::byPoints(const Level &level, const Vec3 &centre, const Mat3 &cube, int perAxis) const {
  const Vec3 scale(1.0 / static_cast<double>(level.block[0]), 1.0 / static_cast<double>(level.block[1]),
                   1.0 / static_cast<double>(level.block[2]));
  const Mat3 step = scale.asDiagonal() * cube / perAxis;
  const Vec3 first = scale.cwiseProduct(centre + Vec3::Constant(0.5)) - 0.5 * (perAxis - 1) * step.rowwise().sum();
  const std::array<double, 3> size{static_cast<double>(level.size[0]), static_cast<double>(level.size[1]),
                                   static_cast<double>(level.size[2])};
  double sum = 0.0;
  for (int k = 0; k < perAxis; ++k)
    for (int j = 0; j < perAxis; ++j) {
      Vec3 at = first + k * step.col(2) + j * step.col(1);
      for (int i = 0; i < perAxis; ++i, at += step.col(0)) {
        if (!(at[0] >= 0.0 && at[1] >= 0.0 && at[2] >= 0.0 && at[0] < size[0] && at[1] < size[1] && at[2] < size[2]))
          continue;
        sum += static_cast<double>(level.fill[static_cast<std::size_t>(at[0]) +
                                              level.size[0] * (static_cast<std::size_t>(at[1]) +
                                                               level.size[1] * static_cast<std::size_t>(at[2]))]);
      }
    }
  return sum / (static_cast<double>(perAxis) * perAxis * perAxis);
}

void OccupancyField::shares(std::span<const Vec3> centres, const Mat3 &axes, double edge, std::span<double> out) const {
  const Mat3 cube = edge * toIndex_ * axes;  // in voxels
  bool along = true;
  for (int r = 0; r < 3; ++r) {
    const Vec3 row = cube.row(r).cwiseAbs();
    along = along && row.sum() - row.maxCoeff() < 1e-9 * row.maxCoeff();
  }
  // The coarsest level with enough voxels across the cube.
  const double across = along ? 4.0 : 2.0;
  std::size_t l = 0;
  const auto blocksOf = [](const Level &level) {
    return Vec3(static_cast<double>(level.block[0]), static_cast<double>(level.block[1]),
                static_cast<double>(level.block[2]));
  };
  const auto edgesOf = [&](const Level &level) { return Vec3(blocksOf(level).cwiseProduct(spacing_)); };
  while (l + 1 < levels_.size() && edgesOf(levels_[l + 1]).maxCoeff() * across <= edge) ++l;
  const Level &level = levels_[l];
  const int perAxis = std::clamp(static_cast<int>(std::ceil(2.0 * edge / edgesOf(level).minCoeff())), 4, 8);
  // Very thin voxels may be more than alongVoxels() can store.
  const Vec3 count = cube.cwiseAbs().rowwise().sum().cwiseQuotient(blocksOf(level));
  const bool exact = along && count.maxCoeff() < static_cast<double>(kMaxAcross - 2);
  const double uniform = 0.5 * edge * std::sqrt(3.0) * (1.0 + 1e-9);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (distance(centres[i]) > uniform) {
      out[i] = fillAt(centres[i]) > 0.5 ? 1.0 : 0.0;
      continue;
    }
    const Vec3 centre = indexOf(centres[i]);
    const double share = exact ? alongVoxels(level, centre, cube) : byPoints(level, centre, cube, perAxis);
    out[i] = share < kTiny ? 0.0 : share > 1.0 - kTiny ? 1.0 : share;
  }
}

/// The voxels near the segment between two points.
class OccupancyField::Surroundings {
 public:
  using Voxel = std::array<std::ptrdiff_t, 3>;  // relative to the lowest voxel

  Surroundings(const OccupancyField &field, const Vec3 &from, const Vec3 &to)
      : field_(field), from_(from), way_(to - from), fromIndex_(field.indexOf(from)), toIndex_(field.indexOf(to)),
        reach_(std::max(1.01 * field.spacing_.maxCoeff(), 0.25 * way_.norm())) {
    const Size3 &n = field.levels_[0].size;
    for (int c = 0; c < 3; ++c) {
      const auto axis = static_cast<std::size_t>(c);
      const double margin = reach_ * field.toIndex_.row(c).norm();
      const auto clamped = [&](double index) {
        return std::clamp(std::floor(index + 0.5), 0.0, static_cast<double>(n[axis] - 1));
      };
      const double first = clamped(std::min(fromIndex_[c], toIndex_[c]) - margin);
      const double last = clamped(std::max(fromIndex_[c], toIndex_[c]) + margin);
      low_[axis] = static_cast<std::ptrdiff_t>(first);
      size_[axis] = static_cast<std::ptrdiff_t>(last - first) + 1;
    }
  }

  [[nodiscard]] double count() const {
    return static_cast<double>(size_[0]) * static_cast<double>(size_[1]) * static_cast<double>(size_[2]);
  }
  [[nodiscard]] double fill(const Voxel &v) const {
    const auto at = [&](std::size_t axis) { return static_cast<std::size_t>(low_[axis] + v[axis]); };
    return static_cast<double>(field_.levels_[0].fill[field_.offset(at(0), at(1), at(2))]);
  }
  [[nodiscard]] Voxel start() const { return fullestAt(fromIndex_); }
  [[nodiscard]] Voxel end() const { return fullestAt(toIndex_); }

  [[nodiscard]] bool straight(double enough) const {
    const auto steps = static_cast<int>(std::ceil(2.0 * (toIndex_ - fromIndex_).cwiseAbs().maxCoeff())) + 1;
    for (int s = 0; s <= steps; ++s)
      if (!(field_.fillAt(from_ + way_ * (static_cast<double>(s) / steps)) >= enough)) return false;
    return true;
  }
  /// Connectivity from voxel to voxel near the segment.
  [[nodiscard]] bool connected(const Voxel &start, const Voxel &end, double enough) const {
    std::vector<std::uint8_t> seen(static_cast<std::size_t>(count()), 0);
    std::vector<Voxel> stack{start};
    seen[number(start)] = 1;
    while (!stack.empty()) {
      const Voxel v = stack.back();
      stack.pop_back();
      if (v == end) return true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const std::ptrdiff_t sign : {-1, 1}) {
          Voxel u = v;
          u[axis] += sign;
          if (u[axis] < 0 || u[axis] >= size_[axis] || seen[number(u)] != 0) continue;
          seen[number(u)] = 1;
          if (fill(u) >= enough && (u == end || near(u))) stack.push_back(u);
        }
    }
    return false;
  }

 private:
  [[nodiscard]] std::size_t number(const Voxel &v) const {
    return static_cast<std::size_t>(v[0] + size_[0] * (v[1] + size_[1] * v[2]));
  }
  [[nodiscard]] bool near(const Voxel &u) const {
    const Vec3 x =
        field_.origin_ + field_.steps_ * Vec3(static_cast<double>(low_[0] + u[0]), static_cast<double>(low_[1] + u[1]),
                                              static_cast<double>(low_[2] + u[2]));
    const double t = std::clamp(way_.dot(x - from_) / std::max(way_.squaredNorm(), 1e-300), 0.0, 1.0);
    return !((x - from_ - t * way_).norm() > reach_);
  }
  // The voxel around a position, or the fullest adjacent one.
  [[nodiscard]] Voxel fullestAt(const Vec3 &index) const {
    Voxel v{};
    for (int c = 0; c < 3; ++c) {
      const auto axis = static_cast<std::size_t>(c);
      v[axis] = static_cast<std::ptrdiff_t>(std::clamp(std::floor(index[c] + 0.5) - static_cast<double>(low_[axis]),
                                                       0.0, static_cast<double>(size_[axis] - 1)));
    }
    Voxel best = v;
    if (fill(v) > 0.5) return best;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, v[2] - 1); k <= std::min(size_[2] - 1, v[2] + 1); ++k)
      for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, v[1] - 1); j <= std::min(size_[1] - 1, v[1] + 1); ++j)
        for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, v[0] - 1); i <= std::min(size_[0] - 1, v[0] + 1); ++i)
          if (fill({i, j, k}) > fill(best)) best = {i, j, k};
    return best;
  }

  const OccupancyField &field_;
  Vec3 from_, way_, fromIndex_, toIndex_;
  double reach_;
  Voxel low_{}, size_{};
};

bool OccupancyField::crosses(const Vec3 &from, const Vec3 &to) const {
  const Surroundings around(*this, from, to);
  const Surroundings::Voxel start = around.start(), end = around.end();
  const double enough = 0.5 * std::min(around.fill(start), around.fill(end));
  if (!(enough > 0.5 * kTiny)) return true;
  if (around.straight(enough)) return false;  // the usual case
  constexpr double kMaxVoxels = 1e6;
  return around.count() > kMaxVoxels || !around.connected(start, end, enough);
}

}  // namespace pointbased::detail
