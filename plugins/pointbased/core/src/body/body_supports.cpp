// SPDX-License-Identifier: Apache-2.0
// Supports of a body: their prescribed motion, and their reactions.
#include <algorithm>
#include <cmath>

#include "base/expects.h"
#include "body/rest_surface.h"
#include "pointbased/body.h"
#include "pointbased/support_energy.h"

namespace pointbased {
namespace {

constexpr double kFoundationSampling = 0.5;  // spacings, of the surface

// Velocity of a material point moved by a fix, m/s: 0 after the end of its ramp, and in static solutions.
Vec3 velocityAt(const Body &body, std::size_t f, double t, const Vec3 &X) {
  const RestState &rest = body.rest();
  const Fix &fix = rest.conditions.fixes[f];
  if (body.quasiStatic || !(t < fix.ramp)) return Vec3::Zero();
  return motionRate(fix, rest.conditions.held[f], rest.origin, body.factor(fix.ramp, t), X) / fix.ramp;
}

}  // namespace

Surface detail::restSurface(const RestState &rest) {
  Surface surface;
  surface.positions.resize(rest.surfels.count());
  std::vector<Vec3> normals(rest.surfelNormals.size());
  const std::vector<Vec3> still(rest.phyxelCount(), Vec3::Zero());
  updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, still, surface.positions, normals, serialFor());
  surface.triangles = rest.skin;
  return surface;
}

RigidMotion Body::supportMotion(std::size_t fix) const {
  const BoundaryConditions &conditions = rest_->conditions;
  const Fix &one = conditions.fixes[fix];
  return motionAt(one, conditions.held[fix], rest_->origin,
                  state_.supportTime ? factor(one.ramp, *state_.supportTime) : 0.0);
}

std::optional<SupportedMotion> Body::supportAt(const Vec3 &X) const {
  if (rigid_) return std::nullopt;
  const BoundaryConditions &conditions = rest_->conditions;
  const auto found = std::find_if(conditions.fixes.begin(), conditions.fixes.end(),
                                  [&](const Fix &fix) { return contains(fix.region, X); });
  if (found == conditions.fixes.end()) return std::nullopt;
  const auto f = static_cast<std::size_t>(found - conditions.fixes.begin());
  SupportedMotion out{supportMotion(f), Vec3::Zero()};
  if (state_.supportTime) out.velocity = velocityAt(*this, f, *state_.supportTime, X - rest_->origin);
  return out;
}

// Sorted by fix. Regions refer to the first reference, so nothing is found after rereferencing.
void Body::findHeldSurfels() {
  heldSurfels_.clear();
  nearSupports_.clear();
  if (!rest_->referenceShift.empty()) return;
  const std::vector<Fix> &fixes = rest_->conditions.fixes;
  std::vector<std::uint8_t> isHeld(rest_->surfels.count(), 0);
  for (std::size_t f = 0; f < fixes.size(); ++f) {
    for (std::size_t s = 0; s < isHeld.size(); ++s)
      if (isHeld[s] == 0 && contains(fixes[f].region, rest_->origin + rest_->surfels.position(s, rest_->positions))) {
        isHeld[s] = 1;
        heldSurfels_.push_back({static_cast<Index>(s), static_cast<Index>(f)});
      }
    for (std::size_t i = 0; i < rest_->phyxelCount(); ++i)
      if (signedDistance(fixes[f].region, rest_->origin + rest_->positions[i]) <= rest_->spacing)
        nearSupports_.push_back({static_cast<Index>(i), static_cast<Index>(f)});
  }
}

namespace {

// Calls place(surfel, rest position in the frame of the phyxels, motion) for each surfel that is held.
template <class HeldSurfels, class Place>
void forHeld(const Body &body, const HeldSurfels &held, const Place &place) {
  Index present = StencilSet::kNoFrame;
  RigidMotion motion;
  for (const auto &[surfel, fix] : held) {
    if (fix != present) motion = body.supportMotion(present = fix);
    place(surfel, body.rest().surfels.position(surfel, body.rest().positions), motion);
  }
}

}  // namespace

