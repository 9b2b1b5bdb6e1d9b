// SPDX-License-Identifier: Apache-2.0
#include "pointbased/occupancy.h"

#include <Eigen/LU>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/simulator.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace lattice_cases;

namespace {

struct Voxels {
  std::array<std::size_t, 3> size{};
  Vec3 origin = Vec3::Zero();
  Mat3 steps = Mat3::Identity();
  std::vector<float> fill;

  [[nodiscard]] Vec3 middle(std::size_t v) const {
    return origin + steps * Vec3(static_cast<double>(v % size[0]), static_cast<double>(v / size[0] % size[1]),
                                 static_cast<double>(v / (size[0] * size[1])));
  }
  [[nodiscard]] double voxelVolume() const { return std::abs(steps.determinant()); }
  [[nodiscard]] double volume() const {
    double total = 0.0;
    for (const float f : fill) total += static_cast<double>(f);
    return total * voxelVolume();
  }
  [[nodiscard]] Vec3 centroid() const {
    Vec3 total = Vec3::Zero();
    for (std::size_t v = 0; v < fill.size(); ++v) total += static_cast<double>(fill[v]) * middle(v);
    return total * voxelVolume() / volume();
  }
  /// ∫ (x - c)(x - c)^T dV of evenly filled voxels.
  [[nodiscard]] Mat3 secondMoments() const {
    Mat3 total = volume() / 12.0 * steps * steps.transpose();
    const Vec3 c = centroid();
    for (std::size_t v = 0; v < fill.size(); ++v)
      total += static_cast<double>(fill[v]) * voxelVolume() * (middle(v) - c) * (middle(v) - c).transpose();
    return total;
  }
  [[nodiscard]] Occupancy view() const { return {size, fill, origin, steps}; }
  [[nodiscard]] BodyShape shape(Surface surface = {}) const {
    auto found = shapeOf(view(), std::move(surface));
    if (!found) throw std::runtime_error(found.error());
    return std::move(*found);
  }
};

// A grid about a point, filled by a function of the position.
template <class Inside>
Voxels voxels(std::array<std::size_t, 3> size, const Vec3 &centre, const Mat3 &steps, const Inside &inside) {
  Voxels v;
  v.size = size;
  v.steps = steps;
  v.origin = centre - steps * (0.5 * Vec3(static_cast<double>(size[0] - 1), static_cast<double>(size[1] - 1),
                                          static_cast<double>(size[2] - 1)));
  v.fill.resize(size[0] * size[1] * size[2]);
  for (std::size_t i = 0; i < v.fill.size(); ++i) v.fill[i] = static_cast<float>(inside(v.middle(i)));
  return v;
}

Mat3 along(const Vec3 &spacing) { return spacing.asDiagonal(); }
Mat3 oblique(const Vec3 &spacing) { return rotation(0, 25) * rotation(2, 40) * along(spacing); }
Mat3 leftHanded(const Vec3 &spacing) { return oblique(Vec3(spacing[0], spacing[1], -spacing[2])); }
Mat3 tilted(const Vec3 &spacing) {
  Mat3 steps = oblique(spacing);
  steps.col(2) += 0.4 * steps.col(1);
  return steps;
}

Mat3 secondMoments(const LatticeBody &body) {
  const double volume = sum(body.volumes);
  Vec3 c = Vec3::Zero();
  Mat3 total = Mat3::Zero();
  for (std::size_t i = 0; i < body.positions.size(); ++i) c += body.volumes[i] * body.positions[i] / volume;
  for (std::size_t i = 0; i < body.positions.size(); ++i)
    total += body.volumes[i] * (body.positions[i] - c) * (body.positions[i] - c).transpose();
  return total;
}

// Tr ∫ (x - c)(x - c)^T dV by the evaluation points.
double spreadOf(const LatticeBody &body, const Vec3 &c) {
  double total = 0.0;
  for (std::size_t q = 0; q < body.pointCentres.size(); ++q)
    total += body.stencils.volumes[q] *
             ((body.origin + body.pointCentres[q] - c).squaredNorm() + body.stencils.variances[q].sum());
  return total;
}

void checkSound(const LatticeBody &body, const Voxels &v) {
  CHECK_THAT(body.countedVolume, WithinRel(v.volume(), 0.01));
  CHECK_THAT(sum(body.volumes), WithinRel(v.volume(), 1e-12));
  CHECK_THAT(sum(body.weightVolumes), WithinRel(v.volume(), 1e-12));
  CHECK_THAT(sum(body.stencils.volumes), WithinRel(v.volume(), 1e-12));
  CHECK(consistencyOf(body).worst() < 1e-9);
  Vec3 centre = Vec3::Zero();
  for (std::size_t q = 0; q < body.pointCentres.size(); ++q) centre += body.stencils.volumes[q] * body.pointCentres[q];
  CHECK((body.origin + centre / v.volume() - v.centroid()).norm() < 0.02 * body.spacing);
  CHECK_THAT(spreadOf(body, v.centroid()), WithinRel(v.secondMoments().trace(), 0.01));
  for (const double part : body.volumes) CHECK(part > 0.0);
}

}  // namespace

