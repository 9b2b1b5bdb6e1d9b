// SPDX-License-Identifier: Apache-2.0
#include "simulator.h"

#include <cstring>
#include <limits>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/structs.hpp"
#include "scene_input.h"

namespace mass_spring {
namespace {

using sdk::Error;

// Of methods that find a body's rest.
constexpr std::string_view kIntegrator = "solver.integrator", kLoadSteps = "solver.load_steps";

struct Field {
  std::uint32_t on;
  std::string_view name, unit;
  std::uint32_t comps;
};
constexpr std::string_view kStretch = "stretch";
constexpr std::uint32_t kPoints = C3DE_SIM_ON_POINTS, kSurface = C3DE_SIM_ON_SURFACE;
constexpr std::array kFields{
    Field{kPoints, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3},
    Field{kPoints, C3DE_SIM_FIELD_POSITION, "m", 3},
    Field{kPoints, C3DE_SIM_FIELD_VELOCITY, "m/s", 3},
    Field{kPoints, C3DE_SIM_FIELD_MASS, "kg", 1},
    Field{kPoints, C3DE_SIM_FIELD_VOLUME, "m^3", 1},
    Field{kPoints, "displacement", "m", 3},
    Field{kPoints, "force", "N", 3},
    Field{kPoints, kStretch, "1", 1},
    Field{kSurface, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3},
    Field{kSurface, C3DE_SIM_FIELD_POSITION, "m", 3},
    Field{kSurface, C3DE_SIM_FIELD_VELOCITY, "m/s", 3},
    Field{kSurface, "displacement", "m", 3},
};

}  // namespace

Simulator::~Simulator() {
  if (node_.v != 0 && context_.attached) context_.attached(*this, {});
}

std::array<sdk::Interface, 1> Simulator::interfaces() { return {sdk::interfaceOf(sdk::kSimulatorTable<Simulator>)}; }

void Simulator::attach(c3de_handle node) {
  if (node.v == node_.v) return;
  if (node_.v != 0 && context_.attached) context_.attached(*this, {});
  node_ = node;
  if (node_.v != 0 && context_.attached) context_.attached(*this, node_);
}

void Simulator::declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                             std::uint64_t *stride) {
  if (scope < C3DE_SIM_SCOPE_WORLD || scope > C3DE_SIM_SCOPE_OBSTACLE)
    throw Error(C3DE_E_ARG, "scope " + std::to_string(scope) + " is not known; accepted: 1 ... 3");
  const auto found = scope == C3DE_SIM_SCOPE_WORLD  ? context_.method.world
                     : scope == C3DE_SIM_SCOPE_BODY ? context_.method.body
                                                    : context_.method.ofObstacle;
  sdk::notNull(decls, "decls") = found.data();
  sdk::notNull(n, "n") = found.size();
  sdk::notNull(stride, "stride") = sizeof(c3de_param_decl);
}

void Simulator::setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  const std::lock_guard lock(mutex_);
  ParameterValues changed = world_;
  changed.set(values, n, stride);
  const Vec3 low = changed.vector(C3DE_PARAM_ID_BOX_MIN), high = changed.vector(C3DE_PARAM_ID_BOX_MAX);
  for (std::size_t a = 0; a < 3; ++a)
    if (!(high[a] > low[a])) throw Error(C3DE_E_ARG, "world.box.max must be above world.box.min on every axis");
  const ParameterValues before = std::exchange(world_, std::move(changed));
  try {
    (void)stepSize();
    if (isQuasiStatic() && world_.number(C3DE_PARAM_ID_BOX_ENABLED) != 0.0)
      throw Error(C3DE_E_UNSUPPORTED,
                  methodText(context_, "touch no walls on their way to rest; accepted: no world.box"));
    if (!isQuasiStatic() && !obstacles_.empty())
      throw Error(C3DE_E_UNSUPPORTED, methodText(context_, "touch obstacles on their way to rest only"));
  } catch (...) {
    world_ = before;
    throw;
  }
}

