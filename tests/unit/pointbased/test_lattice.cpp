// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <numeric>
#include <utility>

#include "lattice_cases.h"
#include "support/catch.h"

using namespace lattice_cases;

namespace {

const BodyShape &beam() {
  static const BodyShape shape = box(Vec3(0, -0.02, -0.02), Vec3(0.2, 0.02, 0.02));
  return shape;
}

struct Case {
  const char *name;
  BodyShape shape;
  LatticeSampling sampling;
};

std::vector<Case> cases() {
  const auto turned = [](double spacing, double jitter = 0.0) {
    LatticeSampling s = withSpacing(spacing);
    s.axes = rotation(0, 20) * rotation(1, 35) * rotation(2, 15);
    s.jitter = jitter;
    return s;
  };
  LatticeSampling jittered = withSpacing(0.01);
  jittered.jitter = 0.25;
  const auto quadratic = [](LatticeSampling s) {
    s.order = LatticeOrder::quadratic;
    return s;
  };
  return {{"beam", beam(), withSpacing(0.01)},
          {"beam beside the lattice", shifted(beam(), 0.01, Vec3(0.37, 0.21, 0.43)), withSpacing(0.01)},
          {"beam turned", beam(), turned(0.01)},
          {"beam jittered", beam(), jittered},
          {"ball", ball(Vec3(0.1, 0.2, 0.3), 0.05), withSpacing(0.0125)},
          {"ball turned and jittered", ball(Vec3(0.1, 0.2, 0.3), 0.05), turned(0.01, 0.3)},
          {"horseshoe", shapes::horseshoe(), withSpacing(0.03)},
          {"beam turned, second order", beam(), quadratic(turned(0.01))},
          {"ball, second order", ball(Vec3(0.1, 0.2, 0.3), 0.05), quadratic(withSpacing(0.0125))},
          {"horseshoe, second order", shapes::horseshoe(), quadratic(withSpacing(0.03))}};
}

Vec3 centreOfMass(const LatticeBody &body) {
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < body.positions.size(); ++i) centre += body.volumes[i] * body.positions[i];
  return body.origin + centre / sum(body.volumes);
}

}  // namespace

TEST_CASE("stencils of a lattice reproduce affine fields and their modes see none") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    CHECK(consistencyOf(body).worst() < 1e-12);
    CHECK(body.stencils.rank == std::vector<std::uint8_t>(body.stencils.pointCount(), 3));
    CHECK(body.stencils.modes.size() == body.stencils.phyxels.indices.size());
    CHECK(body.stencils.entriesOfPhyxel.rows() == body.positions.size());
  }
}

TEST_CASE("volumes of phyxels and of points sum to the volume of the body") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    CHECK_THAT(sum(body.volumes), WithinRel(c.shape.volume, 1e-12));
    CHECK_THAT(sum(body.stencils.volumes), WithinRel(c.shape.volume, 1e-12));
    CHECK(*std::min_element(body.volumes.begin(), body.volumes.end()) > 0.0);
    CHECK(*std::min_element(body.stencils.volumes.begin(), body.stencils.volumes.end()) > 0.0);
    CHECK(body.components == 1);
  }
}

TEST_CASE("the mass of a body on a lattice lies where the body does") {
  CHECK((centreOfMass(filled(beam(), withSpacing(0.01))) - Vec3(0.1, 0, 0)).norm() < 1e-12);
  // Slivers distribute evenly, which pulls outwards by some thousandths of the spacing.
  const BodyShape beside = shifted(beam(), 0.01, Vec3(0.37, 0.21, 0.43));
  CHECK((centreOfMass(filled(beside, withSpacing(0.01))) - Vec3(0.1, 0, 0)).norm() < 1e-4);
  CHECK((centreOfMass(filled(ball(Vec3(0.1, 0.2, 0.3), 0.05), withSpacing(0.0125))) - Vec3(0.1, 0.2, 0.3)).norm() <
        1e-12);
}

