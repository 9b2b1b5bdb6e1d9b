// SPDX-License-Identifier: Apache-2.0
// A simulation continues from the state of another one whose bodies may be filled differently.
#include <set>

#include "base/expects.h"
#include "base/point_tree.h"
#include "body/history_transfer.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

constexpr double kExtrapolatedSpacings = 0.9;

bool haveSamePhyxels(const Body &a, const Body &b) {
  return a.rest().origin == b.rest().origin && a.rest().positions == b.rest().positions &&
         a.rest().pointCentres == b.rest().pointCentres;
}

double energyOf(const Body &body, const ParallelFor &parallelFor) {
  if (body.isStatic()) return 0.0;
  const ElasticEnergy elastic = body.rigid() ? ElasticEnergy() : body.elasticEnergy(parallelFor);
  return elastic.strain + elastic.stabilisation + body.kineticEnergy();
}

/// Why `to` cannot continue from `from`; empty: it can.
std::string continuationError(const Body &from, const Body &to) {
  if (!from.isStatic() && from.rereferenceCount() > 0)
    return "body '" + from.name() + "' has flowed so far that its reference is a later shape";
  if (from.rigid() != to.rigid() || from.isFreeRigid() != to.isFreeRigid())
    return "body '" + to.name() + "' is rigid in only one of the simulations";
  return {};
}

/// Sets displacements and velocities of some phyxels to those of another body at the points of the binding.
/// @param numbers  [points of the binding] of phyxels
void interpolateMotion(const Body &from, const Interpolation &binding, std::span<const std::size_t> numbers, State &to,
                       const ParallelFor &parallelFor) {
  std::vector<Vec3> values(numbers.size());
  interpolateDisplacements(binding, from.rest().positions, from.state().displacements, values, parallelFor);
  for (std::size_t i = 0; i < numbers.size(); ++i) to.displacements[numbers[i]] = values[i];
  interpolateField(binding, from.state().velocities, values, parallelFor);
  for (std::size_t i = 0; i < numbers.size(); ++i) to.velocities[numbers[i]] = values[i];
}

State interpolatedState(const Body &from, const Body &to, const ParallelFor &parallelFor) {
  const RestState &rest = to.rest(), &other = from.rest();
  State state = to.checkpoint().state;
  const PointTree tree(other.positions);
  // Beyond the cells next to the other body, trilinear extrapolation would distort: an affine motion is continued.
  const double reach = kExtrapolatedSpacings * other.spacing;
  std::vector<Vec3> near, far;
  std::vector<std::size_t> nearNumbers, farNumbers;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 at = rest.positions[i] + rest.origin - other.origin;
    Index nearest = 0;
    double squared = 0.0;
    (void)tree.nearest(at, 1, &nearest, &squared);
    const bool isFar = squared > reach * reach;
    (isFar ? far : near).push_back(at);
    (isFar ? farNumbers : nearNumbers).push_back(i);
  }
  interpolateMotion(from, other.bind(near, {}), nearNumbers, state, parallelFor);
  if (!far.empty())
    interpolateMotion(from, bindToCloud(far, other.positions, parallelFor), farNumbers, state, parallelFor);
  detail::transferHistory(from, state, rest);
  return state;
}

/// State of the phyxels alone; the memory of contact and integrators is reset.
State copiedState(const Body &from, const Body &to) {
  State state = to.checkpoint().state;
  const PointHistory &history = from.state().history;
  state.displacements = from.state().displacements;
  state.velocities = from.state().velocities;
  if (history.plasticInverse.size() == state.history.plasticInverse.size())
    state.history.plasticInverse = history.plasticInverse;
  if (history.prony.size() == state.history.prony.size()) state.history.prony = history.prony;
  if (history.modes.size() == state.history.modes.size()) state.history.modes = history.modes;
  return state;
}

}  // namespace

Result<std::vector<ContinuedBody>> StateArchive::continueFrom(
    const StateArchive &from, std::span<const std::pair<std::size_t, std::size_t>> bodies) {
  const detail::SimulationState &other = from.state_;
  const auto refused = [](const std::string &text) { return tl::unexpected<std::string>(text); };
  if (other.quasiStatic() != state_.quasiStatic())
    return refused("one of the simulations is quasi-static, the other is not");
  std::set<std::size_t> theirs, ours;
  for (const auto &[before, now] : bodies) {
    const Body *source = other.body(before), *target = state_.body(now);
    if (!source || !target || !theirs.insert(before).second || !ours.insert(now).second)
      return refused("the bodies " + std::to_string(before) + " and " + std::to_string(now) +
                     " do not exist, or are stated twice");
    if (const std::string error = continuationError(*source, *target); !error.empty()) return refused(error);
  }
  state_.reset();
  state_.progress = other.progress;
  std::vector<ContinuedBody> continued;
  for (const auto &[before, now] : bodies) {
    const Body &source = *other.body(before);
    detail::BodyStepper &stepper = *state_.bodies.at(now);
    Body &target = stepper.body();
    if (target.isStatic()) continue;
    const bool isSame = haveSamePhyxels(source, target);
    detail::BodyStepper::Checkpoint checkpoint = stepper.checkpoint();
    checkpoint.body.state =
        isSame ? copiedState(source, target) : interpolatedState(source, target, state_.parallelFor);
    if (state_.progress.steps > 0) checkpoint.body.state.supportTime = state_.rampTime();
    const bool isRestored = stepper.restore(checkpoint, state_.parallelFor);
    POINTBASED_EXPECTS(isRestored, "a checkpoint of the same body");
    target.placeHeld(state_.rampTime(), false);
    target.invalidatePointValues();
    continued.push_back({now, isSame, energyOf(source, state_.parallelFor), energyOf(target, state_.parallelFor)});
  }
  return continued;
}

}  // namespace pointbased
