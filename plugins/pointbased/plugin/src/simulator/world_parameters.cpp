// SPDX-License-Identifier: Apache-2.0
#include "simulator/world_parameters.h"

#include <algorithm>
#include <utility>

#include "c3de/sdk/structs.hpp"

namespace pointbased {

using sdk::Error;

void WorldParameters::set(ChangeAccess, std::span<const c3de_param_value> values) {
  ParameterValues changed = world_.parameters;
  sdk::orThrow(changed.set(values.data(), values.size(), sizeof(c3de_param_value)));
  sdk::orThrow(resolveAccuracyTarget(changed, values.data(), values.size(), sizeof(c3de_param_value)));
  const WorldSettings settings = worldSettings(changed);
  if (settings.box.enabled && !((settings.box.max - settings.box.min).minCoeff() > 0.0))
    throw Error(C3DE_E_ARG, "world.box.max must be above world.box.min on every axis");
  if (settings.integrator == Integrator::quasiStatic)
    for (const auto &[id, record] : table_.bodies()) record.checkFree(*record.values, true);
  world_.parameters = std::move(changed);
  show();
  // Parameters that affect only the view or the time limit of a step are not passed to the solver.
  const auto isForTheSolver = [](const c3de_param_value &value) {
    return !isOfTheView(sdk::text(value.id)) && sdk::text(value.id) != "solver.step_budget";
  };
  if (!values.empty() && std::none_of(values.begin(), values.end(), isForTheSolver)) return;
  const bool isExplicit = mayStepExplicitly(settings.integrator);
  if (isExplicit != mayStepExplicitly(simulator_.world().settings().integrator))
    for (const auto &[id, record] : table_.bodies())
      if (record.adaptive && record.adaptive->halved > 0)
        simulator_.body(id)->scaleMasses(isExplicit ? record.adaptive->evenStep : 0.0,
                                         world_.context.services.parallelFor());
  simulator_.setWorld(settings);
  simulator_.world().setContact(contactSettings(world_.parameters));
}

void WorldParameters::growBox(const BodyRecord &body) {
  const WorldBox &box = simulator_.world().settings().box;
  const Vec3 low = box.min.cwiseMin(body.surface->min), high = box.max.cwiseMax(body.surface->max);
  if (!box.enabled || (low == box.min && high == box.max)) return;
  ParameterValues changed = world_.parameters;
  for (const auto &[id, corner] : {std::pair("world.box.min", low), std::pair("world.box.max", high)}) {
    c3de_param_value value = sdk::orThrow(world_.parameters.get(id));
    for (int axis = 0; axis < 3; ++axis) value.vec[axis] = corner[axis];
    sdk::orThrow(changed.set(value));
  }
  world_.parameters = std::move(changed);
  show();
  simulator_.setWorld(worldSettings(world_.parameters));
  world_.context.services.log.info("the world box was enlarged for '" + body.name + "'");
}

void WorldParameters::show() {
  auto values = std::make_shared<const ParameterValues>(world_.parameters);
  const std::lock_guard lock(shownMutex_);
  shown_ = std::move(values);
}

std::shared_ptr<const ParameterValues> WorldParameters::shown() const {
  const std::lock_guard lock(shownMutex_);
  return shown_;
}

ParameterValues WorldParameters::values() const {
  const std::lock_guard lock(world_.mutex);
  return world_.parameters;
}

}  // namespace pointbased
