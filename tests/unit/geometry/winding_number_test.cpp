// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/winding_number.h"

#include <chrono>
#include <numbers>
#include <thread>

#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

/// Sum of the solid angles of all triangles, by the spherical excess formula of L'Huilier, which differs from the one
/// under test.
double bruteForce(const TriangleMesh &mesh, const Vec3 &p) {
  const auto angle = [](const Vec3 &a, const Vec3 &b) { return std::atan2(norm(cross(a, b)), dot(a, b)); };
  double sum = 0.0;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
    const double x = angle(b, c), y = angle(c, a), z = angle(a, b), s = 0.5 * (x + y + z);
    const double product = std::tan(s / 2) * std::tan((s - x) / 2) * std::tan((s - y) / 2) * std::tan((s - z) / 2);
    const double excess = 4.0 * std::atan(std::sqrt(std::max(product, 0.0)));
    sum += dot(a, cross(b, c)) >= 0.0 ? excess : -excess;
  }
  return sum / (4.0 * std::numbers::pi);
}

}  // namespace

TEST_CASE("The winding number is one inside and zero outside") {
  const auto mesh = shapes::box({0, 0, 0}, {10, 20, 30});
  const WindingNumber winding(mesh);
  CHECK_THAT(winding.at({5, 5, 5}), WithinAbs(1.0, 1e-12));
  CHECK_THAT(winding.at({5, 5, 35}), WithinAbs(0.0, 1e-3));
  CHECK_THAT(winding.at({1e6, 5, 35}), WithinAbs(0.0, 1e-9));
  CHECK(WindingNumber(TriangleMesh{}).at({0, 0, 0}) == 0.0);
}

TEST_CASE("Overlapping, nested and turned parts add up") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 3);
  auto cavity = shapes::sphere({0, 0, 0}, 4.0, 3);
  shapes::turnInsideOut(cavity);
  shapes::append(mesh, cavity);
  shapes::append(mesh, shapes::sphere({8, 0, 0}, 5.0, 3));
  const WindingNumber winding(mesh);
  CHECK_THAT(winding.at({0, 0, 0}), WithinAbs(0.0, 0.01));
  CHECK_THAT(winding.at({-6, 0, 0}), WithinAbs(1.0, 0.01));
  CHECK_THAT(winding.at({7, 0, 0}), WithinAbs(2.0, 0.01));
  CHECK_THAT(winding.at({12, 0, 0}), WithinAbs(1.0, 0.01));
}

TEST_CASE("The winding number stays within 0.01 of the sum over all triangles on organs") {
  for (const char *file :
       {"mesh/openhelp/Liver.stl", "mesh/ssvtk_liver_patient/portal_vein.vtk", "mesh/sofa_env_nasty/tissue_surface.obj",
        "mesh/sofa_env_nasty/grasp/liver_collision.stl", "mesh/sofa/n0.obj", "mesh/sofa/smCube27.obj",
        "mesh/ssvtk_kidney/kidney.vtk", "mesh/sofa/dragon.obj"}) {
    C3DE_DATA_OR_SKIP(path, file);
    const auto loaded = loadMesh(path, LengthUnit::millimetre);
    REQUIRE(loaded);
    const TriangleMesh &mesh = loaded->mesh;
    const WindingNumber winding(mesh);
    const auto [min, max] = loaded->report.box;
    const Vec3 size = max - min;
    shapes::RandomPoints random(51);
    const int points = mesh.triangles.size() > 10000 ? 120 : 400;
    double worst = 0.0;
    for (int i = 0; i < points; ++i) {
      Vec3 p = random.in(min - 0.1 * size, max + 0.1 * size);
      const Triangle &t = mesh.triangles[random.index(mesh.triangles.size())];
      const double u = random.uniform(0, 0.5), v = random.uniform(0, 0.5);
      const Vec3 onSurface = (1 - u - v) * mesh.vertices[t[0]] + u * mesh.vertices[t[1]] + v * mesh.vertices[t[2]];
      if (i % 3 == 1) p = onSurface + random.in(-1e-5 * size, 1e-5 * size);
      if (i % 3 == 2) p = onSurface + random.in(-1e-2 * size, 1e-2 * size);
      worst = std::max(worst, std::abs(winding.at(p) - bruteForce(mesh, p)));
    }
    INFO(file << ": worst difference " << worst);
    CHECK(worst < 0.01);
  }
}