TEST_CASE("weights are the means of the functions, with the volume and centre of the body") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    CHECK_THAT(sum(body.weightVolumes), WithinRel(c.shape.volume, 1e-12));
    // As at the corners of hexahedra of 20 nodes, integrals of functions of second order may be negative.
    if (c.sampling.order == LatticeOrder::linear)
      CHECK(*std::min_element(body.weightVolumes.begin(), body.weightVolumes.end()) > 0.0);
    Vec3 centre = Vec3::Zero(), ofPoints = Vec3::Zero();
    for (std::size_t i = 0; i < body.positions.size(); ++i) centre += body.weightVolumes[i] * body.positions[i];
    for (std::size_t q = 0; q < body.stencils.pointCount(); ++q)
      ofPoints += body.stencils.volumes[q] * body.pointCentres[q];
    CHECK((centre - ofPoints).norm() < 1e-9 * c.shape.volume);
  }
}

TEST_CASE("inside of a body every phyxel has the mass of a cell") {
  const double d = 0.01;
  const LatticeBody body = filled(shapes::box(Vec3::Constant(-0.05), Vec3::Constant(0.05)), withSpacing(d));
  for (std::size_t i = 0; i < body.positions.size(); ++i)
    if (body.positions[i].cwiseAbs().maxCoeff() < 0.02 + 1e-9) CHECK_THAT(body.volumes[i], WithinRel(d * d * d, 1e-9));
}

TEST_CASE("bars of few cells have their inertia, by the weights of end-corrected quadratures") {
  const double a = 0.04;
  for (const int n : {2, 3, 5, 8}) {
    INFO(n << " cells across");
    const LatticeBody body = filled(shapes::box(Vec3(0, -a / 2, -a / 2), Vec3(0.4, a / 2, a / 2)), withSpacing(a / n));
    double ours = 0.0, uncorrected = 0.0;
    for (std::size_t i = 0; i < body.positions.size(); ++i) {
      const Vec3 X = body.positions[i] + body.origin;
      ours += body.volumes[i] * (X[1] * X[1] + X[2] * X[2]);
      uncorrected += body.weightVolumes[i] * (X[1] * X[1] + X[2] * X[2]);
    }
    const double truth = 0.4 * a * a * (a * a + a * a) / 12.0;
    CHECK_THAT(uncorrected / truth, WithinRel(1.0 + 2.0 / (n * n), 1e-9));
    // The edges of the bar transfer no more than 0.45 of their mass, which leaves a quarter of the surplus at two
    // cells.
    CHECK(ours / truth > 1.0 - 1e-9);
    CHECK(ours / truth < 1.0 + 0.5 / (n * n));
  }
}

TEST_CASE("oblique bars have their inertia, at every section") {
  // Without MomentErrors the polar moment is 8 to 11 % too large at three cells across: corners of cut cells have no
  // mass to spare.
  const double a = 0.04, length = 0.24;
  const bool isQuadratic = GENERATE(false, true);
  for (const int n : {3, 5})
    for (const double angle : {10.0, 20.0, 30.0, 45.0}) {
      INFO(n << " cells across, turned by " << angle << (isQuadratic ? ", second order" : ", first order"));
      LatticeSampling sampling = withSpacing(a / n);
      sampling.axes = rotation(0, angle) * rotation(1, 0.7 * angle) * rotation(2, 0.4 * angle);
      sampling.order = isQuadratic ? LatticeOrder::quadratic : LatticeOrder::linear;
      const BodyShape shape = shapes::box(Vec3(-length, -a, -a) / 2, Vec3(length, a, a) / 2);
      const LatticeBody body = filled(shape, sampling);
      // Weighted by hat functions along the bar.
      std::array<double, 4> sections{};
      Mat3 second = Mat3::Zero();
      for (std::size_t i = 0; i < body.positions.size(); ++i) {
        const Vec3 X = body.positions[i] + body.origin;
        second += body.volumes[i] * X * X.transpose();
        const double u = (X[0] / length + 0.5) * 3.0;
        for (std::size_t k = 0; k < 4; ++k)
          sections[k] +=
              std::max(0.0, 1.0 - std::abs(u - static_cast<double>(k))) * body.volumes[i] * (X[1] * X[1] + X[2] * X[2]);
      }
      const double across = length * a * a * a * a / 12.0, along = length * length * length * a * a / 12.0;
      CHECK_THAT((second(1, 1) + second(2, 2)) / (2.0 * across), WithinAbs(1.0, 0.02));
      CHECK_THAT(second(0, 0) / along, WithinAbs(1.0, 3e-3));
      for (const std::size_t k : {1u, 2u}) CHECK_THAT(sections[k] / (2.0 * across / 3.0), WithinAbs(1.0, 0.04));
      CHECK(centreOfMass(body).norm() < 1e-3 * a / n);
    }
}

