// SPDX-License-Identifier: Apache-2.0
#include "touching_bodies.h"

#include <map>

#include "contact_cases.h"
#include "crossing_triangles.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

namespace shapes {

using namespace pointbased;

Material soft(double modulus, double poisson, double viscosity) {
  Material material = rubber(modulus, viscosity);
  material.poissonRatio = poisson;
  return material;
}

std::unique_ptr<Body> bodyOf(const BodyShape &shape, double spacing, const Material &material, std::vector<Fix> fixes,
                             std::vector<Load> loads) {
  return makeBody(
      restState(shape, {.sampling = {.spacing = spacing}, .fixes = std::move(fixes), .loads = std::move(loads)}),
      {material});
}

std::unique_ptr<Body> block(const Vec3 &low, const Vec3 &high, double spacing, const Material &material, int n,
                            std::vector<Fix> fixes, std::vector<Load> loads) {
  return bodyOf(inside(boxSurface(low, high, n)), spacing, material, std::move(fixes), std::move(loads));
}

std::unique_ptr<Body> ball(const Vec3 &centre, double radius, double spacing, const Material &material, int n) {
  static std::map<std::array<double, 6>, std::shared_ptr<const RestState>> built;
  auto &rest = built[{centre[0], centre[1], centre[2], radius, spacing, static_cast<double>(n)}];
  if (!rest) rest = restState(inside(ballSurface(centre, radius, n)), {.sampling = {.spacing = spacing}});
  return makeBody(rest, {material});
}

std::vector<std::size_t> addStack(Simulator &simulator, int count) {
  simulator.addObstacle(halfSpace(Vec3(0, 0, 0), Vec3(0, 1, 0), 0.5));
  std::vector<std::size_t> ids;
  for (int k = 0; k < count; ++k) {
    const Vec3 low(0.002 * (k % 2), 0.0001 + k * 0.0501, 0.0);
    ids.push_back(simulator.addBody(block(low, low + Vec3::Constant(0.05), 0.0125, soft(3e5, 0.3), 6)));
  }
  return ids;
}

std::vector<std::size_t> stackOfFive(Simulator &simulator) {
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .damping = 5.0});
  simulator.world().setContact({true, true, 0.3});
  return addStack(simulator, 5);
}

void checkWeights(Simulator &simulator, const std::vector<std::size_t> &ids) {
  const double weight = 9.81 * simulator.body(ids[0])->totalMass();
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  for (std::size_t k = 1; k < ids.size(); ++k) {
    const ContactSummary *found = between(contacts, ids[k - 1], ids[k]);
    REQUIRE(found);
    CHECK_THAT(found->normalForce, WithinRel(weight * static_cast<double>(ids.size() - k), 0.02));
    CHECK(crossings(simulator, ids[k - 1], ids[k]) == 0);
  }
}

std::pair<std::size_t, std::size_t> addCollidingBalls(Simulator &simulator) {
  simulator.world().setContact({true, false, 0.0});
  const Material material = soft(1e4, 0.3);
  const std::size_t a = simulator.addBody(ball(Vec3(-0.051, 0, 0), 0.05, 0.0125, material, 32));
  const std::size_t b = simulator.addBody(ball(Vec3(0.051, 0.01, 0), 0.05, 0.0125, material, 32));
  setVelocity(simulator, a, Vec3(0.2, 0, 0));
  setVelocity(simulator, b, Vec3(-0.2, 0, 0));
  return {a, b};
}

std::size_t addBlockOnBlock(Simulator &simulator, double friction, std::pair<double, double> spacings, double gap) {
  simulator.world().setContact({true, false, friction});
  const Material material = soft(1e6, 0.3, 300.0);
  simulator.addBody(block(Vec3(-0.1, -0.04, -0.04), Vec3(0.2, 0, 0.04), spacings.first, material, 12,
                          {{.region = HalfSpaceRegion{Vec3(0, -0.039, 0), Vec3(0, 1, 0)}}}));
  return simulator.addBody(block(Vec3(-0.06, gap, -0.03), Vec3(0, 0.03 + gap, 0.03), spacings.second, material, 6));
}

void setVelocity(Simulator &simulator, std::size_t id, const Vec3 &velocity) {
  for (Vec3 &v : simulator.body(id)->state().velocities) v = velocity;
}

Total totalOf(Simulator &simulator) {
  Total out;
  for (const std::size_t id : simulator.bodyIds()) {
    const Body &body = *simulator.body(id);
    for (std::size_t i = 0; i < body.masses().size(); ++i) {
      const Vec3 mv = body.masses()[i] * body.state().velocities[i];
      out.momentum += mv;
      out.angular += (body.rest().origin + body.rest().positions[i] + body.state().displacements[i]).cross(mv);
    }
    out.energy += totalEnergy(simulator, id) + simulator.diagnostics().energy(id).foundation;
  }
  return out;
}

Collision collide(Simulator &simulator, std::size_t a, std::size_t b, double until, std::size_t every) {
  const Total before = totalOf(simulator);
  const double momentum = (simulator.body(a)->totalMass() * meanVelocity(*simulator.body(a))).norm();
  Collision out;
  while (simulator.time() < until) {
    REQUIRE(simulator.step());
    const Total now = totalOf(simulator);
    out.energy = std::max(out.energy, now.energy / before.energy);
    out.momentumError = std::max(out.momentumError, (now.momentum - before.momentum).norm() / momentum);
    out.angularError = std::max(out.angularError, (now.angular - before.angular).norm() / before.angular.norm());
    out.touched = out.touched || !simulator.diagnostics().contacts().empty();
    if (simulator.steps() % every == 0) out.crossings += crossings(simulator, a, b);
  }
  return out;
}

std::vector<Vec3> meanDisplacements(const Simulator &simulator, const std::vector<std::size_t> &ids) {
  std::vector<Vec3> out;
  for (const std::size_t id : ids) out.push_back(meanDisplacement(*simulator.body(id)));
  return out;
}

const ContactSummary *between(const std::vector<ContactSummary> &contacts, std::size_t a, std::size_t b) {
  for (const ContactSummary &one : contacts)
    if (one.first == a && one.second == b) return &one;
  return nullptr;
}

}  // namespace shapes
