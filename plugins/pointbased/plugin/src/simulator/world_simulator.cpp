// SPDX-License-Identifier: Apache-2.0
#include "simulator/world_simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/sdk/structs.hpp"
#include "instruments/grab_patch.h"
#include "report/report.h"
#include "simulator/body_fields.h"
#include "simulator/point_sets.h"

namespace pointbased {
namespace {

using sdk::Error;
using sdk::Failure;

}  // namespace

WorldSimulator::WorldSimulator(PluginContext &context)
    : context_(context), simulator_(context.services.parallelFor()),
      snapshots_(context.services, simulator_, table_, points_) {
  context_.laws.refresh();
}

WorldSimulator::~WorldSimulator() {
  if (node_.v != 0 && context_.listener) context_.listener->detached(*this);
}

std::array<sdk::Interface, 5> WorldSimulator::interfaces() {
  static constexpr c3de_pointbased_bodies_v1 kBodies{sizeof(c3de_pointbased_bodies_v1), 1,
                                                     sdk::thunk<WorldSimulator, &WorldSimulator::phyxels>,
                                                     sdk::thunk<WorldSimulator, &WorldSimulator::surfels>};
  return {sdk::interfaceOf(sdk::kSimulatorTable<WorldSimulator>), sdk::interfaceOf(kBodies),
          sdk::interfaceOf(sdk::kContactTable<WorldSimulator>), sdk::interfaceOf(sdk::kAttachmentTable<WorldSimulator>),
          sdk::interfaceOf(sdk::kGraspTable<WorldSimulator>)};
}

void WorldSimulator::attach(c3de_handle node) {
  if (node_.v == node.v) return;
  if (node_.v != 0 && context_.listener) context_.listener->detached(*this);
  node_ = node;
  if (node_.v != 0 && context_.listener) context_.listener->attached(*this, node_);
}

c3de_status WorldSimulator::declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                                         std::uint64_t *stride) {
  std::span<const c3de_param_decl> found;
  switch (scope) {
    case C3DE_SIM_SCOPE_WORLD: found = worldDeclarations(); break;
    case C3DE_SIM_SCOPE_BODY: found = context_.laws.declarations(); break;
    case C3DE_SIM_SCOPE_OBSTACLE: found = obstacleDeclarations(); break;
    default: throw Error(C3DE_E_ARG, "scope " + std::to_string(scope) + " is not known; accepted: 1 … 3");
  }
  sdk::notNull(decls, "decls") = found.data();
  sdk::notNull(n, "n") = found.size();
  sdk::notNull(stride, "stride") = sizeof(c3de_param_decl);
  return C3DE_OK;
}

sdk::Result<void> WorldSimulator::setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  const std::lock_guard lock(mutex_);
  ParameterValues changed = world_;
  if (auto done = changed.set(values, n, stride); !done) return done;
  if (auto done = resolveAccuracyTarget(changed, values, n, stride); !done) return done;
  const WorldSettings settings = worldSettings(changed);
  if (settings.box.enabled && !((settings.box.max - settings.box.min).minCoeff() > 0.0))
    return Failure{C3DE_E_ARG, "world.box.max must be above world.box.min on every axis"};
  if (settings.integrator == Integrator::quasiStatic)
    for (const auto &[id, record] : table_.bodies()) record.checkFree(*record.values, true);
  world_ = std::move(changed);
  // Parameters that affect only the view or the time limit of a step are not passed to the solver.
  bool isForTheSolver = n == 0;
  for (std::uint64_t i = 0; i < n && !isForTheSolver; ++i) {
    const std::string_view id = sdk::text(sdk::readElement(values, i, stride, "value").id);
    isForTheSolver = !isOfTheView(id) && id != "solver.step_budget";
  }
  if (isForTheSolver) {
    const bool isExplicit = mayStepExplicitly(settings.integrator);
    if (isExplicit != mayStepExplicitly(simulator_.world().settings().integrator))
      for (const auto &[id, record] : table_.bodies())
        if (record.adaptive && record.adaptive->halved > 0)
          simulator_.body(id)->scaleMasses(isExplicit ? record.adaptive->evenStep : 0.0,
                                           context_.services.parallelFor());
    simulator_.setWorld(settings);
    simulator_.world().setContact(contactSettings(world_));
  }
  return {};
}

