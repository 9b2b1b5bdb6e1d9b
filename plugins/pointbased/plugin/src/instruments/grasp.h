// SPDX-License-Identifier: Apache-2.0
// Two jaws that grasp a fold of tissue, independent of a host: how they locate skin, what they hold, how they close.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/surface.h"

namespace pointbased {

/// Dimensions of a pair of jaws.
struct GraspSettings {
  double jaw = 0.01;        ///< m, > 0: diameter of the patch that a jaw holds; at least two spacings are used
  double opening = 0.02;    ///< m, >= jaw: distance of the jaw centres before they close
  double closed = 0.01;     ///< m, 0 … opening: distance of the patch centres at which the jaws stop
  double forceLimit = 0.0;  ///< N, >= 0: closing also stops while the squeeze exceeds it; 0: no limit
  bool operator==(const GraspSettings &) const = default;
};
/// Which setting is not accepted, and what is. Empty if they are valid.
[[nodiscard]] std::string problemOf(const GraspSettings &settings);

/// A point on a skin.
struct SkinPoint {
  std::array<Index, 3> corners{};  ///< of its triangle: vertices of the skin
  Vec3 weights = Vec3::Zero();     ///< of the corners, sum 1

  /// Position of the point. @param positions  of the vertices, any type with three numbers
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

/// Positions of two jaws on a skin.
struct JawPositions {
  std::array<SkinPoint, 2> points;
  Vec3 axis = Vec3::UnitX();    ///< unit, along the skin, from the first jaw to the second
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the tissue
};
/// On either side of a point of the skin, half the opening away along it. Errors, as display text: the axis is
/// perpendicular to the skin, a jaw misses the body, the body is narrower than the opening.
/// @param normal  unit, outwards, at the point
/// @param axis    unit; only its component along the skin is used
[[nodiscard]] Result<JawPositions> findJaws(const Surface &skin, const Vec3 &at, const Vec3 &normal, const Vec3 &axis,
                                            const GraspSettings &settings);
/// Whether a body can be grasped in this way. Jaws that hold most of it, or the same phyxels, are refused. Empty if it
/// can be grasped.
[[nodiscard]] std::string problemOf(const RestState &rest, const JawPositions &jaws, const GraspSettings &settings);

/// Two jaws that hold a body. Each is pulled by one grab of the simulator; the two move as one.
struct Grasp {
  std::uint64_t body = 0;
  JawPositions jaws;
  GraspSettings settings;
  std::array<Grab, 2> grabs;         ///< targets: where they pull to now
  std::array<Vec3, 2> offsets;       ///< m, from the line between the jaws to the patches, at the start of the grasp
  Vec3 middle = Vec3::Zero();        ///< world, m; prescribed position between the jaws
  Mat3 rotation = Mat3::Identity();  ///< since the start of the grasp
  /// m, between the patches: at the start, the present target, and between the spring targets
  double initialGap = 0.0, targetGap = 0.0, commandedGap = 0.0;

  /// Unit, as the jaws are rotated now.
  [[nodiscard]] Vec3 axis() const { return rotation * jaws.axis; }
  /// Applies `middle`, `rotation` and `commandedGap` to the targets of the grabs.
  void updateTargets();
};

/// Forces of the jaws on the tissue.
struct GraspForces {
  Vec3 pull = Vec3::Zero();  ///< N, sum of both, on the body
  double squeeze = 0.0;      ///< N, half of the difference along the axis; above 0 they press towards each other
  double gap = 0.0;          ///< m, between the patches, along the axis
};
[[nodiscard]] GraspForces forcesOf(const Grasp &grasp, const std::array<GrabStatus, 2> &grabs);

/// Starts a grasp at the body's present position, without motion.
/// @param jaws  of findJaws(), surfels of this body
[[nodiscard]] Grasp beginGrasp(std::uint64_t id, const Body &body, const JawPositions &jaws,
                               const GraspSettings &settings);
/// Closes further, for a step of dt: at a constant rate to the closed gap within kClosingTime, while the force is below
/// its limit. The springs yield, so the pull targets are moved beyond that gap until the held tissue reaches it.
void advanceClosing(Grasp &grasp, const GraspForces &forces, double dt);
constexpr double kClosingTime = 0.3;  ///< s, simulated

/// The displayed shape of a jaw: a disc on the outer side of the patch it holds.
/// @param at     m, of the patch
/// @param axis   unit, away from the other jaw
[[nodiscard]] Surface discOf(const Vec3 &at, const Vec3 &axis, double diameter);

/// Unit vector that is horizontal on the screen, to the right. Computed from two different positions under the mouse,
/// in the plane through a point that is parallel to the screen, and their offset on the screen.
/// @param offset    m, from the first to the second
/// @param right_px  from the first to the second; y points down
[[nodiscard]] Vec3 screenRight(const Vec3 &offset, double right_px, double down_px, const Vec3 &view);

}  // namespace pointbased
