// SPDX-License-Identifier: Apache-2.0
// Removals, interactive tools, loads and holds, checkpoints.
#include <algorithm>

#include "simulator/change_kinds.h"
#include "simulator/world_simulator.h"

namespace pointbased {
namespace {

using sdk::Error;

[[noreturn]] void missing(const std::string &what) {
  throw Error(C3DE_E_NOT_FOUND, "there is no " + what + " in this simulation");
}

void requireGrab(const Grab &grab, const Body &body) {
  const std::size_t n = body.rest().phyxelCount();
  require(grab.weights.size() == grab.phyxels.size() && (grab.arms.empty() || grab.arms.size() == grab.phyxels.size()),
          "a grab has another number of weights or arms than of phyxels");
  require(std::all_of(grab.phyxels.begin(), grab.phyxels.end(), [n](Index i) { return i < n; }),
          "a grab holds a phyxel that does not exist");
  for (const double weight : grab.weights) requireFinite("a weight of a grab", weight);
  for (const Vec3 &arm : grab.arms) requireFinite("an arm of a grab", arm);
  requireFinite("a grab", grab.target, grab.frequency, grab.dampingRatio);
  requireRotation(grab.rotation);
  require(grab.frequency >= 0.0 && grab.dampingRatio >= 0.0 && grab.maxForce >= 0.0, "the spring of a grab is not one");
}

/// The body, which is not static.
std::uint64_t movableBody(const SimulatorParts &parts, const ObjectName &name) {
  const std::uint64_t id = parts.world.table.bodyNamed(name);
  if (parts.world.simulator.body(id)->isStatic())
    throw Error(C3DE_E_STATE, "body '" + textOf(name) + "' is rigid and fixed, so it cannot be pulled");
  return id;
}

/// Id of the first entry of this name; 0 if there is none.
template <class Entries, class NameOf>
std::uint64_t idNamed(const Entries &entries, const std::string &name, const NameOf &nameOf) {
  for (const auto &entry : entries)
    if (nameOf(entry) == name) return entry.first;
  return 0;
}

std::uint64_t idOf(const SimulatorParts &parts, const RemoveObject &what) {
  using What = RemoveObject::What;
  const std::string &name = what.name.name;
  switch (what.what) {
    case What::body: return parts.world.table.bodyNamed(what.name);
    case What::obstacle: return parts.world.table.obstacleNamed(what.name);
    case What::load: return parts.forces.loadNumbered(what.number);
    case What::hold: return parts.holds.holdNumbered(what.number);
    case What::attachment:
      return idNamed(parts.world.table.attachments(), name, [](const auto &entry) { return entry.second.name; });
    case What::grasp:
      return idNamed(parts.world.grasps, name,
                     [](const auto &entry) { return entry.second.scene ? entry.second.name : std::string(); });
    case What::probe:
      for (const Probe &probe : parts.world.simulator.world().probes())
        if (probe.name == name) return probe.id;
      break;
  }
  return 0;
}

}  // namespace

void requireJaws(const JawPositions &jaws, const GraspSettings &settings, const Body &body) {
  const std::size_t n = body.rest().surfels.count();
  for (const SkinPoint &point : jaws.points) {
    require(std::all_of(point.corners.begin(), point.corners.end(), [n](Index i) { return i < n; }),
            "a jaw is at a point of the skin that does not exist");
    requireFinite("the point of a jaw", point.weights);
  }
  requireFinite("the direction of jaws", jaws.axis, jaws.normal);
  if (const std::string problem = problemOf(settings); !problem.empty()) require(false, problem);
  if (const std::string problem = problemOf(body.rest(), jaws, settings); !problem.empty()) require(false, problem);
}

std::string RemoveObject::text() const {
  if (what == What::load) return "remove load";
  return what == What::hold ? "release" : "remove " + textOf(name);
}

void RemoveObject::apply(SimulatorParts &parts, ChangeAccess access) const {
  const std::uint64_t id = idOf(parts, *this);
  if (id == 0) missing("'" + (isTransient() ? std::to_string(number) : textOf(name)) + "' to remove");
  SimulatedWorld &world = parts.world;
  parts.snapshots.forget(id);
  world.points.forget(id);
  switch (what) {
    case What::body:
      world.table.removeBody(id);
      world.simulator.removeBody(id);
      parts.forces.removeLoadsOf(access, id);
      parts.holds.removeOf(access, id);
      parts.grasps.removeOf(access, id);
      break;
    case What::obstacle: parts.obstacles.remove(access, id); break;
    case What::probe: (void)world.simulator.world().removeProbe(id); break;
    case What::attachment:
      world.table.removeAttachment(id);
      (void)world.simulator.world().removeAttachment(id);
      break;
    case What::grasp: parts.grasps.remove(access, id); break;
    case What::load: parts.forces.removeLoad(access, id); break;
    case What::hold: parts.holds.remove(access, id); break;
  }
}

void ClearWorld::apply(SimulatorParts &parts, ChangeAccess access) const {
  SimulatedWorld &world = parts.world;
  ++world.resets;
  world.simulator.clear();
  world.table.clear();
  parts.forces.removeLoads();
  parts.conditions.clear();
  parts.holds.clear();
  parts.obstacles.clear(access);
  world.grasps.clear();
}

void PlaceInstrument::apply(SimulatorParts &parts, ChangeAccess access) const {
  requireFinite("the instrument", radius, length, friction, at, axis);
  ProbeTool tool;
  tool.radius = radius;
  tool.length = length;
  tool.friction = friction;
  tool.path = {{0.0, at, axis}};
  parts.obstacles.placeInstrument(access, std::move(tool));
}

void MoveInstrument::apply(SimulatorParts &parts, ChangeAccess access) const {
  requireFinite("the position of the instrument", middle);
  parts.obstacles.moveInstrument(access, middle);
}

void RemoveInstrument::apply(SimulatorParts &parts, ChangeAccess access) const {
  parts.obstacles.removeInstrument(access);
}

void BeginGrasp::apply(SimulatorParts &parts, ChangeAccess access) const {
  const std::uint64_t id = movableBody(parts, body);
  requireJaws(places, settings, *parts.world.simulator.body(id));
  parts.grasps.begin(access, id, places, settings);
}

void MoveGrasp::apply(SimulatorParts &parts, ChangeAccess access) const {
  requireFinite("the position of the jaws", middle);
  requireRotation(rotation);
  parts.grasps.move(access, middle, rotation);
}

void ReleaseGrasp::apply(SimulatorParts &parts, ChangeAccess access) const {
  parts.grasps.remove(access, kInteractiveGrasp);
}

void BeginPinch::apply(SimulatorParts &parts, ChangeAccess access) const {
  const std::uint64_t id = movableBody(parts, body);
  requireGrab(grab, *parts.world.simulator.body(id));
  requireFinite("a limit", ownLimit);
  parts.holds.grab(access, id, grab, ownLimit);
}

void MovePinch::apply(SimulatorParts &parts, ChangeAccess access) const {
  requireFinite("a target", target);
  parts.holds.moveGrab(access, parts.world.table.bodyNamed(body), target);
}

void ReleasePinch::apply(SimulatorParts &parts, ChangeAccess access) const {
  parts.holds.releaseGrab(access, parts.world.table.bodyNamed(body));
}

void AddLoad::apply(SimulatorParts &parts, ChangeAccess access) {
  require(validate(load.region).has_value(), "the region of a load is not one");
  requireFinite("a load", load.force, load.pressure, load.ramp);
  require(load.ramp >= 0.0, "the ramp of a load is below 0");
  id = parts.forces.addLoad(access, parts.world.table.bodyNamed(body), load, number);
}

void BeginHold::apply(SimulatorParts &parts, ChangeAccess access) {
  id = parts.holds.add(access, parts.world.table.bodyNamed(body), *this);
}

void PullHold::apply(SimulatorParts &parts, ChangeAccess access) const {
  const std::uint64_t id = parts.holds.holdNumbered(number);
  if (id == 0) missing("hold " + std::to_string(number));
  if (!target.allFinite()) throw Error(C3DE_E_ARG, "pull: the target is not finite");
  std::optional<Mat3> rotation;
  if (quaternion && parts.holds.keepsShape(id)) rotation = readRotation(quaternion->data(), "pull");
  parts.holds.pull(access, id, target, rotation);
}

void SetSurfaceCondition::apply(SimulatorParts &parts, ChangeAccess access) {
  parts.conditions.set(access, number, condition);
}

void SetMatchedState::apply(SimulatorParts &parts, ChangeAccess access) const {
  const std::uint64_t id = movableBody(parts, body);
  Simulator &simulator = parts.world.simulator;
  Body &matched = *simulator.body(id);
  const std::size_t n = matched.rest().phyxelCount();
  require(displacements.size() == n && forces.size() == n, "a matched state has another number of phyxels");
  for (std::size_t i = 0; i < n; ++i) requireFinite("a matched state", displacements[i], forces[i]);
  matched.state().displacements = displacements;
  matched.state().velocities.assign(n, Vec3::Zero());
  matched.invalidatePointValues();
  matched.forcesCurrent = false;
  parts.forces.setMatched(access, id, forces);
  simulator.stepper().wake(id);
}

void StoreState::apply(SimulatorParts &parts, ChangeAccess access) { bytes = parts.savedState.bytes(access); }

void StoreCheckpoint::apply(SimulatorParts &parts, ChangeAccess access) { parts.checkpoints.store(access, number); }

void ExchangeCheckpoint::apply(SimulatorParts &parts, ChangeAccess access) const {
  if (!parts.checkpoints.exchange(access, number)) missing("checkpoint " + std::to_string(number));
}

void DropCheckpoint::apply(SimulatorParts &parts, ChangeAccess access) const {
  // One that was stored before a recording began is not in its replay.
  (void)parts.checkpoints.drop(access, number);
}

}  // namespace pointbased
