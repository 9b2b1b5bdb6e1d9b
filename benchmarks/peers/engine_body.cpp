// SPDX-License-Identifier: Apache-2.0
#include "engine_body.h"

namespace peers {

using namespace pointbased;

namespace {

class EngineBody final : public MovingBody {
 public:
  EngineBody(const Scene &scene, const std::shared_ptr<const RestState> &rest, const Solid &solid,
             Integrator integrator, double dt)
      : scene_(scene) {
    Material material;  // neo-Hookean
    material.youngsModulus = solid.youngsModulus;
    material.poissonRatio = solid.poissonRatio;
    material.restDensity = solid.density;
    WorldSettings world;
    world.gravity = kGravity;
    world.integrator = integrator;
    world.dt = dt;
    simulator_.setWorld(world);
    simulator_.world().setContact({false});  // as the peer engines
    id_ = simulator_.addBody(
        std::make_unique<Body>("body", rest, Constitution{{material}, kLatticeStabilisation}, serialFor()));
  }

  double step() override {
    const double before = simulator_.time();
    if (!simulator_.step() || body().stopped) return 0.0;
    return simulator_.time() - before;
  }
  [[nodiscard]] double surplus() const override {
    const Diagnostics::Energy energy = simulator_.diagnostics().energy(id_);
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
    for (Vec3 &v : simulator_.body(id_)->state().velocities) v.setZero();
  }

  Result<void> relaxToRest() {
    while (!simulator_.finished())
      if (const auto done = simulator_.step(); !done) return tl::unexpected(done.error().text);
    if (body().stopped) return tl::unexpected(body().stopMessage());
    return {};
  }

 private:
  [[nodiscard]] const Body &body() const { return *simulator_.body(id_); }

  const Scene &scene_;
  Simulator simulator_;
  std::size_t id_ = 0;
};

}  // namespace

Result<std::shared_ptr<const RestState>> buildEngineRest(const Scene &scene, std::size_t nodes) {
  BodyRecipe recipe;
  recipe.sampling = scene.sampling(nodes);
  Fix fix;
  fix.region = scene.held;
  recipe.fixes.push_back(fix);
  return buildRestState(scene.shape, recipe, {}, serialFor());
}

std::unique_ptr<MovingBody> makeEngineBody(const Scene &scene, const std::shared_ptr<const RestState> &rest,
                                           const Solid &solid, Integrator integrator, double dt) {
  return std::make_unique<EngineBody>(scene, rest, solid, integrator, dt);
}

Result<Vec3> engineAtRest(const Scene &scene, const std::shared_ptr<const RestState> &rest, const Solid &solid) {
  EngineBody body(scene, rest, solid, Integrator::quasiStatic, 0.0);
  if (const auto done = body.relaxToRest(); !done) return tl::unexpected(done.error());
  return body.displacement();
}

}  // namespace peers