TEST_CASE("a ball of voxels keeps volume, centre and second moments at any spacing, on any grid") {
  const Vec3 centre(0.3, -0.2, 1.1);
  const auto inside = [&](const Vec3 &x) { return (x - centre).norm() < 0.05 ? 1.0 : 0.0; };
  struct Grid {
    const char *name;
    Voxels voxels;
  };
  for (const Grid &grid :
       {Grid{"along the axes", voxels({52, 52, 52}, centre, along(Vec3::Constant(0.002)), inside)},
        Grid{"oblique, uneven", voxels({80, 62, 30}, centre, oblique(Vec3(0.0014, 0.002, 0.0045)), inside)},
        Grid{"left-handed", voxels({80, 62, 30}, centre, leftHanded(Vec3(0.0014, 0.002, 0.0045)), inside)},
        Grid{"sheared", voxels({80, 80, 30}, centre, tilted(Vec3(0.0014, 0.002, 0.0045)), inside)}})
    for (const double spacing : {0.03, 0.0137, 0.006}) {
      INFO(grid.name << ", spacing " << spacing);
      const LatticeBody body = filled(grid.voxels.shape(), withSpacing(spacing));
      checkSound(body, grid.voxels);
      CHECK(body.components == 1);
      // Masses have the inertia of a true ball on this lattice.
      const Mat3 wanted = secondMoments(filled(ball(centre, 0.05), withSpacing(spacing)));
      CHECK((secondMoments(body) - wanted).norm() < 0.02 * wanted.norm());
    }
}

TEST_CASE("a lattice turned against its voxels finds all of them") {
  const Voxels v =
      voxels({40, 20, 16}, Vec3::Zero(), oblique(Vec3(0.003, 0.003, 0.004)), [](const Vec3 &) { return 1.0; });
  LatticeSampling sampling = withSpacing(0.0113);
  checkSound(filled(v.shape(), sampling), v);
  sampling.axes = rotation(0, 25) * rotation(2, 40);
  checkSound(filled(v.shape(), sampling), v);
  sampling.refinements = {{HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}, 0.006}};
  checkSound(filled(v.shape(), sampling), v);
}

TEST_CASE("parts of voxels count as parts") {
  // A box whose border voxels are filled to 0.3; between cells, and within one.
  const auto fill = [](const Vec3 &x) {
    const double off = std::max({std::abs(x[0]) / 0.0305, std::abs(x[1]) / 0.0205, std::abs(x[2]) / 0.0105});
    return off > 1.1 ? 0.0 : std::abs(x[0]) > 0.029 ? 0.3 : 1.0;
  };
  const Voxels v = voxels({80, 60, 40}, Vec3(0.0, 0.0, 0.0), along(Vec3::Constant(0.001)), fill);
  for (const double spacing : {0.02, 0.0043, 0.0021}) {
    INFO("spacing " << spacing);
    checkSound(filled(v.shape(), withSpacing(spacing)), v);
  }
  // A sheet that fills its voxels to a fifth everywhere is still one body.
  const Voxels sheet = voxels({40, 40, 5}, Vec3::Zero(), oblique(Vec3::Constant(0.002)), [&](const Vec3 &x) {
    return std::abs((oblique(Vec3::Ones()).transpose() * x)[2]) < 0.001 ? 0.2 : 0.0;
  });
  for (const double spacing : {0.007, 0.004}) {
    const LatticeBody body = filled(sheet.shape(), withSpacing(spacing));
    INFO("sheet, spacing " << spacing);
    // Parts of less than a fiftieth of a cell are dropped, and this sheet consists of such parts.
    CHECK_THAT(body.countedVolume, WithinRel(sheet.volume(), 0.1));
    CHECK_THAT(sum(body.volumes), WithinRel(sheet.volume(), 1e-12));
    CHECK(body.components == 1);
  }
}

