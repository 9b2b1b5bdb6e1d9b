// SPDX-License-Identifier: Apache-2.0
#include "simulator/grasps.h"

#include <algorithm>
#include <cmath>

#include "c3de/sdk/structs.hpp"

namespace pointbased {
namespace {

using sdk::Error;

// Grab id in the simulator; the pinch has 0. The jaws of a scene have the id of their grasp and the next one.
constexpr std::uint64_t kFirstGrab = 1;

std::string millimetres(double metres) { return shortNumber(1e3 * metres) + " mm"; }

/// Id of the grab of its first jaw; the second jaw has the next id.
std::uint64_t findGrab(std::uint64_t grasp) { return grasp == kInteractiveGrasp ? kFirstGrab : grasp; }

}  // namespace

void Grasps::begin(ChangeAccess, std::uint64_t body, const JawPositions &places, const GraspSettings &settings) {
  erase(kInteractiveGrasp);
  GraspRecord record;
  record.now = beginGrasp(body, *simulator_.body(body), places, settings);
  setGrabs(kInteractiveGrasp, *record.now);
  grasps_.emplace(kInteractiveGrasp, std::move(record));
}

void Grasps::move(ChangeAccess, const Vec3 &middle, const Mat3 &rotation) {
  const auto found = grasps_.find(kInteractiveGrasp);
  if (found == grasps_.end()) return;
  found->second.now->middle = middle;
  found->second.now->rotation = rotation;
}

void Grasps::removeOf(ChangeAccess, std::uint64_t body) {
  std::erase_if(grasps_, [body](const auto &entry) { return entry.second.body() == body; });
}

void Grasps::erase(std::uint64_t id) {
  const auto found = grasps_.find(id);
  if (found == grasps_.end()) return;
  if (found->second.now)
    for (std::uint64_t jaw = 0; jaw < 2; ++jaw)
      simulator_.stepper().releaseGrab(found->second.now->body, findGrab(id) + jaw);
  grasps_.erase(found);
}

void Grasps::setGrabs(std::uint64_t id, const Grasp &grasp) {
  for (std::size_t jaw = 0; jaw < 2; ++jaw) {
    world_.recordGrab(grasp.body, grasp.grabs[jaw]);
    simulator_.stepper().setGrab(grasp.body, grasp.grabs[jaw], findGrab(id) + jaw);
  }
}

std::optional<GraspForces> Grasps::forcesOn(std::uint64_t id, const Grasp &grasp) const {
  std::array<GrabStatus, 2> grabs;
  for (std::size_t jaw = 0; jaw < 2; ++jaw) {
    const std::optional<GrabStatus> status = simulator_.stepper().grabStatus(grasp.body, findGrab(id) + jaw);
    if (!status) return std::nullopt;
    grabs[jaw] = *status;
  }
  // Before the first step their state has not been evaluated.
  if (grabs[0].mass == 0.0) {
    GraspForces none;
    none.gap = grasp.initialGap;
    return none;
  }
  return forcesOf(grasp, grabs);
}

void Grasps::update() {
  if (grasps_.empty()) return;
  const double dt = simulator_.stepper().stepSize(), end = simulator_.time() + dt;
  for (auto entry = grasps_.begin(); entry != grasps_.end();) {
    const std::uint64_t id = entry->first;
    GraspRecord &record = entry->second;
    if (!record.now && !record.isReleased && record.scene && end > record.scene->startTime()) {
      record.now = beginGrasp(record.scene->body, *simulator_.body(record.scene->body), record.scene->jaws,
                              record.scene->settings);
      setGrabs(id, *record.now);
    }
    if (record.now) {
      const std::optional<GraspForces> forces = forcesOn(id, *record.now);
      if (!forces) {  // the phyxels that it held have been replaced, or the body is static
        record.now.reset();
        record.isReleased = true;
      } else {
        advanceClosing(*record.now, *forces, dt);
        if (record.scene) record.scene->applyPose(*record.now, end);
        record.now->updateTargets();
        for (std::size_t jaw = 0; jaw < 2; ++jaw) {
          world_.recordPull(record.now->body, findGrab(id) + jaw);
          simulator_.stepper().moveGrab(record.now->body, record.now->grabs[jaw].target, findGrab(id) + jaw);
          simulator_.stepper().turnGrab(record.now->body, record.now->rotation, findGrab(id) + jaw);
        }
      }
    }
    entry = record.now || record.scene ? std::next(entry) : grasps_.erase(entry);
  }
}

InteractionState Grasps::checkpoint() const { return {simulator_.archive().checkpoint(), grasps_}; }

bool Grasps::exchange(ChangeAccess, InteractionState &other) {
  InteractionState left = checkpoint();
  if (!simulator_.archive().restore(other.state)) return false;
  grasps_ = other.grasps;
  for (const auto &[id, record] : grasps_)
    if (record.now) setGrabs(id, *record.now);
  other = std::move(left);
  table_.syncInstruments(simulator_);
  return true;
}

std::uint64_t Grasps::jawsNamed(const std::string &name) const {
  if (name.empty()) return kInteractiveGrasp;
  for (const auto &[id, record] : grasps_)
    if (record.scene && record.name == name) return id;
  return 0;
}

std::vector<SavedGrasp> Grasps::saved() const {
  std::vector<SavedGrasp> all;
  for (const auto &[id, record] : grasps_) {
    SavedGrasp &one = all.emplace_back();
    one = {record.scene ? record.name : std::string(), id, record.isReleased, std::nullopt};
    if (!record.now) continue;
    const Grasp &now = *record.now;
    one.now = {table_.bodyOrThrow(now.body).identity(),
               now.jaws,
               now.settings,
               now.offsets,
               now.middle,
               now.rotation,
               now.initialGap,
               now.targetGap,
               now.commandedGap};
  }
  return all;
}

std::map<std::uint64_t, std::uint64_t> Grasps::grabIds(const std::vector<SavedGrasp> &saved) const {
  std::map<std::uint64_t, std::uint64_t> ids;
  for (const SavedGrasp &one : saved) {
    const std::uint64_t id = jawsNamed(one.name);
    if (id == 0) throw Error(C3DE_E_FORMAT, "there is no grasp '" + one.name + "' in this scene");
    if (!one.now) continue;
    requireJaws(one.now->jaws, one.now->settings, *simulator_.body(table_.bodyNamed(one.now->body)));
    requireFinite("a grasp", one.now->offsets[0], one.now->offsets[1], one.now->middle, one.now->initialGap,
                  one.now->targetGap, one.now->commandedGap);
    requireRotation(one.now->rotation);
    for (std::uint64_t jaw = 0; jaw < 2; ++jaw) ids.emplace(findGrab(one.id) + jaw, findGrab(id) + jaw);
  }
  return ids;
}

void Grasps::restore(const std::vector<SavedGrasp> &saved) {
  grasps_.erase(kInteractiveGrasp);
  for (auto &[id, record] : grasps_) {
    record.now.reset();
    record.isReleased = false;
  }
  for (const SavedGrasp &one : saved) {
    const std::uint64_t id = jawsNamed(one.name);
    if (id != kInteractiveGrasp) grasps_.at(id).isReleased = one.isReleased;
    if (!one.now) continue;
    Grasp now{table_.bodyNamed(one.now->body),
              one.now->jaws,
              one.now->settings,
              {},
              one.now->offsets,
              one.now->middle,
              one.now->rotation,
              one.now->initialGap,
              one.now->targetGap,
              one.now->commandedGap};
    for (const ActiveGrab &active : simulator_.body(now.body)->grabs)
      if (active.id == findGrab(id) || active.id == findGrab(id) + 1) now.grabs[active.id - findGrab(id)] = active.grab;
    grasps_[id].now = std::move(now);
  }
}

std::vector<GraspSnapshot> Grasps::snapshots() const {
  std::vector<GraspSnapshot> out;
  for (const auto &[id, record] : grasps_) {
    if (!record.now) continue;
    const std::optional<GraspForces> forces = forcesOn(id, *record.now);
    if (!forces) continue;
    const Grasp &grasp = *record.now;
    out.push_back({id, record.name, grasp.body, grasp.jaws.points, grasp.settings, grasp.middle, grasp.rotation,
                   grasp.axis(), Vec3(grasp.rotation * grasp.jaws.normal), *forces});
  }
  return out;
}

std::vector<ReportedGrasp> Grasps::reported() const {
  std::vector<ReportedGrasp> out;
  for (const auto &[id, record] : grasps_) {
    ReportedGrasp one;
    one.name = record.name;
    if (record.now)
      if (const std::optional<GraspForces> forces = forcesOn(id, *record.now)) {
        one.forces = *forces;
        one.holds = true;
      }
    out.push_back(std::move(one));
  }
  return out;
}

double SceneGrasp::startTime() const { return path.empty() ? 0.0 : path.front().time; }

void SceneGrasp::applyPose(Grasp &grasp, double time) const {
  if (path.empty()) return;
  const auto after =
      std::find_if(path.begin(), path.end(), [time](const GraspPose &place) { return place.time > time; });
  if (after == path.begin()) return;
  const GraspPose &from = *std::prev(after), &to = after == path.end() ? from : *after;
  const double s = after == path.end() ? 0.0 : (time - from.time) / (to.time - from.time);
  grasp.middle = from.at + s * (to.at - from.at);
  grasp.rotation = from.rotation.slerp(s, to.rotation).toRotationMatrix();
}

void Grasps::add(const c3de_sim_grasp *given, c3de_handle *out) {
  const c3de_sim_grasp in = sdk::readStruct(given, "grasp");
  const std::string which = "grasp '" + std::string(sdk::text(in.name)) + "': ";
  const auto refuse = [&which](const std::string &text) { throw Error(C3DE_E_ARG, which + text); };
  GraspRecord record;
  record.name = std::string(sdk::text(in.name));
  SceneGrasp &scene = record.scene.emplace();
  scene.body = in.body.v;
  scene.settings = {in.jaw_m, in.opening_m, in.closed_m, in.force_limit_N};
  if (const std::string problem = problemOf(scene.settings); !problem.empty()) refuse(problem);
  const Vec3 at(in.at_m), axis(in.axis);
  if (!at.allFinite() || !axis.allFinite() || axis.norm() <= 0.0)
    refuse("the point or the axis is not finite; accepted: finite numbers, and an axis that is not [0, 0, 0]");
  if (in.path_n > 0 && in.path == nullptr) refuse("its path is null");
  for (std::uint64_t k = 0; k < in.path_n; ++k) {
    const auto place = sdk::readElement(in.path, k, in.path_stride, which + "place");
    const Vec3 to(place.at_m);
    if (!std::isfinite(place.time_s) || !to.allFinite() ||
        !(scene.path.empty() || place.time_s > scene.path.back().time))
      refuse("place " + std::to_string(k) + " of its path: accepted: finite numbers and times that ascend");
    scene.path.push_back({place.time_s, to, Eigen::Quaterniond(readRotation(place.quaternion, "path"))});
  }
  const StateLock lock(world_);
  const BodyRecord &of = table_.bodyOrThrow(in.body.v);
  for (const auto &[id, other] : grasps_)
    if (other.name == record.name) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  if (simulator_.quasiStatic())
    throw Error(C3DE_E_UNSUPPORTED, which +
                                        "a quasi-static solution supports no grasps; accepted: solver.integrator = "
                                        "auto, explicit or implicit");
  if (simulator_.body(in.body.v)->isStatic())
    refuse("body '" + of.name +
           "' is rigid and fixed, so it cannot be pulled; accepted: rigid = false, or free = true");
  const PlacedMesh &mesh = *of.surface;
  const double off = distanceOff(world_.context.services, mesh, at);
  const RestState &rest = simulator_.body(in.body.v)->rest();
  if (off > 0.5 * scene.settings.opening + rest.spacing)
    refuse("(" + shortNumber(at[0]) + ", " + shortNumber(at[1]) + ", " + shortNumber(at[2]) + ") m lies " +
           millimetres(off) + " off body '" + of.name + "'; accepted: on its skin, or up to half the opening and a " +
           "spacing (" + millimetres(0.5 * scene.settings.opening + rest.spacing) + ") off it");
  const c3de_closest nearest = closestOn(world_.context.services, mesh, at);
  auto places = findJaws({mesh.positions, mesh.triangles}, Vec3(nearest.point), Vec3(nearest.normal), axis.normalized(),
                         scene.settings);
  if (!places) refuse("body '" + of.name + "': " + places.error());
  scene.jaws = *places;
  if (const std::string problem = problemOf(rest, scene.jaws, scene.settings); !problem.empty())
    refuse("body '" + of.name + "': " + problem);
  world_.reset();
  const std::uint64_t id = world_.allocateIds(2);  // one grab id for each jaw
  grasps_.emplace(id, std::move(record));
  if (out) *out = {id};
}

}  // namespace pointbased
