// SPDX-License-Identifier: Apache-2.0
// Position of mask surfaces: near the border of the voxels, and without self-intersections.
#include <algorithm>
#include <stdexcept>

#include "c3de/collision/aabb_tree.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/surface.h"
#include "label_files.h"
#include "phantoms.h"
#include "support/catch.h"
#include "support/letter_phantom.h"

using namespace c3de;
using namespace c3de::imaging;
using collision::AabbTree;
using geometry::TriangleMesh;

namespace {

AabbTree treeOf(const TriangleMesh &mesh) {
  auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  if (!tree) throw std::runtime_error(tree.error().message);
  return std::move(*tree);
}

/// The faces between voxels inside and outside.
TriangleMesh borderOf(const Mask &mask) {
  TriangleMesh border;
  const auto &n = mask.geometry.size;
  const auto isInside = [&](const std::array<std::size_t, 3> &at, std::size_t axis, int step) {
    if (step < 0 ? at[axis] == 0 : at[axis] + 1 == n[axis]) return false;
    auto other = at;
    other[axis] = step < 0 ? at[axis] - 1 : at[axis] + 1;
    return phantoms::get(mask, other);
  };
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i) {
        if (!phantoms::get(mask, {i, j, k})) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int step : {-1, 1}) {
            if (isInside({i, j, k}, axis, step)) continue;
            const auto first = static_cast<unsigned>(border.vertices.size());
            for (const auto &[u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
              Vec3 x{double(i), double(j), double(k)};
              x[axis] += 0.5 * step;
              x[(axis + 1) % 3] += u;
              x[(axis + 2) % 3] += v;
              border.vertices.push_back(mask.geometry.worldAt(x));
            }
            border.triangles.push_back({first, first + 1, first + 2});
            border.triangles.push_back({first, first + 2, first + 3});
          }
      }
  return border;
}

/// The largest distance of the surface's vertices from the border, in the longest edges of voxels.
double farthestFromBorder(const TriangleMesh &mesh, const Mask &mask) {
  const TriangleMesh border = borderOf(mask);
  const AabbTree tree = treeOf(border);
  double farthest = 0.0;
  for (const Vec3 &x : mesh.vertices) farthest = std::max(farthest, std::abs(tree.closest(x).distance));
  const Vec3 spacing = mask.geometry.spacing();
  return farthest / *std::max_element(spacing.begin(), spacing.end());
}

double side(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &x) { return dot(cross(b - a, c - a), x - a); }

/// Pairs of triangles without a common edge such that an edge of one passes through the other.
std::size_t crossings(const TriangleMesh &mesh) {
  const AabbTree tree = treeOf(mesh);
  std::size_t count = 0;
  std::vector<std::uint32_t> near;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle &one = mesh.triangles[t];
    Vec3 middle{};
    for (const auto v : one) middle = middle + (1.0 / 3.0) * mesh.vertices[v];
    double radius = 0.0;
    for (const auto v : one) radius = std::max(radius, norm(mesh.vertices[v] - middle));
    tree.sphere(middle, 1.001 * radius, near);
    for (const std::uint32_t o : near)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto from = one[c], to = one[(c + 1) % 3];
        const Triangle &other = mesh.triangles[o];
        if (std::any_of(other.begin(), other.end(), [&](auto v) { return v == from || v == to; })) continue;
        const Vec3 &p = mesh.vertices[from], &q = mesh.vertices[to];
        const Vec3 &a = mesh.vertices[other[0]], &b = mesh.vertices[other[1]], &d = mesh.vertices[other[2]];
        if (side(a, b, d, p) * side(a, b, d, q) >= 0.0) continue;
        const double u = side(p, q, a, b), v = side(p, q, b, d), w = side(p, q, d, a);
        count += (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0) ? 1 : 0;
      }
  }
  return count;
}

/// @param farthest  voxels
void checkGeometry(const Mask &mask, double edge, double farthest) {
  const auto mesh = surfaceOf(mask, {edge, 0.0});
  if (!mesh) FAIL(mesh.error().message);
  CHECK(farthestFromBorder(*mesh, mask) < farthest);
  CHECK(crossings(*mesh) == 0);
}

// Vertices are held within 0.45 voxels of the border; the volume moves them once more.
constexpr double kHalfVoxel = 0.55;

}  // namespace

TEST_CASE("surfaces of letters three voxels thick stay at their border", "[imaging][surface]") {
  for (const test::LetterGrid &grid : test::letterGrids()) {
    const test::LetterPhantom phantom = test::letterPhantom(grid.size, grid.worldFromIndex);
    const Mask mask = maskOf(LabelMap{{grid.size, grid.worldFromIndex}, phantom.labels, {}}, 2);
    for (const double edge : {0.0, 0.7, 1.0}) {
      CAPTURE(grid.name, edge);
      checkGeometry(mask, edge, kHalfVoxel);
    }
  }
}

