// SPDX-License-Identifier: Apache-2.0
#include "instruments/grasp.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/number_text.h"
#include "instruments/grab_patch.h"

namespace pointbased {
namespace {

constexpr double kMinAxisSine = 0.2;      // sine: a smaller component of the axis along the skin counts as none
constexpr double kStiffnessRatio = 10.0;  // ratio of a jaw's spring stiffness to the held tissue, E times its diameter
constexpr double kMaxPull = 4.0;          // times E times the squared diameter: several hundred per cent of strain
constexpr double kMaxPart = 0.25;        // fraction of a body that a jaw may hold: one as large as a ball holds 5/16 of
                                         // it
constexpr double kMaxShared = 0.5;       // fraction of a patch that both jaws may hold
constexpr double kFollowingTime = 0.05;  // s, in which the held tissue reaches its prescribed position
constexpr double kMaxGain = 30.0;        // factor by which jaws move faster where their springs yield
constexpr double kNearLimit = 0.98;      // fraction of the force limit at which closing stops
constexpr double kMinTissueTravel = 0.01;  // of the opening: smaller motion is no measure of the springs
constexpr double kMaxOvershoot = 100.0;    // openings, by which jaws may be moved past each other
constexpr double kThickness = 0.2;         // of the diameter of a jaw, as displayed
constexpr double kEverywhere = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kDiscSegments = 24;

std::string millimetres(double metres) { return significant(1e3 * metres) + " mm"; }

struct Hit {
  double t = 0.0;  // m along the ray
  SkinPoint point;
};

// Intersection of a ray with a triangle.
// @source  Möller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997
/// @source  Möller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997
std::optional<Hit> intersect(const Vec3 &origin, const Vec3 &direction, const Surface &skin,
                             const std::array<Index, 3> &corners) {
  const Vec3 &a = skin.positions[corners[0]];
  const Vec3 ab = skin.positions[corners[1]] - a, ac = skin.positions[corners[2]] - a, p = direction.cross(ac);
  const double det = ab.dot(p);
  if (std::abs(det) <= 1e-12 * ab.norm() * ac.norm()) return std::nullopt;
  const Vec3 s = (origin - a) / det, q = s.cross(ab);
  const double u = s.dot(p), v = direction.dot(q), t = ac.dot(q);
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || t < 0.0) return std::nullopt;
  return Hit{t, {corners, Vec3(1.0 - u - v, u, v)}};
}

// The hit nearest to `target` along the ray, within `tolerance` of it.
std::optional<Hit> hitNear(const Surface &skin, const Vec3 &origin, const Vec3 &direction, double target,
                           double tolerance) {
  std::optional<Hit> best;
  for (const auto &corners : skin.triangles) {
    const auto hit = intersect(origin, direction, skin, corners);
    if (!hit || std::abs(hit->t - target) > tolerance ||
        (best && std::abs(best->t - target) <= std::abs(hit->t - target)))
      continue;
    best = hit;
  }
  return best;
}

double patchRadius(const RestState &rest, const GraspSettings &settings) {
  return std::max(0.5 * settings.jaw, rest.spacing);
}

Grab patchOf(const RestState &rest, const SkinPoint &point, const GraspSettings &settings) {
  Vec3 at = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    at += point.weights[static_cast<Eigen::Index>(k)] * rest.surfels.position(point.corners[k], rest.positions);
  Eigen::Index nearest = 0;
  point.weights.maxCoeff(&nearest);
  return patchAround(rest, at, patchRadius(rest, settings), point.corners[static_cast<std::size_t>(nearest)]);
}

}  // namespace

std::string problemOf(const GraspSettings &s) {
  if (!(s.jaw > 0.0) || !std::isfinite(s.jaw))
    return "the jaws have a size of " + millimetres(s.jaw) + "; accepted: above 0";
  if (!(s.opening >= s.jaw) || !std::isfinite(s.opening))
    return "jaws of " + millimetres(s.jaw) + " do not fit side by side into an opening of " + millimetres(s.opening) +
           "; accepted: an opening of at least the size of a jaw";
  if (!(s.closed >= 0.0 && s.closed <= s.opening))
    return "the jaws close to " + millimetres(s.closed) + "; accepted: 0 to their opening, " + millimetres(s.opening);
  if (!(s.forceLimit >= 0.0) || !std::isfinite(s.forceLimit))
    return "the limit of the force is " + significant(s.forceLimit) + " N; accepted: at least 0; 0: none";
  return {};
}