void WorldSimulator::growWorldBox(const BodyRecord &body) {
  const WorldBox &box = simulator_.world().settings().box;
  const Vec3 low = box.min.cwiseMin(body.surface->min), high = box.max.cwiseMax(body.surface->max);
  if (!box.enabled || (low == box.min && high == box.max)) return;
  ParameterValues changed = world_;
  for (const auto &[id, corner] : {std::pair("world.box.min", low), std::pair("world.box.max", high)}) {
    c3de_param_value value = sdk::orThrow(world_.get(id));
    for (int axis = 0; axis < 3; ++axis) value.vec[axis] = corner[axis];
    sdk::orThrow(changed.set(value));
  }
  world_ = std::move(changed);
  simulator_.setWorld(worldSettings(world_));
  context_.services.log.info("the walls of the world have made room for '" + body.name + "'");
}

void WorldSimulator::add(const c3de_sim_body *body, c3de_handle *out, Walls walls) {
  const c3de_sim_body in = sdk::readStruct(body, "body");
  BodyRecord record;
  record.name = std::string(sdk::text(in.name));
  ParameterValues values(context_.laws.declarations());
  sdk::orThrow(values.set(in.params, in.params_n, in.params_stride));
  record.source = readSource(in, values);
  record.values = std::make_shared<const ParameterValues>(std::move(values));
  record.checkRigid();
  BuiltBody built = buildBody(context_.services, context_.laws, record.name, in.mesh, record.source, *record.values,
                              samplingRequest(), sdk::Progress(in.progress));
  record.take(built);
  record.source.mesh = std::make_shared<const sdk::MeshHandle>(copyMesh(context_.services, in.mesh));
  const StepInterrupt::Waiting waiting(request_);
  const std::lock_guard lock(mutex_);
  record.checkFree(*record.values, simulator_.quasiStatic());
  if (walls == Walls::growWorldBox) growWorldBox(record);
  record.checkInsideWalls(simulator_.world().settings().box, built.body->rest().spacing);
  resetSimulator();
  const std::uint64_t id = simulator_.addBody(std::move(built.body));
  table_.addBody(id, std::move(record));
  if (out) *out = {id};
}

void WorldSimulator::addObstacle(const c3de_sim_obstacle *obstacle, c3de_handle *out) {
  const c3de_sim_obstacle in = sdk::readStruct(obstacle, "obstacle");
  ParameterValues values(obstacleDeclarations());
  sdk::orThrow(values.set(in.params, in.params_n, in.params_stride));
  const std::string name(sdk::text(in.name));
  auto mesh = placeMesh(context_.services, in.mesh, readPlacement(in.placement));
  Obstacle built =
      buildObstacle(context_.services, name, mesh, {values.number("friction"), values.number("restitution")},
                    readMotion(in.motion, "obstacle"));
  ObstacleRecord record{name, std::move(mesh), built.friction, built.restitution, built.motion};
  const std::lock_guard lock(mutex_);
  resetSimulator();
  const std::uint64_t id = simulator_.addObstacle(std::move(built));
  table_.addObstacle(id, std::move(record));
  if (out) *out = {id};
}

void WorldSimulator::addProbe(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  const BodyRecord &record = table_.bodyOrThrow(body.v);
  (void)sdk::notNull(at_m3, "at_m3");
  const Vec3 at(at_m3[0], at_m3[1], at_m3[2]);
  const std::string which = "probe '" + std::string(sdk::text(name)) + "': ";
  if (!at.allFinite()) throw Error(C3DE_E_ARG, which + "the point is not finite");
  // A probe is carried by the cell that contains it. Off the skin it is carried by the cell of the skin, whose
  // functions are extrapolated. Within half a spacing these are as accurate as the sampling; farther off they represent
  // no tissue.
  record.checkNearBody(context_.services, at, simulator_.body(body.v)->rest().spacing, which);
  for (const Probe &other : simulator_.world().probes())
    if (other.name == sdk::text(name)) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  const std::size_t id = simulator_.world().addProbe(std::string(sdk::text(name)), body.v, at);
  if (out) *out = {id};
}

