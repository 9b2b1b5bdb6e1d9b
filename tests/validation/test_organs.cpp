// SPDX-License-Identifier: Apache-2.0
// Third-party organs fall on an obstacle: loaded, filled, simulated for 2 s through the plugin. They are judged by this
// test's own tree over the obstacle, not by the plugin's reports.
#include <algorithm>
#include <cmath>

#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/mesh_report.h"
#include "simulator_session.h"
#include "support/catch.h"

using namespace c3de;
using test::SimulatorSession;

namespace {

constexpr double kYoungsModulus = 6000.0, kPoissonRatio = 0.45, kDensity = 1060.0;

struct Organ {
  const char *file;
  geometry::LengthUnit unit;
  double scale;  // the SOFA files have no unit and are 6.5 and 2.1 units wide: scaled to the width of a liver
};

/// A hill of one unit around the origin, top at y = 0, on a plate: curved where a body lands, closed, smooth.
geometry::TriangleMesh hill() {
  constexpr int n = 24;
  geometry::TriangleMesh mesh;
  const auto at = [](int i, int j) { return static_cast<unsigned>(j * (n + 1) + i); };
  for (const bool top : {true, false})
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = -1200.0 + 2400.0 * i / n, z = -1200.0 + 2400.0 * j / n;
        const double y = top ? 150.0 * (std::exp(-(x * x + z * z) / 8e4) - 1.0) : -400.0;
        mesh.vertices.push_back({x, y, z});
      }
  const unsigned below = (n + 1) * (n + 1);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const unsigned a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, d, c}, Triangle{a, c, b}});
      mesh.triangles.insert(mesh.triangles.end(),
                            {Triangle{a + below, c + below, d + below}, Triangle{a + below, b + below, c + below}});
    }
  const auto side = [&](unsigned p, unsigned q) {
    mesh.triangles.insert(mesh.triangles.end(), {Triangle{p, q, q + below}, Triangle{p, q + below, p + below}});
  };
  for (int i = 0; i < n; ++i) {
    side(at(i, 0), at(i + 1, 0));
    side(at(i + 1, n), at(i, n));
    side(at(0, i + 1), at(0, i));
    side(at(n, i), at(n, i + 1));
  }
  return mesh;
}

void fallAndRest(const Organ &organ) {
  C3DE_DATA_OR_SKIP(path, std::string("mesh/") + organ.file);
  auto mesh = geometry::loadMesh(path, organ.unit);
  REQUIRE(mesh);
  REQUIRE(geometry::checkFillable(mesh->mesh, mesh->report));
  const double volume_m3 = std::abs(mesh->report.volume_mm3) * 1e-9 * std::pow(organ.scale, 3);
  const geometry::Box box = mesh->report.box;
  const auto low = [&](std::size_t k) { return 1e-3 * organ.scale * box.min[k]; };
  const auto high = [&](std::size_t k) { return 1e-3 * organ.scale * box.max[k]; };
  const double width = std::max({high(0) - low(0), high(1) - low(1), high(2) - low(2)});

  auto obstacle = geometry::buildMesh(hill(), geometry::LengthUnit::millimetre);
  REQUIRE(obstacle);
  REQUIRE(obstacle->report.closed);
  std::vector<Vec3> placed;
  for (const Vec3 &v : obstacle->mesh.vertices) placed.push_back(1e-3 * width * v);
  const auto tree = collision::AabbTree::build(placed, obstacle->mesh.triangles);
  REQUIRE(tree);

  SimulatorSession session(2);
  session.setWorld(
      {SimulatorSession::vector("world.gravity", {0.0, -9.81, 0.0}), SimulatorSession::number("solver.damping", 5.0)});
  session.addObstacle(*obstacle, {{0, 0, 0}, width}, 0.5);
  const c3de_handle body = session.addBody(
      *mesh, {{-0.5 * (low(0) + high(0)), 0.1 * width - low(1), -0.5 * (low(2) + high(2))}, organ.scale},
      {SimulatorSession::number("material.youngs_modulus", kYoungsModulus),
       SimulatorSession::number("material.poisson_ratio", kPoissonRatio),
       SimulatorSession::number("material.density", kDensity), SimulatorSession::number("sampling.count", 1000.0)});

  const c3de_sim_body_info info = session.info(body);
  CHECK_THAT(static_cast<double>(info.points), WithinRel(1000.0, 0.1));
  CHECK_THAT(info.mass_kg, WithinRel(kDensity * volume_m3, 1e-9));

  const std::uint64_t initial = session.stateHash();
  double deepest = 0.0;
  while (session.status().time_s < 2.0) {
    session.step();
    if (session.status().steps % 50 != 0) continue;
    // The skin is the contact surface; phyxels at the corners of cut cells are outside of the body.
    for (const Vec3 &x : session.surfels(body, C3DE_SIM_FIELD_POSITION)) {
      REQUIRE((std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])));
      deepest = std::min(deepest, tree->closest(x, 2.0 * info.spacing_m).distance);
    }
  }
  // By mass: corners of cells that the body only touches have almost no mass.
  double fastest = 0.0, squares = 0.0, total = 0.0;
  const std::vector<double> masses = session.phyxelMasses(body);
  const std::vector<Vec3> velocities = session.phyxels(body, C3DE_SIM_FIELD_VELOCITY);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    fastest = std::max(fastest, norm(velocities[i]));
    squares += masses[i] * dot(velocities[i], velocities[i]);
    total += masses[i];
  }
  const double rms = std::sqrt(squares / total);
  WARN(organ.file << ": " << info.points << " phyxels, spacing " << 1e3 * info.spacing_m << " mm, deepest "
                  << 1e3 * deepest << " mm, speed rms " << rms << " m/s, largest " << fastest << " m/s, "
                  << session.status().steps << " steps");
  CHECK(deepest > -0.5 * info.spacing_m);
  // It landed at about 0.6 m/s; the rest is the slow creep of a soft body that still slides and sags.
  CHECK(rms < 0.03);
  for (const Vec3 &x : session.surfels(body, C3DE_SIM_FIELD_POSITION))
    REQUIRE((std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])));

  session.reset();
  CHECK(session.stateHash() == initial);
}

}  // namespace

