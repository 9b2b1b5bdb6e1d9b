// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "contact_cases.h"
#include "pointbased/body.h"
#include "pointbased/rest_state.h"
#include "pointbased/simulator.h"
#include "pointbased/supports.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

constexpr double kSpacing = 0.01;  // m

// Phyxels of a beam of 0.1 x 0.04 x 0.04 m at the centres of its cells.
struct Beam {
  std::vector<Vec3> positions;
  std::vector<double> volumes;
  Surface surface = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.1, 0.04, 0.04));
  Beam() {
    for (int x = 0; x < 10; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = 0; z < 4; ++z) positions.push_back(kSpacing * Vec3(x + 0.5, y + 0.5, z + 0.5));
    volumes.assign(positions.size(), std::pow(kSpacing, 3));
  }
  [[nodiscard]] Result<ConstrainedRegion> hold(const Region &region) const {
    return holdCloud(region, positions, volumes, kSpacing, surface, serialFor());
  }
  [[nodiscard]] Result<LoadedPart> load(const Load &load, double spacing = kSpacing) const {
    const Binder bind = [this](std::span<const Vec3> points, std::span<const Vec3>) {
      return bindToCloud(points, positions, serialFor());
    };
    return loadedPart(load, surface, spacing, bind, positions, volumes);
  }
};

Region slab(double from, double to) { return BoxRegion{Vec3(from, -1, -1), Vec3(to, 1, 1)}; }

std::vector<Vec3> moved(const std::vector<Vec3> &X, const Mat3 &F, const Vec3 &shift) {
  std::vector<Vec3> u(X.size());
  for (std::size_t i = 0; i < X.size(); ++i) u[i] = F * X[i] + shift - X[i];
  return u;
}

using shapes::total;

Mat3 matrix(shapes::Random &random) {
  Mat3 F;
  for (int c = 0; c < 3; ++c) F.col(c) = random.vector();
  return F;
}

}  // namespace

TEST_CASE("Phyxels inside a region are held, those beside it are not", "[supports]") {
  const Beam beam;
  const auto part = beam.hold(slab(-1.0, 0.02));
  REQUIRE(part);
  CHECK(part->phyxels.size() == 2 * 16);
  CHECK(std::is_sorted(part->phyxels.begin(), part->phyxels.end()));
  for (const Index i : part->phyxels) CHECK(beam.positions[i][0] < 0.02);
  CHECK(part->volume == Approx(0.02 * 0.04 * 0.04).epsilon(1e-12));
  CHECK(part->area == Approx(0.04 * 0.04 + 4 * 0.02 * 0.04).epsilon(1e-6));
  CHECK((part->centroid - Vec3(0.01, 0.02, 0.02)).norm() < 1e-15);
}

TEST_CASE("A face that holds no phyxel is held in patches that cover it", "[supports]") {
  const Beam beam;
  // The second region ends exactly on the face.
  for (const Region &region : {slab(-0.001, 0.001), slab(-0.001, 0.0)}) {
    const auto part = beam.hold(region);
    REQUIRE(part);
    CHECK(part->phyxels.empty());
    CHECK(part->volume == 0.0);
    const double strip = contains(region, Vec3(0.0005, 0, 0)) ? 4 * 0.001 * 0.04 : 0.0;
    CHECK(part->area == Approx(0.04 * 0.04 + strip).epsilon(1e-6));
    CHECK(shapes::sum(part->areas) == Approx(part->area).epsilon(1e-12));
    CHECK(part->areas.size() == 16);  // one for each phyxel of the first layer
    REQUIRE(part->rows.rows() == part->areas.size());
    CHECK((part->centroid - Vec3(strip > 0.0 ? 0.0005 * strip / part->area : 0.0, 0.02, 0.02)).norm() < 1e-8);

    Vec3 mean = Vec3::Zero();
    for (std::size_t r = 0; r < part->rows.rows(); ++r) {
      double sum = 0.0;
      Vec3 at = Vec3::Zero();
      for (Index e = part->rows.offsets[r]; e < part->rows.offsets[r + 1]; ++e) {
        sum += part->weights[e];
        at += part->weights[e] * beam.positions[part->rows.indices[e]];
        if (e > part->rows.offsets[r]) CHECK(part->rows.indices[e] > part->rows.indices[e - 1]);
      }
      CHECK(sum == Approx(1.0).epsilon(1e-12));
      // Affine functions: the mean of the phyxels is the centre of the patch, which is on the surface.
      CHECK(at[0] < 0.00051);
      CHECK(at[0] > -1e-12);
      mean += part->areas[r] * at;
    }
    CHECK((mean / part->area - part->centroid).norm() < 1e-12);
  }
}

