// SPDX-License-Identifier: Apache-2.0
#include "stepping/coupling/attachment_layer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/number_text.h"
#include "body/rest_surface.h"
#include "contact/contact_search.h"
#include "contact/contact_skin.h"
#include "discretisation/interpolation_at.h"

namespace pointbased::detail {
namespace {

constexpr double kSampling = 0.5;          // spacings, of the surface
constexpr double kFacing = -0.1;           // cosine: surfaces joined by a layer face each other
constexpr double kContactDistance = 1e-6;  // spacings
constexpr double kMinVolumeRatio = 0.05;   // det F, below which the direction of the normal is not reliable

// Nearest point on the second body's surface at rest, for any point.
struct NearestOfBody {
  explicit NearestOfBody(const Body &body)
      : rest_(body.rest()), zeros_(rest_.phyxelCount(), Vec3::Zero()),
        skin_(makeContactSkin(rest_.surfels.expanded(rest_.positions), rest_.skin, {rest_.spacing}, rest_.bind,
                              rest_.maxInfluence),
              rest_.origin, rest_.spacing) {
    skin_.move(zeros_, zeros_, rest_.maxInfluence, 0.0);
    skin_.refitTree();
  }
  struct SurfaceSample {
    Vec3 x, normal;  // m, world; unit
  };
  [[nodiscard]] SurfaceSample of(const Vec3 &x) {
    Index triangle = 0;
    NearestOnTriangle best;
    best.squared = std::numeric_limits<double>::infinity();
    skin_.tree().nearest(x, [&](Index t) {
      const NearestOnTriangle found = skin_.nearestOn(t, x);
      if (found.squared < best.squared) {
        best = found;
        triangle = t;
      }
      return found.squared;
    });
    return {skin_.pointOn(triangle, best.weights), skin_.faceNormal(triangle).normalized()};
  }

