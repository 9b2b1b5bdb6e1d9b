// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surfels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "base/expects.h"
#include "base/polar.h"
#include "discretisation/interpolation_at.h"
#include "forces/point_loops.h"
#include "skin/surfel_kernel.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr std::size_t kGrain = 256;
constexpr std::size_t kCorners = 8;
// A row is that of a cell if its weights (relative to 1) and gradients (relative to the largest) agree to this. Larger:
// rows that were changed on purpose would be taken for cells; smaller: rounding prevents compression.
constexpr double kSameRow = 1e-11;

/// φ of a point at given cell coordinates.
std::array<double, kCorners> cellWeights(const std::array<double, 3> &at) {
  std::array<double, kCorners> weights{};
  for (std::size_t j = 0; j < kCorners; ++j)
    weights[j] =
        (j & 1 ? at[0] : 1.0 - at[0]) * (j >> 1 & 1 ? at[1] : 1.0 - at[1]) * (j >> 2 & 1 ? at[2] : 1.0 - at[2]);
  return weights;
}

/// φ and ∇φ.
struct Functions {
  std::array<double, kCorners> weights;
  std::array<Vec3, kCorners> gradients;

  Functions(const std::array<double, 3> &at, const Mat3 &frame) : weights(cellWeights(at)) {
    for (std::size_t j = 0; j < kCorners; ++j) {
      double f[3], sign[3];
      for (std::size_t a = 0; a < 3; ++a) {
        const bool far = (j >> a & 1) != 0;
        f[a] = far ? at[a] : 1.0 - at[a];
        sign[a] = far ? 1.0 : -1.0;
      }
      gradients[j] = frame * Vec3(sign[0] * f[1] * f[2], f[0] * sign[1] * f[2], f[0] * f[1] * sign[2]);
    }
  }
};

struct Found {
  std::array<double, 3> at{};
  Mat3 frame;
};

/// Cell coordinates of row p; empty if the row is not that of a cell.
std::optional<Found> placeOf(const Interpolation &binding, std::size_t p) {
  const Index first = binding.phyxels.offsets[p];
  if (binding.phyxels.offsets[p + 1] - first != kCorners || rankOf(binding, p) < 3) return std::nullopt;
  Found found;
  found.frame.setZero();
  double largest = 0.0;
  for (std::size_t j = 0; j < kCorners; ++j) {
    largest = std::max(largest, binding.gradients[first + j].norm());
    for (std::size_t a = 0; a < 3; ++a)
      if (j >> a & 1) {
        found.at[a] += binding.weights[first + j];
        found.frame.col(static_cast<Eigen::Index>(a)) += binding.gradients[first + j];
      }
  }
  const Functions functions(found.at, found.frame);
  for (std::size_t j = 0; j < kCorners; ++j) {
    const double weight = std::abs(functions.weights[j] - binding.weights[first + j]);
    const double gradient = (functions.gradients[j] - binding.gradients[first + j]).norm();
    if (!(weight <= kSameRow) || !(gradient <= kSameRow * largest)) return std::nullopt;
  }
  return found;
}

}  // namespace

