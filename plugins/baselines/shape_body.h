// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "point_body.h"

namespace baselines {

using namespace mass_spring;

/// Shape matching: each cluster draws its points to where its shape at rest, turned and carried along, would have them.
/// Clusters are cells with all cells around them, `reach` in every direction; they overlap and add up. A cluster draws
/// with k = E V / (Σ |r|²/3), V its share of the volume and r from its middle at rest: the energy of a stretched bar
/// with Poisson's ratio 0. In a step k is at most what brings a point to its goal, alpha = 1 of the paper; with larger
/// steps a body is as stiff as that.
/// @source  M. Müller, B. Heidelberger, M. Teschner, M. Gross, ACM Trans. Graph. 24 (2005), equations 5 to 9 and 4.3;
///          cells as clusters: A. Rivers, D. James, ACM Trans. Graph. 26 (2007)
class ShapeBody : public PointBody {
 public:
  /// @param linear  beta of the paper: 0, goals are rigid; towards 1, they are stretched and sheared with the cluster
  ShapeBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, int reach, double linear);

  void setMaterials(std::vector<Elasticity> materials) override;
  [[nodiscard]] double elasticEnergy_J() const override;
  [[nodiscard]] Elements elements() const override { return {"clusters", clusters_.size()}; }
  /// Steps of any length are stable.
  [[nodiscard]] double longestStep_s() const override { return 1.0; }

 private:
  struct Cluster {
    std::vector<std::uint32_t> nodes;
    Vec3 middle{};  ///< at rest
    double stiffness_N_m = 0.0;
    double cap_kg = 0.0;      ///< times 1/dt²: the largest stiffness in a step
    Eigen::Matrix3d inverse;  ///< of Σ r r^T, 1/m²
  };

  void addInternalForces(double dt_s) override;
  [[nodiscard]] double stiffnessOf(const Cluster &cluster) const;
  /// Calls each(node, from the point to its goal).
  template <class Each>
  void forGoals(const Cluster &cluster, const Each &each) const;

  double linear_ = 0.0, step_s_ = 0.0;
  std::vector<Cluster> clusters_;
  std::vector<std::vector<std::uint32_t>> cells_;  ///< of each cluster
};

}  // namespace baselines
