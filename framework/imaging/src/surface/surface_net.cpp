// SPDX-License-Identifier: Apache-2.0
#include "surface/surface_net.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace c3de::imaging {
namespace {

constexpr float kHalf = 0.5f;
constexpr double kLeash = 0.45;  // less than a half, so that two sides of a thin part do not meet
constexpr double kMinGap = 0.1;  // of an edge, half of the gap between two cells

// A side of a quadrilateral, to be paired with its opposite.
struct Side {
  unsigned low, high;    // vertices
  std::uint32_t inside;  // node on the inner side of the quadrilateral
  unsigned half;
};

class NetBuilder {
 public:
  NetBuilder(const Fill &fill, bool leftHanded)
      : fill_(fill.values), size_(fill.geometry.size), leftHanded_(leftHanded) {
    for (auto &slice : cells_) slice.assign(size_[0] * size_[1], EditMesh::kNone);
  }

  SurfaceNet build() {
    const std::size_t nx = size_[0], ny = size_[1], nz = size_[2];
    const std::array<std::size_t, 3> step{1, nx, nx * ny};
    for (std::size_t k = 0; k + 1 < nz; ++k) {
      if (k > 0) {
        std::swap(cells_[0], cells_[1]);
        std::fill(cells_[1].begin(), cells_[1].end(), EditMesh::kNone);
      }
      for (std::size_t j = 0; j + 1 < ny; ++j)
        for (std::size_t i = 0; i + 1 < nx; ++i) {
          const std::size_t at = i + nx * (j + ny * k);
          for (std::size_t axis = 0; axis < 3; ++axis)
            if ((fill_[at] >= kHalf) != (fill_[at + step[axis]] >= kHalf))
              addQuadrilateral({i, j, k}, axis, at, at + step[axis]);
        }
    }
    std::sort(sides_.begin(), sides_.end(), [](const Side &a, const Side &b) {
      return std::tie(a.low, a.high, a.inside, a.half) < std::tie(b.low, b.high, b.inside, b.half);
    });
    // Where four quadrilaterals meet, two belong to the voxel on either side: voxels that share only an edge stay
    // separate.
    for (std::size_t s = 0; s + 1 < sides_.size(); s += 2) {
      twins_[sides_[s].half] = sides_[s + 1].half;
      twins_[sides_[s + 1].half] = sides_[s].half;
    }
    EditMesh mesh(homes_, triangles_, std::move(twins_));
    std::vector<Vec3> homes = mesh.points;
    // Vertices added for a second fan are at the position of the first one.
    for (unsigned v = 0; v < sums_.size(); ++v) mesh.points[v] = (1.0 / crossings_[v]) * sums_[v];
    return {std::move(mesh), std::move(homes)};
  }

 private:
  unsigned vertexOf(std::array<std::size_t, 3> cell, std::size_t k) {
    unsigned &vertex = cells_[cell[2] == k ? 1 : 0][cell[0] + size_[0] * cell[1]];
    if (vertex == EditMesh::kNone) {
      vertex = static_cast<unsigned>(homes_.size());
      homes_.push_back(
          {static_cast<double>(cell[0]) + 0.5, static_cast<double>(cell[1]) + 0.5, static_cast<double>(cell[2]) + 0.5});
      sums_.push_back({});
      crossings_.push_back(0.0);
    }
    return vertex;
  }

  void addQuadrilateral(const std::array<std::size_t, 3> &node, std::size_t axis, std::size_t at, std::size_t other) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double a = fill_[at], b = fill_[other];
    Vec3 crossing{static_cast<double>(node[0]), static_cast<double>(node[1]), static_cast<double>(node[2])};
    crossing[axis] += (a - kHalf) / (a - b);
    std::array<unsigned, 4> corners{};
    constexpr std::array<std::array<std::size_t, 2>, 4> kBack{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
    for (std::size_t c = 0; c < 4; ++c) {
      std::array<std::size_t, 3> cell = node;
      cell[u] -= kBack[c][0];
      cell[v] -= kBack[c][1];
      corners[c] = vertexOf(cell, node[2]);
      sums_[corners[c]] = sums_[corners[c]] + crossing;
      crossings_[corners[c]] += 1.0;
    }
    if ((a < b) != leftHanded_) std::reverse(corners.begin(), corners.end());
    const auto inside = static_cast<std::uint32_t>(a > b ? at : other);
    const auto first = static_cast<unsigned>(3 * triangles_.size());
    triangles_.push_back({corners[0], corners[1], corners[2]});
    triangles_.push_back({corners[0], corners[2], corners[3]});
    twins_.resize(first + 6);
    twins_[first + 2] = first + 3;
    twins_[first + 3] = first + 2;
    const auto side = [&](unsigned from, unsigned to, unsigned half) {
      sides_.push_back({std::min(from, to), std::max(from, to), inside, half});
    };
    side(corners[0], corners[1], first);
    side(corners[1], corners[2], first + 1);
    side(corners[2], corners[3], first + 4);
    side(corners[3], corners[0], first + 5);
  }

