// SPDX-License-Identifier: Apache-2.0
#include "stepping/implicit/stage_coupling.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace pointbased::detail {
namespace {

// Spacings: no further contacts are expected this close to a path that has been searched.
constexpr double kSearchedDistance = 0.05;

}  // namespace

void StageCoupling::clear() {
  members_.clear();
  joint_.clear();
  count_ = 0;
  pairs_ = {};
  layers_ = {};
}

void StageCoupling::add(Body &body, bool moves) {
  const std::size_t count = moves ? body.rest().phyxelCount() : 0;
  members_.push_back({&body, count_, count});
  count_ += count;
  joint_.add(body, moves, moves);
}

void StageCoupling::join(std::span<const JoinedPair> pairs, std::span<const JoinedLayer> layers) {
  pairs_ = pairs;
  layers_ = layers;
}

bool StageCoupling::holds(const Body &body) const {
  std::vector<std::uint8_t> held(members_.size());
  for (std::size_t k = 0; k < members_.size(); ++k)
    held[k] = members_[k].count == 0 || members_[k].body->held() || members_[k].body->foundation().settings().holds();
  for (bool more = true; more;) {
    more = false;
    for (const JoinedLayer &joined : layers_) {
      const Attachment &of = joined.layer->settings();
      if (!(of.stiffness > 0.0 && of.tangential > 0.0)) continue;
      const bool first = held[joined.first] != 0,
                 second = joined.second == JoinedLayer::kNoBody || held[joined.second] != 0;
      if (first == second) continue;
      held[first ? joined.second : joined.first] = 1;
      more = true;
    }
  }
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member &one) { return one.body == &body; });
  return found != members_.end() && held[static_cast<std::size_t>(found - members_.begin())] != 0;
}

template <class T>
std::span<T> StageCoupling::partOf(std::size_t body, std::span<T> of) const {
  return body == JoinedLayer::kNoBody ? std::span<T>() : of.subspan(members_[body].first, members_[body].count);
}

AttachmentLayer::AttachedState StageCoupling::attachedState(const JoinedLayer &layer, std::span<const Vec3> now) const {
  const auto stateOf = [&](std::size_t body) -> std::span<const Vec3> {
    if (body == JoinedLayer::kNoBody) return {};
    return members_[body].count > 0 ? partOf(body, now) : members_[body].body->state().displacements;
  };
  return {stateOf(layer.first), stateOf(layer.second), end_};
}

void StageCoupling::begin(std::span<const Vec3> start, double end, double span, bool isStatic) {
  start_.assign(start.begin(), start.end());
  end_ = end;
  span_ = span;
  base_ = start_;
  searchEnd_.clear();
  contactsOfPaths_.clear();
  displacementsOf_.resize(members_.size());
  velocitiesOf_.resize(members_.size());
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const std::vector<Vec3> &u = members_[k].body->state().displacements;
    displacementsOf_[k].assign(u.begin(), u.end());
    velocitiesOf_[k].assign(u.size(), Vec3::Zero());
  }
  for (const JoinedLayer &layer : layers_) (void)layer.layer->updateNormals(attachedState(layer, start));
  isRepeat_ = false;
  isStatic_ = isStatic;
}

void StageCoupling::find(std::span<const Vec3> now) {
  if (pairs_.empty()) return;
  double distance = std::numeric_limits<double>::infinity(), spacing = distance;
  for (const JoinedPair &joined : pairs_) spacing = std::min(spacing, joined.pair->spacing());
  if (searchEnd_.size() == now.size()) {
    distance = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) distance = std::max(distance, (now[i] - searchEnd_[i]).norm());
  }
  searchEnd_.assign(now.begin(), now.end());
  foundAtState_ = distance < kSearchedDistance * spacing;
  if (!foundAtState_) return findAlong(now);
  base_.assign(now.begin(), now.end());
  findFromBase(0.0);
}