void Simulator::addObstacle(const c3de_sim_obstacle *obstacle, c3de_handle *out) {
  if (!context_.method.obstacle)
    throw Error(C3DE_E_UNSUPPORTED,
                methodText(context_, "touch nothing but the walls of the world; accepted: no obstacle"));
  const auto in = sdk::readStruct(obstacle, "obstacle");
  ParameterValues values(context_.method.ofObstacle);
  values.set(in.params, in.params_n, in.params_stride);
  const std::lock_guard lock(mutex_);
  if (!isQuasiStatic())
    throw Error(
        C3DE_E_UNSUPPORTED,
        methodText(context_, "touch obstacles on their way to rest only; accepted: solver.integrator = quasistatic"));
  obstacles_.emplace(nextId_, context_.method.obstacle(context_.host, in));
  resetAll();
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

Simulator::Body &Simulator::bodyOrThrow(c3de_handle body) {
  const auto found = bodies_.find(body.v);
  if (found == bodies_.end()) throw Error(C3DE_E_STALE, "there is no such body in this simulation");
  return found->second;
}

void Simulator::addProbe(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  const PointBody &physics = *bodyOrThrow(body).physics;
  const Lattice &lattice = physics.lattice();
  Probe probe{nextId_, body.v, std::string(sdk::text(name)), vectorOf(&sdk::notNull(at_m3, "at_m3")), {}};
  const std::string which = "probe '" + probe.name + "': ";
  if (!isFinite(probe.reference)) throw Error(C3DE_E_ARG, which + "the point is not finite");
  for (const Probe &other : probes_)
    if (other.name == probe.name) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  double off = 0.0;
  probe.bound = physics.bind(probe.reference, &off);
  if (!(off <= 0.5 * lattice.spacing()))
    throw Error(C3DE_E_ARG, which + "the point lies " + shown(1e3 * off) +
                                " mm off the lattice of the body; accepted: up to half a spacing (" +
                                shown(500.0 * lattice.spacing()) + " mm)");
  probes_.push_back(std::move(probe));
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

void Simulator::setBodyParam(c3de_handle body, const c3de_param_value *value) {
  const auto in = sdk::readStruct(value, "value");
  const std::lock_guard lock(mutex_);
  Body &of = bodyOrThrow(body);
  ParameterValues changed = of.values;
  changed.set(in);
  const std::string id(sdk::text(in.id));
  if ((changed.declaration(id).flags & C3DE_PARAM_NEEDS_RESET) != 0)
    throw Error(C3DE_E_STATE, id + " takes effect when the body is built again");
  std::vector<Part> parts = of.parts;
  for (Part &part : parts)
    if (std::find(part.own.begin(), part.own.end(), id) == part.own.end()) part.values.set(in);
  const std::vector<Elasticity> before = of.physics->materials();
  of.physics->setMaterials(materials(of.physics->lattice(), changed, parts));
  try {
    (void)stepSize();
  } catch (...) {
    of.physics->setMaterials(before);
    throw;
  }
  of.values = std::move(changed);
  of.parts = std::move(parts);
}

void Simulator::getBodyParam(c3de_handle body, c3de_str id, c3de_param_value *out) {
  const std::lock_guard lock(mutex_);
  sdk::writeStruct(out, bodyOrThrow(body).values.value(sdk::text(id)), "out");
}

void Simulator::remove(c3de_handle what) {
  const std::lock_guard lock(mutex_);
  std::size_t gone = bodies_.erase(what.v) + obstacles_.erase(what.v);
  gone += std::erase_if(probes_, [&](const Probe &p) { return p.id == what.v || p.body == what.v; });
  for (auto &[id, body] : bodies_) gone += body.liveLoads.erase(what.v) + body.physics->holds.erase(what.v);
  if (gone == 0) throw Error(C3DE_E_STALE, "there is no such body, obstacle, probe, load or hold in this simulation");
}

void Simulator::clear() {
  const std::lock_guard lock(mutex_);
  bodies_.clear();
  obstacles_.clear();
  probes_.clear();
  resetAll();
}

/// The stable step of the stiffest body, or what was asked for.
double Simulator::stepSize() const {
  double stable = std::numeric_limits<double>::infinity(), longest = stable;
  const std::string *stiffest = nullptr;
  for (const auto &[id, body] : bodies_) {
    stable = std::min(stable, body.physics->stableStep_s());
    if (body.physics->longestStep_s() < longest) {
      longest = body.physics->longestStep_s();
      stiffest = &body.name;
    }
  }
  if (world_.isAuto("solver.dt")) return stiffest != nullptr ? stable : 1e-3;
  const double wanted = world_.number("solver.dt");
  if (wanted > longest)
    throw Error(C3DE_E_ARG, "solver.dt = " + shown(wanted) + " s is above the stable step of body '" + *stiffest +
                                "'; accepted: up to " + shown(longest) + " s, or \"auto\"");
  return wanted;
}

bool Simulator::isQuasiStatic() const { return context_.method.relax && world_.text(kIntegrator) == "quasistatic"; }

std::uint64_t Simulator::loadSteps() const { return static_cast<std::uint64_t>(world_.number(kLoadSteps)); }

Loading Simulator::loadingOf(const Body &body, const Moment &moment) const {
  Loading out{moment, moment.of(0.0) * world_.vector(C3DE_PARAM_ID_GRAVITY), {}, {}, {}};
  for (const auto &[id, obstacle] : obstacles_) out.obstacles.push_back(obstacle);
  if (body.hasForces) out.external_N = body.lentForces;
  for (const auto &[number, load] : body.liveLoads) out.more.push_back(load);
  return out;
}

void Simulator::step() {
  const std::lock_guard lock(mutex_);
  const bool isLoadStep = isQuasiStatic();
  if (isLoadStep && steps_ >= loadSteps()) return;
  const double dt = stepSize();
  Moment moment{time_s_};
  if (isLoadStep) moment.factor = static_cast<double>(steps_ + 1) / static_cast<double>(loadSteps());
  const double damping = world_.number(C3DE_PARAM_ID_DAMPING);
  const bool hasWalls = world_.number(C3DE_PARAM_ID_BOX_ENABLED) != 0.0;
  std::vector<PointBody::State> before;
  for (const auto &[id, body] : bodies_) before.push_back(body.physics->state());
  std::string failure;
  for (auto &[id, body] : bodies_) {
    const Loading loading = loadingOf(body, moment);
    body.hasForces = false;
    try {
      if (isLoadStep)
        context_.method.relax(*body.physics, loading, world_);
      else
        body.physics->step(dt, damping, loading);
    } catch (const Error &error) {
      if (failure.empty()) failure = "body '" + body.name + "': " + error.what();
    }
    if (hasWalls && !isLoadStep)
      body.physics->keepWithin(world_.vector(C3DE_PARAM_ID_BOX_MIN), world_.vector(C3DE_PARAM_ID_BOX_MAX));
    if (const std::string trouble = isLoadStep ? body.physics->trouble() : ""; !trouble.empty() && failure.empty())
      failure = "body '" + body.name + "': " + trouble;
    if (!body.physics->isFinite() && failure.empty())
      failure = "body '" + body.name + "' left the finite numbers; help: a smaller load, more damping";
  }
  failed_ = !failure.empty();
  if (failed_) {
    std::size_t i = 0;
    for (auto &[id, body] : bodies_) body.physics->setState(std::move(before[i++]));
    throw Error(C3DE_E_DIVERGED, failure);
  }
  ++steps_;
  if (!isLoadStep) time_s_ += dt;
}

void Simulator::resetAll() {
  for (auto &[id, body] : bodies_) {
    body.physics->reset();
    body.liveLoads.clear();
    body.hasForces = false;
  }
  steps_ = 0;
  time_s_ = 0.0;
  failed_ = false;
}

void Simulator::reset() {
  const std::lock_guard lock(mutex_);
  resetAll();
}

void Simulator::publish() {
  auto next = std::make_shared<Snapshot>();
  {
    const std::lock_guard lock(mutex_);
    for (const auto &[id, body] : bodies_) {
      std::optional<Vec3> force;
      if (!body.physics->holds.empty()) force = body.physics->holds.rbegin()->second.force_N;  // of the last hand
      next->bodies.push_back({id, body.name, body.colour, body.triangles,
                              body.physics->onSkin(body.physics->state().positions), body.physics->lattice().spacing(),
                              body.physics->masses().size(), force});
    }
  }
  const std::lock_guard lock(snapshotMutex_);
  snapshot_ = std::move(next);
}

std::shared_ptr<const Snapshot> Simulator::snapshot() const {
  const std::lock_guard lock(snapshotMutex_);
  return snapshot_;
}

void Simulator::status(c3de_sim_status *out) {
  const std::lock_guard lock(mutex_);
  c3de_sim_status s{};
  s.failed = failed_ ? 1u : 0u;
  s.steps = steps_;
  s.time_s = time_s_;
  s.dt_s = stepSize();
  if (isQuasiStatic()) {
    s.flags = C3DE_SIM_LOAD_STEPS;
    s.planned_steps = static_cast<std::uint32_t>(loadSteps());
    s.finished = !bodies_.empty() && steps_ >= loadSteps() ? 1u : 0u;
  }
  s.bodies = bodies_.size();
  s.obstacles = obstacles_.size();
  sdk::writeStruct(out, s, "out");
}

void Simulator::bodyAt(std::uint64_t index, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  if (index >= bodies_.size())
    throw Error(C3DE_E_NOT_FOUND, "body " + std::to_string(index) + ": there are " + std::to_string(bodies_.size()));
  sdk::notNull(out, "out") = {std::next(bodies_.begin(), static_cast<std::ptrdiff_t>(index))->first};
}

void Simulator::bodyInfo(c3de_handle body, c3de_sim_body_info *out) {
  const std::lock_guard lock(mutex_);
  const Body &of = bodyOrThrow(body);
  const PointBody &p = *of.physics;
  c3de_sim_body_info info{};
  info.name = sdk::str(of.name);
  info.points = p.masses().size();
  info.surface_points = p.skin().vertices.size();
  info.mass_kg = p.mass_kg();
  info.volume_m3 = p.volume_m3();
  info.mesh_volume_m3 = of.meshVolume_m3;
  info.spacing_m = p.lattice().spacing();
  info.stable_dt_s = p.stableStep_s();
  sdk::writeStruct(out, info, "out");
}

c3de_status Simulator::enumFields(c3de_handle body, void *visitor,
                                  c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_field *field)) {
  if (each == nullptr) throw Error(C3DE_E_ARG, "each is null");
  bool hasStretch = false;
  {
    const std::lock_guard lock(mutex_);
    hasStretch = !bodyOrThrow(body).physics->stretches().empty();
  }
  for (const Field &f : kFields) {
    if (f.name == kStretch && !hasStretch) continue;
    const c3de_sim_field field{sizeof field, f.on, sdk::str(f.name), sdk::str(f.unit), f.comps, 0};
    if (const c3de_status status = each(visitor, &field); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

void Simulator::readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
  const std::lock_guard lock(mutex_);
  const PointBody &p = *bodyOrThrow(body).physics;
  const std::string_view which = sdk::text(name);
  const auto field =
      std::find_if(kFields.begin(), kFields.end(), [&](const Field &f) { return f.on == on && f.name == which; });
  if (field == kFields.end() || (which == kStretch && p.stretches().empty()))
    throw Error(C3DE_E_NOT_FOUND, methodText(context_, "have no field '" + std::string(which) + "' there"));
  const auto write = [&](const auto &values, const auto &copyRow) {
    if (out.count < values.size())
      throw Error(C3DE_E_ARG, "field '" + std::string(which) + "' has " + std::to_string(values.size()) +
                                  " rows; there is room for " + std::to_string(out.count));
    for (std::size_t i = 0; i < values.size(); ++i) copyRow(i, values[i]);
  };
  if (field->comps == 1) {
    const auto rows = sdk::orThrow(sdk::asMutableRows<double, 1>(out, which));
    write(which == C3DE_SIM_FIELD_MASS     ? p.masses()
          : which == C3DE_SIM_FIELD_VOLUME ? p.volumes()
                                           : p.stretches(),
          [&](std::size_t i, double value) { *rows[i] = value; });
    return;
  }
  std::vector<Vec3> values = which == C3DE_SIM_FIELD_VELOCITY             ? p.state().velocities
                             : which == C3DE_SIM_FIELD_REFERENCE_POSITION ? p.points()
                             : which == "force"                           ? p.forces()
                                                                          : p.state().positions;
  if (which == "displacement")
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= p.points()[i];
  const auto rows = sdk::orThrow(sdk::asMutableRows<double, 3>(out, which));
  write(on == kSurface ? p.onSkin(values) : values,
        [&](std::size_t i, const Vec3 &value) { std::copy(value.begin(), value.end(), rows[i]); });
}

void Simulator::triangles(c3de_handle body, c3de_view *out) {
  const std::lock_guard lock(mutex_);
  const auto &found = *bodyOrThrow(body).triangles;
  sdk::notNull(out, "out") = {found.data(), found.size(), 3, C3DE_U32, 0};
}

c3de_status Simulator::enumProbes(void *visitor,
                                  c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_probe *probe)) {
  if (each == nullptr) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(mutex_);
  for (const Probe &probe : probes_) {
    const PointBody::State &state = bodies_.at(probe.body).physics->state();
    c3de_sim_probe out{};
    out.size = sizeof out;
    out.name = sdk::str(probe.name);
    out.body = {probe.body};
    const Vec3 x = probe.bound.of(state.positions), v = probe.bound.of(state.velocities);
    std::copy(probe.reference.begin(), probe.reference.end(), out.reference_m);
    std::copy(x.begin(), x.end(), out.position_m);
    std::copy(v.begin(), v.end(), out.velocity_m_s);
    if (const c3de_status status = each(visitor, &out); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

void Simulator::points(c3de_handle handle, c3de_sim_points *out) {
  const std::lock_guard lock(mutex_);
  Body &body = bodyOrThrow(handle);
  const PointBody &p = *body.physics;
  const std::size_t n = p.masses().size();
  body.lentPositions = p.state().positions;
  body.lentVelocities = p.state().velocities;
  body.lentForces.assign(n, Vec3{});
  body.lentMasses = p.masses();
  for (std::size_t i = 0; i < n; ++i)
    if (p.held()[i] != 0) body.lentMasses[i] = 0.0;
  body.hasForces = true;
  c3de_sim_points points{};
  points.name = sdk::str(body.name);
  points.count = n;
  points.positions_m = body.lentPositions.front().data();
  points.velocities_m_s = body.lentVelocities.front().data();
  points.masses_kg = body.lentMasses.data();
  points.forces_N = body.lentForces.front().data();
  sdk::writeStruct(out, points, "out");
}

void Simulator::addLoad(c3de_handle handle, const c3de_sim_load *load, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  Body &body = bodyOrThrow(handle);
  SurfaceLoad made = readLoad(sdk::readStruct(load, "load"), *body.physics);
  made.began_s = time_s_;
  body.liveLoads.emplace(nextId_, std::move(made));
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

void Simulator::hold(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out) {
  const auto asked = sdk::readStruct(hold, "hold");
  const auto amount = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!isFinite(vectorOf(asked.at_m)) || !(asked.radius_m > 0.0) || !std::isfinite(asked.radius_m))
    throw Error(C3DE_E_ARG, "hold: accepted: a finite point and a radius above 0 m");
  if (!amount(asked.frequency_hz) || !amount(asked.damping_ratio) || !amount(asked.max_force_N))
    throw Error(C3DE_E_ARG,
                "hold: accepted: a frequency, a damping ratio and a force that are finite and not negative");
  if (asked.flags != 0)
    throw Error(C3DE_E_UNSUPPORTED, methodText(context_, "lead the mean of what is held, and nothing else"));
  const std::lock_guard lock(mutex_);
  PointBody &p = *bodyOrThrow(body).physics;
  p.holds.emplace(nextId_, p.holdAround(asked));
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

std::pair<std::uint64_t, Hold *> Simulator::holdOrThrow(c3de_handle handle) {
  for (auto &[id, body] : bodies_)
    if (const auto found = body.physics->holds.find(handle.v); found != body.physics->holds.end())
      return {id, &found->second};
  throw Error(C3DE_E_STALE, "no such hold: it was removed, or its body was");
}

void Simulator::pull(c3de_handle hold, const double *target_m3, const double *) {
  if (target_m3 == nullptr || !isFinite(vectorOf(target_m3))) throw Error(C3DE_E_ARG, "pull: the target is not finite");
  const std::lock_guard lock(mutex_);
  holdOrThrow(hold).second->target_m = vectorOf(target_m3);
}

void Simulator::holdState(c3de_handle hold, c3de_sim_hold_state *out) {
  const std::lock_guard lock(mutex_);
  const auto [body, hand] = holdOrThrow(hold);
  c3de_sim_hold_state state{};
  state.body = {body};
  for (std::size_t c = 0; c < 3; ++c) {
    state.point_m[c] = hand->middle_m[c] - hand->offset_m[c];
    state.target_m[c] = hand->target_m[c];
    state.force_N[c] = hand->force_N[c];
  }
  state.mass_kg = hand->mass_kg;
  sdk::writeStruct(out, state, "out");
}

}  // namespace mass_spring
