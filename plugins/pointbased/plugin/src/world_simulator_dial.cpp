// SPDX-License-Identifier: Apache-2.0
// What bodies ask the dial when they are built.
#include "world_simulator.h"

namespace pointbased {

DialRequest WorldSimulator::dialRequest() {
  DialRequest request;
  {
    const std::lock_guard lock(mutex_);
    request.wish = wishOf(world_);
    request.setting.world = worldSettings(world_);
    request.setting.touches =
        world_.number(C3DE_PARAM_ID_CONTACT_ENABLED) != 0.0 && world_.number(C3DE_PARAM_ID_ACCURACY_BODIES) > 1.0;
    request.setting.contact = request.setting.world.box.enabled || !obstacles_.empty();
  }
  request.gravity = request.setting.world.gravity;
  // What nobody has wished for must not depend on the machine.
  if (request.wish.kind == AccuracyWish::Kind::standard) {
    request.setting.speed = nominalSpeed();
    return request;
  }
  request.setting.speed = context_.speed.speed();
  if (request.setting.world.integrator != Integrator::quasiStatic)
    request.frameTime = [this](const Body &body, const StopRequest *stop) { return frameTime(body, stop); };
  return request;
}

double WorldSimulator::frameTime(const Body &body, const StopRequest *stop) const {
  WorldSettings settings;
  std::vector<Obstacle> obstacles;
  {
    const std::lock_guard lock(mutex_);
    settings = worldSettings(world_);
    obstacles.assign(simulator_.obstacles().begin(), simulator_.obstacles().end());
  }
  return measureFrame(body, settings, obstacles, context_.services.parallelFor(), stop);
}

void WorldSimulator::shareBudget(std::size_t bodies) {
  const std::lock_guard lock(mutex_);
  sdk::orThrow(world_.set(sdk::integerValue(C3DE_PARAM_ID_ACCURACY_BODIES, static_cast<std::int64_t>(bodies))));
}

}  // namespace pointbased