void StageCoupling::findAlong(std::span<const Vec3> now) {
  // Without a time span the displacement itself is the velocity.
  const double dt = span_ > 0.0 ? span_ : 1.0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    for (std::size_t i = 0; i < members_[k].count; ++i)
      velocitiesOf_[k][i] = (now[members_[k].first + i] - start_[members_[k].first + i]) / dt;
  base_ = start_;
  findFromBase(dt);
  // Contacts of earlier paths are retained; otherwise two could alternate.
  for (std::size_t p = 0; p < contactsOfPaths_.size(); ++p) {
    std::vector<SkinContact> &active = pairs_[p].pair->active();
    const auto byKey = [](const SkinContact &a, const SkinContact &b) { return a.key < b.key; };
    std::vector<SkinContact> all;
    std::set_union(active.begin(), active.end(), contactsOfPaths_[p].begin(), contactsOfPaths_[p].end(),
                   std::back_inserter(all), byKey);
    active = std::move(all);
  }
  if (!contactsOfPaths_.empty()) gather();
  contactsOfPaths_ = contacts().ofPairs;
}

void StageCoupling::findFromBase(double dt) {
  for (std::size_t k = 0; k < members_.size(); ++k)
    std::copy_n(base_.begin() + static_cast<std::ptrdiff_t>(members_[k].first), members_[k].count,
                displacementsOf_[k].begin());
  for (const JoinedPair &joined : pairs_)
    for (const auto &[side, k] : {std::pair(std::size_t{0}, joined.first), std::pair(std::size_t{1}, joined.second)})
      joined.pair->moving(side).move(displacementsOf_[k], velocitiesOf_[k], members_[k].body->rest().maxInfluence, dt);
  for (const JoinedPair &joined : pairs_) {
    joined.pair->setStepKind(isStatic_ ? SkinPair::StepKind::quasiStatic : SkinPair::StepKind::implicitStep);
    joined.pair->find(dt, isRepeat_);
  }
  isRepeat_ = true;
  gather();
}

void StageCoupling::gather() {
  joint_.gather(pairs_, std::numeric_limits<double>::infinity(), false);
  std::size_t c = 0;
  for (const JoinedPair &joined : pairs_) {
    double modulus = std::numeric_limits<double>::infinity();
    for (const std::size_t k : {joined.first, joined.second})
      modulus = std::min(modulus, members_[k].body->material().youngsModulus);
    // Contacts without a stiffness of their own (edges, other sides of a corner) are as stiff as the layer of a cell.
    const double ofCell = joined.pair->settings().stiffness * modulus * joined.pair->spacing();
    for (std::size_t n = 0; n < joined.pair->active().size(); ++n, ++c) {
      double &k = joint_.state().active[c].stiffness;
      if (!(k > 0.0)) k = ofCell;
    }
  }
  if (base_.size() != start_.size()) return;
  // Refers the gaps to the start.
  const Interpolation &rows = joint_.rows().binding;
  for (std::size_t r = 0; r < rows.count(); ++r) {
    Contact &contact = joint_.state().active[r];
    for (Index e = rows.phyxels.offsets[r]; e < rows.phyxels.offsets[r + 1]; ++e) {
      const Index j = rows.phyxels.indices[e];
      contact.gap -= rows.weights[e] * contact.normal.dot(base_[j] - start_[j]);
    }
  }
}

double StageCoupling::energy(std::span<const Vec3> now) const {
  double sum = touches() ? contactEnergy(joint_.rows(), joint_.state(), penalty(), start_, now) : 0.0;
  for (const JoinedLayer &layer : layers_) {
    const AttachmentLayer::AttachedState sides = attachedState(layer, now);
    sum += layer.layer->energy(sides) - layer.layer->workOfRotationForces(sides.first);
  }
  return sum;
}

void StageCoupling::addForces(std::span<const Vec3> now, std::span<Vec3> forces) const {
  if (touches()) addContactForces(joint_.rows(), joint_.state(), penalty(), start_, now, forces);
  for (const JoinedLayer &layer : layers_)
    layer.layer->addForces(attachedState(layer, now), partOf(layer.first, forces), partOf(layer.second, forces));
}

void StageCoupling::addProduct(std::span<const Vec3> now, std::span<const Vec3> du, std::span<Vec3> out) const {
  if (touches()) addContactProduct(joint_.rows(), joint_.state(), penalty(), start_, now, du, out);
  for (const JoinedLayer &layer : layers_)
    layer.layer->addProduct({partOf(layer.first, du), partOf(layer.second, du), end_}, partOf(layer.first, out),
                            partOf(layer.second, out));
}

