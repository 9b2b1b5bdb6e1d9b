// SPDX-License-Identifier: Apache-2.0
// Initial state, stored states and rereferencing of a body.
#include <algorithm>

#include "body/rigid_frame.h"
#include "pointbased/body.h"

namespace pointbased {

void Body::setInitialVelocity(const Vec3 &velocity, const Vec3 &angularVelocity) {
  initialVelocity_ = velocity;
  initialAngularVelocity_ = angularVelocity;
  reset();
}

void Body::keepState() {
  // As plain numbers: vectors of Eigen types would be copied one by one in every step.
  const auto copy = [](const std::vector<Vec3> &from, std::vector<Vec3> &to) {
    to.resize(from.size());
    if (!from.empty()) std::copy_n(from.front().data(), 3 * from.size(), to.front().data());
  };
  copy(state_.displacements, kept_.displacements);
  copy(state_.velocities, kept_.velocities);
  kept_.history = state_.history;
}

void Body::rereference(std::shared_ptr<const RestState> rest, State state, const ParallelFor &parallelFor) {
  const auto moment = [this](std::span<const Vec3> u) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      sum += masses_[i] * (rest_->origin - first_->origin + rest_->positions[i] + u[i]);
    return sum;
  };
  Vec3 way = referenceShiftMoment_;
  for (std::size_t i = 0; i < masses_.size(); ++i) way += masses_[i] * state_.displacements[i];
  const Vec3 before = moment(state_.displacements);
  const double deepest = contact.deepest;
  rest_ = std::move(rest);
  state_ = std::move(state);
  resizeForRestState();
  setConstitution(constitution_, parallelFor);
  // The work of gravity continues; the new phyxels have a slightly different centre of mass, which would show.
  referenceShiftMoment_ = way + moment(state_.displacements) - before;
  ++rereferenceCount_;
  contact = ContactState();
  contact.deepest = deepest;
  forces_.assign(rest_->phyxelCount(), Vec3::Zero());
  if (rest_->evaluation == Evaluation::stressPoints) grabs.clear();  // the phyxels have changed
  computeGradients(parallelFor);
  computeElasticStresses(parallelFor);
  keepState();
}

void Body::restoreState() {
  state_ = kept_;
  contact.clearance.clear();  // stored distances may belong to the failed step
  contact.active.clear();
  contact.sums = {};
  patches_.clearForces();
  forcesCurrent = false;
}

std::string Body::stopMessage() const {
  if (!stopped) return {};
  return "body '" + name() + "', phyxel " + std::to_string(stopped->phyxel) + ": " + stopped->quantity +
         "; it stands still in the last good state. Help: " + stopped->help;
}

BodyCheckpoint Body::checkpoint() const {
  return {rest_, state_, contact, stopped, rereferenceCount_, referenceShiftMoment_, rigid_, free_};
}

bool Body::restore(const BodyCheckpoint &checkpoint, const ParallelFor &parallelFor) {
  if (checkpoint.rigid != rigid_ || checkpoint.free != free_) return false;
  const bool sameReference = rest_ == checkpoint.rest;
  rest_ = checkpoint.rest;
  state_ = checkpoint.state;
  if (!sameReference) resizeForRestState();
  setConstitution(constitution_, parallelFor);  // fits the history to the current material
  rereferenceCount_ = checkpoint.rereferenceCount;
  referenceShiftMoment_ = checkpoint.referenceShiftMoment;
  contact = checkpoint.contact;
  stopped = checkpoint.stopped;
  grabs.clear();
  externalForces_.clear();
  patches_.clearForces();
  forces_.assign(rest_->phyxelCount(), Vec3::Zero());
  computeGradients(parallelFor);
  computeElasticStresses(parallelFor);
  forcesCurrent = false;
  keepState();
  return true;
}

void Body::setRigid(bool rigid, bool free) {
  rigid_ = rigid;
  free_ = free;
  if (rigid_) frameRigid();
  reset();
}

void Body::reset() {
  if (rest_ != first_) {
    rest_ = first_;
    state_.history = PointHistory();
    resizeForRestState();
    setConstitution(constitution_, serialFor());
  }
  rereferenceCount_ = 0;
  referenceShiftMoment_.setZero();
  const std::size_t n = rest_->phyxelCount();
  state_.displacements.assign(n, Vec3::Zero());
  state_.velocities.assign(n, initialVelocity_);
  state_.supportTime.reset();
  state_.history = PointHistory();
  state_.history.reset(constitution_, rest_->pointCount(), rest_->stencils.isLattice());
  relaxedModes_.clear();
  if (!initialAngularVelocity_.isZero()) {
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i)
      centre += (restMasses()[i] + (supportMasses_.empty() ? 0.0 : supportMasses_[i])) * rest_->positions[i];
    centre /= totalMass();
    for (std::size_t i = 0; i < n; ++i)
      state_.velocities[i] += initialAngularVelocity_.cross(rest_->positions[i] - centre);
  }
  for (const HeldPhyxel &held : heldPhyxels_) state_.velocities[held.phyxel].setZero();
  if (isStatic()) state_.velocities.assign(n, Vec3::Zero());
  forces_.assign(n, Vec3::Zero());
  std::fill(gradients_.begin(), gradients_.end(), Mat3::Identity());
  std::fill(stresses_.begin(), stresses_.end(), Mat3::Zero());
  gradientsStale_ = stressesStale_ = false;
  tangentRatio_ = 1.0;
  patches_.clearForces();
  contact = ContactState();
  stopped.reset();
  grabs.clear();
  externalForces_.clear();
  forcesCurrent = false;
  keepState();
}

}  // namespace pointbased