sdk::Result<void> WorldSimulator::setBodyParam(c3de_handle body, const c3de_param_value *value) {
  const c3de_param_value in = sdk::readStruct(value, "value");
  const std::lock_guard lock(mutex_);
  BodyRecord &record = table_.bodyOrThrow(body.v);
  ParameterValues changed = *record.values;
  if (auto done = changed.set(in); !done) return done;
  const std::string_view id = sdk::text(in.id);
  for (const c3de_param_decl &d : changed.declarations())
    if (sdk::text(d.id) == id && (d.flags & C3DE_PARAM_NEEDS_RESET))
      return Failure{C3DE_E_STATE, std::string(id) + " takes effect when the body is built again"};
  if (isOfTheSurroundings(id)) {
    if (const auto set = simulator_.world().setFoundation(body.v, foundationOf(changed)); !set)
      return Failure{C3DE_E_ARG, record.name + ": " + std::string(id) + ": " + set.error()};
  } else if (id == "rigid" || id == C3DE_PARAM_ID_FREE) {
    record.checkFree(changed, simulator_.quasiStatic());
    simulator_.world().setRigid(body.v, isRigid(changed), isFree(changed));
  } else {
    // Parts keep the values they specify themselves.
    for (BodyPart &part : record.source.parts)
      if (std::find(part.own.begin(), part.own.end(), id) == part.own.end()) sdk::orThrow(part.values.set(in));
    if (const auto lent = lent_.find(body.v); lent != lent_.end()) lent->second.masses.clear();
    simulator_.world().setConstitution(body.v, constitutionOf(context_.laws, record.name, record.source, changed));
  }
  record.values = std::make_shared<const ParameterValues>(std::move(changed));
  return {};
}

sdk::Result<void> WorldSimulator::getBodyParam(c3de_handle body, c3de_str id, c3de_param_value *out) {
  const std::lock_guard lock(mutex_);
  auto found = table_.bodyOrThrow(body.v).values->get(sdk::text(id));
  if (!found) return found.failure();
  sdk::writeStruct(out, *found, "out");
  return {};
}

sdk::Result<void> WorldSimulator::remove(c3de_handle handle) {
  const std::lock_guard lock(mutex_);
  snapshots_.forget(handle.v);
  points_.forget(handle.v);
  if (table_.removeBody(handle.v)) {
    simulator_.removeBody(handle.v);
    std::erase_if(liveLoads_, [&](const auto &entry) { return entry.second.body == handle.v; });
    std::erase_if(holds_, [&](const auto &entry) { return entry.second.body == handle.v; });
    std::erase_if(grasps_, [&](const auto &entry) {
      const GraspRecord &record = entry.second;
      return (record.scene ? record.scene->body : record.now->body) == handle.v;
    });
    return {};
  }
  if (const auto hold = holds_.find(handle.v); hold != holds_.end()) {
    simulator_.stepper().releaseGrab(hold->second.body, hold->first);
    holds_.erase(hold);
    return {};
  }
  if (liveLoads_.erase(handle.v) > 0 || simulator_.world().removeProbe(handle.v)) return {};
  if (table_.removeObstacle(handle.v)) {
    simulator_.removeObstacle(handle.v);
    return {};
  }
  if (table_.removeAttachment(handle.v)) {
    simulator_.world().removeAttachment(handle.v);
    return {};
  }
  if (grasps_.contains(handle.v) && handle.v != kInteractiveGrasp) {
    releaseGrasp(handle.v);
    return {};
  }
  return noSuch("body, obstacle, attachment, load, probe, grasp or hold");
}

