// SPDX-License-Identifier: Apache-2.0
#include "stepping/coupling/joint_contact.h"

#include <algorithm>
#include <limits>

namespace pointbased::detail {
namespace {

constexpr Index kNone = 0xffffffffu;
// Contacts of two skins outnumber their degrees of freedom, and converge more slowly than those with an obstacle.
constexpr int kSweeps = 60;
// Fraction of the margin that residual speeds may close in a step, and of the largest of these speeds. Residuals drive
// bodies at rest: at 0.02 and 5e-3 the phyxels of stacked blocks kept moving with up to 38 mm/s.
constexpr double kResidualFraction = 5e-4, kTolerance = 2e-3;
// Fraction of the layer between two skins: contacts that have slid by less keep their normals and features.
constexpr double kSlip = 0.06;
// Sine: a point of a skin counts as nearer to the other one if it is lower by this fraction of its distance.
constexpr double kCone = 5e-3;

// Whether a vertex, or one of two edges, is not the nearest feature of its own skin to the edge or corner that it is in
// contact with: a point of the flat skin around it is nearer, which has separate contacts. The plane of such a contact
// is inclined against the sliding direction, as if the vertex protruded from its skin.
bool hasNearerFeature(SkinPair &pair, const SkinContact &contact) {
  const auto isNearer = [&](MovingSkin &skin, Index from, Index other, const Vec3 &towards, const Vec3 &along) {
    Vec3 edge = skin.position(other) - skin.position(from);
    edge -= along.dot(edge) * along;
    return edge.dot(towards) > kCone * edge.norm();
  };
  const auto towardsOther = [&](bool ofSecond) { return ofSecond ? contact.normal : Vec3(-contact.normal); };
  if (contact.isOfEdges()) {
    for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
      const auto [a, ofSecond, weight] = contact.parts[k];
      const Index b = contact.parts[k + 1].vertex;
      MovingSkin &skin = pair.moving(ofSecond ? 1 : 0);
      const Vec3 along = (skin.position(b) - skin.position(a)).normalized();
      for (const Index t : skin.skin().trianglesOf.row(a)) {
        const auto &corners = skin.skin().triangles[t];
        if (std::find(corners.begin(), corners.end(), b) == corners.end()) continue;
        for (const Index other : corners)
          if (other != a && other != b && isNearer(skin, a, other, towardsOther(ofSecond), along)) return true;
      }
    }
    return false;
  }
  const auto isInside = [](const SkinContact::Part &part) { return part.weight != 0.0; };
  if (std::all_of(contact.parts.begin() + 1, contact.parts.end(), isInside)) return false;  // of a face
  const SkinContact::Part &vertex = contact.parts[0];
  MovingSkin &skin = pair.moving(vertex.ofSecond ? 1 : 0);
  for (const Index t : skin.skin().trianglesOf.row(vertex.vertex))
    for (const Index other : skin.skin().triangles[t])
      if (isNearer(skin, vertex.vertex, other, towardsOther(vertex.ofSecond), Vec3::Zero())) return true;
  return false;
}

// A contact with an empty row exerts no force; its earlier forces are cleared.
void clearContactRow(Contact &contact) {
  contact.gap = std::numeric_limits<double>::infinity();
  contact.normalImpulse = contact.projectionImpulse = contact.normalForce = 0.0;
  contact.frictionImpulse.setZero();
  contact.projectionFriction.setZero();
}

}  // namespace

void JointContact::clear() {
  bodies_.clear();
  count_ = 0;
  inverseMasses_.clear();
  rigid_.clear();
}

void JointContact::add(Body &body, bool moves, bool hasUnknowns, RigidState *rigid) {
  bodies_.push_back({&body, count_, moves, hasUnknowns, rigid, rigid_.size(), {}});
  if (!hasUnknowns) return;
  if (rigid) {
    rigid_.emplace_back();
    rigid_.back().first = static_cast<Index>(count_);
    count_ += 4;
    inverseMasses_.resize(count_, 4.0 / rigid->frame().mass());
    return;
  }
  count_ += body.rest().phyxelCount();
  if (moves)
    inverseMasses_.insert(inverseMasses_.end(), body.inverseMasses().begin(), body.inverseMasses().end());
  else
    inverseMasses_.resize(count_, 0.0);
}

// Merges the entries of a phyxel that occurs twice in a row.
void JointContact::addEntry(Index of, double weight) {
  if (weight == 0.0) return;
  if (entryOf_[of] != kNone) {
    rows_.binding.weights[entryOf_[of]] += weight;
    return;
  }
  entryOf_[of] = static_cast<Index>(rows_.binding.weights.size());
  rows_.binding.phyxels.indices.push_back(of);
  rows_.binding.weights.push_back(weight);
}