 private:
  const RestState &rest_;
  std::vector<Vec3> zeros_;
  MovingSkin skin_;
};

void keepOnly(SurfacePoints &points, const std::vector<std::uint8_t> &kept) {
  std::size_t n = 0;
  for (std::size_t p = 0; p < kept.size(); ++p) {
    if (!kept[p]) continue;
    points.positions[n] = points.positions[p];
    points.normals[n] = points.normals[p];
    points.areas[n] = points.areas[p];
    points.triangles[n++] = points.triangles[p];
  }
  points.positions.resize(n);
  points.normals.resize(n);
  points.areas.resize(n);
  points.triangles.resize(n);
}

std::string millimetres(double metres) { return number(1e3 * metres) + " mm"; }

}  // namespace

Result<AttachmentLayer> AttachmentLayer::make(const Attachment &settings, const Body &first, const Body *second,
                                              const Obstacle *obstacle) {
  if (auto valid = validate(settings); !valid) return tl::unexpected(valid.error());
  for (const Body *body : {&first, second})
    if (body && body->rest().skin.empty())
      return tl::make_unexpected("body '" + body->name() + "' has no surface that could be attached");
  for (const Body *body : {&first, second})
    if (body && body->rereferenceCount() > 0)
      return tl::make_unexpected(
          "body '" + body->name() +
          "' has flowed so far that its reference is a later shape; reset before it is attached");
  AttachmentLayer out;
  out.settings_ = settings;
  const RestState &rest = first.rest();
  out.origin_ = rest.origin;
  out.points_ = sampleSurface(restSurface(rest), kSampling * rest.spacing, shifted(settings.region, rest.origin));
  const std::size_t inRegion = out.points_.count();
  if (inRegion == 0)
    return tl::make_unexpected("no part of the surface of body '" + first.name() +
                               "' is in the region of the attachment");

  double nearest = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> near(inRegion, 1);
  std::vector<Vec3> anchors, anchorNormals;
  if (second) {
    NearestOfBody search(*second);
    for (std::size_t p = 0; p < inRegion; ++p) {
      const Vec3 x = rest.origin + out.points_.positions[p];
      const NearestOfBody::SurfaceSample found = search.of(x);
      const double away = (x - found.x).norm();
      nearest = std::min(nearest, away);
      // Where nearness is the only criterion, the far sides of thin bodies are excluded.
      const bool faces = !std::isfinite(settings.within) || out.points_.normals[p].dot(found.normal) < kFacing;
      near[p] = away <= settings.within && faces ? 1 : 0;
      if (!near[p]) continue;
      out.maxGap_ = std::max(out.maxGap_, away);
      anchors.push_back(found.x - second->rest().origin);
      anchorNormals.push_back(found.normal);
    }
  } else if (obstacle && std::isfinite(settings.within)) {
    std::vector<Vec3> at(inRegion);
    const RigidMotion motion = obstacle->motion ? obstacle->motion(0.0) : RigidMotion{};
    for (std::size_t p = 0; p < inRegion; ++p) at[p] = toRestFrame(motion, rest.origin + out.points_.positions[p]);
    const std::vector<double> ranges(inRegion, std::numeric_limits<double>::infinity());
    std::vector<SurfacePoint> found(inRegion);
    if (obstacle->closest) obstacle->closest(at, ranges, found);
    for (std::size_t p = 0; p < inRegion; ++p) {
      const double away = std::abs(found[p].distance);
      nearest = std::min(nearest, away);
      const double facing = out.points_.normals[p].dot(motion.rotation * found[p].normal);
      // The normal of a touching sheet may point to either side.
      const bool faces = away > kContactDistance * rest.spacing ? facing < kFacing : std::abs(facing) > -kFacing;
      near[p] = away <= settings.within && faces ? 1 : 0;
    }
  }
  keepOnly(out.points_, near);
  if (out.points_.count() == 0)
    return tl::make_unexpected("the surface of body '" + first.name() + "' is nowhere within " +
                               millimetres(settings.within) + " of the surface of '" +
                               (second ? second->name() : obstacle->name) +
                               "' and faces it; the nearest place of both is " + millimetres(nearest) + " apart");
  if (obstacle) out.motion_ = obstacle->motion;
  out.first_ = rest.bind(out.points_.positions, out.points_.normals);
  if (second) {
    out.second_ = second->rest().bind(anchors, anchorNormals);
    // Extrapolated linearly to the points of the first body.
    for (std::size_t p = 0; p < out.points_.count(); ++p) {
      const Vec3 beyond = rest.origin + out.points_.positions[p] - second->rest().origin - out.second_.positions[p];
      for (Index e = out.second_.phyxels.offsets[p]; e < out.second_.phyxels.offsets[p + 1]; ++e)
        out.second_.weights[e] += out.second_.gradients[e].dot(beyond);
    }
  }
  out.normals_ = out.points_.normals;
  out.area_ = std::accumulate(out.points_.areas.begin(), out.points_.areas.end(), 0.0);
  return out;
}

std::optional<RigidMotion> AttachmentLayer::motionAt(const AttachedState &at) const {
  return motion_ ? std::optional(motion_(at.time)) : std::nullopt;
}

Vec3 AttachmentLayer::relativeDisplacement(std::size_t p, const AttachedState &at, const RigidMotion *motion) const {
  Vec3 displacement = at.first.empty() ? Vec3(Vec3::Zero()) : fieldAt(first_, p, at.first);
  if (joinsBodies()) {
    if (!at.second.empty()) displacement -= fieldAt(second_, p, at.second);
  } else if (motion) {
    displacement -= motion->displacementOf(origin_ + points_.positions[p]);
  }
  return displacement;
}

Mat3 AttachmentLayer::stiffnessOf(std::size_t p) const {
  const Vec3 &n = normals_[p];
  return points_.areas[p] *
         (settings_.tangential * Mat3::Identity() + (settings_.stiffness - settings_.tangential) * n * n.transpose());
}

Vec3 AttachmentLayer::timesStiffness(std::size_t p, const Vec3 &d) const {
  const Vec3 &n = normals_[p];
  return points_.areas[p] * (settings_.tangential * d + (settings_.stiffness - settings_.tangential) * n.dot(d) * n);
}

// visit(isSecond, phyxel, weight of its displacement in d of p)
template <class Visit>
void AttachmentLayer::forEntries(std::size_t p, const Visit &visit) const {
  for (Index e = first_.phyxels.offsets[p]; e < first_.phyxels.offsets[p + 1]; ++e)
    visit(false, first_.phyxels.indices[e], first_.weights[e]);
  if (!joinsBodies()) return;
  for (Index e = second_.phyxels.offsets[p]; e < second_.phyxels.offsets[p + 1]; ++e)
    visit(true, second_.phyxels.indices[e], -second_.weights[e]);
}

// With n = cof(F) N / |cof(F) N|: δn = -P F^-T δFᵀ n, P = 1 - n nᵀ. The energy A (k_n - k_t) (n·d)²/2 therefore pulls
// phyxel j with n (g_j·w), w = F^-1 P A (k_n - k_t) (n·d) d. Without it a rotating layer would gain or lose energy.
double AttachmentLayer::updateNormals(const AttachedState &at) {
  if (settings_.stiffness == settings_.tangential || at.first.empty()) return 0.0;
  const std::optional<RigidMotion> motion = motionAt(at);
  rotationForces_.assign(at.first.size(), Vec3::Zero());
  stiffening_ = 0.0;
  double most = 0.0;
  for (std::size_t p = 0; p < normals_.size(); ++p) {
    const Mat3 F = gradientAt(first_, p, at.first);
    Mat3 cofactor;
    for (int c = 0; c < 3; ++c) cofactor.col(c) = F.col((c + 1) % 3).cross(F.col((c + 2) % 3));
    const Vec3 n = cofactor * points_.normals[p];
    const double length = n.norm(), J = F.col(0).dot(cofactor.col(0));
    const bool isValid = length > 0.0 && std::isfinite(length);
    const Vec3 turned = isValid ? Vec3(n / length) : points_.normals[p];
    most = std::max(most, (turned - normals_[p]).norm());
    normals_[p] = turned;
    if (isTorn(p) || !isValid || !(J > kMinVolumeRatio) || rankOf(first_, p) < 3) continue;
    const Vec3 d = relativeDisplacement(p, at, motion ? &*motion : nullptr);
    const double along = turned.dot(d);
    const Vec3 pull = points_.areas[p] * (settings_.stiffness - settings_.tangential) * along * (d - along * turned);
    const Vec3 w = cofactor.transpose() * pull / J;
    double gradients = 0.0, weights = 0.0;
    for (Index e = first_.phyxels.offsets[p]; e < first_.phyxels.offsets[p + 1]; ++e) {
      rotationForces_[first_.phyxels.indices[e]] += first_.gradients[e].dot(w) * turned;
      gradients += first_.gradients[e].squaredNorm();
      weights += first_.weights[e] * first_.weights[e];
    }
    stiffening_ = std::max(stiffening_, d.norm() * std::sqrt(gradients / weights));
  }
  return most;
}

double AttachmentLayer::workOfRotationForces(std::span<const Vec3> first) const {
  double work = 0.0;
  for (std::size_t i = 0; i < std::min(rotationForces_.size(), first.size()); ++i)
    work += rotationForces_[i].dot(first[i]);
  return work;
}

double AttachmentLayer::energy(const AttachedState &at) const {
  const std::optional<RigidMotion> motion = motionAt(at);
  double energy = 0.0;
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    const Vec3 d = relativeDisplacement(p, at, motion ? &*motion : nullptr);
    energy += 0.5 * d.dot(timesStiffness(p, d));
  }
  return energy;
}

