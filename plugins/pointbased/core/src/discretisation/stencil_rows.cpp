// SPDX-License-Identifier: Apache-2.0
// Expands rows of stencils over the corners of a cell from a few numbers.
#include <cmath>
#include <unordered_map>

#include "pointbased/stencil.h"

namespace pointbased {
namespace {

constexpr std::size_t kCorners = 8;

double sign(std::size_t corner, std::size_t axis) { return (corner >> axis & 1) != 0 ? 1.0 : -1.0; }

Eigen::Vector4d modeSigns(std::size_t corner) {
  const double x = sign(corner, 0), y = sign(corner, 1), z = sign(corner, 2);
  return {x * y, x * z, y * z, x * y * z};
}

template <class Value>
double mean(const Value &value) {
  double sum = 0.0;
  for (std::size_t j = 0; j < kCorners; ++j) sum += value(j);
  return sum / static_cast<double>(kCorners);
}

// Hash of the bits: shapes are equal if they were computed from the same numbers.
struct ShapeHash {
  std::size_t operator()(const CellShape &shape) const {
    std::size_t hash = 0;
    const auto add = [&](double value) { hash = (hash ^ std::hash<double>()(value)) * 0x9e3779b97f4a7c15ull; };
    add(shape.gradient);
    for (const Vec3 *v : {&shape.first, &shape.mixed})
      for (int c = 0; c < 3; ++c) add((*v)[c]);
    for (int m = 0; m < 4; ++m) add(shape.modes[m]);
    return hash;
  }
};

}  // namespace

void cellGradients(const CellShape &shape, const Mat3 &axes, std::array<Vec3, 8> &out) {
  const auto &f = shape.first;
  const Vec3 x = shape.gradient * axes.col(0), y = shape.gradient * axes.col(1), z = shape.gradient * axes.col(2);
  const Vec3 xy = f[1] * axes.col(0) + f[0] * axes.col(1), xz = f[2] * axes.col(0) + f[0] * axes.col(2),
             yz = f[2] * axes.col(1) + f[1] * axes.col(2);
  const Vec3 xyz = axes * shape.mixed;
  const auto layer = [&](std::size_t first, const Vec3 &one, const Vec3 &ofX, const Vec3 &ofY, const Vec3 &ofXY) {
    const Vec3 below = one - ofY, above = one + ofY, belowX = ofX - ofXY, aboveX = ofX + ofXY;
    out[first] = below - belowX;
    out[first + 1] = below + belowX;
    out[first + 2] = above - aboveX;
    out[first + 3] = above + aboveX;
  };
  layer(0, -z, x - xz, y - yz, xy - xyz);
  layer(4, z, x + xz, y + yz, xy + xyz);
}

void cellModes(const CellShape &shape, std::array<Eigen::Vector4d, 8> &out) {
  for (std::size_t j = 0; j < kCorners; ++j) out[j] = shape.modes.cwiseProduct(modeSigns(j));
}

std::optional<CellShape> shapeOfRows(const std::array<Vec3, 8> &g, const std::array<Eigen::Vector4d, 8> &modes) {
  std::array<Eigen::Vector4d, kCorners> signs;
  for (std::size_t j = 0; j < kCorners; ++j) signs[j] = modeSigns(j);
  CellShape shape;
  shape.gradient = mean([&](std::size_t j) { return sign(j, 0) * g[j].x(); });
  shape.first = {mean([&](std::size_t j) { return signs[j][0] * g[j].y(); }),
                 mean([&](std::size_t j) { return signs[j][0] * g[j].x(); }),
                 mean([&](std::size_t j) { return signs[j][1] * g[j].x(); })};
  for (int c = 0; c < 3; ++c) shape.mixed[c] = mean([&](std::size_t j) { return signs[j][3] * g[j][c]; });
  for (int m = 0; m < 4; ++m) shape.modes[m] = mean([&](std::size_t j) { return signs[j][m] * modes[j][m]; });

  std::array<Vec3, kCorners> again;
  cellGradients(shape, Mat3::Identity(), again);
  for (std::size_t j = 0; j < kCorners; ++j) {
    if (!((again[j] - g[j]).cwiseAbs().maxCoeff() <= kSameRows * shape.gradient)) return {};
    for (int m = 0; m < 4; ++m)
      if (!(std::abs(shape.modes[m] * signs[j][m] - modes[j][m]) <= kSameRows * std::abs(shape.modes[m]))) return {};
  }
  return shape;
}

std::optional<CellShape> findShape(const StencilSet &s, std::size_t q) {
  if (!s.isLattice() || !s.reference.empty() || s.rank[q] != 3 ||
      s.phyxels.offsets[q + 1] - s.phyxels.offsets[q] != kCorners || s.hanging.find(q) != nullptr)
    return {};
  if (const CellShape *shape = s.shapeOf(q)) return *shape;
  const std::size_t first = s.firstRow(q);
  std::array<Vec3, kCorners> gradients;
  std::array<Eigen::Vector4d, kCorners> modes;
  for (std::size_t j = 0; j < kCorners; ++j) {
    gradients[j] = s.axes.transpose() * s.gradients[first + j];
    modes[j] = s.modes[first + j];
  }
  return shapeOfRows(gradients, modes);
}

void compactRows(StencilSet &s) {
  if (!s.isLattice() || !s.rowsOf.empty()) return;
  std::unordered_map<CellShape, Index, ShapeHash> known;
  std::vector<CellShape> shapes;
  std::vector<Index> rowsOf(s.pointCount());
  std::vector<std::uint8_t> shaped(s.pointCount(), 0);
  std::vector<Vec3> gradients;
  std::vector<Eigen::Vector4d> modes;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    if (const auto shape = findShape(s, q)) {
      const auto [found, fresh] = known.emplace(*shape, static_cast<Index>(shapes.size()));
      if (fresh) shapes.push_back(*shape);
      rowsOf[q] = found->second;
      shaped[q] = 1;
      continue;
    }
    rowsOf[q] = static_cast<Index>(gradients.size());
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      gradients.push_back(s.gradients[e]);
      modes.push_back(s.modes[e]);
    }
  }
  for (std::size_t q = 0; q < rowsOf.size(); ++q)
    if (shaped[q] == 0) rowsOf[q] += static_cast<Index>(shapes.size());
  shapes.shrink_to_fit();
  gradients.shrink_to_fit();
  modes.shrink_to_fit();
  s.shapes = std::move(shapes);
  s.rowsOf = std::move(rowsOf);
  s.gradients = std::move(gradients);
  s.modes = std::move(modes);
}