  const std::vector<float> &fill_;
  std::array<std::size_t, 3> size_;
  bool leftHanded_;
  std::array<std::vector<unsigned>, 2> cells_;  // vertices of the slices of cells below and above
  std::vector<Vec3> homes_, sums_;
  std::vector<double> crossings_;
  std::vector<Triangle> triangles_;
  std::vector<unsigned> twins_;
  std::vector<Side> sides_;
};

}  // namespace

SurfaceNet surfaceNetOf(const Fill &fill, bool leftHanded) { return NetBuilder(fill, leftHanded).build(); }

void relax(SurfaceNet &net, std::size_t times) {
  EditMesh &mesh = net.mesh;
  std::vector<std::uint32_t> offsets{0};
  std::vector<unsigned> neighbours;
  for (unsigned v = 0; v < mesh.points.size(); ++v) {
    mesh.around(v, [&](unsigned h) { neighbours.push_back(mesh.to(h)); });
    offsets.push_back(static_cast<std::uint32_t>(neighbours.size()));
  }
  std::vector<Vec3> moved(mesh.points.size());
  const auto smooth = [&](std::vector<Vec3> &values, const auto &bound) {
    for (std::size_t t = 0; t < times; ++t) {
      for (std::size_t v = 0; v < moved.size(); ++v) {
        Vec3 sum{};
        for (std::uint32_t e = offsets[v]; e < offsets[v + 1]; ++e) sum = sum + values[neighbours[e]];
        moved[v] = bound(v, (1.0 / (offsets[v + 1] - offsets[v])) * sum);
      }
      values.swap(moved);
    }
  };
  const auto leashed = [&](std::size_t v, Vec3 x) {
    for (std::size_t a = 0; a < 3; ++a) x[a] = std::clamp(x[a], net.homes[v][a] - kLeash, net.homes[v][a] + kLeash);
    return x;
  };
  // The residual of the smoothing is itself smoothed and added: steps are removed, curved shapes do not shrink
  // (twicing).
  std::vector<Vec3> lost = mesh.points;
  smooth(mesh.points, leashed);
  for (std::size_t v = 0; v < lost.size(); ++v) lost[v] = lost[v] - mesh.points[v];
  smooth(lost, [](std::size_t, const Vec3 &x) { return x; });
  for (std::size_t v = 0; v < lost.size(); ++v) mesh.points[v] = leashed(v, mesh.points[v] + lost[v]);
}

BorderCells::BorderCells(const Fill &fill, double edge) : leash_(0.5 - std::min(0.5 - kLeash, kMinGap * edge)) {
  const auto &n = fill.geometry.size;
  for (std::size_t a = 0; a < 3; ++a) size_[a] = n[a] - 1;
  border_.resize(size_[0] * size_[1] * size_[2]);
  std::size_t at = 0;
  for (std::size_t k = 0; k < size_[2]; ++k)
    for (std::size_t j = 0; j < size_[1]; ++j)
      for (std::size_t i = 0; i < size_[0]; ++i) {
        int inside = 0;
        for (std::size_t c = 0; c < 8; ++c)
          inside += fill.values[i + (c & 1) + n[0] * (j + (c >> 1 & 1) + n[1] * (k + (c >> 2)))] >= kHalf ? 1 : 0;
        border_[at++] = inside > 0 && inside < 8 ? 1 : 0;
      }
}

Vec3 BorderCells::nearest(const Vec3 &index) const {
  std::array<std::size_t, 3> first{}, end{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto cell = static_cast<std::size_t>(std::clamp(index[a], 0.0, static_cast<double>(size_[a] - 1)));
    first[a] = cell > 0 ? cell - 1 : 0;
    end[a] = std::min(cell + 2, size_[a]);
  }
  Vec3 best = index;
  double least = 1e300;
  for (std::size_t k = first[2]; k < end[2]; ++k)
    for (std::size_t j = first[1]; j < end[1]; ++j)
      for (std::size_t i = first[0]; i < end[0]; ++i) {
        if (!isBorder({i, j, k})) continue;
        const Vec3 middle{static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5, static_cast<double>(k) + 0.5};
        Vec3 x{};
        for (std::size_t a = 0; a < 3; ++a) x[a] = std::clamp(index[a], middle[a] - leash_, middle[a] + leash_);
        if (const double way = dot(x - index, x - index); way < least) {
          least = way;
          best = x;
        }
      }
  return best;
}

}  // namespace c3de::imaging