void WorldSimulator::reattach(Attachment attachment, std::uint64_t before, std::uint64_t now) {
  (attachment.first == before ? attachment.first : attachment.second) = now;
  if (const auto added = simulator_.world().addAttachment(attachment))
    table_.addAttachment(*added, std::move(attachment));
  else
    simulator_.diagnostics().addWarning(now, "attachment '" + attachment.name + "' was removed: " + added.error());
}

void WorldSimulator::clear() {
  const std::lock_guard lock(mutex_);
  simulator_.clear();
  table_.clear();
  liveLoads_.clear();
  holds_.clear();
  grasps_.clear();
}

sdk::Result<void> WorldSimulator::step() {
  const std::lock_guard lock(mutex_);
  applyExternalForces();
  updateGrasps();
  const double budget =
      isInteracting() ? std::numeric_limits<double>::infinity() : stepBudget(world_, context_.hasWindow);
  request_.beginStep(budget);
  auto stepped = simulator_.step(&request_);
  const bool tookTooLong = !stepped && stepped.error().ended && request_.isOverBudget();
  request_.endStep();
  if (tookTooLong)
    return Failure{C3DE_E_TIMEOUT, "the step was given up after " + shortNumber(budget) +
                                       " s (solver.step_budget), the state before it stays: " +
                                       simulator_.stepper().suggestAffordableStep(stepped.error(), budget)};
  if (!stepped) return Failure{stepped.error().ended ? C3DE_E_CANCELLED : C3DE_E_DIVERGED, stepped.error().text};
  return {};
}

bool WorldSimulator::isInteracting() const {
  const auto isHeld = [this](const auto &entry) { return !simulator_.body(entry.first)->grabs.empty(); };
  const auto isInstrument = [this](const auto &entry) { return simulator_.world().isInstrument(entry.first); };
  return std::any_of(table_.bodies().begin(), table_.bodies().end(), isHeld) ||
         std::any_of(table_.obstacles().begin(), table_.obstacles().end(), isInstrument);
}

void WorldSimulator::activity(c3de_sink text) {
  std::string line = simulator_.diagnostics().activity();
  const double budget = request_.budget();
  if (!line.empty() && std::isfinite(budget)) line += "; given up after " + shortNumber(budget) + " s";
  if (const c3de_status status = sdk::put(text, line); status < 0) throw Error(status, "the text was not accepted");
}

void WorldSimulator::reset() {
  const std::lock_guard lock(mutex_);
  liveLoads_.clear();
  holds_.clear();
  resetSimulator();
}

void WorldSimulator::publish() {
  const std::lock_guard lock(mutex_);
  snapshots_.publish(viewSettings(world_), graspsNow());
}

void WorldSimulator::status(c3de_sim_status *out) {
  const std::lock_guard lock(mutex_);
  c3de_sim_status s{};
  s.failed = simulator_.failed() ? 1u : 0u;
  s.steps = simulator_.steps();
  s.time_s = simulator_.time();
  s.dt_s = simulator_.stepper().stepSize();
  s.bodies = table_.bodies().size();
  s.obstacles = table_.obstacles().size();
  s.finished = simulator_.finished() ? 1u : 0u;
  s.stopped = static_cast<std::uint32_t>(simulator_.stepper().stoppedBodies());
  if (simulator_.quasiStatic()) {
    s.flags = C3DE_SIM_LOAD_STEPS;
    s.planned_steps = static_cast<std::uint32_t>(simulator_.world().settings().loadSteps);
  }
  sdk::writeStruct(out, s, "out");
}

void WorldSimulator::stateHash(std::uint64_t *out) {
  const std::lock_guard lock(mutex_);
  sdk::notNull(out, "out") = simulator_.stateHash();
}

bool WorldSimulator::hasStepped() const {
  const std::lock_guard lock(mutex_);
  return simulator_.steps() > 0;
}