TEST_CASE("a ball of few cells has its inertia") {
  // Without MomentErrors it is 9 % too large.
  for (const double spacing : {0.01, 0.0085, 0.006}) {
    INFO("spacing " << spacing);
    const double radius = 0.027;
    const LatticeBody body = filled(ball(Vec3::Zero(), radius), withSpacing(spacing));
    Mat3 second = Mat3::Zero();
    double mass = 0.0;
    for (std::size_t i = 0; i < body.positions.size(); ++i) {
      const Vec3 X = body.positions[i] + body.origin;
      second += body.volumes[i] * X * X.transpose();
      mass += body.volumes[i];
    }
    CHECK_THAT(second.trace() / (0.6 * mass * radius * radius), WithinAbs(1.0, 0.02));
  }
}

TEST_CASE("second order: each part of a body keeps its mass and centre") {
  // Two bars of different thickness, half a cell apart, oblique to the lattice.
  const BodyShape thin = box(Vec3(-0.1, 0.005, -0.01), Vec3(0.1, 0.025, 0.01)),
                  thick = box(Vec3(-0.1, -0.04, -0.02), Vec3(0.1, 0.0, 0.02));
  LatticeSampling sampling = withSpacing(0.01);
  sampling.axes = rotation(0, 20) * rotation(1, 15) * rotation(2, 10);
  sampling.order = LatticeOrder::quadratic;
  const LatticeBody body = filled(together(thin, thick), sampling);
  REQUIRE(body.components == 2);
  // Phyxels of one point have the same component.
  std::vector<Index> component(body.positions.size());
  std::iota(component.begin(), component.end(), Index{0});
  const auto &rows = body.stencils.phyxels;
  for (bool isChanged = true; isChanged;) {
    isChanged = false;
    for (std::size_t q = 0; q < body.stencils.pointCount(); ++q) {
      const auto row = std::span(rows.indices).subspan(rows.offsets[q], rows.offsets[q + 1] - rows.offsets[q]);
      Index least = component[row.front()];
      for (const Index i : row) least = std::min(least, component[i]);
      for (const Index i : row) isChanged = std::exchange(component[i], least) != least || isChanged;
    }
  }
  struct Part {
    double mass = 0.0, weight = 0.0;
    Vec3 first = Vec3::Zero(), ofWeight = Vec3::Zero();
  };
  std::map<Index, Part> parts;
  for (std::size_t i = 0; i < component.size(); ++i) {
    Part &part = parts[component[i]];
    part.mass += body.volumes[i];
    part.first += body.volumes[i] * body.positions[i];
    part.weight += body.weightVolumes[i];
    part.ofWeight += body.weightVolumes[i] * body.positions[i];
  }
  REQUIRE(parts.size() == 2);
  for (const auto &[root, part] : parts) {
    CHECK_THAT(part.mass, WithinRel(part.weight, 1e-12));
    CHECK((part.first / part.mass - part.ofWeight / part.weight).norm() < 1e-5);
  }
}