TEST_CASE("A rigid motion of the phyxels moves every held patch as the fix prescribes", "[supports]") {
  const Beam beam;
  const auto part = beam.hold(slab(-0.001, 0.001));
  REQUIRE(part);
  const Fix fix{.displacement = Vec3(0.01, 0.02, -0.03), .rotation_deg = Vec3(20, 30, 200)};
  const RigidMotion motion = motionAt(fix, *part, Vec3::Zero(), 0.7);
  for (std::size_t r = 0; r < part->rows.rows(); ++r) {
    Vec3 rest = Vec3::Zero(), now = Vec3::Zero();
    for (Index e = part->rows.offsets[r]; e < part->rows.offsets[r + 1]; ++e) {
      const Vec3 &X = beam.positions[part->rows.indices[e]];
      rest += part->weights[e] * X;
      now += part->weights[e] * (X + motion.displacementOf(X));
    }
    CHECK((now - rest - motion.displacementOf(rest)).norm() < 1e-15);
  }
}

TEST_CASE("Patches that only held phyxels move have no row", "[supports]") {
  const Beam beam;
  const auto whole = beam.hold(EverywhereRegion{});
  REQUIRE(whole);
  CHECK(whole->phyxels.size() == beam.positions.size());
  CHECK(whole->areas.empty());
  CHECK(whole->area == Approx(shapes::areaOf(beam.surface)).epsilon(1e-12));

  const auto half = beam.hold(slab(-1, 0.05));
  REQUIRE(half);
  const std::vector<Index> &held = half->phyxels;
  for (std::size_t r = 0; r < half->rows.rows(); ++r)
    CHECK_FALSE(std::all_of(half->rows.indices.begin() + half->rows.offsets[r],
                            half->rows.indices.begin() + half->rows.offsets[r + 1],
                            [&](Index j) { return std::binary_search(held.begin(), held.end(), j); }));
}

TEST_CASE("A cloud without surface holds its phyxels alone", "[supports]") {
  Beam beam;
  beam.surface = {};
  const auto part = beam.hold(slab(-1.0, 0.01));
  REQUIRE(part);
  CHECK(part->phyxels.size() == 16);
  CHECK(part->areas.empty());
  CHECK_FALSE(beam.hold(slab(-0.001, 0.001)));
}

TEST_CASE("A region that meets nothing is refused with a reason", "[supports]") {
  const Beam beam;
  const auto held = beam.hold(slab(0.2, 0.3));
  REQUIRE_FALSE(held);
  CHECK_THAT(held.error(), Contains("meets no part of the body"));
  Load load{.region = slab(0.2, 0.3)};
  for (const double pressure : {0.0, 10.0}) {
    load.pressure = pressure;
    const auto loaded = beam.load(load);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error(), Contains("meets no part of the body"));
  }
  CHECK_FALSE(beam.hold(SphereRegion{Vec3::Zero(), -1.0}));
  load.region = SphereRegion{Vec3::Zero(), -1.0};
  CHECK_FALSE(beam.load(load));
  load.region = slab(-1, 1);
  load.pressure = std::nan("");
  CHECK_FALSE(beam.load(load));
}