TEST_CASE("surfaces of plates, bars and single voxels stay at their border", "[imaging][surface]") {
  for (const VolumeGeometry &g : {phantoms::grid({24, 24, 24}), phantoms::oblique({24, 24, 24}, {1.0, 1.5, 2.0}, true)})
    for (const double edge : {0.0, 0.5, 1.5}) {
      CAPTURE(g.handedness(), edge);
      checkGeometry(phantoms::box(g, {4, 4, 10}, {20, 20, 11}), edge, kHalfVoxel);
      checkGeometry(phantoms::box(g, {4, 10, 10}, {20, 11, 11}), edge, kHalfVoxel);
      checkGeometry(phantoms::box(g, {10, 10, 10}, {11, 11, 11}), edge, kHalfVoxel);
      checkGeometry(phantoms::ball(g, 8.0), edge, kHalfVoxel);
    }
}

TEST_CASE("surfaces of scattered voxels do not go through each other", "[imaging][surface]") {
  Mask mask{phantoms::oblique({14, 15, 16}, {1.0, 0.8, 1.2}), {}};
  phantoms::Dice dice(10);
  for (std::size_t v = 0; v < mask.geometry.voxelCount(); ++v) mask.voxels.push_back(dice(100) < 10 ? 1 : 0);
  checkGeometry(mask, 0.6, kHalfVoxel);
  checkGeometry(mask, 0.0, kHalfVoxel);
}

TEST_CASE("surfaces of branching vessels stay at their border and do not go through themselves", "[imaging][surface]") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    checkGeometry(phantoms::where(phantoms::grid({100, 100, 100}), phantoms::randomTree(seed, 3.0, 0.6)), 0.0, 0.7);
    checkGeometry(
        phantoms::where(phantoms::oblique({140, 140, 70}, {0.7, 0.7, 1.5}), phantoms::randomTree(seed, 3.0, 1.0)), 0.0,
        0.7);
  }
}

TEST_CASE("surfaces of organs stay at their border and do not go through themselves", "[imaging][surface]") {
  for (const std::string file : {"example_seg.nii.gz", "example_seg_fast_force_split.nii.gz"}) {
    C3DE_DATA_OR_SKIP(path, "volume/totalseg/" + file);
    const LabelMap map = label_files::read(path);
    for (const std::uint16_t label : {1, 5, 7, 33, 117})
      for (const double edge : {0.0, 3.0}) {
        const Mask mask = maskOf(map, label);
        if (voxelCount(mask) == 0) continue;
        CAPTURE(file, label, edge);
        // Vessels and ribs of few voxels, whose volume is corrected for the rounding of their rims by a larger
        // displacement.
        checkGeometry(mask, edge, 0.7);
      }
  }
}

TEST_CASE("edges far shorter than voxels are as many as the surface needs, and show no steps", "[imaging][surface]") {
  Mask ball{{{10, 10, 10}, {8, 0, 0, 0, 0, 8, 0, 0, 0, 0, 8, 0, -36, -36, -36, 1}}, std::vector<std::uint8_t>(1000, 0)};
  for (std::size_t v = 0; v < 1000; ++v)
    ball.voxels[v] = norm(ball.geometry.worldAt({double(v % 10), double(v / 10 % 10), double(v / 100)})) < 24.0 ? 1 : 0;
  SurfaceSettings settings;
  settings.edgeLength = 0.5;
  const auto surface = surfaceOf(ball, settings);
  REQUIRE(surface);
  const double triangle = 0.25 * std::sqrt(3.0) * 0.25;  // mm²
  const double wanted = geometry::surfaceArea(*surface) / triangle;
  // Edges between 4/5 and 4/3 of the length: areas from 0.64 to 1.78.
  CHECK(static_cast<double>(surface->triangles.size()) < wanted / 0.64);
  CHECK(static_cast<double>(surface->triangles.size()) > wanted / 1.78);
  CHECK(geometry::signedVolume(*surface) == Approx(volumeOf(ball)).epsilon(1e-3));
  double turned = 0.0;
  for (const Triangle &t : surface->triangles) {
    const Vec3 &a = surface->vertices[t[0]], &b = surface->vertices[t[1]], &c = surface->vertices[t[2]];
    const Vec3 normal = cross(b - a, c - a), out = a + b + c;
    turned += std::acos(std::clamp(dot(normal, out) / (norm(normal) * norm(out)), -1.0, 1.0)) * 57.3;
  }
  // Mean angle to the normals of the ball: 3.3 degrees; 17 where edges are not halved.
  CHECK(turned / static_cast<double>(surface->triangles.size()) < 8.0);
}