void JointContact::addRow(std::span<const Index> phyxels, std::span<const double> weights, const Joined &of,
                          double scale) {
  if (!of.rigid) {
    for (std::size_t e = 0; e < phyxels.size(); ++e)
      addEntry(static_cast<Index>(of.first + phyxels[e]), scale * weights[e]);
    return;
  }
  std::array<double, 4> sums{};
  for (std::size_t e = 0; e < phyxels.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += scale * weights[e] * of.rigid->frame().weightsOf(phyxels[e])[k];
  for (std::size_t k = 0; k < 4; ++k) addEntry(static_cast<Index>(of.first + k), sums[k]);
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
    // Between two deformable skins, inclined planes keep corners and edges apart.
    const auto isRigid = [&](const Joined &body) { return body.rigid || !body.moves; };
    const bool usesInclinedPlanes = !isRigid(bodies_[of[0]]) && !isRigid(bodies_[of[1]]);
    for (const SkinContact &contact : joined.pair->active()) {
      // Overlap always exerts a force. The margin of a long step may have closed a gap, and a plane found on the path
      // may be nearer than the face itself.
      const SkinPairSettings &settings = joined.pair->settings();
      const double layer = contact.thickness > 0.0 ? contact.thickness * settings.offset / settings.thickness
                                                   : settings.offset - settings.thickness;
      const bool exertsForce =
          usesInclinedPlanes || contact.gap + layer < 0.0 || !hasNearerFeature(*joined.pair, contact);
      for (const SkinContact::Part &part : contact.parts) {
        if (part.weight == 0.0 || !exertsForce) continue;
        const std::size_t side = part.ofSecond ? 1 : 0;
        if (!bodies_[of[side]].hasUnknowns) continue;
        const Interpolation &skin = joined.pair->skin(side).vertices;
        const Index begin = skin.phyxels.offsets[part.vertex], end = skin.phyxels.offsets[part.vertex + 1];
        addRow(std::span<const Index>(skin.phyxels.indices).subspan(begin, end - begin),
               std::span<const double>(skin.weights).subspan(begin, end - begin), bodies_[of[side]], part.weight);
      }
      addContact(contact);
      if (!exertsForce) clearContactRow(state_.active.back());
    }
  }
  gatherSnapshots_.clear();
  if (obstacles) {
    loadDisplacements();
    for (const JoinedPair &joined : pairs)
      for (SkinContact &contact : joined.pair->active()) {
        const std::size_t row = gatherSnapshots_.size();
        if (!contact.atSearch) contact.atSearch = {contact.gap, rowDisplacement(row)};
        gatherSnapshots_.push_back({contact.atSearch->displacement, contact.atSearch->gap, 0.0});
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
             std::span<const double>(points.weights).subspan(begin, end - begin), joined, 1.0);
      addContact(contact);
    }
  }
}

bool JointContact::isStillValid() {
  loadDisplacements();
  for (std::size_t c = 0; c < gatherSnapshots_.size(); ++c) {
    const Contact &contact = state_.active[c];
    const Vec3 travel = rowDisplacement(c) - gatherSnapshots_[c].displacement;
    const double slip = kSlip * (contact.thickness > 0.0 ? contact.thickness : margin_);
    gatherSnapshots_[c].normalDisplacement = travel.dot(contact.normal);
    if (!((travel - gatherSnapshots_[c].normalDisplacement * contact.normal).squaredNorm() <= slip * slip))
      return false;
  }
  return true;
}

void JointContact::regather() {
  const std::size_t count = gatherSnapshots_.size();
  rows_.binding.phyxels.offsets.resize(count + 1);
  const Index entries = rows_.binding.phyxels.offsets.back();
  rows_.binding.phyxels.indices.resize(entries);
  rows_.binding.weights.resize(entries);
  rows_.binding.positions.resize(count);
  state_.active.resize(count);
  for (std::size_t c = 0; c < count; ++c)
    state_.active[c].gap = gatherSnapshots_[c].gap + gatherSnapshots_[c].normalDisplacement;
  state_.margin = 0.0;
  addObstacles();
}

Vec3 JointContact::rowDisplacement(std::size_t row) const {
  const Csr &phyxels = rows_.binding.phyxels;
  Vec3 sum = Vec3::Zero();
  for (Index e = phyxels.offsets[row]; e < phyxels.offsets[row + 1]; ++e)
    sum += rows_.binding.weights[e] * displacements_[phyxels.indices[e]];
  return sum;
}

