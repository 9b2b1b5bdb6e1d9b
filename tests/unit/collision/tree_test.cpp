// SPDX-License-Identifier: Apache-2.0
#include <thread>

#include "brute_force.h"
#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using collision::AabbTree;

namespace {

struct Answers {
  std::vector<double> values;
  std::vector<std::uint32_t> triangles;
  bool operator==(const Answers &) const = default;
};

/// Results of a mixture of all queries around a box.
Answers ask(const AabbTree &tree, const geometry::Box &box, unsigned seed, int count) {
  Answers answers;
  shapes::RandomPoints random(seed);
  const Vec3 size = box.max - box.min;
  std::vector<std::uint32_t> found;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = random.in(box.min - 0.2 * size, box.max + 0.2 * size), q = random.in(box.min, box.max);
    const auto hit = tree.ray(p, q - p);
    const auto near = tree.closest(p);
    tree.sphere(q, 0.05 * norm(size), found);
    answers.values.insert(answers.values.end(), {hit.t, near.distance, near.point[0], near.normal[1]});
    answers.triangles.insert(answers.triangles.end(), {hit.triangle, near.triangle});
    answers.triangles.insert(answers.triangles.end(), found.begin(), found.end());
  }
  return answers;
}

geometry::TriangleMesh bent(geometry::TriangleMesh mesh) {
  for (Vec3 &v : mesh.vertices) v = {v[0] + 0.1 * v[1] * v[1], v[1] * 1.5, v[2] + 2.0 * std::sin(v[0])};
  return mesh;
}

}  // namespace

TEST_CASE("Balls find the same triangles as brute force") {
  const auto mesh = shapes::sphere({0, 0, 0}, 10.0, 3);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  shapes::RandomPoints random(41);
  std::vector<std::uint32_t> found;
  std::size_t total = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.in({-12, -12, -12}, {12, 12, 12});
    tree->sphere(p, 3.0, found);
    REQUIRE(found == brute_force::trianglesInBall(mesh, p, 3.0));
    total += found.size();
  }
  CHECK(total > 1000);
  tree->sphere({0, 0, 0}, -1.0, found);
  CHECK(found.empty());
}

TEST_CASE("A refitted tree answers like a rebuilt one and like a new one") {
  const auto rest = shapes::sphere({1, 2, 3}, 4.0, 4);
  auto tree = AabbTree::build(rest.vertices, rest.triangles);
  REQUIRE(tree);
  auto moved = rest;
  for (int step = 0; step < 3; ++step) {
    moved = bent(moved);
    REQUIRE(tree->refit(moved.vertices));
  }
  const auto box = geometry::boundingBox(moved);
  const Answers refitted = ask(*tree, box, 42, 300);
  tree->rebuild();
  CHECK(ask(*tree, box, 42, 300) == refitted);
  const auto fresh = AabbTree::build(moved.vertices, moved.triangles);
  REQUIRE(fresh);
  CHECK(ask(*fresh, box, 42, 300) == refitted);
}

TEST_CASE("Rebuilding follows positions given by refit, and refit works after rebuilding") {
  const auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  const auto shifted = [&](double by) {
    auto copy = mesh.vertices;
    for (Vec3 &v : copy) v[2] += by;
    return copy;
  };
  REQUIRE(tree->refit(shifted(5.0)));
  tree->rebuild();
  CHECK_THAT(tree->closest({0.5, 0.5, 8.0}).distance, WithinAbs(2.0, 1e-12));
  REQUIRE(tree->refit(shifted(6.0)));
  CHECK_THAT(tree->closest({0.5, 0.5, 8.0}).distance, WithinAbs(1.0, 1e-12));
}

TEST_CASE("Queries on several threads give the answers of one") {
  const auto mesh = shapes::sphere({0, 0, 0}, 4.0, 4);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  const auto box = geometry::boundingBox(mesh);
  const Answers expectedA = ask(*tree, box, 43, 400), expectedB = ask(*tree, box, 44, 400);
  Answers a, b;
  {
    std::jthread first([&] { a = ask(*tree, box, 43, 400); });
    std::jthread second([&] { b = ask(*tree, box, 44, 400); });
  }
  CHECK(a == expectedA);
  CHECK(b == expectedB);
}

TEST_CASE("Triangles without area break nothing") {
  auto mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  mesh.vertices.push_back({5, 0, 0});
  mesh.vertices.push_back({20, 20, 20});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 0}, {1, 1, 2}, {0, 8, 1}, {9, 9, 9}, {3, 3, 3}});
  auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  shapes::RandomPoints random(45);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random.in({-5, -5, -5}, {25, 25, 25});
    const auto c = tree->closest(p);
    REQUIRE(c.isFound());
    REQUIRE_THAT(std::abs(c.distance), WithinAbs(brute_force::distance(mesh, p), 1e-9));
    REQUIRE_THAT(norm(c.normal), WithinAbs(1.0, 1e-9));
    const auto hit = tree->ray(p, Vec3{5, 5, 5} - p);
    REQUIRE((!hit.isHit() || std::isfinite(hit.t)));
  }
  // All at one point: a tree of boxes without extent.
  for (Vec3 &v : mesh.vertices) v = {1, 1, 1};
  REQUIRE(tree->refit(mesh.vertices));
  tree->rebuild();
  CHECK_THAT(tree->closest({1, 1, 3}).distance, WithinAbs(2.0, 1e-12));
  CHECK_FALSE(tree->ray({1, 1, 3}, {0, 0, -1}).isHit());
}