void Body::placeHeldSurfels(std::span<Vec3> positions, std::span<Vec3> normals) const {
  if (rigid_) return;
  forHeld(*this, heldSurfels_, [&](Index s, const Vec3 &X, const RigidMotion &motion) {
    positions[s] = X + motion.displacementOf(X);
    if (!normals.empty()) normals[s] = motion.rotation * rest_->surfelNormals[s];
  });
}

void Body::placeHeldSurfels(std::span<Vec3f> positions, std::span<Vec3f> normals) const {
  if (rigid_) return;
  forHeld(*this, heldSurfels_, [&](Index s, const Vec3 &X, const RigidMotion &motion) {
    const Vec3 x = rest_->origin + X + motion.displacementOf(X);
    for (std::size_t a = 0; a < 3; ++a) positions[s][a] = static_cast<float>(x[static_cast<Eigen::Index>(a)]);
    if (normals.empty()) return;
    const Vec3 n = motion.rotation * rest_->surfelNormals[s];
    for (std::size_t a = 0; a < 3; ++a) normals[s][a] = static_cast<float>(n[static_cast<Eigen::Index>(a)]);
  });
}

void Body::placeHeld(double t, bool rates) {
  state_.supportTime = t;
  Index present = StencilSet::kNoFrame;
  RigidMotion motion;
  for (const HeldPhyxel &held : heldPhyxels_) {
    if (held.fix != present) motion = supportMotion(present = held.fix);
    const Vec3 X = firstReference(held.phyxel);
    state_.displacements[held.phyxel] = motion.displacementOf(X) - (rest_->positions[held.phyxel] - X);
    if (rates) state_.velocities[held.phyxel] = velocityAt(*this, held.fix, t, X);
  }
}

std::span<const Vec3> Body::patchTargets(double t) {
  const BoundaryConditions &conditions = rest_->conditions;
  Index present = StencilSet::kNoFrame;
  RigidMotion motion;
  for (std::size_t p = 0; p < patchPoints_.size(); ++p) {
    if (fixOfPatch_[p] >= conditions.fixes.size()) break;
    if (fixOfPatch_[p] != present) {
      present = fixOfPatch_[p];
      const Fix &fix = conditions.fixes[present];
      motion = motionAt(fix, conditions.held[present], rest_->origin, factor(fix.ramp, t));
    }
    patchTargets_[p] = motion.displacementOf(patchPoints_[p]) - patchShifts_[p];
  }
  std::size_t p = patchTargets_.size();
  for (std::size_t k = liveSupports_.size(); k-- > 0;) {
    const LiveSupport &support = liveSupports_[k];
    const double s = support.progressAt(t, quasiStatic);
    const Vec3 moved = support.displacementAt(s);
    for (std::size_t row = support.part.rows.rows(); row-- > 0;) {
      --p;
      patchTargets_[p] = (support.returns ? 1.0 - s : 1.0) * support.offsets[row] + moved - patchShifts_[p];
    }
  }
  return patchTargets_;
}

// Forces of the patches of the scene persist; those of live supports begin at zero.
void Body::setLiveSupports(std::vector<LiveSupport> supports) {
  const std::vector<Vec3> before = patches_.forces();
  std::size_t live = 0;
  for (const LiveSupport &support : liveSupports_) live += support.part.rows.rows();
  const std::size_t own = patchPoints_.size() - live;
  for (const LiveSupport &support : supports)
    POINTBASED_EXPECTS(support.offsets.size() == support.part.rows.rows(), "one offset per row of a support");
  liveSupports_ = std::move(supports);
  patchPoints_.resize(own);
  patchShifts_.resize(own);
  fixOfPatch_.resize(own);
  for (std::size_t k = 0; k < liveSupports_.size(); ++k)
    addPatchesOf(liveSupports_[k].part, static_cast<Index>(rest_->conditions.held.size() + k));
  patchTargets_.assign(patchPoints_.size(), Vec3::Zero());
  updateMassDependents();
  std::copy_n(before.begin(), std::min(own, before.size()), patches_.forces().begin());
}