TEST_CASE("plates and bars of one voxel stay in one piece with their volume") {
  for (const Mat3 &steps :
       {along(Vec3::Constant(0.002)), oblique(Vec3(0.002, 0.002, 0.003)), leftHanded(Vec3(0.0015, 0.002, 0.003))}) {
    const Mat3 turn = steps * steps.colwise().norm().cwiseInverse().asDiagonal();
    const auto plate = voxels({50, 50, 9}, Vec3::Zero(), steps,
                              [&](const Vec3 &x) { return std::abs((turn.transpose() * x)[2]) < 0.001 ? 1.0 : 0.0; });
    const auto bar = voxels({60, 9, 9}, Vec3::Zero(), steps, [&](const Vec3 &x) {
      const Vec3 y = turn.transpose() * x;
      return std::abs(y[1]) < 0.001 && std::abs(y[2]) < 0.001 ? 1.0 : 0.0;
    });
    // An oblique plate through its voxels, one to two thick.
    const Vec3 n = Vec3(0.3, 0.5, 1.0).normalized();
    const auto slanted = voxels({50, 50, 40}, Vec3::Zero(), steps,
                                [&](const Vec3 &x) { return std::abs(n.dot(x)) < 0.0025 ? 1.0 : 0.0; });
    for (const Voxels *v : {&plate, &bar, &slanted})
      for (const double spacing : {0.01, 0.006, 0.0035}) {
        INFO("volume " << v->volume() << ", spacing " << spacing);
        const LatticeBody body = filled(v->shape(), withSpacing(spacing));
        // Of such a thin body, parts of less than a fiftieth of a cell are dropped before the rest is scaled.
        CHECK_THAT(body.countedVolume, WithinRel(v->volume(), v == &bar ? 0.2 : 0.02));
        CHECK_THAT(sum(body.volumes), WithinRel(v->volume(), 1e-12));
        CHECK(body.components == 1);
        CHECK(consistencyOf(body).worst() < 1e-9);
      }
  }
}

TEST_CASE("a gap of one voxel separates, at spacings ten times as wide too") {
  for (const Mat3 &steps : {along(Vec3::Constant(0.001)), oblique(Vec3::Constant(0.001))}) {
    const Mat3 turn = 1000.0 * steps;
    const auto blobs = [&](double gap) {
      return voxels({60, 30, 30}, Vec3::Zero(), steps, [&, gap](const Vec3 &x) {
        const Vec3 y = turn.transpose() * x;
        return std::abs(y[0]) < 0.025 && std::abs(y[1]) < 0.012 && std::abs(y[2]) < 0.012 && !(y[0] > 0.0 && y[0] < gap)
                   ? 1.0
                   : 0.0;
      });
    };
    for (const double spacing : {0.01, 0.004, 0.0017}) {
      INFO("spacing " << spacing);
      const Voxels apart = blobs(0.001);
      const LatticeBody two = filled(apart.shape(), withSpacing(spacing));
      CHECK(two.components == 2);
      CHECK_THAT(two.countedVolume, WithinRel(apart.volume(), 0.01));
      CHECK(filled(blobs(0.0).shape(), withSpacing(spacing)).components == 1);
    }
    // Clouds: no pair acts across the gap.
    const auto rest =
        shapes::restState(blobs(0.001).shape(), {.evaluation = Evaluation::phyxels, .sampling = {.spacing = 0.004}});
    CHECK(rest->components == 2);
  }
}

