// SPDX-License-Identifier: Apache-2.0
#include "pointbased/world.h"

#include <algorithm>

#include "base/expects.h"
#include "pointbased/cloud_quality.h"
#include "stepping/monitoring/rigid_tissue.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

// Call after a change of what makes its steps take long.
void describe(detail::SimulationState &state, std::size_t id) {
  const detail::BodyStepper &stepper = *state.bodies.at(id);
  state.activity.describe(id,
                          detail::suggestRemedy(stepper.body(), state.settings, stepper.integratorIn(state.settings)));
}

}  // namespace

const WorldSettings &World::settings() const { return state_.settings; }

void World::setSettings(const WorldSettings &settings) {
  const bool wasStatic = state_.quasiStatic();
  const bool otherEnergy = settings.integrator != state_.settings.integrator ||
                           settings.gravity != state_.settings.gravity ||
                           settings.box.enabled != state_.settings.box.enabled ||
                           settings.box.min != state_.settings.box.min || settings.box.max != state_.settings.box.max;
  state_.settings = settings;
  if (!wasStatic && state_.quasiStatic()) state_.progress.loadFactor = 0.0;
  if (wasStatic && !state_.quasiStatic())
    for (const auto &[id, stepper] : state_.bodies) {
      const BoundaryConditions &conditions = stepper->body().rest().conditions;
      for (const Fix &fix : conditions.fixes)
        state_.progress.time = std::max(state_.progress.time, state_.progress.loadFactor * fix.ramp);
      for (const Load &load : conditions.loads)
        state_.progress.time = std::max(state_.progress.time, state_.progress.loadFactor * load.ramp);
    }
  for (auto &[id, stepper] : state_.bodies) stepper->body().quasiStatic = state_.quasiStatic();
  if (wasStatic != state_.quasiStatic()) state_.updateAttachments();
  for (auto &[id, stepper] : state_.bodies) {
    stepper->body().setPrecision(settings.precision);
    stepper->body().forcesCurrent = false;
    stepper->wake();
    if (otherEnergy) stepper->clearEnergyCheckpoint();
    describe(state_, id);
  }
}

std::size_t World::addBody(std::unique_ptr<Body> body) {
  POINTBASED_EXPECTS(body != nullptr, "a body");
  body->quasiStatic = state_.quasiStatic();
  body->setPrecision(state_.settings.precision);
  std::string cloud = inspectCloud(body->rest()).warning();
  if (!cloud.empty()) cloud += "; sampling.neighbours and the spacing change it";
  for (const std::string &unusual :
       {volumeWarning(body->rest()), tornWarning(body->rest()), gluedWarning(body->rest()), cloud}) {
    if (unusual.empty()) continue;
    state_.addWarning(state_.nextId, "body '" + body->name() + "': " + unusual);
  }
  if (auto tissues = detail::rigidTissuesOf(*body); !tissues.empty())
    state_.contact.rigidTissues[state_.nextId] = std::move(tissues);
  state_.bodies.emplace(state_.nextId, std::make_unique<detail::BodyStepper>(std::move(body)));
  state_.updateSurroundings(state_.nextId);
  ++state_.historyEpoch;
  describe(state_, state_.nextId);
  return state_.nextId++;
}

