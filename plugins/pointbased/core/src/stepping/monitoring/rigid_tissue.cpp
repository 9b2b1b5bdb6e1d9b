// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/rigid_tissue.h"

#include <algorithm>

#include "shape/occupancy_field.h"

namespace pointbased {
namespace {

// Fraction of the query range: planes farther away are not used. At most a third of the range is the travel of a point,
// and a fortieth the margin (findContacts).
constexpr double kPlane = 0.375;

// Whether soft tissue collides with the voxels of a fix.
bool isRigidTissue(const Fix &fix) {
  return std::holds_alternative<VoxelRegion>(fix.region) && !fix.prescribesMotion();
}

// Points that move with the fixes only.
class HeldPoints {
 public:
  explicit HeldPoints(const RestState &rest) : isHeld_(rest.phyxelCount(), 0) {
    for (const ConstrainedRegion &held : rest.conditions.held)
      for (const Index j : held.phyxels) isHeld_[j] = 1;
  }
  [[nodiscard]] bool hold(std::span<const Index> phyxels) const {
    return std::all_of(phyxels.begin(), phyxels.end(), [this](Index j) { return isHeld_[j] != 0; });
  }

 private:
  std::vector<std::uint8_t> isHeld_;
};

}  // namespace

std::vector<Obstacle> detail::rigidTissuesOf(const Body &body) {
  std::vector<Obstacle> out;
  const RestState &rest = body.rest();
  if (!rest.stencils.isLattice()) return out;
  const HeldPoints held(rest);
  for (const Fix &fix : rest.conditions.fixes) {
    if (!isRigidTissue(fix)) continue;
    Obstacle &tissue = out.emplace_back();
    tissue.name = "rigid tissue of " + body.name();
    tissue.closest = [region = fix.region](std::span<const Vec3> points, std::span<const double> ranges,
                                           std::span<SurfacePoint> answers) {
      for (std::size_t k = 0; k < points.size(); ++k) {
        answers[k].distance = signedDistance(region, points[k]);
        if (answers[k].distance <= kPlane * ranges[k]) answers[k].normal = borderNormal(region, points[k]);
      }
    };
    const Interpolation &points = rest.contact.binding;
    for (std::size_t p = 0; p < points.count(); ++p) {
      const bool isPart = held.hold(points.phyxels.row(p)) || contains(fix.region, rest.origin + points.positions[p]);
      tissue.isPart.push_back(isPart ? 1 : 0);
    }
  }
  return out;
}

double detail::depthInRigidTissue(const Body &body, std::vector<Vec3> &skin, const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  skin.resize(rest.surfels.count());
  if (skin.empty() || !rest.stencils.isLattice()) return 0.0;
  updateSurfels(rest.surfels, {}, rest.positions, body.state().displacements, skin, {}, parallelFor);
  const HeldPoints held(rest);
  double deepest = 0.0;
  for (const Fix &fix : rest.conditions.fixes) {
    if (!isRigidTissue(fix)) continue;
    const auto &voxels = std::get<VoxelRegion>(fix.region);
    const Vec3 shift = rest.origin + voxels.offset;
    for (std::size_t p = 0; p < skin.size(); ++p) {
      const Vec3 x = skin[p] + shift;
      // Quick rejection: most of a skin is far from the voxels.
      if ((x.array() < voxels.voxels->min().array()).any() || (x.array() > voxels.voxels->max().array()).any())
        continue;
      const double depth = -voxels.voxels->about(x);
      if (!(depth > deepest)) continue;
      const Interpolation at = rest.surfels.expanded(p, rest.positions);
      if (!held.hold(at.phyxels.row(0)) && !contains(fix.region, rest.origin + at.positions[0])) deepest = depth;
    }
  }
  return deepest;
}

}  // namespace pointbased