TEST_CASE("A fix turns about x, then y, then z, through its centre, and then moves", "[supports]") {
  const ConstrainedRegion part{.centroid = Vec3(0.1, 0, 0)};
  Fix fix{.rotation_deg = Vec3(90, 0, 90)};
  // About x: y -> z; then about z: x -> y, z unchanged.
  CHECK((motionAt(fix, part, Vec3::Zero(), 1.0).rotation * Vec3::UnitY() - Vec3::UnitZ()).norm() < 1e-15);
  CHECK((motionAt(fix, part, Vec3::Zero(), 1.0).rotation * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
  fix.rotation_deg = Vec3(0, 90, 90);
  // About y: z -> x; then about z: x -> y.
  CHECK((motionAt(fix, part, Vec3::Zero(), 1.0).rotation * Vec3::UnitZ() - Vec3::UnitY()).norm() < 1e-15);

  // Without a centre, about the part's own centre, which moves only by the displacement.
  fix.displacement = Vec3(0, 0, 0.4);
  CHECK((motionAt(fix, part, Vec3(7, 7, 7), 0.5).displacementOf(part.centroid) - Vec3(0, 0, 0.2)).norm() < 1e-15);
  // A centre is in world coordinates.
  fix.centre = Vec3(1, 2, 3);
  const Vec3 origin(0.5, 0.5, 0.5);
  CHECK((motionAt(fix, part, origin, 0.5).displacementOf(*fix.centre - origin) - Vec3(0, 0, 0.2)).norm() < 1e-15);
  CHECK(motionAt(fix, part, origin, 0.0).displacementOf(Vec3(4, 5, 6)).norm() == 0.0);
}

TEST_CASE("The rate of a prescribed motion is its derivative", "[supports]") {
  const ConstrainedRegion part{.centroid = Vec3(0.1, -0.2, 0.05)};
  const Fix fix{.displacement = Vec3(0.3, 0.1, -0.2), .rotation_deg = Vec3(100, -170, 250)};
  constexpr double h = 1e-5;
  shapes::Random random(2);
  for (const double s : {0.0, 0.3, 0.77, 1.0}) {
    const Vec3 X = random.vector();
    const Vec3 difference = (motionAt(fix, part, Vec3::Zero(), s + h).displacementOf(X) -
                             motionAt(fix, part, Vec3::Zero(), s - h).displacementOf(X)) /
                            (2 * h);
    // Central differences: h² times a third derivative of up to 9³/6 m, and rounding 1e-16/h.
    CHECK((motionRate(fix, part, Vec3::Zero(), s, X) - difference).norm() < 2e-8);
  }
}

TEST_CASE("The total of a force is exact however its surface is sampled", "[supports]") {
  const Beam beam;
  Load load{.force = Vec3(1.5, -20.0, 0.003)};
  for (const Region &region : {slab(0.099, 0.101), slab(-1, 1), Region(SphereRegion{Vec3(0.05, 0.02, 0.04), 0.013})}) {
    load.region = region;
    for (const double spacing : {0.1, 0.01, 0.0023}) {
      const auto part = beam.load(load, spacing);
      REQUIRE(part);
      CHECK(shapes::sum(part->shares) == Approx(1.0).epsilon(1e-12));
      std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
      addLoadForces(load, *part, 0.25, {}, forces);
      CHECK((total(forces) - 0.25 * load.force).norm() < 1e-12 * load.force.norm());
    }
  }
}

TEST_CASE("A force on a face acts at the centre of the face", "[supports]") {
  const Beam beam;
  const Load load{.region = slab(0.1, 0.101), .force = Vec3(0, -3, 1)};
  const auto part = beam.load(load);
  REQUIRE(part);
  CHECK(part->area == Approx(0.04 * 0.04).epsilon(1e-9));
  std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
  addLoadForces(load, *part, 1.0, {}, forces);
  Vec3 torque = Vec3::Zero();
  for (std::size_t j = 0; j < forces.size(); ++j) torque += beam.positions[j].cross(forces[j]);
  CHECK((torque - Vec3(0.1, 0.02, 0.02).cross(load.force)).norm() < 1e-14);
}

TEST_CASE("A force in a region without surface acts on the volume, a pressure is refused there", "[supports]") {
  Beam beam;
  beam.volumes.back() = 5e-6;
  Load load{.region = BoxRegion{Vec3(0.02, 0.011, 0.011), Vec3(0.06, 0.029, 0.029)}, .force = Vec3(0, 2, 0)};
  const auto part = beam.load(load);
  REQUIRE(part);
  CHECK(part->points.count() == 4 * 2 * 2);
  CHECK(part->area == 0.0);
  std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
  addLoadForces(load, *part, 1.0, {}, forces);
  CHECK((total(forces) - load.force).norm() < 1e-13);

  load.pressure = 100.0;
  const auto refused = beam.load(load);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error(), Contains("surface"));
  // Shares are proportional to the volumes.
  Beam uneven;
  uneven.surface = {};
  uneven.volumes[0] *= 3.0;
  const Load end{.region = BoxRegion{Vec3(0, 0, 0), Vec3(0.01, 0.01, 0.02)}, .force = Vec3(1, 0, 0)};
  const auto two = uneven.load(end);
  REQUIRE(two);
  REQUIRE(two->shares.size() == 2);
  CHECK(two->shares[0] == Approx(0.75));
}

TEST_CASE("A dead pressure pushes into the body with p times the area at rest", "[supports]") {
  const Beam beam;
  const Load load{.region = slab(0.1, 0.101), .pressure = 250.0, .follower = false};
  const auto part = beam.load(load);
  REQUIRE(part);
  shapes::Random random(4);
  const std::vector<Vec3> u = moved(beam.positions, matrix(random), Vec3(1, 0, 0));
  std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
  addLoadForces(load, *part, 0.5, u, forces);
  CHECK((total(forces) - Vec3(-0.5 * 250.0 * 0.04 * 0.04, 0, 0)).norm() < 1e-8 * 0.2);
}

TEST_CASE("A following pressure stands on the deformed face", "[supports]") {
  const Beam beam;
  const Load load{.region = slab(0.1, 0.101), .pressure = 250.0};
  const auto part = beam.load(load);
  REQUIRE(part);
  shapes::Random random(4);
  for (int k = 0; k < 5; ++k) {
    const Mat3 F = matrix(random);
    std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
    addLoadForces(load, *part, 1.0, moved(beam.positions, F, Vec3(1, 0, 0)), forces);
    // The face is spanned by F e_y and F e_z.
    const Vec3 deformed = 0.04 * 0.04 * Vec3(F.col(1)).cross(Vec3(F.col(2)));
    CHECK((total(forces) + 250.0 * deformed).norm() < 1e-8 * 250.0 * deformed.norm());
  }
}

TEST_CASE("A following pressure on a closed surface has no net force and torque and does -p dV of work", "[supports]") {
  const Beam beam;
  const Load load{.pressure = 400.0};
  const auto part = beam.load(load);
  REQUIRE(part);
  const double V = 0.1 * 0.04 * 0.04, A = part->area;
  shapes::Random random(17);
  for (int k = 0; k < 6; ++k) {
    const Mat3 F = matrix(random), rate = matrix(random);
    const std::vector<Vec3> u = moved(beam.positions, F, Vec3(0.3, 0, 0));
    std::vector<Vec3> forces(beam.positions.size(), Vec3::Zero());
    addLoadForces(load, *part, 1.0, u, forces);
    double power = 0.0;
    Vec3 torque = Vec3::Zero();
    for (std::size_t j = 0; j < forces.size(); ++j) {
      power += forces[j].dot(rate * beam.positions[j]);
      torque += (beam.positions[j] + u[j]).cross(forces[j]);
    }
    CHECK(total(forces).norm() < 1e-11 * load.pressure * A);
    CHECK(torque.norm() < 1e-11 * load.pressure * A);
    // dV/dt = V d det(F)/dt, by the cofactor.
    const Mat3 cofactor = F.determinant() * F.inverse().transpose();
    const double volumeRate = V * cofactor.cwiseProduct(rate).sum();
    CHECK(power == Approx(-load.pressure * volumeRate).margin(1e-11 * load.pressure * V));
  }
}

TEST_CASE("A pressure on a ball squeezes it evenly", "[supports]") {
  // Any part of it carries -p times the area vector of that part: a hemisphere p π r².
  const std::vector<Vec3> X = [] {
    std::vector<Vec3> points;
    for (int x = -5; x <= 5; ++x)
      for (int y = -5; y <= 5; ++y)
        for (int z = -5; z <= 5; ++z)
          if (const Vec3 p = kSpacing * Vec3(x, y, z); p.norm() < 0.05) points.push_back(p);
    return points;
  }();
  const Surface ball = shapes::ballSurface(Vec3(0, 0, 0), 0.05, 40);
  const Binder bind = [&](std::span<const Vec3> points, std::span<const Vec3>) {
    return bindToCloud(points, X, serialFor());
  };
  const Load load{.region = HalfSpaceRegion{Vec3::Zero(), Vec3(0, 0, -1)}, .pressure = 100.0};
  const auto part = loadedPart(load, ball, kSpacing, bind, X, {});
  REQUIRE(part);
  std::vector<Vec3> forces(X.size(), Vec3::Zero());
  addLoadForces(load, *part, 1.0, std::vector<Vec3>(X.size(), Vec3::Zero()), forces);
  // The net of 80 meridians is a polygon of 80 sides at the equator: sin(4.5°)/4.5° of the circle's area, 1e-3 less.
  const Vec3 expected(0, 0, -100.0 * std::numbers::pi * 0.05 * 0.05);
  CHECK((total(forces) - expected).norm() < 1.1e-3 * expected.norm());
}

TEST_CASE("A body that is held in part begins to spin about its centre of mass", "[supports]") {
  // The held region ends within cells, so that phyxels there are partly carried.
  const Vec3 low(0, 0, 0), high(0.1, 0.04, 0.04), spin(0, 0, 3);
  const BodyRecipe recipe{.sampling = {.spacing = 0.02}, .fixes = {{.region = slab(-0.01, 0.033)}}};
  Body body("bar", shapes::restState(shapes::box(low, high, 4), recipe),
            Constitution{{Material{}}, kLatticeStabilisation}, serialFor());
  const std::span<const double> carried = body.supportMasses();
  REQUIRE(std::accumulate(carried.begin(), carried.end(), 0.0) > 0.01 * body.totalMass());
  body.setInitialVelocity(Vec3::Zero(), spin);
  const Vec3 centre = 0.5 * (low + high);
  double free = 0;
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 X = body.rest().origin + body.rest().positions[i], v = body.state().velocities[i];
    if (v.isZero()) continue;
    ++free;
    // Lumped masses have the centroid of the box to a hundredth of a spacing; without the carried mass it is 5 mm off.
    CHECK((v - spin.cross(X - centre)).norm() < 0.01 * recipe.sampling.spacing * spin.norm());
  }
  CHECK(free > 10);
}

