// SPDX-License-Identifier: Apache-2.0
// Two jaws on a fold of tissue, without a host: where they find skin, what they hold, how they close.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/surface.h"

namespace pointbased {

/// Sizes of a pair of jaws.
struct GraspSettings {
  double jaw = 0.01;        ///< m, > 0: diameter of the patch that a jaw holds; at least two spacings are taken
  double opening = 0.02;    ///< m, >= jaw: between the middles of the jaws before they close
  double closed = 0.01;     ///< m, 0 … opening: between the middles of the patches; the jaws stop there
  double forceLimit = 0.0;  ///< N, >= 0: nor do they close while they squeeze with more; 0: no limit
  bool operator==(const GraspSettings &) const = default;
};
/// What of them is not accepted, and what is; empty: they are good.
[[nodiscard]] std::string problemOf(const GraspSettings &settings);

/// A point of a skin.
struct SkinPoint {
  std::array<Index, 3> corners{};  ///< of its triangle, vertices of the skin
  Vec3 weights = Vec3::Zero();     ///< of the corners, sum 1

  /// Where it is. @param positions  of the vertices, anything that has three numbers
  template <class Positions>
  [[nodiscard]] Vec3 at(const Positions &positions) const {
    Vec3 x = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &corner = positions[corners[k]];
      x += weights[static_cast<Eigen::Index>(k)] * Vec3(corner[0], corner[1], corner[2]);
    }
    return x;
  }
};

/// Where two jaws stand on a skin.
struct JawPlaces {
  std::array<SkinPoint, 2> points;
  Vec3 axis = Vec3::UnitX();    ///< unit, along the skin, from the first jaw to the second
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the tissue
};
/// On either side of a point of the skin, half the opening away along it. Errors, as text for people: the axis stands
/// on the skin, a jaw misses the body, the body is narrower than the opening.
/// @param normal  unit, outwards, at the point
/// @param axis    unit; what of it lies along the skin counts
[[nodiscard]] Result<JawPlaces> findJaws(const Surface &skin, const Vec3 &at, const Vec3 &normal, const Vec3 &axis,
                                         const GraspSettings &settings);
/// Whether a body can be held so: jaws that hold most of it, or the same phyxels, do not grasp. Empty: it can.
[[nodiscard]] std::string problemOf(const RestState &rest, const JawPlaces &places, const GraspSettings &settings);

/// Two jaws that hold a body. A hand of the simulator pulls each; the two are led as one.
struct Grasp {
  std::uint64_t body = 0;
  JawPlaces places;
  GraspSettings settings;
  std::array<Grab, 2> grabs;         ///< targets: where they pull to now
  std::array<Vec3, 2> across;        ///< m, from the line between the jaws to the patches, as they took hold
  Vec3 middle = Vec3::Zero();        ///< world, m, between the jaws, where the hand wants it
  Mat3 rotation = Mat3::Identity();  ///< since they took hold
  /// m, between the patches: as they took hold, as it is to be now, and between where the jaws pull to
  double firstGap = 0.0, wantedGap = 0.0, pulledGap = 0.0;

  /// Unit, as the jaws are turned now.
  [[nodiscard]] Vec3 axis() const { return rotation * places.axis; }
  /// Takes `middle`, `rotation` and `pulledGap` to the targets of the grabs.
  void aim();
};

/// What the jaws do to the tissue.
struct GraspForces {
  Vec3 pull = Vec3::Zero();  ///< N, both together, on the body
  double squeeze = 0.0;      ///< N, half of the difference along the axis; above 0 they press towards each other
  double gap = 0.0;          ///< m, between the patches, along the axis
};
[[nodiscard]] GraspForces forcesOf(const Grasp &grasp, const std::array<GrabStatus, 2> &hands);

/// Takes hold where the body is now; nothing moves yet.
/// @param places  of findJaws(), surfels of this body
[[nodiscard]] Grasp takeHold(std::uint64_t id, const Body &body, const JawPlaces &places,
                             const GraspSettings &settings);
/// Closes further, for a step of dt: evenly to the closed gap within kClosingTime, as long as the limit of the force is
/// not reached. The springs yield, so the jaws are led as far beyond as it takes until what they hold is there.
void closeFurther(Grasp &grasp, const GraspForces &forces, double dt);
constexpr double kClosingTime = 0.3;  ///< s, simulated

/// What is drawn of a jaw: a disc on the outer side of what it holds.
/// @param at     m, of the patch
/// @param axis   unit, away from the other jaw
[[nodiscard]] Surface discOf(const Vec3 &at, const Vec3 &axis, double diameter);

/// Unit, what is horizontal on the screen, to the right: from two places under the mouse in the plane through a point
/// that is parallel to the screen, and what lies between them on the screen. The two differ.
/// @param way       m, from the first to the second
/// @param right_px  likewise; y goes down
[[nodiscard]] Vec3 screenRight(const Vec3 &way, double right_px, double down_px, const Vec3 &view);

}  // namespace pointbased
