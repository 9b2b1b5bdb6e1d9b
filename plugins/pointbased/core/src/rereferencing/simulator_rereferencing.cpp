// SPDX-License-Identifier: Apache-2.0
#include "pointbased/simulator.h"
#include "rereferencing/rereferencing.h"

namespace pointbased {
namespace {

constexpr std::uint64_t kLookInterval = 8;  // steps
constexpr std::size_t kFirstTold = 3;       // rereferencings that are reported one by one; later ones at powers of two

bool isReported(std::size_t count) { return count <= kFirstTold || (count & (count - 1)) == 0; }

}  // namespace

void Simulator::bindProbes(std::size_t id, std::span<const Vec3> ways) {
  const Body &target = *body(id);
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    if (probes_[p].body != id) continue;
    probes_[p].referenceShift = ways[p];
    const Vec3 local = probes_[p].reference + ways[p] - target.rest().origin;
    probes_[p].binding = target.rest().bind(std::span<const Vec3>(&local, 1), {});
  }
}

bool Simulator::rereferenceIfNeeded(std::size_t id, const StopRequest *stop) {
  Body &body = *this->body(id);
  if (!world_.rereference || body.stopped || notRereferenced_.contains(id)) return false;
  if ((steps_ + 1) % kLookInterval != 0 || !body.constitution().plastic() || !needsRereferencing(body)) return false;
  body.computeGradients(parallelFor_);
  Result<Rereferencing> renewal;
  try {
    const StoppableLoops::Watch watch(loops_, stop);
    renewal = rereferenced(body, parallelFor_);
  } catch (const Stopped &) {
    return false;
  }
  if (!renewal) {
    notRereferenced_.insert(id);
    reportEvent("note",
                "body '" + body.name() + "' has flowed far, but its reference cannot be renewed: " + renewal.error());
    return false;
  }
  std::vector<Vec3> ways;
  for (const Probe &probe : probes_) ways.push_back(probeState(probe).position - probe.reference);
  const std::size_t relieved = renewal->relieved;
  body.rereference(std::move(renewal->rest), std::move(renewal->state), parallelFor_);
  bindProbes(id, ways);
  if (isReported(body.rereferenceCount()))
    reportEvent(
        "renewed",
        "body '" + body.name() + "' has flowed far: its present shape is its reference, time " +
            std::to_string(body.rereferenceCount()) +
            (relieved > 0 ? "; " + std::to_string(relieved) + " crushed points have lost their elastic strain" : ""));
  return true;
}

}  // namespace pointbased
