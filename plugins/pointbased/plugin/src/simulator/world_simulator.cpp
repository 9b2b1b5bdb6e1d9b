// SPDX-License-Identifier: Apache-2.0
#include "simulator/world_simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/sdk/conditions.hpp"
#include "c3de/sdk/identification.hpp"
#include "c3de/sdk/matching.hpp"
#include "c3de/sdk/structs.hpp"
#include "simulator/point_sets.h"

namespace pointbased {
namespace {

using sdk::Error;

/// Calls a member of a part: sdk::thunk for what WorldSimulator does not do itself.
template <auto part, auto member, class Type = decltype(member)>
struct PartCall;
template <auto part, auto member, class Part, class R, class... Args>
struct PartCall<part, member, R (Part::*)(Args...)> {
  static c3de_status C3DE_CALL call(c3de_object *self, Args... args) noexcept {
    return sdk::guard([&]() -> R { return (WorldSimulator::from(self)->parts().*part.*member)(args...); });
  }
};
template <auto part, auto member>
constexpr auto *slot = &PartCall<part, member>::call;
template <auto member>
constexpr auto *own = sdk::thunk<WorldSimulator, member>;

using Self = WorldSimulator;
using Parts = SimulatorParts;

constexpr c3de_simulator_v1 kSimulatorSlots{
    .size = sizeof(c3de_simulator_v1),
    .rev = 1,
    .attach = own<&Self::attach>,
    .declarations = own<&Self::declarations>,
    .set_world = slot<&Parts::calls, &ChangingCalls::setWorld>,
    .add_body = slot<&Parts::bodies, &Bodies::add>,
    .add_obstacle = slot<&Parts::obstacles, &Obstacles::add>,
    .add_probe = slot<&Parts::probes, &Probes::add>,
    .set_body_param = slot<&Parts::calls, &ChangingCalls::setBodyParameter>,
    .get_body_param = slot<&Parts::bodies, &Bodies::getParameter>,
    .remove = slot<&Parts::calls, &ChangingCalls::remove>,
    .clear = slot<&Parts::calls, &ChangingCalls::clear>,
    .step = own<&Self::step>,
    .reset = own<&Self::reset>,
    .publish = own<&Self::publish>,
    .status = own<&Self::status>,
    .state_hash = own<&Self::stateHash>,
    .report = own<&Self::report>,
    .body_at = slot<&Parts::queries, &BodyQueries::bodyAt>,
    .body_info = slot<&Parts::queries, &BodyQueries::bodyInfo>,
    .enum_fields = slot<&Parts::queries, &BodyQueries::enumFields>,
    .read_field = slot<&Parts::queries, &BodyQueries::readField>,
    .triangles = slot<&Parts::queries, &BodyQueries::triangles>,
    .enum_probes = slot<&Parts::probes, &Probes::enumerate>,
    .displacement = slot<&Parts::queries, &BodyQueries::displacement>,
    .interrupt = own<&Self::interrupt>,
    .activity = own<&Self::activity>,
    .points = slot<&Parts::forces, &ExternalForces::points>,
    .add_load = slot<&Parts::calls, &ChangingCalls::addLoad>,
    .hold = slot<&Parts::calls, &ChangingCalls::hold>,
    .pull = slot<&Parts::calls, &ChangingCalls::pull>,
    .hold_state = slot<&Parts::holds, &Holds::state>,
    .save_state = slot<&Parts::calls, &ChangingCalls::saveState>,
    .load_state = slot<&Parts::savedState, &SavedState::load>,
    .verify = slot<&Parts::verifier, &BodyVerifier::report>,
};
constexpr c3de_pointbased_bodies_v1 kBodiesSlots{sizeof(c3de_pointbased_bodies_v1), 1, own<&Self::phyxels>,
                                                 own<&Self::surfels>};
constexpr c3de_contact_v1 kContactSlots{sizeof(c3de_contact_v1), 1, slot<&Parts::contacts, &Contacts::setPair>,
                                        slot<&Parts::contacts, &Contacts::addProbeTool>,
                                        slot<&Parts::contacts, &Contacts::enumProbeTools>};
constexpr c3de_attachment_v1 kAttachmentSlots{sizeof(c3de_attachment_v1), 1,
                                              slot<&Parts::attachments, &Attachments::add>,
                                              slot<&Parts::attachments, &Attachments::enumerate>};
constexpr c3de_grasp_v1 kGraspSlots{sizeof(c3de_grasp_v1), 1, slot<&Parts::grasps, &Grasps::add>};
constexpr c3de_changes_v1 kChangesSlots{sizeof(c3de_changes_v1), 1, slot<&Parts::changes, &Changes::observe>,
                                        slot<&Parts::changes, &Changes::apply>};
constexpr c3de_continuation_v0 kContinuationSlots{sizeof(c3de_continuation_v0), 1,
                                                  slot<&Parts::continuation, &Continuation::continueFrom>};
constexpr c3de_conditions_v0 kConditionSlots{
    sizeof(c3de_conditions_v0), 1, slot<&Parts::conditionCalls, &ConditionCalls::set>,
    slot<&Parts::conditionCalls, &ConditionCalls::remove>, slot<&Parts::conditionCalls, &ConditionCalls::state>};
constexpr c3de_matching_v0 kMatchingSlots{sizeof(c3de_matching_v0), 1, slot<&Parts::matching, &MatchingCalls::match>};
constexpr c3de_identification_v0 kIdentificationSlots{sizeof(c3de_identification_v0), 1,
                                                      slot<&Parts::identification, &IdentificationCalls::fit>,
                                                      slot<&Parts::identification, &IdentificationCalls::sensitivity>};

}  // namespace

WorldSimulator::WorldSimulator(PluginContext &context) : context_(context), parts_(context) { context_.laws.refresh(); }

WorldSimulator::~WorldSimulator() {
  if (node_.v != 0 && context_.listener) context_.listener->detached(*this);
}

std::array<sdk::Interface, 10> WorldSimulator::interfaces() {
  return {sdk::interfaceOf(kSimulatorSlots),     sdk::interfaceOf(kBodiesSlots),    sdk::interfaceOf(kContactSlots),
          sdk::interfaceOf(kAttachmentSlots),    sdk::interfaceOf(kGraspSlots),     sdk::interfaceOf(kChangesSlots),
          sdk::interfaceOf(kContinuationSlots),  sdk::interfaceOf(kConditionSlots), sdk::interfaceOf(kMatchingSlots),
          sdk::interfaceOf(kIdentificationSlots)};
}

WorldSimulator *WorldSimulator::fromAbi(c3de_object *object) {
  const auto *table = sdk::Ref<>::share(object).query<c3de_continuation_v0>();
  return table == &kContinuationSlots ? from(object) : nullptr;
}

void WorldSimulator::attach(c3de_handle node) {
  if (node_.v == node.v) return;
  if (node_.v != 0 && context_.listener) context_.listener->detached(*this);
  node_ = node;
  if (node_.v != 0 && context_.listener) context_.listener->attached(*this, node_);
}

void WorldSimulator::declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
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
}