Surfels::Surfels(const Interpolation &binding) : cellPoints_(binding.count()) {
  rows_.phyxels.offsets.assign(1, 0);
  for (std::size_t p = 0; p < binding.count(); ++p) {
    const Index first = binding.phyxels.offsets[p], last = binding.phyxels.offsets[p + 1];
    CellPoint &place = cellPoints_[p];
    if (const std::optional<Found> found = placeOf(binding, p)) {
      place.at = found->at;
      std::copy_n(binding.phyxels.indices.begin() + first, kCorners, place.phyxels.begin());
      const auto same = std::find_if(frames_.begin(), frames_.end(), [&](const Mat3 &frame) {
        return (frame - found->frame).norm() <= kSameRow * frame.norm();
      });
      place.frame = static_cast<std::uint32_t>(same - frames_.begin());
      if (same == frames_.end()) addFrame(found->frame);
      continue;
    }
    place.frame = kRow;
    place.phyxels[0] = static_cast<Index>(rowOwners_.size());
    rowOwners_.push_back(static_cast<Index>(p));
    rows_.positions.push_back(binding.positions[p]);
    for (Index e = first; e < last; ++e) {
      rows_.phyxels.indices.push_back(binding.phyxels.indices[e]);
      rows_.weights.push_back(binding.weights[e]);
      rows_.gradients.push_back(binding.gradients[e]);
      const Vec3 &g = binding.gradients[e];
      rowCoefficients_.push_back({static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2]),
                                  static_cast<float>(binding.weights[e])});
    }
    rows_.phyxels.offsets.push_back(static_cast<Index>(rows_.phyxels.indices.size()));
    if (binding.rank.empty()) continue;
    rows_.rank.push_back(binding.rank[p]);
    rows_.frameOf.push_back(StencilSet::kNoFrame);
    if (binding.rank[p] == 3) continue;
    rows_.frameOf.back() = static_cast<Index>(rows_.frames.size());
    rows_.frames.push_back(binding.frames[binding.frameOf[p]]);
    rows_.offsets.push_back(binding.offsets[binding.frameOf[p]]);
  }
}

void Surfels::addFrame(const Mat3 &frame) {
  frames_.push_back(frame);
  const Mat3 by = cofactor(frame.transpose());
  std::array<float, 12> columns{};
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index r = 0; r < 3; ++r) columns[static_cast<std::size_t>(4 * c + r)] = static_cast<float>(by(r, c));
  normalFrames_.push_back(columns);
}

std::size_t Surfels::bytes() const {
  return cellPoints_.size() * sizeof(CellPoint) + frames_.size() * sizeof(Mat3) +
         rows_.positions.size() * sizeof(Vec3) + rows_.phyxels.offsets.size() * sizeof(Index) +
         rowOwners_.size() * sizeof(Index) +
         rowCoefficients_.size() * (sizeof(Index) + sizeof(double) + sizeof(Vec3) + sizeof(std::array<float, 4>));
}

Vec3 Surfels::position(std::size_t p, std::span<const Vec3> phyxelPositions) const {
  const CellPoint &place = cellPoints_[p];
  if (place.frame == kRow) return rows_.positions[place.phyxels[0]];
  const std::array<double, kCorners> weights = cellWeights(place.at);
  const Vec3 anchor = phyxelPositions[place.phyxels[0]];
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 1; j < kCorners; ++j) sum += weights[j] * (phyxelPositions[place.phyxels[j]] - anchor);
  return anchor + sum;
}

Interpolation Surfels::expanded(std::size_t p, std::span<const Vec3> phyxelPositions) const {
  Interpolation out;
  out.positions.push_back(position(p, phyxelPositions));
  const CellPoint &place = cellPoints_[p];
  if (place.frame != kRow) {
    const Functions functions(place.at, frames_[place.frame]);
    out.phyxels.offsets = {0, static_cast<Index>(kCorners)};
    out.phyxels.indices.assign(place.phyxels.begin(), place.phyxels.end());
    out.weights.assign(functions.weights.begin(), functions.weights.end());
    out.gradients.assign(functions.gradients.begin(), functions.gradients.end());
    return out;
  }
  const Index row = place.phyxels[0];
  const Index first = rows_.phyxels.offsets[row], last = rows_.phyxels.offsets[row + 1];
  out.phyxels.offsets = {0, last - first};
  out.phyxels.indices.assign(rows_.phyxels.indices.begin() + first, rows_.phyxels.indices.begin() + last);
  out.weights.assign(rows_.weights.begin() + first, rows_.weights.begin() + last);
  out.gradients.assign(rows_.gradients.begin() + first, rows_.gradients.begin() + last);
  if (rankOf(rows_, row) == 3) return out;
  out.rank = {rows_.rank[row]};
  out.frameOf = {0};
  out.frames = {rows_.frames[rows_.frameOf[row]]};
  out.offsets = {rows_.offsets[rows_.frameOf[row]]};
  return out;
}