void JointContact::loadDisplacements() {
  displacements_.resize(count_);
  for (const Joined &joined : bodies_) {
    if (joined.rigid) {
      const std::array<Vec3, 4> four = joined.rigid->frame().displacementsOf(joined.rigid->pose);
      std::copy(four.begin(), four.end(), displacements_.begin() + static_cast<std::ptrdiff_t>(joined.first));
      continue;
    }
    std::copy(joined.body->state().displacements.begin(), joined.body->state().displacements.end(),
              displacements_.begin() + static_cast<std::ptrdiff_t>(joined.first));
  }
}

void JointContact::loadVelocities() {
  velocities_.resize(count_);
  for (const Joined &joined : bodies_) {
    if (joined.rigid) {
      const RigidState &state = *joined.rigid;
      const std::array<Vec3, 4> four = state.frame().particleVelocities(state.pose, state.motion);
      std::copy(four.begin(), four.end(), velocities_.begin() + static_cast<std::ptrdiff_t>(joined.first));
      rigid_[joined.number] = state.frame().particles(state.pose, static_cast<Index>(joined.first));
      continue;
    }
    std::copy(joined.body->state().velocities.begin(), joined.body->state().velocities.end(),
              velocities_.begin() + static_cast<std::ptrdiff_t>(joined.first));
  }
}

void JointContact::predict() {
  loadVelocities();
  for (std::size_t c = 0; c < state_.active.size(); ++c) {
    const Contact &contact = state_.active[c];
    if (!(contact.normalImpulse > 0.0)) continue;
    const Vec3 impulse = contact.normalImpulse * contact.normal + contact.frictionImpulse;
    for (Index e = rows_.binding.phyxels.offsets[c]; e < rows_.binding.phyxels.offsets[c + 1]; ++e)
      velocities_[rows_.binding.phyxels.indices[e]] +=
          inverseMasses_[rows_.binding.phyxels.indices[e]] * rows_.binding.weights[e] * impulse;
  }
  for (Joined &joined : bodies_) {
    if (!joined.rigid) continue;
    const RigidState &state = *joined.rigid;
    const RigidVelocity motion =
        state.frame().velocityOf(state.pose, std::span<const Vec3>(velocities_).subspan(joined.first, 4));
    joined.predicted.resize(joined.body->rest().phyxelCount());
    state.frame().move(state.pose, motion, joined.body->rest().positions, joined.predicted);
  }
}

void JointContact::storeVelocities() {
  for (const Joined &joined : bodies_)
    if (joined.rigid) {
      RigidState &state = *joined.rigid;
      state.motion = state.frame().velocityOf(state.pose, std::span<const Vec3>(velocities_).subspan(joined.first, 4));
      state.storeVelocities();
    } else if (joined.moves)
      std::copy_n(velocities_.begin() + static_cast<std::ptrdiff_t>(joined.first),
                  joined.body->state().velocities.size(), joined.body->state().velocities.begin());
}

void JointContact::writeBack(std::span<const JoinedPair> pairs) {
  auto solved = state_.active.cbegin();
  const auto copyResult = [&](Contact &contact) {
    contact.normalImpulse = solved->normalImpulse;
    contact.frictionImpulse = solved->frictionImpulse;
    contact.projectionImpulse = solved->projectionImpulse;
    contact.projectionFriction = solved->projectionFriction;
    contact.normalForce = solved->normalForce;
    contact.initialPenetration = solved->initialPenetration;
    contact.tangentialDisplacement = solved->tangentialDisplacement;
    ++solved;
  };
  for (const JoinedPair &joined : pairs)
    for (SkinContact &contact : joined.pair->active()) copyResult(contact);
  for (const Joined &joined : bodies_)
    if (joined.moves && gathersObstacles_)
      for (Contact &contact : joined.body->contact.active) copyResult(contact);
}

void JointContact::solve(double dt, std::span<const JoinedPair> pairs) {
  loadVelocities();
  ImpulseSettings settings;
  settings.sweeps = kSweeps;
  settings.tolerance = kTolerance;
  settings.leastSpeed = kResidualFraction * margin_ / dt;
  solveContactImpulses(rows_.binding, inverseMasses_, rigid_, dt, settings, state_, velocities_);
  storeVelocities();
  writeBack(pairs);
}

void JointContact::projectVelocities(std::span<const JoinedPair> pairs) {
  loadVelocities();
  projectContactVelocities(rows_.binding, inverseMasses_, rigid_, state_, velocities_);
  storeVelocities();
  writeBack(pairs);
}

}  // namespace pointbased::detail