void WorldSimulator::step() {
  SimulatedWorld &world = parts_.world;
  const StateLock lock(world);
  parts_.conditions.update();
  parts_.forces.apply(parts_.conditions);
  parts_.grasps.update();
  const double budget =
      isInteracting() ? std::numeric_limits<double>::infinity() : stepBudget(world.parameters, context_.hasWindow);
  world.request.beginStep(budget);
  auto stepped = simulator_.step(&world.request);
  const bool tookTooLong = !stepped && stepped.error().ended && world.request.isOverBudget();
  world.request.endStep();
  if (tookTooLong)
    throw Error(C3DE_E_TIMEOUT, "the step was abandoned after " + shortNumber(budget) +
                                    " s (solver.step_budget), the previous state is kept: " +
                                    simulator_.stepper().suggestAffordableStep(stepped.error(), budget));
  if (!stepped) throw Error(stepped.error().ended ? C3DE_E_CANCELLED : C3DE_E_DIVERGED, stepped.error().text);
  parts_.forces.continueToEquilibrium(parts_.conditions);
}

bool WorldSimulator::isInteracting() const {
  const auto isHeld = [this](const auto &entry) { return !simulator_.body(entry.first)->grabs.empty(); };
  const auto isInstrument = [this](const auto &entry) { return simulator_.world().isInstrument(entry.first); };
  return std::any_of(table_.bodies().begin(), table_.bodies().end(), isHeld) ||
         std::any_of(table_.obstacles().begin(), table_.obstacles().end(), isInstrument);
}

