// SPDX-License-Identifier: Apache-2.0
#include "simulator/accuracy_control.h"

#include "base/build_request.h"

namespace pointbased {

SamplingInputs AccuracyControl::inputs() const {
  SamplingInputs inputs;
  {
    const std::lock_guard lock(world_.mutex);
    inputs.world = entriesOf(world_.parameters);
    inputs.hasObstacles = !table_.obstacles().empty();
  }
  // Without a target the result must not depend on the machine.
  const bool isStandard =
      accuracyTargetOf(valuesOf(worldDeclarations(), inputs.world)).kind == AccuracyTarget::Kind::standard;
  inputs.speed = isStandard ? nominalSpeed() : world_.context.speed.speed();
  return inputs;
}

SamplingRequest AccuracyControl::requestOf(const SamplingInputs &inputs) {
  const ParameterValues values = valuesOf(worldDeclarations(), inputs.world);
  SamplingRequest request;
  request.wish = accuracyTargetOf(values);
  request.setting.world = worldSettings(values);
  request.setting.touches =
      values.number(C3DE_PARAM_ID_CONTACT_ENABLED) != 0.0 && values.number(C3DE_PARAM_ID_ACCURACY_BODIES) > 1.0;
  request.setting.contact = request.setting.world.box.enabled || inputs.hasObstacles;
  request.setting.speed = inputs.speed;
  request.gravity = request.setting.world.gravity;
  return request;
}

SamplingRequest AccuracyControl::requestFor(SamplingInputs &inputs) const {
  SamplingRequest request = requestOf(inputs);
  if (request.wish.kind != AccuracyTarget::Kind::standard &&
      request.setting.world.integrator != Integrator::quasiStatic)
    request.frameTime = [this, &inputs](const Body &body, const StopRequest *stop) {
      return inputs.frames_ms.emplace_back(frameTime(body, stop));
    };
  return request;
}

SamplingRequest AccuracyControl::repeatedRequest(const SamplingInputs &inputs) const {
  SamplingRequest request = requestOf(inputs);
  if (request.wish.kind != AccuracyTarget::Kind::standard &&
      request.setting.world.integrator != Integrator::quasiStatic)
    request.frameTime = [&inputs, next = std::size_t{0}](const Body &, const StopRequest *) mutable {
      require(next < inputs.frames_ms.size(), "it measured fewer frames");
      return inputs.frames_ms[next++];
    };
  return request;
}

double AccuracyControl::frameTime(const Body &body, const StopRequest *stop) const {
  WorldSettings settings;
  std::vector<Obstacle> obstacles;
  {
    const std::lock_guard lock(world_.mutex);
    settings = worldSettings(world_.parameters);
    obstacles.assign(simulator_.world().obstacles().begin(), simulator_.world().obstacles().end());
  }
  return measureFrame(body, settings, obstacles, world_.context.services.parallelFor(), stop);
}

void AccuracyControl::computeTrials(const sdk::Progress &progress, const ParallelFor &parallelFor) {
  struct Untried {
    std::uint64_t id = 0;
    std::string name;
    BodySource source;
    std::shared_ptr<const ParameterValues> values;
    std::shared_ptr<const RestState> rest;
  };
  std::vector<Untried> all;
  Vec3 gravity;
  {
    const StateLock lock(world_);
    gravity = simulator_.world().settings().gravity;
    for (const auto &[id, record] : table_.bodies())
      if (!record.trials && !simulator_.body(id)->rigid())
        all.push_back({id, record.name, record.source, record.values, simulator_.body(id)->sharedRest()});
  }
  BuildRequest request(progress);
  const auto tried = [&](const Untried &one) -> DisplacementTrials {
    if (!request.report(0.0, one.name + ": trying coarse samplings")) return {nullptr, "its trials were cancelled"};
    if (one.rest->evaluation != Evaluation::stressPoints) return {nullptr, "phyxels without a lattice have no trials"};
    // Trials with an assumed support would not describe this state, and filling a body for them takes time.
    if (one.rest->conditions.fixes.empty() && !foundationOf(*one.values).holds())
      return {nullptr, "nothing holds it but contact, attachments or inertia"};
    try {
      BodyFilling filling = fillingOf(world_.context.services, one.name, one.source, *one.values, parallelFor);
      filling.recipe.sampling.order = one.rest->sampling.order;
      const Constitution constitution = constitutionOf(world_.context.laws, one.name, one.source, *one.values);
      auto survey = surveyAccuracy({filling.shape, filling.recipe, constitution, foundationOf(*one.values), gravity},
                                   parallelFor, &request);
      if (request.isRaised()) return {nullptr, "its trials were cancelled"};
      if (!survey) return {nullptr, survey.error()};
      return {std::make_shared<const AccuracySurvey>(std::move(*survey)), {}};
    } catch (const sdk::Error &error) {
      return {nullptr, error.what()};
    }
  };
  for (const Untried &one : all) {
    DisplacementTrials trials = tried(one);
    const std::lock_guard lock(world_.mutex);
    if (BodyRecord *record = table_.body(one.id); record && simulator_.body(one.id)->sharedRest() == one.rest)
      record->trials = std::make_shared<const DisplacementTrials>(std::move(trials));
  }
}

}  // namespace pointbased