TEST_CASE("Bad input is refused by name") {
  const auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  auto noTriangles = AabbTree::build(mesh.vertices, {});
  REQUIRE_FALSE(noTriangles);
  CHECK_THAT(noTriangles.error().message, Contains("no triangles"));

  auto triangles = mesh.triangles;
  triangles[3] = {1, 99, 2};
  auto outOfRange = AabbTree::build(mesh.vertices, triangles);
  REQUIRE_FALSE(outOfRange);
  CHECK_THAT(outOfRange.error().message, Contains("triangle 3 names vertex 99") && Contains("0 to 7"));

  auto vertices = mesh.vertices;
  vertices[5][1] = std::nan("");
  auto notFinite = AabbTree::build(vertices, mesh.triangles);
  REQUIRE_FALSE(notFinite);
  CHECK(notFinite.error().code == ErrorCode::input);
  CHECK_THAT(notFinite.error().message, Contains("y coordinate nan of vertex 5"));

  auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  CHECK_FALSE(tree->refit(vertices));
  vertices.pop_back();
  const auto wrongCount = tree->refit(vertices);
  REQUIRE_FALSE(wrongCount);
  CHECK_THAT(wrongCount.error().message, Contains("7 positions") && Contains("8 vertices"));
  // A refused update left the tree unchanged.
  CHECK_THAT(tree->closest({0.5, 0.5, 3.0}).distance, WithinAbs(2.0, 1e-12));
  CHECK(tree->triangleCount() == 12);
  CHECK(tree->vertexCount() == 8);
}

namespace {

bool segmentMeets(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const Vec3 n = cross(b - a, c - a);
  const double before = dot(p - a, n), after = dot(q - a, n);
  if (before * after > 0.0 || before == after) return false;
  const Vec3 x = p + (before / (before - after)) * (q - p);
  return dot(cross(b - a, x - a), n) >= 0.0 && dot(cross(c - b, x - b), n) >= 0.0 && dot(cross(a - c, x - c), n) >= 0.0;
}

double segmentsApart(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
  // By bisection: the distance of a point of one to the other is convex along it.
  double low = 0.0, high = 1.0;
  const auto at = [&](double s) { return brute_force::segmentDistance(a + s * (b - a), c, d); };
  for (int i = 0; i < 100; ++i) {
    const double l = low + (high - low) / 3.0, h = high - (high - low) / 3.0;
    (at(l) < at(h) ? high : low) = at(l) < at(h) ? h : l;
  }
  return at(0.5 * (low + high));
}

/// By other formulas than the tree's: vertices against triangles, edges against edges, edges through triangles.
double apart(const geometry::TriangleMesh &x, std::size_t i, const geometry::TriangleMesh &y, std::size_t j) {
  Vec3 s[3], t[3];
  for (std::size_t k = 0; k < 3; ++k) {
    s[k] = x.vertices[x.triangles[i][k]];
    t[k] = y.vertices[y.triangles[j][k]];
  }
  double least = 1e300;
  for (std::size_t k = 0; k < 3; ++k) {
    if (segmentMeets(s[k], s[(k + 1) % 3], t[0], t[1], t[2]) || segmentMeets(t[k], t[(k + 1) % 3], s[0], s[1], s[2]))
      return 0.0;
    least = std::min({least, brute_force::triangleDistance(s[k], t[0], t[1], t[2]),
                      brute_force::triangleDistance(t[k], s[0], s[1], s[2])});
    for (std::size_t m = 0; m < 3; ++m)
      least = std::min(least, segmentsApart(s[k], s[(k + 1) % 3], t[m], t[(m + 1) % 3]));
  }
  return least;
}

}  // namespace

TEST_CASE("Pairs of two surfaces are those of brute force, whether they meet or are near") {
  const auto left = shapes::sphere({0, 0, 0}, 10.0, 2), right = bent(shapes::sphere({14, 1, 2}, 6.0, 2));
  const auto a = AabbTree::build(left.vertices, left.triangles), b = AabbTree::build(right.vertices, right.triangles);
  REQUIRE(a);
  REQUIRE(b);
  std::vector<std::array<std::uint32_t, 2>> found, turned;
  for (const double distance : {0.0, 0.5, 3.0}) {
    a->pairs(*b, distance, found);
    std::size_t wrong = 0, expected = 0;
    for (std::uint32_t i = 0; i < left.triangles.size(); ++i)
      for (std::uint32_t j = 0; j < right.triangles.size(); ++j) {
        const double d = apart(left, i, right, j);
        const bool isFound = std::binary_search(found.begin(), found.end(), std::array<std::uint32_t, 2>{i, j});
        // A pair whose distance equals the limit up to round-off may be found or not.
        if (isFound != (d <= distance) && std::abs(d - distance) > 1e-6) ++wrong;
        if (d <= distance) ++expected;
      }
    INFO(distance);
    CHECK(wrong == 0);
    CHECK(expected > 10);
    b->pairs(*a, distance, turned);
    CHECK(turned.size() == found.size());
  }
  a->pairs(*b, -1.0, found);
  CHECK(found.empty());
}

TEST_CASE("A surface meets itself where it goes through itself, each pair once, and neighbours are none") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 2);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  std::vector<std::array<std::uint32_t, 2>> found;
  tree->pairs(*tree, 0.0, found);
  CHECK(found.empty());
  // A second sphere in the same mesh passes through the first.
  const auto other = shapes::sphere({12, 0, 0}, 6.0, 2);
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto first = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle &t : other.triangles) mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  const auto both = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(both);
  both->pairs(*both, 0.0, found);
  CHECK(found.size() > 10);
  for (const auto &[i, j] : found) {
    CHECK(i < first);
    CHECK(j >= first);
  }
}
