// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "point_body.h"

namespace baselines {

using namespace mass_spring;
using Mat3d = Eigen::Matrix3d;

/// Finite elements: linear tetrahedra, five per cell of the lattice, in turn mirrored so that faces meet. A cell that
/// the surface cuts has the stiffness and mass of its part inside.
/// @source  O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 1, ch. 6; corotated: M. Müller, M. Gross,
///          Graphics Interface 2004
class TetraBody : public PointBody {
 public:
  enum class Law { neoHookean, stVenantKirchhoff, corotated, linear };

  TetraBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, Law law);

  void setMaterials(std::vector<Elasticity> materials) override;
  [[nodiscard]] double elasticEnergy_J() const override;
  [[nodiscard]] Elements elements() const override { return {"tetrahedra", tetrahedra_.size()}; }
  [[nodiscard]] std::string trouble() const override;

 private:
  struct Tetrahedron {
    std::array<std::uint32_t, 4> nodes{};
    Mat3d inverse;           ///< of the edges at rest, 1/m
    double volume_m3 = 0.0;  ///< of it that is filled
    double lambda = 0.0, mu = 0.0;
  };

  void addInternalForces(double dt_s) override;
  [[nodiscard]] Mat3d gradient(const Tetrahedron &t) const;

  Law law_;
  std::vector<Tetrahedron> tetrahedra_;
};

/// The rotation nearest to F: polar decomposition, of a mirrored F without the mirror.
[[nodiscard]] Mat3d rotationOf(const Mat3d &F);

}  // namespace baselines