namespace {

// Springs between patches and their rest positions, in steps like explicit ones: half a kick, drift, correction, half a
// kick.
struct SpringSystem {
  static constexpr double kStep = 1e-3;  // s
  PatchSolver springs;
  std::vector<Vec3> u, v, targets;

  // @param rows       [patches] phyxels, all with the same weight
  // @param stiffness  [patches] k dt²/m, of masses of 1 kg
  SpringSystem(std::size_t phyxels, const std::vector<std::vector<Index>> &rows, const std::vector<double> &stiffness)
      : u(phyxels, Vec3::Zero()), v(phyxels, Vec3::Zero()), targets(rows.size(), Vec3::Zero()) {
    Csr csr;
    csr.offsets.assign(1, 0);
    std::vector<double> weights, k;
    for (const std::vector<Index> &row : rows) {
      csr.indices.insert(csr.indices.end(), row.begin(), row.end());
      csr.offsets.push_back(static_cast<Index>(csr.indices.size()));
      weights.insert(weights.end(), row.size(), 1.0 / static_cast<double>(row.size()));
    }
    for (const double one : stiffness) k.push_back(one / (kStep * kStep));
    springs.set(csr, weights, k, std::vector<double>(phyxels, 1.0));
  }
  void step() {
    springs.kick(0.5 * kStep, v);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += kStep * v[i];
    springs.correct(kStep, targets, u, v);
    springs.kick(0.5 * kStep, v);
  }
};

}  // namespace

