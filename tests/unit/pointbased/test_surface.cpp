// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using shapes::sum;

namespace {

Vec3 areaVector(const SurfacePoints &points) {
  Vec3 total = Vec3::Zero();
  for (std::size_t i = 0; i < points.count(); ++i) total += points.areas[i] * points.normals[i];
  return total;
}

Vec3 centroid(const SurfacePoints &points) {
  Vec3 total = Vec3::Zero();
  for (std::size_t i = 0; i < points.count(); ++i) total += points.areas[i] * points.positions[i];
  return total / sum(points.areas);
}

}  // namespace

TEST_CASE("The whole surface is sampled with its area, and closed", "[surface]") {
  const Surface box = shapes::boxSurface(Vec3(0.1, 0.2, -0.1), Vec3(0.4, 0.3, 0.1));
  const Surface ball = shapes::ballSurface(Vec3(0.5, 0, 0), 0.05, 24);
  for (const Surface *surface : {&box, &ball})
    for (const double spacing : {0.0, 1.0, 0.02, 0.003}) {
      const SurfacePoints points = sampleSurface(*surface, spacing, EverywhereRegion{});
      const double area = shapes::areaOf(*surface);
      CHECK(sum(points.areas) == Approx(area).epsilon(1e-12));
      CHECK(areaVector(points).norm() < 1e-12 * area);
      // V = 1/3 ∮ x·n dA, exact because the parts carry their centroids.
      double volume = 0.0;
      for (std::size_t i = 0; i < points.count(); ++i)
        volume += points.areas[i] * points.normals[i].dot(points.positions[i]) / 3.0;
      const double expected = surface == &box ? 0.3 * 0.1 * 0.2 : 4.0 / 3.0 * std::numbers::pi * std::pow(0.05, 3);
      CHECK(volume == Approx(expected).epsilon(surface == &box ? 1e-12 : 0.01));  // the ball's net is inscribed
    }
}

TEST_CASE("The parts of a sampled surface are no larger than the spacing asks", "[surface]") {
  const Surface box = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.2, 0.04, 0.04));
  const double spacing = 0.01;
  const SurfacePoints points = sampleSurface(box, spacing, EverywhereRegion{});
  // A piece of diameter d has at most the area of the circle over it.
  CHECK(*std::max_element(points.areas.begin(), points.areas.end()) <= std::numbers::pi / 4.0 * spacing * spacing);
  // Every point of the face is near a sample: the spacing bounds the diameter of the pieces.
  for (double y = 0.001; y < 0.04; y += 0.005) {
    const Vec3 x(0.0, y, 0.021);
    double nearest = 1.0;
    for (const Vec3 &p : points.positions) nearest = std::min(nearest, (p - x).norm());
    CHECK(nearest < spacing);
  }
  // Nor are they finer than necessary: the smallest of halved pieces is a quarter of the largest allowed.
  CHECK(static_cast<double>(points.count()) < 12.0 * shapes::areaOf(box) / (spacing * spacing));
}

TEST_CASE("One point stands for each triangle without a spacing, with its centroid and number", "[surface]") {
  const Surface box = shapes::boxSurface(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const SurfacePoints points = sampleSurface(box, 0.0, EverywhereRegion{});
  REQUIRE(points.count() == box.triangles.size());
  for (std::size_t i = 0; i < points.count(); ++i) {
    CHECK(points.triangles[i] == i);
    const auto &[a, b, c] = box.triangles[i];
    CHECK((points.positions[i] - (box.positions[a] + box.positions[b] + box.positions[c]) / 3.0).norm() < 1e-15);
  }
}

TEST_CASE("A box and a half-space cut a surface with exact areas and centroids", "[surface]") {
  const Surface box = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.2, 0.04, 0.04));
  for (const double spacing : {1.0, 0.013, 0.004}) {
    // The left 30 %: the face at x = 0 and four sides 0.06 long.
    const Region regions[] = {BoxRegion{Vec3(-1, -1, -1), Vec3(0.06, 1, 1)},
                              HalfSpaceRegion{Vec3(0.06, 3, 4), Vec3(10, 0, 0)}};
    for (const Region &region : regions) {
      const SurfacePoints points = sampleSurface(box, spacing, region);
      const double sides = 4 * 0.06 * 0.04, face = 0.04 * 0.04;
      // The border moves by 1e-9 of the size, 1e-8 of this length.
      CHECK(sum(points.areas) == Approx(sides + face).epsilon(2e-8));
      CHECK((centroid(points) - Vec3(sides * 0.03 / (sides + face), 0.02, 0.02)).norm() < 1e-8);
      for (const Vec3 &x : points.positions) CHECK(contains(region, x));
    }
  }
  // An oblique cut through the middle of the y faces takes half of everything.
  const HalfSpaceRegion oblique{Vec3(0.1, 0.02, 0.02), Vec3(1, 2, 3)};
  CHECK(sum(sampleSurface(box, 0.01, oblique).areas) == Approx(0.5 * shapes::areaOf(box)).epsilon(1e-8));
}

