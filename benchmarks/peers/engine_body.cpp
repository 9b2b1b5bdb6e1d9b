// SPDX-License-Identifier: Apache-2.0
#include "engine_body.h"

#include "bench/bodies.h"

namespace peers {

using namespace pointbased;

namespace {

class EngineBody final : public MovingBody {
 public:
  EngineBody(const Scene &scene, const std::shared_ptr<const RestState> &rest, const Solid &solid,
             Integrator integrator, double dt)
      : scene_(scene),
        world_(std::make_unique<Body>(
                   "body", rest, bench::elastic(solid.youngsModulus, solid.poissonRatio, solid.density), serialFor()),
               settingsOf(integrator, dt)) {
    world_.simulator.world().setContact({false});  // as the peer engines
  }

  double step() override {
    const double before = world_.simulator.time();
    if (!world_.simulator.step() || body().stopped) return 0.0;
    return world_.simulator.time() - before;
  }
  [[nodiscard]] double surplus() const override {
    const Diagnostics::Energy energy = world_.simulator.diagnostics().energy(world_.id);
    return energy.kinetic + energy.gravity;
  }
  [[nodiscard]] Vec3 displacement() const override {
    return scene_.measure(body().rest(), body().state().displacements);
  }
  [[nodiscard]] double largestDisplacement() const override {
    double most = 0.0;
    for (const Vec3 &u : body().state().displacements)
      if (!(u.norm() <= most)) most = u.norm();
    return most;
  }
  [[nodiscard]] double kineticEnergy() const override { return body().kineticEnergy(); }
  void stop() override {
    for (Vec3 &v : world_.body().state().velocities) v.setZero();
  }

  Vec3 relaxToRest() {
    world_.solve();
    return displacement();
  }

 private:
  static WorldSettings settingsOf(Integrator integrator, double dt) {
    WorldSettings settings;
    settings.gravity = kGravity;
    settings.integrator = integrator;
    settings.dt = dt;
    return settings;
  }
  [[nodiscard]] const Body &body() const { return *world_.simulator.body(world_.id); }

  const Scene &scene_;
  bench::World world_;
};

}  // namespace

Result<std::shared_ptr<const RestState>> buildEngineRest(const Scene &scene, std::size_t nodes) {
  BodyRecipe recipe;
  recipe.sampling = scene.sampling(nodes);
  recipe.fixes.push_back(bench::heldIn(scene.held));
  return buildRestState(scene.shape, recipe, {}, serialFor());
}

std::unique_ptr<MovingBody> makeEngineBody(const Scene &scene, const std::shared_ptr<const RestState> &rest,
                                           const Solid &solid, Integrator integrator, double dt) {
  return std::make_unique<EngineBody>(scene, rest, solid, integrator, dt);
}

Vec3 engineAtRest(const Scene &scene, const std::shared_ptr<const RestState> &rest, const Solid &solid) {
  return EngineBody(scene, rest, solid, Integrator::quasiStatic, 0.0).relaxToRest();
}

}  // namespace peers
