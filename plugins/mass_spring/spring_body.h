// SPDX-License-Identifier: Apache-2.0
// A body of masses and springs: its forces.
#pragma once

#include "point_body.h"

namespace mass_spring {

/// Springs join all corners of a cell; masses sit there.
class SpringBody : public PointBody {
 public:
  /// @param materials  one per cell of the lattice
  SpringBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials);

  void setMaterials(std::vector<Elasticity> materials) override;
  [[nodiscard]] double elasticEnergy_J() const override;
  [[nodiscard]] std::vector<double> stretches() const override;
  [[nodiscard]] Elements elements() const override { return {"springs", springs_.size()}; }

 private:
  struct Spring {
    std::uint32_t a = 0, b = 0;
    double length_m = 0.0, stiffness_N_m = 0.0, damping_Ns_m = 0.0;
  };

  void addInternalForces(double dt_s) override;

  std::vector<Spring> springs_;
};

}  // namespace mass_spring
