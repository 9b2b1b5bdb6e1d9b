// SPDX-License-Identifier: Apache-2.0
#include "touching_bodies.h"

#include <map>

#include "contact_cases.h"
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

namespace {

std::shared_ptr<const RestState> restOf(const BodyShape &shape, double spacing, std::vector<Fix> fixes,
                                        std::vector<Load> loads) {
  BodyRecipe recipe;
  recipe.sampling.spacing = spacing;
  recipe.fixes = std::move(fixes);
  recipe.loads = std::move(loads);
  auto rest = buildRestState(shape, recipe, {}, serialFor());
  REQUIRE(rest);
  return *rest;
}

std::unique_ptr<Body> bodyAt(std::shared_ptr<const RestState> rest, const Material &material) {
  return std::make_unique<Body>("body", std::move(rest), Constitution{{material}, kLatticeStabilisation}, serialFor());
}

}  // namespace

std::unique_ptr<Body> bodyOf(const BodyShape &shape, double spacing, const Material &material, std::vector<Fix> fixes,
                             std::vector<Load> loads) {
  return bodyAt(restOf(shape, spacing, std::move(fixes), std::move(loads)), material);
}

std::unique_ptr<Body> block(const Vec3 &low, const Vec3 &high, double spacing, const Material &material, int n,
                            std::vector<Fix> fixes, std::vector<Load> loads) {
  return bodyOf(inside(boxSurface(low, high, n)), spacing, material, std::move(fixes), std::move(loads));
}

std::unique_ptr<Body> ball(const Vec3 &centre, double radius, double spacing, const Material &material, int n) {
  static std::map<std::array<double, 6>, std::shared_ptr<const RestState>> built;
  auto &rest = built[{centre[0], centre[1], centre[2], radius, spacing, static_cast<double>(n)}];
  if (!rest) rest = restOf(inside(ballSurface(centre, radius, n)), spacing, {}, {});
  return bodyAt(rest, material);
}

std::vector<std::size_t> stackOfFive(Simulator &simulator) {
  WorldSettings world;
  world.gravity = Vec3(0, -9.81, 0);
  world.damping = 5.0;
  simulator.setWorld(world);
  simulator.world().setContact({true, true, 0.3});
  simulator.addObstacle(halfSpace(Vec3(0, 0, 0), Vec3(0, 1, 0), 0.5));
  std::vector<std::size_t> ids;
  for (int k = 0; k < 5; ++k) {
    const Vec3 low(0.002 * (k % 2), 0.0001 + k * 0.0501, 0.0);
    ids.push_back(simulator.addBody(block(low, low + Vec3::Constant(0.05), 0.0125, soft(3e5, 0.3), 6)));
  }
  return ids;
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

const ContactSummary *between(const std::vector<ContactSummary> &contacts, std::size_t a, std::size_t b) {
  for (const ContactSummary &one : contacts)
    if (one.first == a && one.second == b) return &one;
  return nullptr;
}

}  // namespace shapes
