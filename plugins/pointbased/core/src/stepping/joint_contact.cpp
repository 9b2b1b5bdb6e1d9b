// SPDX-License-Identifier: Apache-2.0
#include "stepping/joint_contact.h"

#include <algorithm>

namespace pointbased::detail {
namespace {

constexpr Index kNone = 0xffffffffu;
// Contacts of two skins are many for what moves them, and take longer to agree than those with an obstacle.
constexpr int kSweeps = 60;
// Of the margin, that speeds left by the sweeps may close in a step, and of the fastest of them. What is left over
// drives what rests: at 0.02 and 5e-3 phyxels of blocks that lay on each other kept up to 38 mm/s.
constexpr double kLeft = 5e-4, kTolerance = 2e-3;
// Of the layer between two skins: contacts that have slid by less keep their normals and what they touch.
constexpr double kSlip = 0.06;

}  // namespace

void JointContact::clear() {
  bodies_.clear();
  count_ = 0;
  inverseMasses_.clear();
}

void JointContact::add(Body &body, bool moves, bool counts) {
  bodies_.push_back({&body, count_, moves, counts});
  if (!counts) return;
  count_ += body.rest().phyxelCount();
  if (moves)
    inverseMasses_.insert(inverseMasses_.end(), body.inverseMasses().begin(), body.inverseMasses().end());
  else
    inverseMasses_.resize(count_, 0.0);
}

// Entries of a phyxel that a row meets twice become one.
void JointContact::addRow(std::span<const Index> phyxels, std::span<const double> weights, std::size_t first,
                          double scale) {
  for (std::size_t e = 0; e < phyxels.size(); ++e) {
    const double weight = scale * weights[e];
    if (weight == 0.0) continue;
    const auto j = static_cast<Index>(first + phyxels[e]);
    if (entryOf_[j] != kNone) {
      rows_.binding.weights[entryOf_[j]] += weight;
      continue;
    }
    entryOf_[j] = static_cast<Index>(rows_.binding.weights.size());
    rows_.binding.phyxels.indices.push_back(j);
    rows_.binding.weights.push_back(weight);
  }
}

void JointContact::endRow() {
  for (Index e = rows_.binding.phyxels.offsets.back(); e < rows_.binding.phyxels.indices.size(); ++e)
    entryOf_[rows_.binding.phyxels.indices[e]] = kNone;
  rows_.binding.phyxels.offsets.push_back(static_cast<Index>(rows_.binding.phyxels.indices.size()));
  rows_.binding.positions.push_back(Vec3::Zero());
}

void JointContact::addContact(const Contact &contact) {
  state_.active.push_back(contact);
  state_.active.back().point = static_cast<Index>(state_.active.size() - 1);
  endRow();
}

void JointContact::gather(std::span<const JoinedPair> pairs, double margin, bool obstacles) {
  rows_.binding.phyxels.offsets.assign(1, 0);
  rows_.binding.phyxels.indices.clear();
  rows_.binding.weights.clear();
  rows_.binding.positions.clear();
  state_.active.clear();
  margin_ = margin;
  state_.margin = 0.0;
  if (entryOf_.size() != count_) entryOf_.assign(count_, kNone);
  for (const JoinedPair &joined : pairs) {
    const std::array<std::size_t, 2> of{joined.first, joined.second};
    for (const SkinContact &contact : joined.pair->active()) {
      for (const SkinContact::Part &part : contact.parts) {
        if (part.weight == 0.0) continue;
        const std::size_t side = part.ofSecond ? 1 : 0;
        if (!bodies_[of[side]].counts) continue;
        const Interpolation &skin = joined.pair->skin(side).vertices;
        const Index begin = skin.phyxels.offsets[part.vertex], end = skin.phyxels.offsets[part.vertex + 1];
        addRow(std::span<const Index>(skin.phyxels.indices).subspan(begin, end - begin),
               std::span<const double>(skin.weights).subspan(begin, end - begin), bodies_[of[side]].first, part.weight);
      }
      addContact(contact);
    }
  }
  began_.clear();
  if (obstacles) {
    takeDisplacements();
    for (const JoinedPair &joined : pairs)
      for (SkinContact &contact : joined.pair->active()) {
        const std::size_t row = began_.size();
        if (!contact.found) contact.found = {contact.gap, way(row)};
        began_.push_back({contact.found->way, contact.found->gap, 0.0});
      }
  }
  gathersObstacles_ = obstacles;
  if (obstacles) addObstacles();
}

void JointContact::addObstacles() {
  for (const Joined &joined : bodies_) {
    if (!joined.moves) continue;
    state_.margin = std::max(state_.margin, joined.body->contact.margin);
    const Interpolation &points = joined.body->rest().contact.binding;
    for (const Contact &contact : joined.body->contact.active) {
      const Index begin = points.phyxels.offsets[contact.point], end = points.phyxels.offsets[contact.point + 1];
      addRow(std::span<const Index>(points.phyxels.indices).subspan(begin, end - begin),
             std::span<const double>(points.weights).subspan(begin, end - begin), joined.first, 1.0);
      addContact(contact);
    }
  }
}

bool JointContact::serves() {
  takeDisplacements();
  for (std::size_t c = 0; c < began_.size(); ++c) {
    const Contact &contact = state_.active[c];
    const Vec3 moved = way(c) - began_[c].way;
    const double slip = kSlip * (contact.thickness > 0.0 ? contact.thickness : margin_);
    began_[c].rise = moved.dot(contact.normal);
    if (!((moved - began_[c].rise * contact.normal).squaredNorm() <= slip * slip)) return false;
  }
  return true;
}

void JointContact::gatherAgain() {
  const std::size_t count = began_.size();
  rows_.binding.phyxels.offsets.resize(count + 1);
  const Index entries = rows_.binding.phyxels.offsets.back();
  rows_.binding.phyxels.indices.resize(entries);
  rows_.binding.weights.resize(entries);
  rows_.binding.positions.resize(count);
  state_.active.resize(count);
  for (std::size_t c = 0; c < count; ++c) state_.active[c].gap = began_[c].gap + began_[c].rise;
  state_.margin = 0.0;
  addObstacles();
}

Vec3 JointContact::way(std::size_t row) const {
  const Csr &phyxels = rows_.binding.phyxels;
  Vec3 sum = Vec3::Zero();
  for (Index e = phyxels.offsets[row]; e < phyxels.offsets[row + 1]; ++e)
    sum += rows_.binding.weights[e] * displacements_[phyxels.indices[e]];
  return sum;
}

void JointContact::takeDisplacements() {
  displacements_.resize(count_);
  for (const Joined &joined : bodies_)
    std::copy(joined.body->state().displacements.begin(), joined.body->state().displacements.end(),
              displacements_.begin() + static_cast<std::ptrdiff_t>(joined.first));
}

void JointContact::takeVelocities() {
  velocities_.resize(count_);
  for (const Joined &joined : bodies_)
    std::copy(joined.body->state().velocities.begin(), joined.body->state().velocities.end(),
              velocities_.begin() + static_cast<std::ptrdiff_t>(joined.first));
}

void JointContact::predict() {
  takeVelocities();
  for (std::size_t c = 0; c < state_.active.size(); ++c) {
    const Contact &contact = state_.active[c];
    if (!(contact.normalImpulse > 0.0)) continue;
    const Vec3 impulse = contact.normalImpulse * contact.normal + contact.frictionImpulse;
    for (Index e = rows_.binding.phyxels.offsets[c]; e < rows_.binding.phyxels.offsets[c + 1]; ++e)
      velocities_[rows_.binding.phyxels.indices[e]] +=
          inverseMasses_[rows_.binding.phyxels.indices[e]] * rows_.binding.weights[e] * impulse;
  }
}

void JointContact::giveVelocities() {
  for (const Joined &joined : bodies_)
    if (joined.moves)
      std::copy_n(velocities_.begin() + static_cast<std::ptrdiff_t>(joined.first),
                  joined.body->state().velocities.size(), joined.body->state().velocities.begin());
}

void JointContact::giveBack(std::span<const JoinedPair> pairs) {
  auto solved = state_.active.cbegin();
  const auto give = [&](Contact &contact) {
    contact.normalImpulse = solved->normalImpulse;
    contact.frictionImpulse = solved->frictionImpulse;
    contact.settleImpulse = solved->settleImpulse;
    contact.settleFriction = solved->settleFriction;
    contact.normalForce = solved->normalForce;
    contact.initialPenetration = solved->initialPenetration;
    contact.tangentialDisplacement = solved->tangentialDisplacement;
    ++solved;
  };
  for (const JoinedPair &joined : pairs)
    for (SkinContact &contact : joined.pair->active()) give(contact);
  for (const Joined &joined : bodies_)
    if (joined.moves && gathersObstacles_)
      for (Contact &contact : joined.body->contact.active) give(contact);
}

void JointContact::solve(double dt, std::span<const JoinedPair> pairs) {
  takeVelocities();
  ImpulseSettings settings;
  settings.sweeps = kSweeps;
  settings.tolerance = kTolerance;
  settings.leastSpeed = kLeft * margin_ / dt;
  solveContactImpulses(rows_.binding, inverseMasses_, dt, settings, state_, velocities_);
  giveVelocities();
  giveBack(pairs);
}

void JointContact::settle(double dt, std::span<const JoinedPair> pairs) {
  takeVelocities();
  settleContactVelocities(rows_.binding, inverseMasses_, dt, state_, velocities_);
  giveVelocities();
  giveBack(pairs);
}

}  // namespace pointbased::detail
