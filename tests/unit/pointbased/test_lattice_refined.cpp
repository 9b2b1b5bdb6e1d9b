// SPDX-License-Identifier: Apache-2.0
#include "lattice_cases.h"
#include "support/catch.h"

using namespace lattice_cases;

namespace {

BodyShape beam() { return box(Vec3(0, -0.02, -0.02), Vec3(0.2, 0.02, 0.02)); }

LatticeSampling refined(double spacing, const Region &region, double to, const Mat3 &axes = Mat3::Identity()) {
  LatticeSampling sampling = withSpacing(spacing);
  sampling.refinements = {{region, to}};
  sampling.axes = axes;
  return sampling;
}

const Region kLeft = BoxRegion{Vec3(-1, -1, -1), Vec3(0.05, 1, 1)};

}  // namespace

TEST_CASE("cells of a refined region are as small as it wants and grow by two") {
  const LatticeBody body = filled(beam(), refined(0.02, kLeft, 0.005));
  CHECK(consistencyOf(body).worst() < 1e-11);
  CHECK_THAT(sum(body.volumes), WithinRel(0.04 * 0.04 * 0.2, 1e-12));
  CHECK_THAT(sum(body.stencils.volumes), WithinRel(0.04 * 0.04 * 0.2, 1e-12));
  CHECK(body.components == 1);
  for (std::size_t q = 0; q < body.pointCentres.size(); ++q) {
    const double x = (body.origin + body.pointCentres[q])[0], edge = std::cbrt(body.stencils.volumes[q]);
    if (x < 0.05) CHECK_THAT(edge, WithinRel(0.005, 1e-9));
    if (x > 0.081) CHECK_THAT(edge, WithinRel(0.02, 1e-9));
    CHECK((body.stencils.variances[q] - Vec3::Constant(edge * edge / 12.0)).norm() < 1e-6 * edge * edge);
  }
}

TEST_CASE("a constant stress stays in balance across a change of spacing") {
  CHECK(patchError(filled(beam(), refined(0.02, kLeft, 0.005)), beam()) < 1e-3);
  // Slanted cuts as without refinement, in units of the coarse spacing².
  CHECK(patchError(filled(beam(), refined(0.02, kLeft, 0.005, rotation(1, 30))), beam()) < 0.03);
  const BodyShape round = ball(Vec3(0.1, 0.2, 0.3), 0.05);
  LatticeSampling sampling = withSpacing(0.025);
  sampling.surfaceSpacing = 0.00625;
  CHECK(patchError(filled(round, sampling), round) < 0.01);
}

TEST_CASE("binding on refined cells follows affine motions") {
  for (const Mat3 &axes : {Mat3(Mat3::Identity()), rotation(1, 30)}) {
    const LatticeBody body = filled(beam(), refined(0.02, SphereRegion{Vec3(0.1, 0, 0.02), 0.004}, 0.0025, axes));
    CHECK(consistencyOf(body).worst() < 1e-10);
    shapes::Random random(5);
    std::vector<Vec3> points;
    for (int i = 0; i < 500; ++i) points.push_back(0.6 * random.vector().cwiseProduct(Vec3(0.2, 0.04, 0.04)));
    CHECK(bindingError(body, points, {}) < 1e-10);
  }
}

TEST_CASE("functions of refined cells are continuous where cells of two sizes meet") {
  const LatticeBody body = filled(beam(), refined(0.02, kLeft, 0.005));
  shapes::Random random(9);
  std::vector<double> field;
  for (std::size_t i = 0; i < body.positions.size(); ++i) field.push_back(random());
  std::vector<Vec3> before, after;
  for (int i = 0; i < 200; ++i) {
    const Vec3 r = random.vector();
    for (const double x : {0.06, 0.08}) {  // from 5 to 10 mm, from 10 to 20 mm
      before.push_back(Vec3(x - 0.1 - 1e-9, 0.0199 * r[1], 0.0199 * r[2]));
      after.push_back(Vec3(x - 0.1 + 1e-9, 0.0199 * r[1], 0.0199 * r[2]));
    }
  }
  const auto values = [&](std::span<const Vec3> points) {
    const Interpolation bound = body.cells->bind(points, {}, serialFor());
    std::vector<double> result(points.size(), 0.0);
    for (std::size_t p = 0; p < points.size(); ++p)
      for (Index e = bound.phyxels.offsets[p]; e < bound.phyxels.offsets[p + 1]; ++e)
        result[p] += bound.weights[e] * field[bound.phyxels.indices[e]];
    return result;
  };
  const std::vector<double> a = values(before), b = values(after);
  for (std::size_t p = 0; p < a.size(); ++p) CHECK_THAT(a[p], WithinAbs(b[p], 1e-5));
}

TEST_CASE("cells at the surface are refined on their own") {
  LatticeSampling sampling = withSpacing(0.02);
  sampling.surfaceSpacing = 0.005;
  const BodyShape shape = ball(Vec3::Zero(), 0.05);
  const LatticeBody body = filled(shape, sampling);
  double largest = 0.0;
  for (std::size_t q = 0; q < body.pointCentres.size(); ++q) {
    // A cell of 5 mm cannot contain more, nor can a cut cell be larger.
    if (std::abs(body.pointCentres[q].norm() - 0.05) < 0.003)
      CHECK(body.stencils.volumes[q] < 1.02 * 0.005 * 0.005 * 0.005);
    largest = std::max(largest, body.stencils.volumes[q]);
  }
  CHECK(std::cbrt(largest) > 0.0195);
}

TEST_CASE("a refined beam bends between its coarse and its fine lattice") {
  const auto tip = [](const LatticeSampling &refinedSampling) {
    LatticeSampling sampling = refinedSampling;
    sampling.held = {HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}};
    const BodyShape shape = beam();
    return 100.0 * (solveLinear(filled(shape, sampling), shape, HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()},
                                Vec3(0, 0, -1.6e-3))
                            .tip /
                        2.033e-3 -
                    1.0);
  };
  const double error = tip(refined(0.04 / 3, kLeft, 0.04 / 6));
  INFO("three layers, six near the clamp: " << error << " %");
  CHECK(std::abs(error) < 1.0);
}

TEST_CASE("gaps separate refined cells as others") {
  const BodyShape both =
      together(box(Vec3::Zero(), Vec3(0.06, 0.06, 0.023)), box(Vec3(0, 0, 0.025), Vec3(0.06, 0.06, 0.05)));
  const LatticeBody body = filled(both, refined(0.01, BoxRegion{Vec3(-1, -1, -1), Vec3(0.025, 1, 1)}, 0.005));
  CHECK(body.components == 2);
  CHECK(consistencyOf(body).worst() < 1e-10);
  std::vector<int> side(body.positions.size(), 0);
  bool mixed = false;
  const StencilSet &s = body.stencils;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const int of = (body.origin + body.pointCentres[q])[2] < 0.024 ? -1 : 1;
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      mixed = mixed || side[s.phyxels.indices[e]] == -of;
      side[s.phyxels.indices[e]] = of;
    }
  }
  CHECK_FALSE(mixed);
}

TEST_CASE("a refined lattice is the same for any number of threads") {
  const LatticeSampling sampling = refined(0.02, SphereRegion{Vec3(0.1, 0, 0.02), 0.004}, 0.0025, rotation(1, 30));
  const LatticeBody one = filled(beam(), sampling), many = filled(beam(), sampling, threadedFor(3));
  CHECK(one.positions == many.positions);
  CHECK(one.stencils.gradients == many.stencils.gradients);
  CHECK(one.stencils.phyxels.indices == many.stencils.phyxels.indices);
}