Interpolation Surfels::expanded(std::span<const Vec3> phyxelPositions) const {
  Interpolation out;
  out.phyxels.offsets.assign(1, 0);
  const bool ranks = !rows_.rank.empty();
  for (std::size_t p = 0; p < count(); ++p) {
    const Interpolation one = expanded(p, phyxelPositions);
    out.positions.push_back(one.positions.front());
    out.phyxels.indices.insert(out.phyxels.indices.end(), one.phyxels.indices.begin(), one.phyxels.indices.end());
    out.weights.insert(out.weights.end(), one.weights.begin(), one.weights.end());
    out.gradients.insert(out.gradients.end(), one.gradients.begin(), one.gradients.end());
    out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
    if (!ranks) continue;
    out.rank.push_back(one.rank.empty() ? std::uint8_t{3} : one.rank.front());
    out.frameOf.push_back(one.rank.empty() ? StencilSet::kNoFrame : static_cast<Index>(out.frames.size()));
    out.frames.insert(out.frames.end(), one.frames.begin(), one.frames.end());
    out.offsets.insert(out.offsets.end(), one.offsets.begin(), one.offsets.end());
  }
  return out;
}

namespace {

// Displacement and F of a point in a cell, relative to the first corner.
struct Moved {
  Vec3 displacement;
  Mat3 F = Mat3::Identity();

  Moved(const CellPoint &place, const Mat3 &frame, std::span<const Vec3> u) {
    const Functions functions(place.at, frame);
    const Vec3 anchor = u[place.phyxels[0]];
    displacement = Vec3::Zero();
    for (std::size_t j = 1; j < kCorners; ++j) {
      const Vec3 d = u[place.phyxels[j]] - anchor;
      displacement += functions.weights[j] * d;
      F += d * functions.gradients[j].transpose();
    }
    displacement += anchor;
  }
};

Vec3 turned(const Mat3 &F, const Vec3 &rest) {
  const Vec3 n = cofactor(F) * rest;
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : rest;
}

}  // namespace

void interpolateScalars(const Surfels &surfels, std::span<const double> field, std::span<double> out,
                        const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(out.size() == surfels.count(), "one result per surfel");
  const Interpolation &rows = surfels.rows();
  runLoop(parallelFor, surfels.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const CellPoint &place = surfels.cellPoints()[p];
      double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
      const auto add = [&](double weight, double value) {
        sum += weight * value;
        low = std::min(low, value);
        high = std::max(high, value);
      };
      if (place.frame == Surfels::kRow) {
        const Index row = place.phyxels[0];
        for (Index e = rows.phyxels.offsets[row]; e < rows.phyxels.offsets[row + 1]; ++e)
          add(rows.weights[e], field[rows.phyxels.indices[e]]);
      } else {
        const std::array<double, kCorners> weights = cellWeights(place.at);
        for (std::size_t j = 0; j < kCorners; ++j) add(weights[j], field[place.phyxels[j]]);
      }
      out[p] = low <= high ? std::clamp(sum, low, high) : 0.0;
    }
  });
}