void WorldSimulator::report(c3de_sink json) {
  std::string text;
  // Before the first step there is no error yet, so a report at that time does not wait.
  if (hasStepped()) computeTrials(sdk::Progress(nullptr), context_.services.parallelFor());
  {
    const std::lock_guard lock(mutex_);
    std::vector<ReportedBody> bodies;
    const std::shared_ptr<const WorldVerification> verified = snapshots_.verificationOfNow();
    for (const std::uint64_t id : table_.bodiesInOrder()) {
      const BodyRecord &record = *table_.body(id);
      bodies.push_back({id, record.surface->volume, areaOf(*record.surface), record.source.fixNumbers,
                        record.source.fixNames, record.promise, record.adaptive, record.trials,
                        verified ? verified->body(id) : nullptr});
    }
    text = reportJson(simulator_, bodies, reportedTools(), reportedAttachments(), reportedGrasps(),
                      [this](std::size_t id) { return table_.nameOf(id); });
  }
  if (const c3de_status status = sdk::put(json, text); status < 0) throw Error(status, "the report was not taken");
}

sdk::Result<void> WorldSimulator::bodyAt(std::uint64_t index, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  const std::vector<std::uint64_t> ids = table_.bodiesInOrder();
  if (index >= ids.size()) return noSuch("body");
  sdk::notNull(out, "out") = {ids[static_cast<std::size_t>(index)]};
  return {};
}

sdk::Result<void> WorldSimulator::bodyInfo(c3de_handle handle, c3de_sim_body_info *out) {
  const std::lock_guard lock(mutex_);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  sdk::writeStruct(out, record.info(*simulator_.body(handle.v)), "out");
  return {};
}

c3de_status WorldSimulator::enumFields(c3de_handle body, void *visitor, EachField each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  {
    const std::lock_guard lock(mutex_);
    (void)table_.bodyOrThrow(body.v);
  }
  for (const std::span<const c3de_sim_field> fields : {bodyFields(), contactFields()})
    for (const c3de_sim_field &field : fields)
      if (const c3de_status status = each(visitor, &field); status != C3DE_OK) return status;
  return C3DE_OK;
}

void WorldSimulator::readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
  const std::lock_guard lock(mutex_);
  (void)table_.bodyOrThrow(body.v);
  const Body &of = *simulator_.body(body.v);
  if (!isContactField(on, sdk::text(name))) return readBodyField(of, on, sdk::text(name), out);
  std::vector<double> pressures;
  simulator_.diagnostics().contactPressures(body.v, pressures);
  writeContactPressures(of, on, pressures, context_.services.parallelFor(), out);
}

void WorldSimulator::triangles(c3de_handle body, c3de_view *out) {
  const std::lock_guard lock(mutex_);
  (void)table_.bodyOrThrow(body.v);
  const auto &skin = simulator_.body(body.v)->rest().skin;
  static_assert(sizeof(skin[0]) == 3 * sizeof(std::uint32_t));
  sdk::notNull(out, "out") = {skin.data(), skin.size(), 3, C3DE_U32, 0};
}