void expandRows(StencilSet &s) {
  if (s.rowsOf.empty()) return;
  std::vector<Vec3> gradients;
  std::vector<Eigen::Vector4d> modes;
  gradients.reserve(s.phyxels.indices.size());
  modes.reserve(s.phyxels.indices.size());
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const GradientRows ofGradients(s, q);
    const ModeRows ofModes(s, q);
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      gradients.push_back(ofGradients[e]);
      modes.push_back(ofModes[e]);
    }
  }
  s.gradients = std::move(gradients);
  s.modes = std::move(modes);
  std::vector<CellShape>().swap(s.shapes);
  std::vector<Index>().swap(s.rowsOf);
}

StencilSet withTrilinearRows(const StencilSet &s) {
  StencilSet whole = s;
  expandRows(whole);
  StencilSet out = whole;
  out.quadratic = {};
  out.phyxels = {};
  out.gradients.clear();
  out.modes.clear();
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const QuadraticPoints::Point *point = s.quadratic.find(q);
    const Index first = s.phyxels.offsets[q], count = s.phyxels.offsets[q + 1] - first;
    std::array<Vec3, kCorners> gradients;
    std::array<Eigen::Vector4d, kCorners> modes;
    if (point != nullptr) {
      cellGradients(point->corners, s.axes, gradients);
      cellModes(point->corners, modes);
    }
    for (Index k = 0; k < (point != nullptr ? QuadraticPoints::kCorners : count); ++k) {
      out.phyxels.indices.push_back(s.phyxels.indices[first + k]);
      const Vec3 inReference = point != nullptr && !s.reference.empty() ? Vec3(s.reference[q] * gradients[k])
                               : point != nullptr                       ? gradients[k]
                                                                        : whole.gradients[first + k];
      out.gradients.push_back(inReference);
      out.modes.push_back(point != nullptr ? modes[k] : whole.modes[first + k]);
    }
    out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
  }
  buildGather(out, s.entriesOfPhyxel.rows());
  return out;
}

}  // namespace pointbased
