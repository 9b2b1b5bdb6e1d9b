// SPDX-License-Identifier: Apache-2.0
// The points of an attachment, and what they do. Private to the core.
#pragma once

#include <Eigen/SparseCore>
#include <optional>

#include "pointbased/attachment.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// @threads one
class AttachmentLayer {
 public:
  /// Errors: settings that validate() refuses; a body without a surface; no point of it is in the region and near
  /// enough.
  /// @param second, obstacle  one of them, or neither: the surroundings
  [[nodiscard]] static Result<AttachmentLayer> make(const Attachment &settings, const Body &first, const Body *second,
                                                    const Obstacle *obstacle);

  [[nodiscard]] const Attachment &settings() const { return settings_; }
  [[nodiscard]] bool joinsBodies() const { return second_.count() > 0; }
  /// m, the widest gap that it spans; of two bodies only.
  [[nodiscard]] double widest() const { return widest_; }

  /// Displacements of the phyxels of both; the second is empty where it is no body, and stands where it is at `time`.
  struct Sides {
    std::span<const Vec3> first, second;
    double time = 0.0;
  };
  /// Of an obstacle at the other side; empty: it stands still, or there is none.
  [[nodiscard]] const std::function<RigidMotion(double)> &motion() const { return motion_; }
  void setMotion(std::function<RigidMotion(double)> motion) { motion_ = std::move(motion); }
  /// Normals as the first body has turned by now, and the forces by which it resists turning them: all below is with
  /// both until the next call. @return by how much at most, rad
  double turn(const Sides &at);
  /// How much |d| |∂n/∂u| adds to what the way alone changes by, largest of all points at the last turn(): no frequency
  /// is above that of squaredFrequencyBound() times one more than this. 0: as stiff across as along the normal.
  [[nodiscard]] double stiffening() const { return stiffening_; }
  /// Of these forces along displacements of the first body, J; energy() leaves it out.
  [[nodiscard]] double workOfTurning(std::span<const Vec3> first) const;
  [[nodiscard]] double energy(const Sides &at) const;  ///< J
  /// Adds its forces to the phyxels of both, N; an empty span is left out.
  void addForces(const Sides &at, std::span<Vec3> first, std::span<Vec3> second) const;
  /// Adds its Hessian times a change of the displacements, likewise.
  void addProduct(const Sides &change, std::span<Vec3> first, std::span<Vec3> second) const;
  /// Adds the diagonal blocks of the Hessian; and all of it, from the rows `first` and `second` (in phyxels) on.
  /// kStands: that body has none.
  void addBlocks(std::span<Mat3> first, std::span<Mat3> second) const;
  void addTriplets(std::size_t first, std::size_t second, std::vector<Eigen::Triplet<double>> &out) const;
  static constexpr std::size_t kStands = std::numeric_limits<std::size_t>::max();
  /// ω² of M^-1 K is at most this, 1/s²: the largest row sum of M^-1/2 K M^-1/2.
  /// @param first, second  [phyxels] 1/kg, 0 for those that do not move; `second` may be empty
  [[nodiscard]] double squaredFrequencyBound(std::span<const double> first, std::span<const double> second) const;

  /// Points that pull with too much are free from now on. @return whether there were any
  bool tear(const Sides &at);
  /// Which points have torn, as [points] 0 or 1; empty: none.
  [[nodiscard]] const std::vector<std::uint8_t> &torn() const { return torn_; }
  /// @return false: not of this layer, nothing is changed
  bool setTorn(std::vector<std::uint8_t> torn);
  void mend() { torn_.clear(); }
  /// Before a step that may be undone.
  void keep() { kept_ = torn_; }
  void goBack() { torn_ = kept_; }

  /// Its id is left to who keeps it.
  [[nodiscard]] AttachmentSummary summary(const Sides &at) const;

 private:
  [[nodiscard]] bool isTorn(std::size_t p) const { return !torn_.empty() && torn_[p] != 0; }
  [[nodiscard]] Mat3 stiffnessOf(std::size_t p) const;  // Pa/m times m²
  [[nodiscard]] Vec3 timesStiffness(std::size_t p, const Vec3 &d) const;
  [[nodiscard]] Vec3 wayOf(std::size_t p, const Sides &at, const RigidMotion *motion) const;
  [[nodiscard]] std::optional<RigidMotion> motionAt(const Sides &at) const;
  template <class Visit>
  void forEntries(std::size_t p, const Visit &visit) const;

  Attachment settings_;
  Vec3 origin_ = Vec3::Zero();
  SurfacePoints points_;                       // of the first body, in the frame of its phyxels
  Interpolation first_, second_;               // of these points; the second is empty where it is no body
  std::function<RigidMotion(double)> motion_;  // of an obstacle that moves
  std::vector<Vec3> normals_;                  // as they have turned
  std::vector<Vec3> turning_;                  // [phyxels of the first] N, of turn(); empty: it does not depend on them
  std::vector<std::uint8_t> torn_, kept_;
  double area_ = 0.0, widest_ = 0.0, stiffening_ = 0.0;
};

/// A layer among the bodies of a group.
struct JoinedLayer {
  static constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
  AttachmentLayer *layer = nullptr;
  std::size_t first = 0, second = kNobody;  ///< numbers of its bodies there; kNobody: an obstacle, or the surroundings
};

}  // namespace pointbased::detail