std::vector<Reaction> Body::reactions(const Vec3 &gravity) const {
  const BoundaryConditions &conditions = rest_->conditions;
  std::vector<Reaction> out(conditions.fixes.size() + liveSupports_.size());
  for (std::size_t k = 0; k < liveSupports_.size(); ++k)
    out[conditions.fixes.size() + k].centre = rest_->origin + liveSupports_[k].part.centroid;
  for (std::size_t f = 0; f < conditions.fixes.size(); ++f)
    out[f].centre = conditions.fixes[f].centre.value_or(rest_->origin + conditions.held[f].centroid);
  const auto add = [&](Index fix, const Vec3 &x, const Vec3 &force) {
    out[fix].force += force;
    out[fix].torque += (rest_->origin + x - out[fix].centre).cross(force);
  };
  for (const HeldPhyxel &held : heldPhyxels_)
    add(held.fix, rest_->positions[held.phyxel] + state_.displacements[held.phyxel],
        -(forces_[held.phyxel] + weights()[held.phyxel] * gravity));
  for (std::size_t i = 0; i < supportWeights_.size(); ++i)
    if (supportWeights_[i] > 0.0)
      add(carrier_[i], rest_->positions[i] + state_.displacements[i], -supportWeights_[i] * gravity);
  const Csr &rows = patches_.phyxels();
  for (std::size_t p = 0; p < patches_.rows(); ++p) {
    // The force of a patch acts at the positions of its phyxels, which preserves the torque on the body.
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e) {
      const Index j = rows.indices[e];
      add(fixOfPatch_[p], rest_->positions[j] + state_.displacements[j], patches_.weights()[e] * patches_.forces()[p]);
    }
  }
  // Patch forces on a phyxel held by another fix are reactions of that fix.
  for (std::size_t p = 0; p < patches_.rows(); ++p)
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e) {
      const Index j = rows.indices[e];
      if (!heldMask_[j]) continue;
      const auto holder =
          std::find_if(heldPhyxels_.begin(), heldPhyxels_.end(), [j](const HeldPhyxel &h) { return h.phyxel == j; });
      add(holder->fix, rest_->positions[j] + state_.displacements[j], -(patches_.weights()[e] * patches_.forces()[p]));
    }
  return out;
}

double supportEnergy(const Body &body) {
  const PatchSolver &patches = body.patches();
  double sum = 0.0;
  for (std::size_t p = 0; p < patches.rows(); ++p)
    sum += 0.5 * patches.forces()[p].squaredNorm() / patches.stiffness()[p];
  return sum;
}

// Separate sample points: contact points have an error of a per cent in the first moments of the surface.
void Body::bindFoundation() {
  foundation_.unbind();
  if (!foundation_.settings().acts()) return;
  SurfacePoints points =
      sampleSurface(detail::restSurface(*rest_), kFoundationSampling * rest_->spacing, EverywhereRegion{});
  Interpolation binding = rest_->bind(points.positions, points.normals);
  foundation_.bind(std::move(points), std::move(binding), rest_->phyxelCount());
}

Result<void> Body::setFoundation(const Foundation &foundation) {
  if (auto valid = validate(foundation); !valid) return valid;
  if (foundation.acts() && rest_->skin.empty())
    return tl::make_unexpected(std::string("the body has no surface that its surroundings could hold"));
  if (foundation.acts() && rereferenceCount_ > 0)
    return tl::make_unexpected(std::string(
        "the body has flowed so far that its reference is a later shape; reset before its surroundings hold it"));
  foundation_.set(foundation);
  if (!foundation_.bound()) bindFoundation();
  foundationFrequency_ = std::sqrt(foundation_.squaredFrequencyBound(masses_));
  forcesCurrent = false;
  return {};
}

Reaction Body::foundationReaction() const {
  Reaction out;
  double mass = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    out.centre += masses_[i] * rest_->positions[i];
    mass += masses_[i];
  }
  if (mass > 0.0) out.centre /= mass;
  const Vec3 centre = out.centre;
  out.centre += rest_->origin;
  if (!foundation_.acts()) return out;
  std::vector<Vec3> forces(rest_->phyxelCount(), Vec3::Zero());
  foundation_.addForces(state_.displacements, state_.velocities, forces, serialFor());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    out.force += forces[i];
    out.torque += (rest_->positions[i] + state_.displacements[i] - centre).cross(forces[i]);
  }
  return out;
}

}  // namespace pointbased