c3de_status WorldSimulator::enumProbes(void *visitor, EachProbe each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(mutex_);
  for (const Probe &probe : simulator_.world().probes()) {
    const World::ProbeState state = simulator_.world().probeState(probe);
    c3de_sim_probe out{};
    out.size = sizeof out;
    out.name = sdk::str(probe.name);
    out.body = {probe.body};
    for (int a = 0; a < 3; ++a) {
      out.reference_m[a] = probe.reference[a];
      out.position_m[a] = state.position[a];
      out.velocity_m_s[a] = state.velocity[a];
    }
    if (const c3de_status status = each(visitor, &out); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

void WorldSimulator::phyxels(c3de_handle body, c3de_object **out) {
  {
    const std::lock_guard lock(mutex_);
    (void)table_.bodyOrThrow(body.v);
  }
  sdk::notNull(out, "out") =
      sdk::make<PhyxelSet>(context_, sdk::Ref<WorldSimulator>::share(this), body.v).detach()->abi();
}

void WorldSimulator::surfels(c3de_handle body, c3de_object **out) {
  {
    const std::lock_guard lock(mutex_);
    (void)table_.bodyOrThrow(body.v);
  }
  sdk::notNull(out, "out") = sdk::make<SurfelSet>(sdk::Ref<WorldSimulator>::share(this), body.v).detach()->abi();
}

void WorldSimulator::setGrab(std::uint64_t body, Grab grab, double ownLimit) {
  const std::lock_guard lock(mutex_);
  if (const Body *held = simulator_.body(body)) limitToTissue(grab, *held, ownLimit);
  recordGrab(body, grab);
  simulator_.stepper().setGrab(body, std::move(grab));
}

void WorldSimulator::moveGrab(std::uint64_t body, const Vec3 &target) {
  const std::lock_guard lock(mutex_);
  recordPull(body, 0);
  simulator_.stepper().moveGrab(body, target);
}

void WorldSimulator::releaseGrab(std::uint64_t body) {
  const std::lock_guard lock(mutex_);
  simulator_.stepper().releaseGrab(body);
}

ParameterValues WorldSimulator::worldValues() const {
  const std::lock_guard lock(mutex_);
  return world_;
}

std::optional<BodySource> WorldSimulator::source(std::uint64_t body) const {
  const std::lock_guard lock(mutex_);
  const BodyRecord *found = table_.body(body);
  return found ? std::optional(found->source) : std::nullopt;
}

void WorldSimulator::rebuildBody(std::uint64_t body, const ParameterValues &values, const sdk::Progress &progress) {
  std::string name;
  BodySource from;
  {
    const std::lock_guard lock(mutex_);
    const BodyRecord &record = table_.bodyOrThrow(body);
    name = record.name;
    from = record.source;
  }
  BuiltBody built =
      buildBody(context_.services, context_.laws, name, from.mesh->handle(), from, values, samplingRequest(), progress);
  const StepInterrupt::Waiting waiting(request_);
  const std::lock_guard lock(mutex_);
  BodyRecord record = table_.bodyOrThrow(body);
  const ContactPairs pairs = simulator_.world().contactPairs();
  const std::vector<Attachment> attached = table_.attachmentsOf(body);
  record.take(built);
  record.values = std::make_shared<const ParameterValues>(values);
  table_.removeBody(body);
  simulator_.removeBody(body);
  resetSimulator();
  const std::size_t id = simulator_.addBody(std::move(built.body));
  table_.addBody(id, std::move(record));
  for (auto &[number, grasp] : grasps_)
    if (grasp.scene && grasp.scene->body == body) grasp.scene->body = id;  // on the same skin
  for (const auto &[pair, settings] : pairs)
    if (pair.first == body || pair.second == body)
      simulator_.world().setContactPair(id, pair.first == body ? pair.second : pair.first, settings);
  for (const Attachment &attachment : attached) reattach(attachment, body, id);
}

void WorldSimulator::displacement(const c3de_sim_grid *grid, double rim, float *out, float *gaps) const {
  if (!grid || !out) throw Error(C3DE_E_ARG, "displacement: grid or xyz_m is null");
  if (!(rim >= 0.0) || !std::isfinite(rim)) throw Error(C3DE_E_ARG, "displacement: rim_m is not finite and >= 0");
  DisplacementField field(readGrid(*grid, "grid"), gaps != nullptr);
  const std::size_t points = grid->points[0] * grid->points[1] * grid->points[2];
  const std::lock_guard lock(mutex_);
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    field.add(body, points_.of(id, body.sharedRest()));
  }
  field.write(rim, {out, 3 * points});
  if (gaps) field.writeGaps({out, 3 * points}, {gaps, points});
}

Vec3 WorldSimulator::displacementAt(const Vec3 &place) const {
  DisplacementField field({{1, 1, 1}, place, Mat3::Identity()});
  std::array<float, 3> u{};
  const std::lock_guard lock(mutex_);
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    field.add(body, points_.of(id, body.sharedRest()));
  }
  field.write(0.0, u);
  return vectorOf(u);
}

bool WorldSimulator::readBody(std::uint64_t body, const std::function<void(const Body &)> &read) const {
  const std::lock_guard lock(mutex_);
  const Body *found = simulator_.body(body);
  if (!found) return false;
  read(*found);
  return true;
}

}  // namespace pointbased
