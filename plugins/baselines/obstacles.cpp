// SPDX-License-Identifier: Apache-2.0
#include "obstacles.h"

#include "scene_input.h"

namespace baselines {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

/// The host's tree about the surface at rest, m, and how it moves.
struct Rigid {
  sdk::Collision collision;
  sdk::CollisionTree tree;
  Vec3 low{}, high{};
  std::optional<Motion> motion;

  void wayOut(const Moment &moment, const std::vector<Vec3> &points, std::vector<Vec3> &out) const {
    // Where the obstacle is at rest; most points are nowhere near it.
    const double part = motion ? moment.of(motion->ramp_s) : 0.0;
    const mass_spring::Mat3 turn = mass_spring::rotationOf(part * (motion ? motion->rotation_rad : Vec3{}));
    const Vec3 centre = motion ? motion->centre_m : Vec3{},
               to = centre + part * (motion ? motion->displacement_m : Vec3{});
    std::vector<Vec3> near;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = points[i] - to;
      const Vec3 x = centre + d[0] * turn[0] + d[1] * turn[1] + d[2] * turn[2];
      bool isNear = true;
      for (std::size_t a = 0; a < 3; ++a) isNear = isNear && x[a] > low[a] && x[a] < high[a];
      if (!isNear) continue;
      near.push_back(x);
      which.push_back(i);
    }
    if (near.empty()) return;
    const std::array range{length(high - low)};
    std::vector<c3de_closest> found(near.size());
    sdk::orThrow(collision.closest(tree.handle(), near, range, found));
    for (std::size_t n = 0; n < near.size(); ++n)
      if (found[n].distance < 0.0) out[which[n]] += -found[n].distance * (turn * vectorOf(found[n].normal));
  }
};

}  // namespace

Obstacle makeObstacle(sdk::Host host, const c3de_sim_obstacle &in) {
  const sdk::Mesh mesh(host);
  const Placement placement = readPlacement(in.placement);
  const auto positions = sdk::orThrow(mesh.positions(in.mesh));
  const auto corners = sdk::orThrow(mesh.triangles(in.mesh));
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i < positions.size(); ++i)
    vertices.push_back(placement.linear * (kMetresPerMillimetre * vectorOf(positions[i])) + placement.position);
  for (std::size_t t = 0; t < corners.size(); ++t) triangles.push_back({corners[t][0], corners[t][1], corners[t][2]});
  auto rigid = std::make_shared<Rigid>(Rigid{sdk::Collision(host), {}, vertices.at(0), vertices.at(0), {}});
  for (const Vec3 &x : vertices)
    for (std::size_t a = 0; a < 3; ++a) {
      rigid->low[a] = std::min(rigid->low[a], x[a]);
      rigid->high[a] = std::max(rigid->high[a], x[a]);
    }
  rigid->tree =
      sdk::orThrow(rigid->collision.create(sdk::rows<double, 3>(vertices), sdk::rows<std::uint32_t, 3>(triangles)));
  if (in.motion != nullptr) rigid->motion = readMotion(in.motion, 0.5 * (rigid->low + rigid->high), 0);
  return [rigid](const Moment &moment, const std::vector<Vec3> &points, std::vector<Vec3> &out) {
    rigid->wayOut(moment, points, out);
  };
}

}  // namespace baselines
