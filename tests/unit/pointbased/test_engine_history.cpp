// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "engine_cases.h"
#include "support/catch.h"

using namespace engine_cases;

namespace {

std::vector<Vec3> sheared(const EngineCase &c, double amount) {
  Mat3 A = Mat3::Identity();
  A(0, 1) = amount;
  return displaced(c, A, Vec3::Zero());
}

Constitution twoMaterials(const EngineCase &c) {
  Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
  constitution.materials.push_back(constitution.materials[0]);
  return constitution;
}

}  // namespace

TEST_CASE("history: nothing is kept where no material needs it") {
  Constitution constitution{{Material{}}, 0.0};
  PointHistory history;
  history.reset(constitution, 5);
  CHECK(history.plasticInverse.empty());
  CHECK(history.prony.empty());
  CHECK_FALSE((constitution.viscous() || constitution.relaxing() || constitution.plastic()));

  constitution.materials.push_back({});
  constitution.materials[1].viscosity = 1.0;
  constitution.materials[1].prony[1] = {0.2, 1.0};
  constitution.materials[1].plastic.yield = 0.1;
  constitution.materials[1].plastic.creep = 1.0;
  CHECK((constitution.viscous() && constitution.relaxing() && constitution.plastic()));
  history.reset(constitution, 5);
  CHECK(history.plasticInverse == std::vector<Mat3>(5, Mat3::Identity()));
  CHECK(history.prony.size() == 5);
  history.reset({{Material{}}, 0.0}, 5);
  CHECK((history.plasticInverse.empty() && history.prony.empty()));
}

TEST_CASE("history: points flow and relax only where their material does") {
  EngineCase c = lattice(3, 3, 2);
  const std::size_t points = c.stencils.pointCount();
  for (std::size_t q = 0; q < points; ++q) c.stencils.materials.push_back(q % 2 == 0 ? 1 : 0);
  Constitution constitution = twoMaterials(c);
  constitution.materials[1].plastic.yield = 0.05;
  constitution.materials[1].plastic.creep = 1.0;
  constitution.materials[1].prony[0] = {0.5, 0.1};
  PointHistory history;
  history.reset(constitution, points);
  const std::vector<Vec3> u = sheared(c, 0.3);
  const Evaluated at = evaluate(c, constitution, u);
  const std::size_t flowing = (points + 1) / 2;
  CHECK(plasticFlow(constitution, c.stencils, at.gradients, 0.01, history, serialFor()) == flowing);
  std::vector<Mat3> stresses(points);
  std::vector<double> ratios(points);
  const PointHistory before = history;
  pointStresses(constitution, c.stencils, at.gradients, {}, before, 0.05, &history, stresses, ratios, serialFor());
  for (std::size_t q = 0; q < points; ++q) {
    const bool remembers = q % 2 == 0;
    INFO(q);
    CHECK((history.plasticInverse[q] != Mat3::Identity()) == remembers);
    CHECK((history.prony[q].internal[0].norm() > 0.0) == remembers);
    // The elastic points have the same bits as without any history.
    CHECK((stresses[q] == at.stresses[q]) == !remembers);
    PronyPoint end;
    const Material &m = constitution.materials[1];
    if (remembers) {
      const Mat3 P = pronyStress(m, at.gradients[q] * before.plasticInverse[q], 0.05, PronyPoint(), end) *
                     before.plasticInverse[q].transpose();
      CHECK((stresses[q] - c.stencils.volumes[q] * P).norm() < 1e-13 * stresses[q].norm());
      CHECK((end.previous - history.prony[q].previous).norm() < 1e-12 * end.previous.norm());
    }
  }
}

TEST_CASE("history: without a place for its end a step of Prony terms is only looked at") {
  const EngineCase c = lattice(2, 2, 2);
  Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
  constitution.materials[0].prony[0] = {0.5, 0.1};
  PointHistory history;
  history.reset(constitution, c.stencils.pointCount());
  const std::vector<Vec3> u = sheared(c, 0.2);
  const Evaluated looked = evaluate(c, constitution, u, history, 0.02);
  CHECK(history.prony[0].previous == Mat3::Zero());
  // In place: the history at the beginning is that at the end.
  std::vector<Mat3> stresses(c.stencils.pointCount());
  std::vector<double> ratios(c.stencils.pointCount());
  pointStresses(constitution, c.stencils, looked.gradients, {}, history, 0.02, &history, stresses, ratios, serialFor());
  CHECK(stresses == looked.stresses);
  CHECK(history.prony[0].previous.norm() > 0.0);
}

TEST_CASE("history: forces of a flowed state are the negative gradient of its energy") {
  // Prony terms at dt = 0 retain what they have relaxed, but that part is not in the energy: plastic flow alone.
  const EngineCase c = lattice(2, 2, 2);
  Constitution constitution = engine_cases::constitution(c, MaterialLaw::corotated);
  constitution.materials[0].plastic.yield = 0.01;
  constitution.materials[0].plastic.creep = 0.7;
  PointHistory history;
  history.reset(constitution, c.stencils.pointCount());
  const std::vector<Vec3> past = plus(sheared(c, 0.4), 0.1 * c.spacing, noise(c, 1.0, 3));
  plasticFlow(constitution, c.stencils, evaluate(c, constitution, past).gradients, 0.01, history, serialFor());
  std::vector<Vec3> u = plus(sheared(c, 0.2), 0.1 * c.spacing, noise(c, 1.0, 4));
  const Evaluated at = evaluate(c, constitution, u, history);
  const double step = 1e-4 * c.spacing;
  const auto energy = [&] {
    const ElasticEnergy e = energyAt(c, constitution, u, history);
    return e.strain + e.stabilisation;
  };
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double start = u[i][1];
    double e[4];
    const double steps[4] = {step, -step, 2.0 * step, -2.0 * step};
    for (int k = 0; k < 4; ++k) {
      u[i][1] = start + steps[k];
      e[k] = energy();
    }
    u[i][1] = start;
    const double slope = (8.0 * (e[0] - e[1]) - (e[2] - e[3])) / (12.0 * step);
    CHECK(std::abs(slope + at.forces[i][1]) < 1e-6 * largest(at.forces));
  }
}