void StageCoupling::addBlocks(std::span<const Vec3> now, std::span<Mat3> blocks) const {
  if (touches()) addContactBlocks(joint_.rows(), joint_.state(), penalty(), start_, now, blocks);
  for (const JoinedLayer &layer : layers_)
    layer.layer->addBlocks(partOf(layer.first, blocks), partOf(layer.second, blocks));
}

void StageCoupling::addTriplets(std::span<const Vec3> now, std::vector<Eigen::Triplet<double>> &out) const {
  if (touches()) addContactTriplets(joint_.rows(), joint_.state(), penalty(), start_, now, out);
  for (const JoinedLayer &layer : layers_) {
    const auto rowOf = [&](std::size_t body) {
      return body == JoinedLayer::kNoBody || members_[body].count == 0 ? AttachmentLayer::kNoRows
                                                                       : members_[body].first;
    };
    layer.layer->addTriplets(rowOf(layer.first), rowOf(layer.second), out);
  }
}

void StageCoupling::updateNormalForces(std::span<const Vec3> now) {
  if (!touches()) return;
  pointbased::updateNormalForces(joint_.rows(), penalty(), start_, now, joint_.state());
  joint_.writeBack(pairs_);
}

void StageCoupling::contactForces(std::span<const Vec3> now, std::vector<Vec3> &out) const {
  out.assign(count_, Vec3::Zero());
  if (touches()) addContactForces(joint_.rows(), joint_.state(), penalty(), start_, now, out);
}

void StageCoupling::record(std::span<const Vec3> now) { contactForces(now, recorded_); }

double StageCoupling::changeTo(std::span<const Vec3> now) {
  contactForces(now, present_);
  double change = 0.0, size = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    change += (present_[i] - recorded_[i]).norm();
    size += present_[i].norm();
  }
  if (change == 0.0) return 0.0;
  return size > 0.0 ? change / size : std::numeric_limits<double>::infinity();
}

void StageCoupling::finish(std::span<const Vec3> now, double weight) {
  if (touches()) {
    const ContactPoints &rows = joint_.rows();
    for (Contact &contact : joint_.state().active) {
      const ContactForce force = contactForceAt(rows, contact, penalty(), start_, now);
      contact.normalForce = force.normal;
      contact.normalImpulse = weight * force.normal;
      contact.frictionImpulse = weight * force.friction;
      contact.projectionImpulse = 0.0;
      contact.projectionFriction = Vec3::Zero();
    }
    endContactStage(rows, penalty(), start_, now, joint_.state());
    joint_.writeBack(pairs_);
  }
  for (const JoinedPair &joined : pairs_) joined.pair->addToSum(weight);
}

StageCoupling::Contacts StageCoupling::contacts() const {
  Contacts out{{}, base_};
  for (const JoinedPair &joined : pairs_) out.ofPairs.push_back(joined.pair->active());
  return out;
}

void StageCoupling::setContacts(const Contacts &contacts) {
  for (std::size_t p = 0; p < pairs_.size(); ++p) pairs_[p].pair->active() = contacts.ofPairs[p];
  base_ = contacts.base;
  if (!pairs_.empty()) gather();
}

std::vector<SkinPair::Sum> StageCoupling::sums() const {
  std::vector<SkinPair::Sum> out;
  for (const JoinedPair &joined : pairs_) out.push_back(joined.pair->sum());
  return out;
}

void StageCoupling::setSums(const std::vector<SkinPair::Sum> &sums) {
  for (std::size_t p = 0; p < pairs_.size(); ++p) pairs_[p].pair->setSum(sums[p]);
}

bool StageCoupling::hasContactAlong(double known, double to) const {
  if (!touches()) return false;
  std::vector<Vec3> on(start_);
  for (std::size_t k = 0; k < members_.size(); ++k)
    for (std::size_t i = 0; i < members_[k].count; ++i)
      on[members_[k].first + i] += to / known * span_ * velocitiesOf_[k][i];
  const auto hasContactForce = [&](const Contact &contact) {
    return contactForceAt(joint_.rows(), contact, penalty(), start_, on).normal > 0.0;
  };
  return std::any_of(joint_.state().active.begin(), joint_.state().active.end(), hasContactForce);
}

StageCoupling::ActiveContacts StageCoupling::activeContacts() const {
  ActiveContacts out;
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for (const SkinContact &contact : pairs_[p].pair->active())
      if (contact.normalForce > 0.0) out.emplace_back(p, contact.key);
  return out;
}

}  // namespace pointbased::detail