void WorldSimulator::activity(c3de_sink text) {
  std::string line = simulator_.diagnostics().activity();
  const double budget = parts_.world.request.budget();
  if (!line.empty() && std::isfinite(budget)) line += "; abandoned after " + shortNumber(budget) + " s";
  if (const c3de_status status = sdk::put(text, line); status < 0) throw Error(status, "the text was not accepted");
}

void WorldSimulator::reset() {
  const StateLock lock(parts_.world);
  parts_.forces.removeLoads();
  parts_.holds.clear();
  parts_.world.reset();
}

void WorldSimulator::publish() {
  const std::lock_guard lock(parts_.world.mutex);
  parts_.conditions.update();
  parts_.snapshots.publish(viewSettings(parts_.world.parameters), parts_.grasps.snapshots(),
                           parts_.conditions.snapshots(), parts_.world.isShowing());
}

void WorldSimulator::status(c3de_sim_status *out) {
  const std::lock_guard lock(parts_.world.mutex);
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
  const StateLock lock(parts_.world, StateLock::AtEnd::shape);
  sdk::notNull(out, "out") = simulator_.stateHash();
}

bool WorldSimulator::hasStepped() {
  const std::lock_guard lock(parts_.world.mutex);
  return simulator_.steps() > 0;
}

void WorldSimulator::report(c3de_sink json) {
  std::string text;
  // Before the first step there is no error yet, so a report at that time does not wait.
  if (hasStepped()) parts_.accuracy.computeTrials(sdk::Progress(nullptr), context_.services.parallelFor());
  {
    const StateLock lock(parts_.world, StateLock::AtEnd::shape);
    std::vector<ReportedBody> bodies;
    const std::shared_ptr<const WorldVerification> verified = parts_.snapshots.verificationOfNow();
    for (const std::uint64_t id : table_.bodiesInOrder()) {
      const BodyRecord &record = *table_.body(id);
      bodies.push_back({id, record.surface->volume, areaOf(*record.surface), record.source.fixNumbers,
                        record.source.fixNames, record.promise, record.adaptive, record.trials,
                        verified ? verified->body(id) : nullptr});
    }
    text = reportJson(simulator_, bodies, parts_.contacts.reported(), parts_.attachments.reported(),
                      parts_.grasps.reported(), parts_.conditions.reported(),
                      [this](std::size_t id) { return table_.nameOf(id); });
  }
  if (const c3de_status status = sdk::put(json, text); status < 0) throw Error(status, "the report was not taken");
}

void WorldSimulator::phyxels(c3de_handle body, c3de_object **out) {
  {
    const std::lock_guard lock(parts_.world.mutex);
    (void)table_.bodyOrThrow(body.v);
  }
  sdk::notNull(out, "out") =
      sdk::make<PhyxelSet>(context_, sdk::Ref<WorldSimulator>::share(this), body.v).detach()->abi();
}

void WorldSimulator::surfels(c3de_handle body, c3de_object **out) {
  {
    const std::lock_guard lock(parts_.world.mutex);
    (void)table_.bodyOrThrow(body.v);
  }
  sdk::notNull(out, "out") = sdk::make<SurfelSet>(sdk::Ref<WorldSimulator>::share(this), body.v).detach()->abi();
}

}  // namespace pointbased