TEST_CASE("the OpenHELP liver falls on a hill and comes to rest", "[slow]") {
  fallAndRest({"openhelp/Liver.stl", geometry::LengthUnit::millimetre, 1.0});
}
TEST_CASE("the OpenHELP kidney falls on a hill and comes to rest") {
  fallAndRest({"openhelp/Kidney_left.stl", geometry::LengthUnit::millimetre, 1.0});
}
TEST_CASE("the coarse SOFA liver falls on a hill and comes to rest") {
  fallAndRest({"sofa/liver.obj", geometry::LengthUnit::metre, 0.03});
}
TEST_CASE("the finer SOFA liver falls on a hill and comes to rest") {
  fallAndRest({"sofa/liver2.obj", geometry::LengthUnit::metre, 0.1});
}
TEST_CASE("the patient's liver of six components falls on a hill and comes to rest") {
  fallAndRest({"ssvtk_liver_patient/liver.vtk", geometry::LengthUnit::millimetre, 1.0});
}

TEST_CASE("every organ of the data either simulates or is refused with what is wrong with it") {
  C3DE_DATA_OR_SKIP(folder, "mesh");
  std::size_t simulated = 0, refused = 0;
  std::vector<std::filesystem::path> files;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto &file : files) {
    INFO(file.string());
    auto mesh = geometry::loadMesh(file, geometry::LengthUnit::millimetre);
    if (!mesh) {
      CHECK_FALSE(mesh.error().message.empty());
      ++refused;
      continue;
    }
    const geometry::Box box = mesh->report.box;
    const double extent = std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
    SimulatorSession session(2);
    session.setWorld({SimulatorSession::vector("world.gravity", {0.0, -9.81, 0.0}),
                      SimulatorSession::number("solver.damping", 5.0)});
    try {
      // As wide as a liver, whatever the unit of the file.
      const c3de_handle body =
          session.addBody(*mesh, {{0, 0, 0}, 200.0 / extent}, {SimulatorSession::number("sampling.count", 300.0)});
      for (int i = 0; i < 20; ++i) session.step();
      for (const Vec3 &x : session.phyxels(body, C3DE_SIM_FIELD_POSITION)) REQUIRE(std::isfinite(x[0] + x[1] + x[2]));
      ++simulated;
    } catch (const std::runtime_error &error) {
      WARN(file.filename().string() << " is refused: " << error.what());
      CHECK(std::string(error.what()).size() > 20);
      ++refused;
    }
  }
  WARN(simulated << " simulated, " << refused << " refused");
  CHECK(simulated >= 15);
}