bool World::removeBody(std::size_t id) {
  std::erase_if(state_.probes, [id](const Probe &p) { return p.body == id; });
  ++state_.historyEpoch;
  state_.warnings.erase(id);
  state_.contact.surroundings.erase(id);
  state_.contact.rigidTissues.erase(id);
  std::erase_if(state_.contact.pairs,
                [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  state_.activity.remove(id);
  state_.skins.remove(id);
  state_.removeAttachmentsOf(id);
  return state_.bodies.erase(id) > 0;
}

Body *World::body(std::size_t id) { return state_.body(id); }
const Body *World::body(std::size_t id) const { return state_.body(id); }

std::vector<std::size_t> World::bodyIds() const {
  std::vector<std::size_t> ids;
  for (const auto &[id, stepper] : state_.bodies) ids.push_back(id);
  return ids;
}

void World::clear() {
  state_.attachments.clear();
  state_.bodies.clear();
  state_.warnings.clear();
  state_.obstacles = {};
  state_.placed.clear();
  state_.contact.pairs.clear();
  state_.contact.surroundings.clear();
  state_.contact.rigidTissues.clear();
  state_.probes.clear();
  state_.reset();
}

std::size_t World::addProbe(std::string name, std::size_t id, const Vec3 &reference) {
  const Body *target = state_.body(id);
  if (!target) return 0;
  ++state_.historyEpoch;
  const Vec3 local = reference - target->rest().origin;
  state_.probes.push_back({state_.nextId++, std::move(name), id, reference,
                           target->rest().bind(std::span<const Vec3>(&local, 1), {}), Vec3::Zero()});
  return state_.probes.back().id;
}

bool World::removeProbe(std::size_t id) {
  const bool found = std::erase_if(state_.probes, [id](const Probe &probe) { return probe.id == id; }) > 0;
  if (found) ++state_.historyEpoch;
  return found;
}

const std::vector<Probe> &World::probes() const { return state_.probes; }

World::ProbeState World::probeState(const Probe &probe) const {
  const Body *target = state_.body(probe.body);
  if (!target) return {probe.reference, Vec3::Zero()};
  Vec3 u, v;
  interpolateDisplacements(probe.binding, target->rest().positions, target->state().displacements,
                           std::span<Vec3>(&u, 1), serialFor());
  interpolateField(probe.binding, target->state().velocities, std::span<Vec3>(&v, 1), serialFor());
  if (const auto held = target->supportAt(probe.reference))
    return {probe.reference + held->motion.displacementOf(probe.reference - target->rest().origin), held->velocity};
  return {probe.reference + probe.referenceShift + u, v};
}

void World::setConstitution(std::size_t id, Constitution constitution) {
  const auto found = state_.bodies.find(id);
  if (found == state_.bodies.end()) return;
  found->second->body().setConstitution(std::move(constitution), state_.parallelFor);
  found->second->invalidate();
  state_.skins.invalidateModuli(id);
  state_.updateAttachments();
  describe(state_, id);
}

void World::setRigid(std::size_t id, bool rigid, bool free) {
  const auto found = state_.bodies.find(id);
  if (found == state_.bodies.end()) return;
  const Body &present = found->second->body();
  if (present.rigid() == rigid && present.rigidIsFree() == free) return;
  const bool renewed = found->second->body().rereferenceCount() > 0;
  found->second->body().setRigid(rigid, free);
  found->second->invalidate();
  if (renewed) state_.bindProbes(id, std::vector<Vec3>(state_.probes.size(), Vec3::Zero()));
  state_.updateAttachments();
}

Result<void> World::setFoundation(std::size_t id, const Foundation &foundation) {
  const auto found = state_.bodies.find(id);
  if (found == state_.bodies.end() || found->second->body().foundation().settings() == foundation) return {};
  if (auto set = found->second->body().setFoundation(foundation); !set) return set;
  found->second->invalidate();
  return {};
}

void World::setLiveSupports(std::size_t id, std::vector<LiveSupport> supports) {
  const auto found = state_.bodies.find(id);
  if (found == state_.bodies.end()) return;
  found->second->body().setLiveSupports(std::move(supports));
  found->second->invalidate();
  found->second->clearEnergyCheckpoint();  // the work of a support is not spurious energy
}

void World::surfels(std::size_t id, std::vector<Vec3> &positions, std::vector<Vec3> &normals) {
  const Body *target = state_.body(id);
  if (!target) return;
  const RestState &rest = target->rest();
  positions.resize(rest.surfels.count());
  normals.resize(rest.surfelNormals.size());
  state_.clock.measure(kSurfels, [&] {
    updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, target->state().displacements, positions, normals,
                  state_.parallelFor);
    target->placeHeldSurfels(positions, normals);
    for (Vec3 &x : positions) x += rest.origin;
  });
}

void World::surfels(std::size_t id, std::vector<Vec3f> &positions, std::vector<Vec3f> &normals) {
  const Body *target = state_.body(id);
  if (!target) return;
  const RestState &rest = target->rest();
  positions.resize(rest.surfels.count());
  normals.resize(rest.surfelNormals.size());
  state_.clock.measure(kSurfels, [&] {
    updateSurfels(rest.surfels, rest.surfelNormals, rest.origin, rest.positions, target->state().displacements,
                  state_.screenPhyxels, positions, normals, state_.parallelFor);
    target->placeHeldSurfels(positions, normals);
  });
}

}  // namespace pointbased