TEST_CASE("a support that is soft for a step is a force in it", "[supports]") {
  SECTION("Verlet's method where it is soft, implicit where it is stiff") {
    SpringSystem system(2, {{0}, {1}}, {0.2, 100.0});
    for (Vec3 &v : system.v) v = Vec3(1, 0, 0);
    const double omega2 = 0.2 / (SpringSystem::kStep * SpringSystem::kStep);
    // The exact invariant of Verlet's method: ½ v² + ½ ω² (1 - ω² dt²/4) u².
    const auto energy = [&] {
      return 0.5 * system.v[0].squaredNorm() + 0.5 * omega2 * (1.0 - 0.05) * system.u[0].squaredNorm();
    };
    const double before = energy();
    double most = 0.0;
    for (int k = 0; k < 1000; ++k) {
      system.step();
      REQUIRE(energy() == Approx(before).epsilon(1e-11));
      if (k > 900) most = std::max(most, system.u[1].norm());
    }
    CHECK(system.springs.solvedRows() == 1);
    CHECK(most < 1e-6 * SpringSystem::kStep);
  }
  SECTION("springs that pull at the same phyxels count together") {
    const std::vector<Index> both{0, 1};
    for (const std::size_t count : {2u, 4u}) {
      SpringSystem system(2, std::vector<std::vector<Index>>(count, both), std::vector<double>(count, 0.2));
      system.step();
      CHECK(system.springs.solvedRows() == (count == 2 ? 0 : 4));
    }
  }
  SECTION("a bar that is held in its soft half rests where its static solution does") {
    const Surface surface = shapes::boxSurface(Vec3(0, 0, 0), Vec3(0.1, 0.02, 0.02));
    const auto rest = shapes::restState(
        shapes::inside(surface),
        {.sampling = {.spacing = 0.01, .materials = {{HalfSpaceRegion{Vec3(0.05, 0, 0), Vec3(-1, 0, 0)}, 1}}},
         .fixes = {{.region = slab(-0.01, 0.014)}},
         .loads = {{.region = slab(0.0999, 0.11), .force = Vec3(0.02, 0, -0.002)}}});
    const Constitution constitution{{shapes::rubber(1e4), shapes::rubber(1e7)}, kLatticeStabilisation};
    std::array<Vec3, 2> ends;
    for (const bool isStatic : {false, true}) {
      Simulator simulator;
      simulator.setWorld({.gravity = Vec3::Zero(),
                          .integrator = isStatic ? Integrator::quasiStatic : Integrator::explicitVerlet,
                          .damping = 20.0});
      const std::size_t id = simulator.addBody(std::make_unique<Body>("bar", rest, constitution, serialFor()));
      simulator.world().addProbe("end", id, Vec3(0.1, 0.01, 0.01));
      while (isStatic ? !simulator.finished() : simulator.time() < 1.5) REQUIRE(simulator.step());
      ends[isStatic ? 1 : 0] =
          simulator.world().probeState(simulator.world().probes().front()).position - Vec3(0.1, 0.01, 0.01);
      const PatchSolver &patches = std::as_const(*simulator.body(id)).patches();
      REQUIRE(patches.rows() > 0);
      if (!isStatic) CHECK(patches.solvedRows() == 0);
    }
    CHECK(ends[1].norm() > 1e-3);
    // Of the static force a thousandth of a per cent remains (solver.tolerance), and e^-15 of the initial oscillation.
    CHECK((ends[0] - ends[1]).norm() < 1e-4 * ends[1].norm());
  }
}
