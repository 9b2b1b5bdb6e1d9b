// SPDX-License-Identifier: Apache-2.0
#include "loading/fitted_skins.h"

#include <algorithm>
#include <cmath>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;

namespace {

constexpr std::size_t kEdges = 20, kPerSide = kEdges + 1;  // of 1 mm, and vertices, along a side of a block
constexpr std::size_t kFace = kPerSide * kPerSide;         // vertices of one face; those of the upper one are behind
constexpr double kHeight = 12.0;

/// A block of 20 x 20 mm from z = low to high; the face at the height of 0 is `border`.
geometry::TriangleMesh block(double low, double high, double (*border)(double x, double y)) {
  geometry::TriangleMesh mesh;
  for (const double z : {low, high})
    for (std::size_t v = 0; v < kFace; ++v) {
      const auto x = static_cast<double>(v % kPerSide), y = static_cast<double>(v / kPerSide);
      mesh.vertices.push_back({x, y, z == 0.0 ? border(x, y) : z});
    }
  const auto at = [](std::size_t i, std::size_t j, std::size_t face) {
    return static_cast<std::uint32_t>(i + kPerSide * j + kFace * face);
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::size_t i = 0; i < kEdges; ++i) {
    for (std::size_t j = 0; j < kEdges; ++j) {
      quad(at(i, j, 0), at(i, j + 1, 0), at(i + 1, j + 1, 0), at(i + 1, j, 0));
      quad(at(i, j, 1), at(i + 1, j, 1), at(i + 1, j + 1, 1), at(i, j + 1, 1));
    }
    quad(at(i, 0, 0), at(i + 1, 0, 0), at(i + 1, 0, 1), at(i, 0, 1));
    quad(at(i + 1, kEdges, 0), at(i, kEdges, 0), at(i, kEdges, 1), at(i + 1, kEdges, 1));
    quad(at(0, i + 1, 0), at(0, i, 0), at(0, i, 1), at(0, i + 1, 1));
    quad(at(kEdges, i, 0), at(kEdges, i + 1, 0), at(kEdges, i + 1, 1), at(kEdges, i, 1));
  }
  return mesh;
}

double flat(double, double) { return 0.0; }
double waved(double x, double y) { return 0.3 * std::sin(0.6 * x) * std::cos(0.5 * y); }
double wavedBack(double x, double y) { return -waved(x, y); }
double lifted(double, double) { return 1.2; }

/// Whether a vertex of a face is away from its rim.
bool isInner(std::size_t v) {
  const std::size_t i = v % kPerSide, j = v / kPerSide;
  return std::min(i, j) >= 2 && std::max(i, j) <= kEdges - 2;
}

/// Largest distance of the two faces at the border, away from their rims, mm.
double apart(const geometry::TriangleMesh &below, const geometry::TriangleMesh &above) {
  double most = 0.0;
  for (std::size_t v = 0; v < kFace; ++v)
    if (isInner(v)) most = std::max(most, std::abs(above.vertices[v][2] - below.vertices[kFace + v][2]));
  return most;
}

}  // namespace

TEST_CASE("Skins that overlap and gape by turns meet in the middle, and nothing else of them moves", "[tissues]") {
  geometry::TriangleMesh below = block(-kHeight, 0.0, &waved), above = block(0.0, kHeight, &wavedBack);
  const geometry::TriangleMesh below0 = below, above0 = above;
  CHECK(apart(below, above) > 0.55);
  geometry::TriangleMesh *const skins[] = {&below, &above};
  REQUIRE(fitSkins(skins, 3.0));
  // The remaining distances are heights of edges over curved regions.
  CHECK(apart(below, above) < 0.06);
  double offMiddle = 0.0;
  std::size_t others = 0;
  for (std::size_t v = 0; v < kFace; ++v) {
    if (isInner(v)) offMiddle = std::max(offMiddle, std::abs(above.vertices[v][2]));
    others +=
        above.vertices[kFace + v] != above0.vertices[kFace + v] || below.vertices[v] != below0.vertices[v] ? 1 : 0;
  }
  CHECK(offMiddle < 0.06);
  CHECK(others == 0);
}

TEST_CASE("Skins beyond reach, and faces that look the same way, stay as they are", "[tissues]") {
  geometry::TriangleMesh below = block(-kHeight, 0.0, &flat), above = block(0.0, kHeight, &lifted);
  geometry::TriangleMesh inside = block(-0.5, kHeight - 0.5, &flat);
  const geometry::TriangleMesh below0 = below, above0 = above, inside0 = inside;
  geometry::TriangleMesh *const gaping[] = {&below, &above};
  REQUIRE(fitSkins(gaping, 3.0));  // a gap of 1.2 mm is wider than a third of the reach
  CHECK(below.vertices == below0.vertices);
  CHECK(above.vertices == above0.vertices);
  // Feet at the height of 0 and of -0.5 mm both face down.
  geometry::TriangleMesh foot = block(0.0, kHeight, &flat);
  const geometry::TriangleMesh foot0 = foot;
  geometry::TriangleMesh *const alike[] = {&foot, &inside};
  REQUIRE(fitSkins(alike, 3.0));
  const std::size_t middle = kFace / 2;
  CHECK(foot.vertices[middle] == foot0.vertices[middle]);
  CHECK(inside.vertices[middle] == inside0.vertices[middle]);
}

TEST_CASE("A skin with a vertex that is no number is refused", "[tissues]") {
  geometry::TriangleMesh below = block(-kHeight, 0.0, &flat), above = block(0.0, kHeight, &flat);
  above.vertices[5][1] = std::nan("");
  geometry::TriangleMesh *const skins[] = {&below, &above};
  CHECK_FALSE(fitSkins(skins, 3.0));
}