TEST_CASE("corners of thin bodies are no lighter than their stiffness allows") {
  // Oblique needles and plates, one to three cells thick, with corners that only slivers reach. Where every corner
  // gives up to 0.45 of its share, Σ v |g|² d² over the volume is 2.9 … 5.4 in every one of them.
  const double d = 0.01;
  for (const double width : {0.0, 0.05})
    for (const double half : {0.004, 0.008, 0.012})
      for (const double angle : {10.0, 25.0, 40.0}) {
        INFO("half a thickness " << half << ", width " << width << ", turned by " << angle);
        LatticeSampling sampling = withSpacing(d);
        sampling.axes = rotation(1, angle) * rotation(2, 0.7 * angle);
        const Vec3 corner(0.06, std::max(half, width), half);
        const BodyShape shape = shapes::box(-corner, corner);
        const LatticeBody body = filled(shape, sampling);
        std::vector<double> stiffness(body.positions.size(), 0.0);
        const StencilSet &s = body.stencils;
        for (std::size_t q = 0; q < s.pointCount(); ++q)
          for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
            stiffness[s.phyxels.indices[e]] += s.volumes[q] * s.gradients[e].squaredNorm() * d * d;
        double most = 0.0;
        for (std::size_t i = 0; i < stiffness.size(); ++i) most = std::max(most, stiffness[i] / body.volumes[i]);
        CHECK(most < 2.8 * (1.0 + 1e-6));
        CHECK_THAT(sum(body.volumes), WithinRel(shape.volume, 1e-12));
        CHECK(centreOfMass(body).norm() < 1e-4 * d);
      }
}

TEST_CASE("a constant stress is in balance with its tractions on the surface") {
  // Aligned boxes are exact; the rest is the quadrature of the tractions. Slanted and round cuts are measured by 4³
  // points, which leaves about a hundredth of spacing² at a corner; slivers of two hundredths of a cell are left out.
  for (const Case &c : cases()) {
    if (c.shape.surface.triangles.empty()) continue;
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    const bool aligned = (!c.sampling.axes || c.sampling.axes->isIdentity(0.0)) &&
                         !std::string(c.name).starts_with("ball") && c.name != std::string("beam beside the lattice");
    CHECK(patchError(body, c.shape) < (aligned ? 1e-3 : 0.03));
  }
}

TEST_CASE("binding on a lattice follows affine motions wherever the point lies") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    shapes::Random random(7);
    std::vector<Vec3> points, normals;
    for (int i = 0; i < 200; ++i) {
      points.push_back(0.8 * random.vector().cwiseProduct(c.shape.max - c.shape.min));
      normals.push_back(random.vector().normalized());
    }
    // Rounding grows with the functions, which grow outside of the body with the square of the distance and more.
    CHECK(bindingError(body, points, {}) < 1e-10);
    CHECK(bindingError(body, points, normals) < 1e-10);
    const std::vector<Vec3> far{Vec3(1e3, 0, 0), Vec3(-4, 1e6, 20)};
    const Interpolation bound = body.cells->bind(far, {}, serialFor());
    CHECK(bound.count() == 2);
    for (const double w : bound.weights) CHECK(std::isfinite(w));
  }
}

TEST_CASE("a box whose edges are multiples of the spacing has phyxels on its faces and full cells") {
  const LatticeBody body = filled(beam(), withSpacing(0.01));
  REQUIRE(body.positions.size() == 21 * 5 * 5);
  REQUIRE(body.stencils.pointCount() == 20 * 4 * 4);
  for (const double v : body.stencils.volumes) CHECK_THAT(v, WithinRel(1e-6, 1e-9));
  for (const Vec3 &s : body.stencils.variances) CHECK((s - Vec3::Constant(1e-4 / 12.0)).norm() < 1e-12);
  double top = -1.0;
  for (const Vec3 &X : body.positions) top = std::max(top, (body.origin + X)[2]);
  CHECK_THAT(top, WithinAbs(0.02, 1e-12));
}

TEST_CASE("a cut cell stands for what is inside it") {
  // Faces of the box are at 0.3 of a cell on either side.
  const LatticeBody body = filled(box(Vec3::Zero(), Vec3::Constant(0.016)), withSpacing(0.01));
  REQUIRE(body.stencils.pointCount() == 8);
  for (std::size_t q = 0; q < 8; ++q) {
    CHECK_THAT(body.stencils.volumes[q], WithinRel(0.008 * 0.008 * 0.008, 1e-6));
    // Distances at the edges use one face at a time, not both.
    CHECK((body.pointCentres[q].cwiseAbs() - Vec3::Constant(0.004)).norm() < 1e-4);
    CHECK((body.stencils.variances[q] - Vec3::Constant(0.008 * 0.008 / 12.0)).norm() < 0.05 * 1e-4 / 12.0);
  }
}

