// SPDX-License-Identifier: Apache-2.0
// Input of the accuracy setting for bodies that are built.
#include "base/build_request.h"
#include "simulator/world_simulator.h"

namespace pointbased {

SamplingRequest WorldSimulator::samplingRequest() {
  SamplingRequest request;
  {
    const std::lock_guard lock(mutex_);
    request.wish = accuracyTargetOf(world_);
    request.setting.world = worldSettings(world_);
    request.setting.touches =
        world_.number(C3DE_PARAM_ID_CONTACT_ENABLED) != 0.0 && world_.number(C3DE_PARAM_ID_ACCURACY_BODIES) > 1.0;
    request.setting.contact = request.setting.world.box.enabled || !table_.obstacles().empty();
  }
  request.gravity = request.setting.world.gravity;
  // Without a target the result must not depend on the machine.
  if (request.wish.kind == AccuracyTarget::Kind::standard) {
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
    obstacles.assign(simulator_.world().obstacles().begin(), simulator_.world().obstacles().end());
  }
  return measureFrame(body, settings, obstacles, context_.services.parallelFor(), stop);
}

void WorldSimulator::computeTrials(const sdk::Progress &progress, const ParallelFor &parallelFor) {
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
    const std::lock_guard lock(mutex_);
    gravity = simulator_.world().settings().gravity;
    for (const auto &[id, record] : table_.bodies())
      if (!record.trials && !simulator_.body(id)->rigid())
        all.push_back({id, record.name, record.source, record.values, simulator_.body(id)->sharedRest()});
  }
  BuildRequest request(progress);
  const auto tried = [&](const Untried &one) -> DisplacementTrials {
    if (!request.tell(0.0, one.name + ": trying coarse samplings")) return {nullptr, "its trials were cancelled"};
    if (one.rest->evaluation != Evaluation::stressPoints) return {nullptr, "phyxels without a lattice have no trials"};
    // Trials with an assumed support would not describe this state, and filling a body for them takes time.
    if (one.rest->conditions.fixes.empty() && !foundationOf(*one.values).holds())
      return {nullptr, "nothing holds it but contact, attachments or inertia"};
    try {
      const BodyFilling filling = fillingOf(context_.services, one.name, one.source, *one.values, parallelFor);
      const Constitution constitution = constitutionOf(context_.laws, one.name, one.source, *one.values);
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
    const std::lock_guard lock(mutex_);
    if (BodyRecord *record = table_.body(one.id); record && simulator_.body(one.id)->sharedRest() == one.rest)
      record->trials = std::make_shared<const DisplacementTrials>(std::move(trials));
  }
}

void WorldSimulator::recordGrab(std::uint64_t body, const Grab &grab) {
  constexpr std::size_t kMost = 8;
  BodyRecord *record = table_.body(body);
  if (!record || grab.phyxels.empty()) return;
  const RestState &rest = simulator_.body(body)->rest();
  SphereRegion place;
  for (std::size_t i = 0; i < grab.phyxels.size(); ++i)
    place.centre += grab.weights[i] * (rest.origin + rest.positions[grab.phyxels[i]]);
  for (const Index i : grab.phyxels)
    place.radius = std::max(place.radius, (rest.origin + rest.positions[i] - place.centre).norm());
  place.radius = std::max(place.radius, rest.spacing);
  std::vector<Load> &grabs = record->source.grabs;
  std::erase_if(grabs, [&](const Load &other) {
    return other.force.isZero(0.0) || signedDistance(other.region, place.centre) < 0.0;
  });
  if (grabs.size() >= kMost) grabs.erase(grabs.begin());
  grabs.push_back({place});
}

void WorldSimulator::recordPull(std::uint64_t body, std::uint64_t hand) {
  const std::optional<GrabStatus> status = simulator_.stepper().grabStatus(body, hand);
  BodyRecord *record = table_.body(body);
  if (!record || record->source.grabs.empty() || !status) return;
  std::vector<Load> &grabs = record->source.grabs;
  const auto way = [&](const Load &load) { return std::abs(signedDistance(load.region, status->point)); };
  Vec3 &most = std::min_element(grabs.begin(), grabs.end(), [&](const Load &a, const Load &b) {
                 return way(a) < way(b);
               })->force;
  if (status->force.squaredNorm() > most.squaredNorm()) most = status->force;
}

void WorldSimulator::shareBudget(std::size_t bodies) {
  const std::lock_guard lock(mutex_);
  sdk::orThrow(world_.set(sdk::integerValue(C3DE_PARAM_ID_ACCURACY_BODIES, static_cast<std::int64_t>(bodies))));
}

}  // namespace pointbased
