// SPDX-License-Identifier: Apache-2.0
#include "lattice_cases.h"
#include "pointbased/rest_state.h"
#include "support/catch.h"

using namespace lattice_cases;

namespace {

struct Case {
  const char *name;
  BodyShape shape;
  LatticeSampling sampling;
  bool everyPoint;  // has a shape
};

std::vector<Case> cases() {
  LatticeSampling turned = withSpacing(0.01), refined = withSpacing(0.01), jittered = withSpacing(0.01);
  turned.axes = rotation(1, 30);
  refined.refinements = {{SphereRegion{Vec3(0.04, 0, 0), 0.02}, 0.005}};
  jittered.jitter = 0.2;
  const BodyShape round = ball(Vec3::Zero(), 0.04);
  return {{"plain", round, withSpacing(0.01), true},
          {"turned", round, turned, true},
          {"refined", round, refined, false},
          {"jittered", round, jittered, false}};
}

// Largest difference of rows, relative to the largest row of the point.
double difference(const StencilSet &a, const StencilSet &b) {
  double worst = 0.0;
  for (std::size_t q = 0; q < a.pointCount(); ++q) {
    const GradientRows ga(a, q), gb(b, q);
    const ModeRows ma(a, q), mb(b, q);
    double gradient = 0.0, of = 0.0;
    Eigen::Vector4d mode = Eigen::Vector4d::Zero(), ofMode = mode;
    for (Index e = a.phyxels.offsets[q]; e < a.phyxels.offsets[q + 1]; ++e) {
      gradient = std::max(gradient, (ga[e] - gb[e]).norm());
      of = std::max(of, ga[e].norm());
      mode = mode.cwiseMax((ma[e] - mb[e]).cwiseAbs());
      ofMode = ofMode.cwiseMax(ma[e].cwiseAbs());
    }
    worst = std::max({worst, gradient / of, mode.cwiseQuotient(ofMode).maxCoeff()});
  }
  return worst;
}

}  // namespace

TEST_CASE("shapes of cells stand for their rows, and rows come back from them") {
  for (const Case &c : cases()) {
    INFO(c.name);
    const LatticeBody body = filled(c.shape, c.sampling);
    StencilSet compact = body.stencils;
    compactRows(compact);
    CHECK(difference(body.stencils, compact) < 10.0 * kSameRows);
    CHECK(compact.modes.size() == compact.gradients.size());
    CHECK(compact.gradients.empty() == c.everyPoint);
    std::size_t shaped = 0;
    for (std::size_t q = 0; q < compact.pointCount(); ++q) shaped += compact.shapeOf(q) != nullptr ? 1 : 0;
    CHECK((shaped == compact.pointCount()) == c.everyPoint);
    CHECK(shaped > compact.pointCount() / 4);
    // Whole cells share one shape, except those of moved phyxels.
    CHECK((compact.shapes.size() < shaped || c.sampling.jitter > 0.0));

    expandRows(compact);
    CHECK(compact.shapes.empty());
    CHECK(compact.gradients.size() == body.stencils.gradients.size());
    CHECK(difference(body.stencils, compact) < 10.0 * kSameRows);
  }
}

TEST_CASE("a rest state on a lattice keeps shapes, and its whole cells share one") {
  const LatticeSampling sampling = withSpacing(0.01);
  const auto rest = shapes::restState(box(Vec3::Constant(-0.04), Vec3::Constant(0.04)), {.sampling = sampling});
  const StencilSet &s = rest->stencils;
  REQUIRE(s.pointCount() == 512);
  CHECK(s.gradients.empty());
  CHECK(s.shapes.size() == 1);
  CHECK(neighboursOf(*rest).rows() == rest->phyxelCount());
  CHECK(countNeighbours(*rest).max == 26);
  CHECK(countNeighbours(*rest).min == 7);
}