TEST_CASE("the bending of a beam is the one of the study however the lattice lies") {
  struct Expected {
    const char *name;
    Vec3 shift;
    Mat3 axes;
    double error[2];  // % of the tip's deflection, three and five layers, by another program with 8³ points per cell
  };
  const Mat3 none = Mat3::Identity();
  const Expected expected[] = {{"aligned", Vec3::Zero(), none, {0.2, 0.0}},
                               {"beside", Vec3(0.37, 0.21, 0.43), none, {0.8, 0.5}},
                               {"turned about y", Vec3::Zero(), rotation(1, 30), {-4.5, -1.8}},
                               {"turned about z", Vec3::Zero(), rotation(2, 30), {1.7, 0.8}}};
  for (const Expected &e : expected)
    for (int i = 0; i < 2; ++i) {
      const double spacing = 0.04 / (3 + 2 * i);
      LatticeSampling sampling = withSpacing(spacing);
      sampling.axes = e.axes;
      sampling.held = {HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}};
      const BodyShape shape = e.shift.isZero(0.0) ? beam() : shifted(beam(), spacing, e.shift);
      const LatticeBody body = filled(shape, sampling);
      const double tip =
          solveLinear(body, shape, HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()}, Vec3(0, 0, -1.6e-3)).tip;
      const double error = 100.0 * (tip / 2.033e-3 - 1.0);
      WARN("beam " << e.name << ", " << 3 + 2 * i << " layers, " << body.positions.size() << " phyxels: " << error
                   << " %");
      // 4³ points, and patches at the clamp that are held twice as stiffly, change the last half per cent. At three
      // layers turned about y the other program gives -4.5 or -3.0 as slivers of one or two hundredths of a cell are
      // dropped; this one -4.8 with both.
      CHECK_THAT(error, WithinAbs(e.error[i], i == 0 ? 1.0 : 0.4));
    }
}

TEST_CASE("bodies on two sides of a gap share no phyxel") {
  struct Gap {
    double width;  // spacings
    bool asks;     // BodyShape::crosses
  };
  for (const Gap &gap : {Gap{0.5, false}, Gap{0.5, true}, Gap{0.2, true}, Gap{0.05, true}})
    for (const bool turned : {false, true}) {
      INFO("a gap of " << gap.width << " spacings, " << (turned ? "turned" : "aligned")
                       << (gap.asks ? ", asking" : ""));
      const BodyShape lower = box(Vec3::Zero(), Vec3(0.06, 0.06, 0.023));
      const double floor = 0.023 + gap.width * 0.01;
      BodyShape both = together(lower, box(Vec3(0, 0, floor), Vec3(0.06, 0.06, floor + 0.02)));
      if (!gap.asks) both.crosses = nullptr;
      LatticeSampling sampling = withSpacing(0.01);
      if (turned) sampling.axes = rotation(0, 33) * rotation(1, 20);
      const LatticeBody body = filled(both, sampling);
      CHECK(body.components == 2);
      // Every stencil and every bound point stays on its side: move the phyxels of one body and check which points
      // follow.
      std::vector<int> side(body.positions.size(), 0);
      const double middle = 0.023 + 0.5 * gap.width * 0.01 - body.origin[2];
      bool mixed = false;
      const auto take = [&](Index phyxel, int of) {
        mixed = mixed || (side[phyxel] != 0 && side[phyxel] != of);
        side[phyxel] = of;
      };
      const StencilSet &s = body.stencils;
      for (std::size_t q = 0; q < s.pointCount(); ++q)
        for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
          take(s.phyxels.indices[e], body.pointCentres[q][2] < middle ? -1 : 1);
      CHECK_FALSE(mixed);
      // Points of the two faces, by their normals. (Next to a gap thinner than the samples are apart, points without
      // such a normal belong to either side.)
      const SurfacePoints all = sampleSurface(both.surface, 0.002, EverywhereRegion{});
      SurfacePoints points;
      for (std::size_t p = 0; p < all.count(); ++p) {
        if (gap.width < 0.5 && std::abs(all.normals[p][2]) < 0.5) continue;
        points.positions.push_back(all.positions[p] - body.origin);
        points.normals.push_back(all.normals[p]);
      }
      const Interpolation bound = body.cells->bind(points.positions, points.normals, serialFor());
      std::size_t astray = 0;
      for (std::size_t p = 0; p < points.count(); ++p)
        for (Index e = bound.phyxels.offsets[p]; e < bound.phyxels.offsets[p + 1]; ++e)
          if (side[bound.phyxels.indices[e]] != (points.positions[p][2] < middle ? -1 : 1)) ++astray;
      CHECK(astray == 0);
    }
}