Result<JawPositions> findJaws(const Surface &skin, const Vec3 &at, const Vec3 &normal, const Vec3 &axis,
                              const GraspSettings &settings) {
  JawPositions jaws;
  jaws.normal = normal;
  jaws.axis = axis - axis.dot(normal) * normal;
  if (jaws.axis.norm() < kMinAxisSine * axis.norm())
    return tl::unexpected(
        std::string("the axis of the jaws is perpendicular to the skin there; accepted: one along the skin"));
  jaws.axis.normalize();
  const double reach = settings.opening, half = 0.5 * settings.opening;
  std::array<std::optional<Hit>, 2> hits;
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3 above = at + (k == 0 ? -half : half) * jaws.axis + reach * normal;
    hits[k] = hitNear(skin, above, -normal, reach, reach);
    if (hits[k]) jaws.points[k] = hits[k]->point;
  }
  if (hits[0] && hits[1]) return jaws;
  // From slightly below the skin to the ends of the body on either side.
  const Vec3 inside = at - 0.1 * settings.opening * normal;
  std::array<double, 2> sides{};
  for (std::size_t k = 0; k < 2; ++k)
    if (const auto end = hitNear(skin, inside, k == 0 ? Vec3(-jaws.axis) : jaws.axis, 0.0, kEverywhere))
      sides[k] = end->t;
  if (sides[0] + sides[1] < settings.opening)
    return tl::unexpected("the body is " + millimetres(sides[0] + sides[1]) +
                          " wide there, less than the opening of the jaws, " + millimetres(settings.opening) +
                          "; accepted: a smaller opening, or a place where it is wider");
  const std::size_t missing = hits[0] ? 1 : 0;
  return tl::unexpected("one of the jaws misses the body, which ends " + millimetres(sides[missing]) +
                        " beside that place; accepted: a place farther from its edge than half the opening, " +
                        millimetres(half) + ", or a smaller opening");
}

std::string problemOf(const RestState &rest, const JawPositions &jaws, const GraspSettings &settings) {
  double total = 0.0;
  for (const double v : rest.volumes) total += v;
  std::array<Grab, 2> patches;
  for (std::size_t k = 0; k < 2; ++k) {
    patches[k] = patchOf(rest, jaws.points[k], settings);
    double held = 0.0;
    for (const Index i : patches[k].phyxels) held += rest.volumes[i];
    if (held > kMaxPart * total)
      return "a jaw of " + millimetres(2.0 * patchRadius(rest, settings)) + " would hold " +
             significant(100.0 * held / total, 2) +
             " % of the body; accepted: jaws that are small beside it, and phyxels that are near enough for them (a " +
             "jaw holds at least two spacings, " + millimetres(2.0 * rest.spacing) + ")";
  }
  double shared = 0.0;
  for (std::size_t k = 0; k < patches[0].phyxels.size(); ++k)
    if (std::find(patches[1].phyxels.begin(), patches[1].phyxels.end(), patches[0].phyxels[k]) !=
        patches[1].phyxels.end())
      shared += patches[0].weights[k];
  if (shared <= kMaxShared) return {};
  return "both jaws would hold the same phyxels; accepted: an opening of more than " +
         millimetres(2.0 * patchRadius(rest, settings)) + ", or a smaller spacing";
}

void Grasp::updateTargets() {
  for (std::size_t k = 0; k < 2; ++k) {
    grabs[k].target = middle + rotation * (offsets[k] + (k == 0 ? -0.5 : 0.5) * commandedGap * jaws.axis);
    grabs[k].rotation = rotation;
  }
}

GraspForces forcesOf(const Grasp &grasp, const std::array<GrabStatus, 2> &grabs) {
  GraspForces out;
  out.pull = grabs[0].force + grabs[1].force;
  out.squeeze = 0.5 * (grabs[0].force - grabs[1].force).dot(grasp.axis());
  out.gap = (grabs[1].point - grabs[0].point).dot(grasp.axis());
  return out;
}