void AttachmentLayer::addForces(const AttachedState &at, std::span<Vec3> first, std::span<Vec3> second) const {
  const std::optional<RigidMotion> motion = motionAt(at);
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    const Vec3 force = -timesStiffness(p, relativeDisplacement(p, at, motion ? &*motion : nullptr));
    if (!first.empty()) spreadForce(first_, p, force, first);
    if (joinsBodies() && !second.empty()) spreadForce(second_, p, -force, second);
  }
  for (std::size_t i = 0; i < std::min(rotationForces_.size(), first.size()); ++i) first[i] += rotationForces_[i];
}

void AttachmentLayer::addProduct(const AttachedState &change, std::span<Vec3> first, std::span<Vec3> second) const {
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    const Vec3 force = timesStiffness(p, relativeDisplacement(p, change, nullptr));
    if (!first.empty()) spreadForce(first_, p, force, first);
    if (joinsBodies() && !second.empty()) spreadForce(second_, p, -force, second);
  }
}

void AttachmentLayer::addBlocks(std::span<Mat3> first, std::span<Mat3> second) const {
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    const Mat3 K = stiffnessOf(p);
    forEntries(p, [&](bool ofSecond, Index j, double weight) {
      const std::span<Mat3> of = ofSecond ? second : first;
      if (!of.empty()) of[j] += weight * weight * K;
    });
  }
}

