// SPDX-License-Identifier: Apache-2.0
// Distances of measured points and landmarks to a body, and their derivatives. Private to the core.
#pragma once

#include <Eigen/Core>

#include "matching/load_estimate.h"
#include "matching/match_springs.h"
#include "matching/skin_distance.h"
#include "matching/warped_response.h"
#include "pointbased/surface_match.h"

namespace pointbased::detail {

enum class RobustLoss { huber, tukey };

/// Distances of a set of measurements to the body, their robust weights, and the springs that pull the body to them.
class MatchTerms {
 public:
  /// All spans must outlive the object.
  /// @param binding  of the vertices of the skin
  MatchTerms(const RestState &rest, const Interpolation &binding, std::span<const MatchPoint> points,
             std::span<const MatchLandmark> landmarks, const SurfaceMatchSettings &settings,
             const ParallelFor &parallelFor);

  /// Finds closest points at a state.
  void evaluate(std::span<const Vec3> displacements, const MatchMotion &motion);
  /// Median of the distances over that of a normal distribution of the noise, at least 1.
  [[nodiscard]] double spread() const;
  void weigh(RobustLoss loss, double scale);
  /// m, root mean square of the distances of points by their weights (of landmarks if there are no points).
  [[nodiscard]] double distance() const;
  /// Distances over those of the noise: the larger of the root mean squares of points and of landmarks.
  [[nodiscard]] double misfit() const;
  [[nodiscard]] bool sees() const;  ///< whether any measurement has a closest point

  /// Springs between the measurements and the points of the body that are closest now, across the surface.
  /// @param stiffness  N/m, of a point with the weight 1; a landmark has it in relation to its noise
  void springs(double stiffness, MatchSprings &out) const;
  /// Distances of points across the surface, and three components per landmark: residuals as `d`, weights and C.
  /// @param scale  of the noise
  void linearise(double scale, LinearMeasurements &out) const;
  /// Derivatives of the measurements with respect to amplitudes: rows as in linearise(), one column per response. Rows
  /// without a weight are zero.
  /// @param displacements  of the phyxels, by amplitude
  /// @param rotation       by which these are rotated
  [[nodiscard]] Eigen::MatrixXd observe(const ResponseMatrix &displacements, std::size_t responses,
                                        const Mat3 &rotation, const ParallelFor &parallelFor) const;
  [[nodiscard]] Eigen::Index rows() const {  ///< of linearise()
    return static_cast<Eigen::Index>(points_.size() + 3 * landmarks_.size());
  }
  [[nodiscard]] std::span<const ClosestSkinPoint> closest() const { return closest_; }
  [[nodiscard]] std::span<const double> weights() const { return weights_; }  ///< [points, landmarks]
  [[nodiscard]] double distanceOf(std::size_t i) const;                       ///< m; infinite: no part faces it
  /// Derivative of a position with respect to the motion, [3, 6], in the frame of the phyxels.
  [[nodiscard]] Eigen::Matrix<double, 3, 6> motionColumns(const Vec3 &x) const;
  /// The motion after a step of its six numbers.
  [[nodiscard]] MatchMotion moved(const MatchMotion &motion, const Eigen::Matrix<double, 6, 1> &step) const;

 private:
  [[nodiscard]] std::size_t count() const { return points_.size() + landmarks_.size(); }
  [[nodiscard]] double noiseOf(std::size_t i) const;
  const RestState &rest_;
  const Interpolation &binding_;
  std::span<const MatchPoint> points_;
  std::span<const MatchLandmark> landmarks_;
  const SurfaceMatchSettings &settings_;
  const ParallelFor &parallelFor_;
  Interpolation bound_;  // landmarks
  SkinDistance skin_;
  Vec3 centre_ = Vec3::Zero();  // of rotations, frame of the phyxels
  std::vector<Vec3> skinPositions_, landmarkPositions_;
  std::vector<ClosestSkinPoint> closest_;
  std::vector<Vec3> residuals_;  // [points, landmarks] m, measured minus body, frame of the phyxels
  std::vector<double> weights_;
};

}  // namespace pointbased::detail