TEST_CASE("A face is taken whole whether the region reaches beyond it or ends on it", "[surface]") {
  // Coordinates that are not exact in binary, far from the origin.
  const Vec3 min(0.1 + 3.7, 0.3, 0.7), max(0.3 + 3.7, 0.34, 0.74);
  const Surface box = shapes::boxSurface(min, max, 3);
  const double face = (max[1] - min[1]) * (max[2] - min[2]), girth = 2 * (max[1] - min[1] + max[2] - min[2]);
  const BoxRegion around{Vec3(min[0] - 0.001, -9, -9), Vec3(min[0] + 0.001, 9, 9)};
  CHECK(sum(sampleSurface(box, 0.01, around).areas) == Approx(face + 0.001 * girth).epsilon(1e-5));

  for (const double ulps : {-2.0, 0.0, 2.0}) {
    const double x = min[0] + ulps * 4.4e-16;
    const Region ending[] = {BoxRegion{Vec3(-9, -9, -9), Vec3(x, 9, 9)}, BoxRegion{Vec3(x, -9, -9), Vec3(x, 9, 9)},
                             HalfSpaceRegion{Vec3(x, 0, 0), Vec3(1, 0, 0)}};
    for (const Region &region : ending) {
      const SurfacePoints points = sampleSurface(box, 0.01, region);
      CHECK(sum(points.areas) == Approx(face).epsilon(1e-9));
      for (const Vec3 &n : points.normals) CHECK((n + Vec3::UnitX()).norm() < 1e-12);
    }
  }
}

TEST_CASE("A sphere cuts a plane face in a circle and a ball in a cap", "[surface]") {
  const Surface face = shapes::boxSurface(Vec3(0, 0, 0), Vec3(1, 1, 0.5));
  // Radius 0.25 about a point 0.15 above the top: a circle of radius 0.2, across the diagonal of the face.
  const SphereRegion sphere{Vec3(0.55, 0.45, 0.65), 0.25};
  for (const double spacing : {2.0, 0.05, 0.011}) {
    const SurfacePoints points = sampleSurface(face, spacing, sphere);
    CHECK(sum(points.areas) == Approx(std::numbers::pi * 0.04).epsilon(1e-6));
    CHECK((centroid(points) - Vec3(0.55, 0.45, 0.5)).norm() < 1e-6);
  }
  // A corner of the face at the centre of the sphere: three quarter circles.
  CHECK(sum(sampleSurface(face, 0.05, SphereRegion{Vec3(0, 0, 0), 0.3}).areas) ==
        Approx(0.75 * std::numbers::pi * 0.09).epsilon(1e-3));

  // Cap within distance d of the pole: area π d². The net of 100 rings lacks 1e-3 of the ball.
  const Surface ball = shapes::ballSurface(Vec3(0, 0, 0), 0.1, 100);
  for (const double d : {0.03, 0.08, 0.15}) {
    const double cap = sum(sampleSurface(ball, 0.01, SphereRegion{Vec3(0, 0, 0.1), d}).areas);
    CHECK(cap == Approx(std::numbers::pi * d * d).epsilon(2e-3));
  }
}

TEST_CASE("Regions beside a surface take nothing of it", "[surface]") {
  const Surface box = shapes::boxSurface(Vec3(0, 0, 0), Vec3(1, 1, 1));
  CHECK(sampleSurface(box, 0.1, BoxRegion{Vec3(1.01, 0, 0), Vec3(2, 1, 1)}).count() == 0);
  CHECK(sampleSurface(box, 0.1, BoxRegion{Vec3(0.4, 0.4, 0.4), Vec3(0.6, 0.6, 0.6)}).count() == 0);
  CHECK(sampleSurface(box, 0.1, SphereRegion{Vec3(0.5, 0.5, 0.5), 0.49}).count() == 0);
  CHECK(sampleSurface(box, 0.1, SphereRegion{Vec3(1.5, 1.5, 1.5), 0.8}).count() == 0);  // near the corner, not in it
  CHECK(sampleSurface(box, 0.1, HalfSpaceRegion{Vec3(-0.01, 0, 0), Vec3(1, 0, 0)}).count() == 0);
  CHECK(sampleSurface(Surface{}, 0.1, EverywhereRegion{}).count() == 0);
}

TEST_CASE("Triangles without area are passed over", "[surface]") {
  Surface s;
  s.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)};
  s.triangles = {{0, 1, 2}, {0, 0, 3}, {0, 1, 3}};
  const SurfacePoints points = sampleSurface(s, 10.0, EverywhereRegion{});
  REQUIRE(points.count() == 1);
  CHECK(points.triangles[0] == 2);
  CHECK(points.areas[0] == Approx(0.5));
}

TEST_CASE("A mesh of a hundred thousand triangles gives the area of a coarse one", "[surface]") {
  const Surface fine = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.2, 0.04, 0.04), 92);
  REQUIRE(fine.triangles.size() > 100'000);
  const Region region = SphereRegion{Vec3(0.21, 0.02, 0.02), 0.03};
  const Surface coarse = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.2, 0.04, 0.04));
  const SurfacePoints a = sampleSurface(fine, 0.01, region), b = sampleSurface(coarse, 0.01, region);
  // Polygons of equal sides about the same centre: only the directions of their corners differ.
  CHECK(sum(a.areas) == Approx(sum(b.areas)).epsilon(1e-3));
  CHECK((centroid(a) - centroid(b)).norm() < 1e-3 * 0.03);
}