TEST_CASE("distances never reach beyond the border, and end on it") {
  const Vec3 centre(0.1, 0.2, 0.3);
  const Voxels v = voxels({40, 30, 20}, centre, oblique(Vec3(0.001, 0.0015, 0.002)),
                          [&](const Vec3 &x) { return (x - centre).norm() < 0.012 ? 1.0 : 0.0; });
  const BodyShape shape = v.shape();
  support::Random random(5);
  std::size_t near = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 x = centre + 0.018 * random.vector();
    double distance = 0.0, inside = 0.0;
    shape.surfaceDistance({&x, 1}, {&distance, 1});
    shape.inside({&x, 1}, {&inside, 1});
    // By all voxels of the other kind: boxes.
    double true_ = 1e300;
    for (std::size_t u = 0; u < v.fill.size(); ++u) {
      if ((v.fill[u] > 0.5f) == (inside > 0.5)) continue;
      const Vec3 index = v.steps.inverse() * (x - v.middle(u));
      const Vec3 beyond = (index.cwiseAbs() - Vec3::Constant(0.5)).cwiseMax(0.0);
      true_ = std::min(true_, beyond.cwiseProduct(v.steps.colwise().norm().transpose()).norm());
    }
    if (true_ > 1e299) continue;
    CHECK(distance <= true_ * (1.0 + 1e-6) + 1e-12);
    // Between the centres of two voxels the error is at most their half diagonals.
    if (inside > 0.5) CHECK(distance >= true_ - 0.003);
    if (true_ < 0.0005) {
      CHECK_THAT(distance, WithinAbs(true_, 1e-9));
      ++near;
    }
  }
  CHECK(near > 10);
}

TEST_CASE("a cantilever of voxels bends, and sags by its weight, as the one in a mesh") {
  const Vec3 min(0.0, -0.02, -0.02), max(0.2, 0.02, 0.02);
  const Surface skin = shapes::boxSurface(min, max, 8);
  const BodyShape mesh = box(min, max);
  const auto full = [](const Vec3 &) { return 1.0; };
  const Voxels v = voxels({100, 20, 20}, 0.5 * (min + max), along(Vec3::Constant(0.002)), full);
  for (const double spacing : {0.04 / 3, 0.011, 0.007}) {
    INFO("spacing " << spacing);
    LatticeSampling sampling = withSpacing(spacing);
    sampling.held = {HalfSpaceRegion{Vec3(0.0, 0, 0), Vec3::UnitX()}};
    const Region end = BoxRegion{Vec3(0.2, -1, -1), Vec3(0.3, 1, 1)};
    const LatticeBody meshed = filled(mesh, sampling), voxelised = filled(v.shape(skin), sampling);
    CHECK(meshed.positions.size() == voxelised.positions.size());
    CHECK(meshed.held[0].phyxels.size() == voxelised.held[0].phyxels.size());
    const double tip = solveLinear(meshed, mesh, end, Vec3(0, 0, -0.1)).tip;
    const double voxelTip = solveLinear(voxelised, v.shape(skin), end, Vec3(0, 0, -0.1)).tip;
    // Small cells of a mesh use only the nearer face, at the beam's edges too: they count 0.3 % too much there.
    CHECK_THAT(voxelTip, WithinRel(tip, 0.006));
  }

  const auto sag = [&](const BodyShape &shape, Evaluation evaluation) {
    BodyRecipe recipe{.evaluation = evaluation, .sampling = {.spacing = 0.011}};
    recipe.fixes.push_back(
        {HalfSpaceRegion{Vec3(0.007, 0, 0), Vec3::UnitX()}, Vec3::Zero(), Vec3::Zero(), std::nullopt, 0.0});
    auto rest =
        buildRestState(shape, recipe, std::vector<Vec3>(shape.surface.positions.size(), Vec3::UnitX()), serialFor());
    if (!rest) throw std::runtime_error(rest.error());
    Constitution constitution{.materials = {Material{}}};
    constitution.materials[0].youngsModulus = 1e6;
    constitution.materials[0].restDensity = 1000.0;
    constitution.stabilisation = evaluation == Evaluation::phyxels ? kCloudStabilisation : kLatticeStabilisation;
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, 0, -9.81), .integrator = Integrator::quasiStatic, .loadSteps = 1});
    const std::size_t id = simulator.addBody(std::make_unique<Body>("beam", *rest, constitution, serialFor()));
    simulator.world().addProbe("end", id, Vec3(0.2, 0, 0));
    while (!simulator.finished())
      if (const auto done = simulator.step(); !done) throw std::runtime_error(done.error().text);
    return simulator.world().probeState(simulator.world().probes()[0]).position[2];
  };
  const Voxels oblong =
      voxels({104, 88, 60}, 0.5 * (min + max), oblique(Vec3(0.0018, 0.0018, 0.0018)), [&](const Vec3 &x) {
        return ((x - 0.5 * (min + max)).cwiseAbs() - 0.5 * (max - min)).maxCoeff() < 0.0 ? 1.0 : 0.0;
      });
  const double meshed = sag(mesh, Evaluation::stressPoints);
  CHECK(meshed < -0.001);
  CHECK_THAT(sag(v.shape(skin), Evaluation::stressPoints), WithinRel(meshed, 0.01));
  CHECK_THAT(sag(v.shape(skin), Evaluation::phyxels), WithinRel(sag(mesh, Evaluation::phyxels), 0.02));
  // A border that is uneven by half of 1/22 of the thickness everywhere, evenly to both sides.
  REQUIRE_THAT(oblong.volume(), WithinRel(0.2 * 0.04 * 0.04, 0.003));
  CHECK_THAT(sag(oblong.shape(skin), Evaluation::stressPoints), WithinRel(meshed, 0.015));
}