TEST_CASE("Grids whose planes lie in faces of the bounding box fill the right volume") {
  for (const char *file : {"mesh/sofa_env_nasty/tissue_surface.obj", "mesh/sofa/cubeQuad.obj", "mesh/sofa/n0.obj"}) {
    C3DE_DATA_OR_SKIP(path, file);
    const auto loaded = loadMesh(path, LengthUnit::metre);
    REQUIRE(loaded);
    const WindingNumber winding(loaded->mesh);
    const auto [min, max] = loaded->report.box;
    const Vec3 size = max - min;
    // The sum over the grid is the volume if points on a face count half and those on an edge a quarter, as they
    // should.
    constexpr int n = 30;
    double volume = 0.0;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        for (int k = 0; k <= n; ++k) {
          const double w = winding.at({min[0] + size[0] * i / n, min[1] + size[1] * j / n, min[2] + size[2] * k / n});
          REQUIRE(std::isfinite(w));
          REQUIRE(std::abs(w - 0.5) < 0.51);
          volume += w * size[0] * size[1] * size[2] / (n * n * n);
        }
    INFO(file);
    // The tissue's sides are 0.05 mm within its box, so a layer of the grid on either side counts nothing: four
    // sixtieths.
    CHECK_THAT(volume, WithinRel(loaded->report.volume_mm3, 4.0 / 60.0 + 0.01));
  }
}

TEST_CASE("On vertices, edges and faces the winding number is finite and between the sides") {
  const auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const WindingNumber winding(mesh);
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j)
      for (int k = 0; k <= 4; ++k) {
        const double w = winding.at({0.25 * i, 0.25 * j, 0.25 * k});
        REQUIRE(std::isfinite(w));
        REQUIRE(w > -1e-9);
        REQUIRE(w < 1.0 + 1e-9);
      }
}

TEST_CASE("Batches, single points and threads give the same bits") {
  const auto mesh = shapes::sphere({0, 0, 0}, 10.0, 4);
  const WindingNumber winding(mesh), second(mesh);
  shapes::RandomPoints random(52);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) points.push_back(random.in({-12, -12, -12}, {12, 12, 12}));
  std::vector<double> batch(points.size()), other(points.size());
  {
    std::jthread a([&] { winding.at(points, batch); });
    std::jthread b([&] { second.at(points, other); });
  }
  CHECK(batch == other);
  for (std::size_t i = 0; i < points.size(); ++i) REQUIRE(batch[i] == winding.at(points[i]));
}

TEST_CASE("Of many shells those count whose box holds the point, and the sum stays the same") {
  // Plates pierced by long thin tubes: no triangle is ever far away.
  TriangleMesh all;
  std::vector<TriangleMesh> shells;
  for (int n = 0; n < 40; ++n) {
    TriangleMesh tube;
    const double x = 10.0 * n;
    constexpr int kSides = 48;
    for (int s = 0; s < kSides; ++s) {
      const double angle = 2.0 * 3.14159265358979323846 * s / kSides;
      for (const double z : {-100.0, 100.0})
        tube.vertices.push_back({x + 3.0 * std::cos(angle), 3.0 * std::sin(angle), z});
    }
    tube.vertices.push_back({x, 0, -100.0});
    tube.vertices.push_back({x, 0, 100.0});
    for (unsigned s = 0; s < kSides; ++s) {
      const unsigned a = 2 * s, b = 2 * ((s + 1) % kSides);
      tube.triangles.push_back({a, b, b + 1});
      tube.triangles.push_back({a, b + 1, a + 1});
      tube.triangles.push_back({2 * kSides, b, a});
      tube.triangles.push_back({2 * kSides + 1, a + 1, b + 1});
    }
    shells.push_back(tube);
  }
  shells.push_back(shapes::box({-20, -20, -5}, {420, 20, 5}));
  shells.back().triangles.pop_back();  // open
  for (const TriangleMesh &shell : shells) {
    const auto first = static_cast<unsigned>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), shell.vertices.begin(), shell.vertices.end());
    for (const Triangle &t : shell.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const WindingNumber whole(all), one(shells.front());
  std::vector<WindingNumber> each;
  for (const TriangleMesh &shell : shells) each.emplace_back(shell);
  std::vector<Vec3> points;
  for (int n = 0; n < 4000; ++n) points.push_back({-30.0 + 0.11 * n, -25.0 + 0.7 * (n % 71), -110.0 + 2.3 * (n % 97)});
  for (const Vec3 &p : points) {
    double sum = 0.0;
    for (const WindingNumber &shell : each) sum += shell.at(p);
    if (std::abs(whole.at(p) - sum) > 0.005) {
      CAPTURE(p[0], p[1], p[2], whole.at(p), sum);
      CHECK(std::abs(whole.at(p) - sum) <= 0.005);
    }
  }
  // Summed triangle by triangle it takes some forty times as long as one tube.
  const auto secondsOf = [&](const WindingNumber &winding) {
    double least = 1e300;
    std::vector<double> out(points.size());
    for (int run = 0; run < 5; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      winding.at(points, out);
      least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return least;
  };
  CHECK(secondsOf(whole) < 10.0 * secondsOf(one));
}
