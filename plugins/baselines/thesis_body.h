// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_body.h"
#include "reference/body.h"

namespace baselines {

using namespace mass_spring;

/// The method of the thesis as its formulas are printed (or corrected), in plain loops: phyxels in the middles of those
/// cells that lie in the body with theirs, the N nearest as neighbours, masses and volumes from densities. Material
/// points follow the nearest 16 phyxels as its surfels do. A support holds the phyxels whose cells its region meets.
/// @source  Bremm, UFSC 2012; plugins/baselines/reference
class ThesisBody : public PointBody {
 public:
  /// @throws sdk::Error  too few phyxels; materials that differ
  ThesisBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, std::size_t neighbours,
             const reference::Errata &errata);

  void setMaterials(std::vector<Elasticity> materials) override;
  [[nodiscard]] double elasticEnergy_J() const override { return reference::elasticEnergy(body_); }
  [[nodiscard]] Elements elements() const override { return {"phyxels", points().size()}; }
  [[nodiscard]] Bound bind(const Vec3 &point, double *off) const override;
  [[nodiscard]] bool isHeldBy(const c3de_sim_region &region, std::uint32_t point) const override;

 private:
  void addInternalForces(double dt_s) override;
  [[nodiscard]] bool movesByOldVelocity() const override { return body_.errata.forwardEuler; }

  reference::Body body_;
  reference::Neighborhoods neighborhoods_;
  double volume_m3_ = 0.0;
};

}  // namespace baselines
