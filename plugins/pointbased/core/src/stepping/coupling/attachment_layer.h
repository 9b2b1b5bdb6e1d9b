// SPDX-License-Identifier: Apache-2.0
// Points of an attachment and their forces. Private to the core.
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
  /// @param second, obstacle  at most one of them is set; neither: the surroundings
  [[nodiscard]] static Result<AttachmentLayer> make(const Attachment &settings, const Body &first, const Body *second,
                                                    const Obstacle *obstacle);

  [[nodiscard]] const Attachment &settings() const { return settings_; }
  [[nodiscard]] bool joinsBodies() const { return second_.count() > 0; }
  /// m, largest distance of two joined points; for two bodies only.
  [[nodiscard]] double maxGap() const { return maxGap_; }

  /// Displacements of the phyxels of both sides. The second is empty if it is not a body; its pose is then that at
  /// `time`.
  struct AttachedState {
    std::span<const Vec3> first, second;
    double time = 0.0;
  };
  /// Motion of an obstacle on the other side; empty: it is static, or there is none.
  [[nodiscard]] const std::function<RigidMotion(double)> &motion() const { return motion_; }
  void setMotion(std::function<RigidMotion(double)> motion) { motion_ = std::move(motion); }
  /// Updates the normals to the present rotation of the first body, and the forces by which the layer resists this
  /// rotation. All functions below use both until the next call.
  /// @return  largest rotation since the last call, rad
  double updateNormals(const AttachedState &at);
  /// Stiffness from the rotation of the normals, |d| |∂n/∂u|, relative to that of the displacement alone: the largest
  /// value of all points at the last updateNormals(). Frequencies are at most that of squaredFrequencyBound() times one
  /// plus this value. 0: the layer is as stiff tangentially as along the normal.
  [[nodiscard]] double stiffening() const { return stiffening_; }
  /// Work of these forces along displacements of the first body, J; not part of energy().
  [[nodiscard]] double workOfRotationForces(std::span<const Vec3> first) const;
  [[nodiscard]] double energy(const AttachedState &at) const;  ///< J
  /// Adds its forces to the phyxels of both bodies, N; an empty span is skipped.
  void addForces(const AttachedState &at, std::span<Vec3> first, std::span<Vec3> second) const;
  /// Adds its Hessian times a change of the displacements; an empty span is skipped.
  void addProduct(const AttachedState &change, std::span<Vec3> first, std::span<Vec3> second) const;
  /// addBlocks() adds the diagonal blocks of the Hessian; addTriplets() all of it, starting at rows `first` and
  /// `second` (in phyxels). kNoRows: the body has no rows.
  void addBlocks(std::span<Mat3> first, std::span<Mat3> second) const;
  void addTriplets(std::size_t first, std::size_t second, std::vector<Eigen::Triplet<double>> &out) const;
  static constexpr std::size_t kNoRows = std::numeric_limits<std::size_t>::max();
  /// Upper bound of ω² of M^-1 K, 1/s²: the largest row sum of M^-1/2 K M^-1/2.
  /// @param first, second  [phyxels] 1/kg, 0 for those that do not move; `second` may be empty
  [[nodiscard]] double squaredFrequencyBound(std::span<const double> first, std::span<const double> second) const;

  /// Releases the points whose traction exceeds Attachment::tearsAt.
  /// @return  whether there were any
  bool tear(const AttachedState &at);
  /// Torn points, as [points] 0 or 1; empty: none.
  [[nodiscard]] const std::vector<std::uint8_t> &torn() const { return torn_; }
  /// @return  false: the size does not match this layer, nothing is changed
  bool setTorn(std::vector<std::uint8_t> torn);
  void resetTears() { torn_.clear(); }
  /// Saves the torn points before a step that may be undone.
  void saveTears() { savedTears_ = torn_; }
  void restoreTears() { torn_ = savedTears_; }

  /// The caller sets the id.
  [[nodiscard]] AttachmentSummary summary(const AttachedState &at) const;

 private:
  [[nodiscard]] bool isTorn(std::size_t p) const { return !torn_.empty() && torn_[p] != 0; }
  [[nodiscard]] Mat3 stiffnessOf(std::size_t p) const;  // Pa/m times m²
  [[nodiscard]] Vec3 timesStiffness(std::size_t p, const Vec3 &d) const;
  [[nodiscard]] Vec3 relativeDisplacement(std::size_t p, const AttachedState &at, const RigidMotion *motion) const;
  [[nodiscard]] std::optional<RigidMotion> motionAt(const AttachedState &at) const;
  template <class Visit>
  void forEntries(std::size_t p, const Visit &visit) const;

  Attachment settings_;
  Vec3 origin_ = Vec3::Zero();
  SurfacePoints points_;                       // of the first body, in the frame of its phyxels
  Interpolation first_, second_;               // of these points; the second is empty if it is not a body
  std::function<RigidMotion(double)> motion_;  // of a moving obstacle
  std::vector<Vec3> normals_;                  // with the present rotation
  std::vector<Vec3>
      rotationForces_;  // [phyxels of the first] N, from updateNormals(); empty: independent of the rotation
  std::vector<std::uint8_t> torn_, savedTears_;
  double area_ = 0.0, maxGap_ = 0.0, stiffening_ = 0.0;
};

/// A layer among the bodies of an island.
struct JoinedLayer {
  static constexpr std::size_t kNoBody = std::numeric_limits<std::size_t>::max();
  AttachmentLayer *layer = nullptr;
  std::size_t first = 0, second = kNoBody;  ///< indices of its bodies there; kNoBody: an obstacle, or the surroundings
};

}  // namespace pointbased::detail
