// SPDX-License-Identifier: Apache-2.0
#include "stepping/rigid_tissue.h"

namespace pointbased {
namespace {

// Of the range that is asked for: planes farther away are not used, since a third of it is the way of a point at most
// and a fortieth the margin (findContacts).
constexpr double kPlane = 0.375;

}  // namespace

std::vector<Obstacle> detail::rigidTissuesOf(const Body &body) {
  std::vector<Obstacle> out;
  const RestState &rest = body.rest();
  if (!rest.stencils.isLattice()) return out;
  for (const Fix &fix : rest.conditions.fixes) {
    if (!std::holds_alternative<VoxelRegion>(fix.region) || fix.leads()) continue;
    Obstacle &tissue = out.emplace_back();
    tissue.name = "rigid tissue of " + body.name();
    tissue.closest = [region = fix.region](std::span<const Vec3> points, std::span<const double> ranges,
                                           std::span<SurfacePoint> answers) {
      for (std::size_t k = 0; k < points.size(); ++k) {
        answers[k].distance = signedDistance(region, points[k]);
        if (answers[k].distance <= kPlane * ranges[k]) answers[k].normal = borderNormal(region, points[k]);
      }
    };
    for (const Vec3 &X : rest.contact.binding.positions)
      tissue.isPart.push_back(contains(fix.region, rest.origin + X) ? 1 : 0);
  }
  return out;
}

}  // namespace pointbased
