// SPDX-License-Identifier: Apache-2.0
#include "rereferencing/rereferencing.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

constexpr std::uint64_t kLookInterval = 8;  // steps
constexpr std::size_t kFirstTold = 3;       // rereferencings that are reported one by one; later ones at powers of two

bool isReported(std::size_t count) { return count <= kFirstTold || (count & (count - 1)) == 0; }

}  // namespace

bool Stepper::rereferenceIfNeeded(std::size_t id, const StopRequest *stop) {
  Body &body = *state_.body(id);
  if (!state_.settings.rereference || body.stopped || state_.reported.notRereferenced.contains(id)) return false;
  if ((state_.progress.steps + 1) % kLookInterval != 0 || !body.constitution().plastic() || !needsRereferencing(body))
    return false;
  body.computeGradients(state_.parallelFor);
  Result<Rereferencing> renewal;
  try {
    const StoppableLoops::Watch watch(state_.loops, stop);
    renewal = rereferenced(body, state_.parallelFor);
  } catch (const Stopped &) {
    return false;
  }
  if (!renewal) {
    state_.reported.notRereferenced.insert(id);
    state_.reportEvent(
        "note", "body '" + body.name() + "' has flowed far, but its reference cannot be renewed: " + renewal.error());
    return false;
  }
  std::vector<Vec3> ways;
  for (const Probe &probe : state_.probes) ways.push_back(world_.probeState(probe).position - probe.reference);
  const std::size_t relieved = renewal->relieved;
  body.rereference(std::move(renewal->rest), std::move(renewal->state), state_.parallelFor);
  state_.bindProbes(id, ways);
  if (isReported(body.rereferenceCount()))
    state_.reportEvent(
        "renewed",
        "body '" + body.name() + "' has flowed far: its present shape is its reference, time " +
            std::to_string(body.rereferenceCount()) +
            (relieved > 0 ? "; " + std::to_string(relieved) + " crushed points have lost their elastic strain" : ""));
  return true;
}

}  // namespace pointbased