TEST_CASE("clouds share the voxels' volume, parts of voxels in part") {
  const Voxels v = voxels({50, 50, 50}, Vec3(0.1, 0, 0), oblique(Vec3(0.002, 0.0025, 0.003)), [](const Vec3 &x) {
    return std::clamp(0.5 + (0.05 - (x - Vec3(0.1, 0, 0)).norm()) / 0.0025, 0.0, 1.0);
  });
  for (const double spacing : {0.02, 0.009}) {
    const auto cloud = fill(v.shape(), {spacing, 0}, serialFor());
    REQUIRE(cloud);
    INFO("spacing " << spacing << ", phyxels " << cloud->positions.size());
    CHECK_THAT(sum(cloud->volumes), WithinRel(v.volume(), 1e-12));
    CHECK_THAT(cloud->countedVolume, WithinRel(v.volume(), 0.01));
  }
}

TEST_CASE("the same lattice comes from any number of threads") {
  const Voxels v = voxels({60, 50, 40}, Vec3::Zero(), oblique(Vec3(0.002, 0.002, 0.003)),
                          [](const Vec3 &x) { return x.norm() < 0.045 && x.head<2>().norm() > 0.01 ? 1.0 : 0.0; });
  const LatticeSampling sampling{.count = 500};
  const LatticeBody alone = filled(v.shape(), sampling);
  const auto shape = shapeOf(v.view(), {}, threadedFor(3));
  REQUIRE(shape);
  const LatticeBody threaded = filled(*shape, sampling, threadedFor(3));
  CHECK(alone.volumes == threaded.volumes);
  CHECK(alone.positions.size() == threaded.positions.size());
  CHECK_THAT(static_cast<double>(alone.positions.size()), WithinRel(500.0, 0.05));
}

TEST_CASE("occupancies are refused with the reason") {
  Voxels v = voxels({3, 2, 2}, Vec3::Zero(), along(Vec3::Constant(0.01)), [](const Vec3 &) { return 1.0; });
  REQUIRE(shapeOf(v.view()));
  Occupancy wrong = v.view();
  wrong.size[0] = 4;
  CHECK_THAT(shapeOf(wrong).error(), Contains("12 values for a grid of 4 x 2 x 2"));
  wrong = v.view();
  wrong.steps.col(1) = wrong.steps.col(0);
  CHECK_THAT(shapeOf(wrong).error(), Contains("span no volume"));
  wrong = v.view();
  wrong.origin[1] = std::nan("");
  CHECK_FALSE(shapeOf(wrong));
  v.fill[7] = 1.5f;
  CHECK_THAT(shapeOf(v.view()).error(), Contains("voxel (1, 0, 1)") && Contains("1.5"));
  v.fill[7] = std::nanf("");
  CHECK_FALSE(shapeOf(v.view()));
  v.fill.assign(12, 0.0f);
  CHECK_THAT(shapeOf(v.view()).error(), Contains("no voxel"));
}
