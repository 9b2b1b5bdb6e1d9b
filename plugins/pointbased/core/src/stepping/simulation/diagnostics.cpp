// SPDX-License-Identifier: Apache-2.0
#include "pointbased/diagnostics.h"

#include <algorithm>

#include "discretisation/interpolation_at.h"
#include "stepping/monitoring/contact_pressure.h"
#include "stepping/monitoring/rigid_tissue.h"
#include "stepping/monitoring/skin_watch.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

// m, present distance of a contact point from the plane with which the contact was found.
double gapNow(const Body &body, const Contact &contact, double elapsed) {
  const Interpolation &binding = body.rest().contact.binding;
  const std::span<const Vec3> u = body.state().displacements;
  const Mat3 F = detail::rankOf(binding, contact.point) < 3 ? detail::gradientAt(binding, contact.point, u)
                                                            : Mat3(Mat3::Identity());
  const Vec3 x =
      body.rest().origin + binding.positions[contact.point] + detail::displacementAt(binding, contact.point, u, F);
  return contact.gap + contact.normal.dot(x - contact.position - elapsed * contact.surfaceVelocity);
}

// J, with half of the attachments to another body.
double attachedEnergy(const detail::SimulationState &state, std::size_t id) {
  double sum = 0.0;
  for (const auto &[number, layer] : state.attachments) {
    const Attachment &of = layer->settings();
    if (of.first == id || of.second == id)
      sum += (layer->joinsBodies() ? 0.5 : 1.0) * layer->energy(state.attachedState(*layer));
  }
  return sum;
}

}  // namespace

const std::vector<SimulationEvent> &Diagnostics::events() const { return state_.events; }
void Diagnostics::addWarning(std::size_t id, const std::string &text) { state_.addWarning(id, text); }

std::string Diagnostics::activity() const { return state_.activity.line(); }

std::vector<StageClock::Summary> Diagnostics::stageTimes() const { return state_.clock.summary(); }

double Diagnostics::costOf(std::size_t id) const {
  const auto found = state_.computingTime.seconds.find(id);
  return found == state_.computingTime.seconds.end() || !(state_.computingTime.advanced > 0.0)
             ? 0.0
             : found->second / state_.computingTime.advanced;
}

std::vector<ContactSummary> Diagnostics::contacts() const {
  std::vector<ContactSummary> out;
  const auto add = [&](const ContactSummary &more) {
    const auto known = std::find_if(out.begin(), out.end(), [&](const ContactSummary &one) {
      return one.first == more.first && one.second == more.second;
    });
    if (known == out.end()) return out.push_back(more);
    known->force += more.force;
    known->normalForce += more.normalForce;
    known->depth = std::max(known->depth, more.depth);
    known->points += more.points;
    known->area += more.area;
  };
  for (const auto &[id, stepper] : state_.bodies) {
    const Body &body = stepper->body();
    const ContactSums &sums = body.contact.sums;
    const std::size_t own = state_.ownObstacleCount(id), walls = own + state_.obstacles.all.size();
    if (!(sums.duration > 0.0) || sums.of.size() != walls + 1) continue;
    std::vector<ContactSummary> found(sums.of.size());
    for (std::size_t o = 0; o < found.size(); ++o) {
      found[o].first = id;
      found[o].second = o < own ? id : o < walls ? state_.obstacles.ids[o - own] : kWorldBox;
      found[o].force = sums.of[o].impulse / sums.duration;
      found[o].normalForce = sums.of[o].normalImpulseSum / sums.duration;
    }
    // By point: one in contact with two faces of an obstacle counts once.
    std::vector<Index> last(found.size(), Contact::kWall);
    const double elapsed = state_.rampTime() - body.contact.searchTime;
    for (const Contact &contact : body.contact.active) {
      const std::size_t o = contact.obstacle == Contact::kWall ? walls : contact.obstacle;
      found[o].depth = std::max(found[o].depth, -gapNow(body, contact, elapsed));
      if (!(contact.normalImpulse > 0.0) || last[o] == contact.point) continue;
      last[o] = contact.point;
      ++found[o].points;
      found[o].area += body.rest().contact.areas[contact.point];
    }
    for (const ContactSummary &summary : found)
      if (summary.normalForce > 0.0) add(summary);
  }
  for (const auto &[id, pair] : state_.skins.pairs()) {
    const detail::SkinPair::Sum &sum = pair->sum();
    if (!(sum.normalImpulseSum > 0.0) || !(sum.duration > 0.0)) continue;
    const auto points = std::count_if(pair->active().begin(), pair->active().end(),
                                      [](const detail::SkinContact &c) { return c.normalImpulse > 0.0; });
    add({id.first, id.second, sum.impulse / sum.duration, sum.normalImpulseSum / sum.duration, pair->depth(),
         static_cast<std::size_t>(points), detail::pressedArea(*pair)});
  }
  return out;
}

void Diagnostics::contactPressures(std::size_t id, std::vector<double> &out) const {
  const Body *target = state_.body(id);
  if (!target) {
    out.clear();
    return;
  }
  detail::PressureOnSkin pressure(*target);
  pressure.addObstacles();
  for (const auto &[pair, skins] : state_.skins.pairs()) {
    if (pair.first == id) pressure.addSkin(*skins, 0);
    if (pair.second == id) pressure.addSkin(*skins, 1);
  }
  out = pressure.pressures();
}

double Diagnostics::skinDepth(std::size_t id) const {
  const Body *target = state_.body(id);
  if (!target) return 0.0;
  std::vector<Vec3> skin;
  const auto reportedDepth = [id](const std::map<std::size_t, double> &depths) {
    const auto found = depths.find(id);
    return found == depths.end() ? 0.0 : found->second;
  };
  const double inRigid =
      state_.ownObstacleCount(id) > 0 ? detail::depthInRigidTissue(*target, skin, state_.parallelFor) : 0.0;
  return std::max({target->contact.deepest, reportedDepth(state_.reported.skinDeepest),
                   reportedDepth(state_.reported.rigidDeepest), inRigid,
                   depthOfPassage(*target, state_.surroundingsOf(id), state_.rampTime(), state_.parallelFor),
                   pointbased::skinDepth(*target, world_.obstaclesOf(id), world_.boxOf(id), state_.rampTime(), skin,
                                         state_.parallelFor)});
}

Diagnostics::Energy Diagnostics::energy(std::size_t id) const {
  Energy out;
  const Body *target = state_.body(id);
  if (!target) return out;
  const ElasticEnergy elastic = target->elasticEnergy(state_.parallelFor);
  out.elastic = elastic.strain;
  out.stabilisation = elastic.stabilisation;
  out.kinetic = target->kineticEnergy();
  out.foundation = target->foundation().energy(target->state().displacements) + attachedEnergy(state_, id);
  for (std::size_t i = 0; i < target->masses().size(); ++i)
    out.gravity -= target->weights()[i] * state_.settings.gravity.dot(target->state().displacements[i]);
  out.gravity -= state_.settings.gravity.dot(target->referenceShiftMoment());
  return out;
}

std::vector<Reaction> Diagnostics::reactions(std::size_t id) const {
  const Body *target = state_.body(id);
  return target ? target->reactions(state_.settings.gravity) : std::vector<Reaction>{};
}

}  // namespace pointbased