void updateSurfels(const Surfels &surfels, std::span<const Vec3> restNormals, std::span<const Vec3> phyxelPositions,
                   std::span<const Vec3> displacements, std::span<Vec3> positions, std::span<Vec3> normals,
                   const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(positions.size() == surfels.count(), "one position per surfel");
  POINTBASED_EXPECTS(normals.empty() || (normals.size() == surfels.count() && restNormals.size() == surfels.count()),
                     "one normal per surfel, and one at rest, or none");
  POINTBASED_EXPECTS(displacements.size() == phyxelPositions.size(), "one displacement per phyxel");
  const Interpolation &rows = surfels.rows();
  runLoop(parallelFor, surfels.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const CellPoint &place = surfels.cellPoints()[p];
      Mat3 F;
      if (place.frame == Surfels::kRow) {
        const Index row = place.phyxels[0];
        F = gradientAt(rows, row, displacements);
        positions[p] = rows.positions[row] + displacementAt(rows, row, displacements, F);
      } else {
        const Moved moved(place, surfels.frames()[place.frame], displacements);
        F = moved.F;
        positions[p] = surfels.position(p, phyxelPositions) + moved.displacement;
      }
      if (!normals.empty()) normals[p] = turned(F, restNormals[p]);
    }
  });
}

void updateSurfels(const Surfels &surfels, std::span<const Vec3> restNormals, const Vec3 &origin,
                   std::span<const Vec3> phyxelPositions, std::span<const Vec3> displacements, ScreenPhyxels &scratch,
                   std::span<Vec3f> positions, std::span<Vec3f> normals, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(positions.size() == surfels.count(), "one position per surfel");
  POINTBASED_EXPECTS(normals.empty() || (normals.size() == surfels.count() && restNormals.size() == surfels.count()),
                     "one normal per surfel, and one at rest, or none");
  POINTBASED_EXPECTS(displacements.size() == phyxelPositions.size(), "one displacement per phyxel");
  const std::size_t n = phyxelPositions.size();
  if (n == 0 || surfels.count() == 0) return;
  scratch.reference = phyxelPositions[0] + displacements[0];
  scratch.positions.resize(n);
  runLoop(parallelFor, n, 2 * kGrain, [&, reference = scratch.reference](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 x = phyxelPositions[i] + displacements[i] - reference;
      scratch.positions[i] = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2]), 0.0f};
    }
  });

  const Interpolation &rows = surfels.rows();
  kernels::SkinJob job;
  job.cellPoints = surfels.cellPoints().data();
  job.frames = surfels.normalFrames();
  job.phyxels = scratch.positions.data();
  job.restNormals = normals.empty() ? nullptr : restNormals.data();
  const Vec3 shift = origin + scratch.reference;
  job.shift = {static_cast<float>(shift[0]), static_cast<float>(shift[1]), static_cast<float>(shift[2])};
  job.positions = positions.data();
  job.normals = normals.data();
  job.rowOwners = surfels.rowOwners().data();
  job.rowOffsets = rows.phyxels.offsets.data();
  job.rowPhyxels = rows.phyxels.indices.data();
  job.rowCoefficients = surfels.rowCoefficients().data();
  if (surfels.inCells() > 0)
    runLoop(parallelFor, surfels.count(), kGrain,
            [&](std::size_t begin, std::size_t end) { kernels::moveCellPoints(job, begin, end); });
  const std::size_t count = surfels.rowOwners().size();
  if (count == 0) return;
  runLoop(parallelFor, count, kGrain,
          [&](std::size_t begin, std::size_t end) { kernels::moveRowPoints(job, begin, end); });
  if (rows.rank.empty()) return;
  // Points of lower rank follow a completed F, for which single precision is not sufficient.
  runLoop(parallelFor, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      if (rows.rank[row] == 3) continue;
      const Index p = surfels.rowOwners()[row];
      const Mat3 F = gradientAt(rows, row, displacements);
      const Vec3 x = origin + rows.positions[row] + displacementAt(rows, row, displacements, F);
      for (int a = 0; a < 3; ++a) positions[p][static_cast<std::size_t>(a)] = static_cast<float>(x[a]);
      if (normals.empty()) continue;
      const Vec3 normal = turned(F, restNormals[p]);
      for (int a = 0; a < 3; ++a) normals[p][static_cast<std::size_t>(a)] = static_cast<float>(normal[a]);
    }
  });
}

}  // namespace pointbased