Grasp beginGrasp(std::uint64_t id, const Body &body, const JawPositions &jaws, const GraspSettings &settings) {
  Grasp grasp;
  grasp.body = id;
  grasp.jaws = jaws;
  grasp.settings = settings;
  const RestState &rest = body.rest();
  const double youngsModulus = body.material().youngsModulus, size = 2.0 * patchRadius(rest, settings);
  std::array<Vec3, 2> middles;
  for (std::size_t k = 0; k < 2; ++k) {
    Grab &grab = grasp.grabs[k];
    grab = patchOf(rest, jaws.points[k], settings);
    middles[k] = addShapeSprings(grab, body);
    grab.frequency = std::sqrt(kStiffnessRatio * youngsModulus * size / heldMass(grab, body.masses()));
    grab.maxForce = kMaxPull * youngsModulus * size * size;
  }
  grasp.middle = 0.5 * (middles[0] + middles[1]);
  grasp.initialGap = grasp.targetGap = grasp.commandedGap = (middles[1] - middles[0]).dot(jaws.axis);
  for (std::size_t k = 0; k < 2; ++k)
    grasp.offsets[k] = middles[k] - grasp.middle - (k == 0 ? -0.5 : 0.5) * grasp.initialGap * jaws.axis;
  grasp.updateTargets();
  return grasp;
}

void advanceClosing(Grasp &grasp, const GraspForces &forces, double dt) {
  const GraspSettings &s = grasp.settings;
  const double commandedTravel = grasp.initialGap - grasp.commandedGap, tissueTravel = grasp.initialGap - forces.gap;
  const double part = std::min(1.0, dt / kFollowingTime);
  double change = 0.0;
  if (s.forceLimit > 0.0 && forces.squeeze >= kNearLimit * s.forceLimit) {
    // While the tissue was moving, the squeeze was less than at rest.
    if (forces.squeeze > s.forceLimit)
      change = part * (1.0 - s.forceLimit / forces.squeeze) * (commandedTravel - tissueTravel);
    grasp.targetGap = std::clamp(forces.gap, grasp.targetGap, grasp.initialGap);
  } else {
    const double closed = std::min(s.closed, grasp.initialGap), before = grasp.targetGap;
    grasp.targetGap = std::max(closed, before - dt / kClosingTime * (grasp.initialGap - closed));
    // Increased by the ratio to which the springs have yielded so far.
    const double gain =
        tissueTravel > kMinTissueTravel * s.opening ? std::clamp(commandedTravel / tissueTravel, 1.0, kMaxGain) : 1.0;
    change = grasp.targetGap - before + gain * part * (grasp.targetGap - forces.gap);
  }
  grasp.commandedGap = std::clamp(grasp.commandedGap + change, -kMaxOvershoot * s.opening, grasp.initialGap);
}

Surface discOf(const Vec3 &at, const Vec3 &axis, double diameter) {
  Surface disc;
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  for (const double along : {0.0, kThickness * diameter})
    for (std::uint32_t k = 0; k < kDiscSegments; ++k) {
      const double turn = 2.0 * std::numbers::pi * k / kDiscSegments;
      disc.positions.push_back(at + along * axis + 0.5 * diameter * (std::cos(turn) * u + std::sin(turn) * v));
    }
  for (const double along : {0.0, kThickness * diameter}) disc.positions.push_back(at + along * axis);
  for (std::uint32_t k = 0; k < kDiscSegments; ++k) {
    const std::uint32_t next = (k + 1) % kDiscSegments;
    disc.triangles.push_back({2 * kDiscSegments, next, k});
    disc.triangles.push_back({2 * kDiscSegments + 1, kDiscSegments + k, kDiscSegments + next});
    disc.triangles.push_back({k, next, kDiscSegments + next});
    disc.triangles.push_back({k, kDiscSegments + next, kDiscSegments + k});
  }
  return disc;
}

Vec3 screenRight(const Vec3 &offset, double right_px, double down_px, const Vec3 &view) {
  return (right_px * offset + down_px * offset.cross(view)).normalized();
}

}  // namespace pointbased