void AttachmentLayer::addTriplets(std::size_t first, std::size_t second,
                                  std::vector<Eigen::Triplet<double>> &out) const {
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    const Mat3 K = stiffnessOf(p);
    forEntries(p, [&](bool ofSecond, Index i, double a) {
      if ((ofSecond ? second : first) == kNoRows) return;
      const auto row = static_cast<int>(3 * ((ofSecond ? second : first) + i));
      forEntries(p, [&](bool otherOfSecond, Index j, double b) {
        if ((otherOfSecond ? second : first) == kNoRows) return;
        const auto column = static_cast<int>(3 * ((otherOfSecond ? second : first) + j));
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) out.emplace_back(row + r, column + c, a * b * K(r, c));
      });
    });
  }
}

double AttachmentLayer::squaredFrequencyBound(std::span<const double> first, std::span<const double> second) const {
  const double k = std::max(settings_.stiffness, settings_.tangential);
  std::vector<double> ofFirst(first.size(), 0.0), ofSecond(second.size(), 0.0);
  for (std::size_t p = 0; p < points_.count(); ++p) {
    double sum = 0.0;
    const auto share = [&](bool isSecond, Index j, double weight) {
      const std::span<const double> inverse = isSecond ? second : first;
      return inverse.empty() ? 0.0 : std::abs(weight) * std::sqrt(inverse[j]);
    };
    forEntries(p, [&](bool isSecond, Index j, double weight) { sum += share(isSecond, j, weight); });
    forEntries(p, [&](bool isSecond, Index j, double weight) {
      std::vector<double> &rows = isSecond ? ofSecond : ofFirst;
      if (!rows.empty()) rows[j] += k * points_.areas[p] * share(isSecond, j, weight) * sum;
    });
  }
  double largest = 0.0;
  for (const double row : ofFirst) largest = std::max(largest, row);
  for (const double row : ofSecond) largest = std::max(largest, row);
  return largest;
}

bool AttachmentLayer::tear(const AttachedState &at) {
  if (!(settings_.tearsAt > 0.0)) return false;
  const std::optional<RigidMotion> motion = motionAt(at);
  bool any = false;
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) continue;
    Vec3 traction = timesStiffness(p, relativeDisplacement(p, at, motion ? &*motion : nullptr)) / points_.areas[p];
    traction -= std::max(0.0, traction.dot(normals_[p])) * normals_[p];  // compression does not tear
    if (!(traction.norm() > settings_.tearsAt)) continue;
    if (torn_.empty()) torn_.assign(points_.count(), 0);
    torn_[p] = 1;
    any = true;
  }
  return any;
}

bool AttachmentLayer::setTorn(std::vector<std::uint8_t> torn) {
  if (!torn.empty() && torn.size() != points_.count()) return false;
  torn_ = std::move(torn);
  return true;
}

AttachmentSummary AttachmentLayer::summary(const AttachedState &at) const {
  AttachmentSummary out;
  out.first = settings_.first;
  out.second = settings_.second;
  out.name = settings_.name;
  out.area = area_;
  out.energy = energy(at);
  const std::optional<RigidMotion> motion = motionAt(at);
  double torn = 0.0;
  for (std::size_t p = 0; p < points_.count(); ++p) out.centre += points_.areas[p] / area_ * points_.positions[p];
  for (std::size_t p = 0; p < points_.count(); ++p) {
    if (isTorn(p)) {
      torn += points_.areas[p];
      continue;
    }
    const Vec3 force = -timesStiffness(p, relativeDisplacement(p, at, motion ? &*motion : nullptr));
    const Vec3 x = points_.positions[p] + fieldAt(first_, p, at.first);
    out.force += force;
    out.torque += (x - out.centre).cross(force);
    out.traction = std::max(out.traction, force.norm() / points_.areas[p]);
  }
  out.centre += origin_;
  out.tornPart = area_ > 0.0 ? torn / area_ : 0.0;
  return out;
}

}  // namespace pointbased::detail