TEST_CASE("lobes of a horseshoe that meet in one cell have corners of their own") {
  // The slot of 0.1 m fits between the samples of a cell of 0.2 m.
  const LatticeBody body = filled(shapes::horseshoe(), withSpacing(0.2));
  CHECK(body.components == 1);
  std::size_t across = 0;
  for (const Vec3 &c : body.pointCentres)
    if (std::abs(c[0]) < 0.02 && c[1] > 0.02) ++across;
  CHECK(across == 0);
  CHECK(consistencyOf(body).worst() < 1e-12);
}

TEST_CASE("a plate thinner than its cells stays one body of the same volume") {
  for (const double thickness : {0.5, 0.3, 0.15})
    for (const bool turned : {false, true}) {
      INFO("thickness of " << thickness << " spacings" << (turned ? ", turned" : ""));
      const BodyShape plate = box(Vec3::Zero(), Vec3(0.1, 0.1, thickness * 0.01));
      LatticeSampling sampling = withSpacing(0.01);
      if (turned) sampling.axes = rotation(0, 33) * rotation(1, 20);
      const LatticeBody body = filled(plate, sampling);
      CHECK(body.components == 1);
      CHECK_THAT(sum(body.stencils.volumes), WithinRel(plate.volume, 1e-12));
      CHECK(consistencyOf(body).worst() < 1e-12);
    }
}

TEST_CASE("a body on a lattice is the same for any number of threads") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody one = filled(c.shape, c.sampling), many = filled(c.shape, c.sampling, threadedFor(3));
    CHECK(one.positions == many.positions);
    CHECK(one.volumes == many.volumes);
    CHECK(one.stencils.phyxels.indices == many.stencils.phyxels.indices);
    CHECK(one.stencils.gradients == many.stencils.gradients);
    CHECK(one.stencils.modes == many.stencils.modes);
    const std::vector<Vec3> &points = one.pointCentres;
    CHECK(one.cells->bind(points, {}, serialFor()).weights == many.cells->bind(points, {}, threadedFor(3)).weights);
  }
}

TEST_CASE("a body far from the origin is sampled as one at the origin") {
  const Vec3 offset(1e6, -1e6, 5e5);
  for (const bool round : {false, true}) {
    const LatticeSampling sampling = withSpacing(0.01);
    const auto at = [&](const Vec3 &centre) {
      return round ? ball(centre, 0.04) : box(centre - Vec3::Constant(0.02), centre + Vec3::Constant(0.02));
    };
    const LatticeBody near = filled(at(Vec3::Zero()), sampling);
    const LatticeBody far = filled(at(offset), sampling);
    REQUIRE(near.positions.size() == far.positions.size());
    REQUIRE(near.stencils.phyxels.indices == far.stencils.phyxels.indices);
    for (std::size_t i = 0; i < near.positions.size(); ++i) {
      CHECK((near.positions[i] - far.positions[i]).norm() < 1e-6 * 0.01);
      CHECK_THAT(far.volumes[i], WithinRel(near.volumes[i], 1e-6));
    }
    for (std::size_t e = 0; e < near.stencils.gradients.size(); ++e)
      CHECK((near.stencils.gradients[e] - far.stencils.gradients[e]).norm() < 1e-6 / 0.01);
  }
}

TEST_CASE("a wanted number of phyxels is met within five per cent") {
  for (const std::size_t count : {498u, 2844u, 10000u}) {
    const LatticeSampling sampling{.count = count};
    CHECK_THAT(static_cast<double>(filled(ball(Vec3::Zero(), 0.05), sampling).positions.size()),
               WithinRel(static_cast<double>(count), 0.05));
  }
}

TEST_CASE("jitter moves only phyxels whose cells lie inside, by what it says") {
  LatticeSampling sampling = withSpacing(0.01);
  const LatticeBody still = filled(beam(), sampling);
  sampling.jitter = 0.3;
  const LatticeBody moved = filled(beam(), sampling);
  REQUIRE(still.positions.size() == moved.positions.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < still.positions.size(); ++i) {
    const Vec3 X = still.origin + still.positions[i], by = moved.positions[i] - still.positions[i];
    const bool inner = X[0] > 0.001 && X[0] < 0.199 && std::abs(X[1]) < 0.019 && std::abs(X[2]) < 0.019;
    CHECK((by.norm() > 0.0) == inner);
    CHECK(by.cwiseAbs().maxCoeff() <= 0.003);
    count += inner ? 1 : 0;
  }
  CHECK(count == 19 * 3 * 3);
  sampling.seed = 2;
  CHECK(filled(beam(), sampling).positions != moved.positions);
}

TEST_CASE("materials have evaluation points of their own, in their region") {
  LatticeSampling sampling = withSpacing(0.01);
  sampling.materials = {{BoxRegion{Vec3(-1, -1, -1), Vec3(0.1, 1, 1)}, std::uint16_t{2}},
                        {HalfSpaceRegion{Vec3(0.05, 0, 0), Vec3::UnitX()}, std::uint16_t{1}}};
  const LatticeBody body = filled(beam(), sampling);
  REQUIRE(body.stencils.materials.size() == body.stencils.pointCount());
  for (std::size_t q = 0; q < body.pointCentres.size(); ++q) {
    const double x = (body.origin + body.pointCentres[q])[0];
    CHECK(body.stencils.materials[q] == (x < 0.05 ? 1 : x < 0.1 ? 2 : 0));
  }
}

TEST_CASE("what cannot be put on a lattice is refused with the value and what is accepted") {
  const BodyShape shape = ball(Vec3::Zero(), 0.05);
  const auto error = [&](auto change) {
    LatticeSampling sampling = withSpacing(0.01);
    BodyShape body = shape;
    change(sampling, body);
    return fillLattice(body, sampling, serialFor()).error();
  };
  using S = LatticeSampling;
  CHECK_THAT(error([](S &s, BodyShape &) { s.spacing = -0.01; }), Contains("spacing = -0.01"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.spacing = std::nan(""); }), Contains("spacing"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.spacing = 1e-5; }), Contains("larger spacing"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.spacing = 1e-300; }), Contains("larger spacing"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.spacing = 0.0, s.count = 0; }), Contains("count = 0"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.jitter = 0.5; }), Contains("jitter = 0.5"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.axes = 2.0 * Mat3::Identity(); }), Contains("rotation"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.surfaceSpacing = -1.0; }), Contains("surfaceSpacing"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.surfaceSpacing = 1e-7; }), Contains("surfaceSpacing"));
  CHECK_THAT(error([](S &s, BodyShape &) { s.refinements = {{EverywhereRegion{}, 0.0}}; }), Contains("refinement 0"));
  CHECK_THAT(error([](S &s, BodyShape &) {
               s.held = {EverywhereRegion{}, SphereRegion{Vec3::Zero(), -1.0}};
             }),
             Contains("held region 1"));
  CHECK_THAT(error([](S &s, BodyShape &) {
               s.materials = {{SphereRegion{Vec3(9, 0, 0), 1.0}, std::uint16_t{1}}};
             }),
             Contains("material region 0"));
  CHECK_THAT(error([](S &, BodyShape &b) { b.volume = 0.0; }), Contains("volume"));
  CHECK_THAT(error([](S &, BodyShape &b) {
               b.inside = [](std::span<const Vec3> p, std::span<double> w) { std::fill_n(w.begin(), p.size(), 0.0); };
               b.surfaceDistance = nullptr;
             }),
             Contains("no point of the body"));
}

TEST_CASE("filling a lattice can be cancelled") {
  const auto result =
      fillLattice(ball(Vec3::Zero(), 0.05), withSpacing(0.01), serialFor(), [](double f) { return f < 0.5; });
  REQUIRE_FALSE(result);
  CHECK(result.error() == "cancelled");
}
