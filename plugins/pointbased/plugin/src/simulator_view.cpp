// SPDX-License-Identifier: Apache-2.0
#include "simulator_view.h"

#include <algorithm>

namespace pointbased {
namespace {

constexpr sdk::Material kOrgan{{0.66f, 0.27f, 0.22f, 1.0f}, false};
constexpr sdk::Material kOrganTransparent{{0.72f, 0.34f, 0.28f, 0.32f}, true};
constexpr sdk::Material kPhyxels{{0.95f, 0.78f, 0.42f, 1.0f}, false};
constexpr sdk::Material kObstacle{{0.55f, 0.60f, 0.66f, 1.0f}, false};
constexpr sdk::Material kBox{{0.45f, 0.52f, 0.62f, 1.0f}, false};
constexpr double kPhyxelRadius = 0.22;  // of the spacing: dense enough to read the shape, open enough to see through

sdk::Vec3 toArray(const Vec3 &v) { return {v[0], v[1], v[2]}; }

}  // namespace

SimulatorView::SimulatorView(const Services &services, WorldSimulator &simulator, c3de_handle node)
    : services_(services), simulator_(simulator), node_(node) {}

void SimulatorView::setStyle(SurfaceStyle style) {
  style_ = style;
  shown_ = 0;  // what was hidden has missed updates
  for (const auto &[id, view] : bodies_) applyStyle(view);
}

void SimulatorView::applyStyle(const BodyView &view) const {
  (void)services_.render.setMaterial(view.surface.handle(), style_ == SurfaceStyle::opaque ? kOrgan : kOrganTransparent);
  (void)services_.render.setVisible(view.surface.handle(), style_ != SurfaceStyle::phyxelsOnly);
  (void)services_.render.setVisible(view.phyxels.handle(), style_ != SurfaceStyle::opaque);
}

SimulatorView::BodyView SimulatorView::makeBody(const BodySnapshot &body) const {
  BodyView view;
  view.node = sdk::orThrow(services_.scene.addNode(node_, body.name));
  view.surface = sdk::orThrow(services_.render.createMesh(
      view.node.handle(), viewOf(body.surfels), sdk::rows<std::uint32_t, 3>(std::span(body.surface->triangles)), kOrgan));
  view.phyxels = sdk::orThrow(services_.render.createSpheres(view.node.handle(), viewOf(body.phyxels),
                                                             kPhyxelRadius * body.rest->spacing, kPhyxels));
  view.rest = body.rest.get();
  applyStyle(view);
  return view;
}

SimulatorView::ObstacleView SimulatorView::makeObstacle(const ObstacleSnapshot &obstacle) const {
  ObstacleView view;
  view.node = sdk::orThrow(services_.scene.addNode(node_, obstacle.name));
  view.mesh = sdk::orThrow(services_.render.createMesh(
      view.node.handle(), viewOf(obstacle.mesh->positions),
      sdk::rows<std::uint32_t, 3>(std::span(obstacle.mesh->triangles)), kObstacle));
  (void)services_.scene.setBounds(view.node.handle(), toArray(obstacle.mesh->min), toArray(obstacle.mesh->max));
  return view;
}

void SimulatorView::updateBox(const WorldBox &box) {
  if (box.enabled == shownBox_.enabled && box.min == shownBox_.min && box.max == shownBox_.max) return;
  shownBox_ = box;
  box_.reset();
  boxNode_.reset();
  if (!box.enabled) return;
  std::vector<Vec3> edges;
  const auto corner = [&](int bits) {
    return Vec3((bits & 1) ? box.max[0] : box.min[0], (bits & 2) ? box.max[1] : box.min[1],
                (bits & 4) ? box.max[2] : box.min[2]);
  };
  for (int a = 0; a < 8; ++a)
    for (const int bit : {1, 2, 4})
      if (!(a & bit)) {
        edges.push_back(corner(a));
        edges.push_back(corner(a | bit));
      }
  boxNode_ = sdk::orThrow(services_.scene.addNode(node_, "World box"));
  box_ = sdk::orThrow(services_.render.createLines(boxNode_.handle(), viewOf(edges), 1.5f, kBox));
}

void SimulatorView::update() {
  const std::shared_ptr<const Snapshot> snapshot = simulator_.snapshot();
  if (!snapshot || snapshot->generation == shown_) return;
  shown_ = snapshot->generation;

  // What is gone, or was built again under the same id.
  std::erase_if(bodies_, [&](const auto &entry) {
    const BodySnapshot *body = snapshot->body(entry.first);
    return !body || body->rest.get() != entry.second.rest;
  });
  std::erase_if(obstacles_, [&](const auto &entry) {
    return std::none_of(snapshot->obstacles.begin(), snapshot->obstacles.end(),
                        [&](const ObstacleSnapshot &o) { return o.id == entry.first; });
  });

  for (const ObstacleSnapshot &obstacle : snapshot->obstacles) {
    auto found = obstacles_.find(obstacle.id);
    if (found == obstacles_.end()) found = obstacles_.emplace(obstacle.id, makeObstacle(obstacle)).first;
    if (!obstacle.moves) continue;
    std::vector<Vec3> positions = obstacle.mesh->positions;
    for (Vec3 &x : positions) x += obstacle.motion.displacementOf(x);
    (void)services_.render.update(found->second.mesh.handle(), C3DE_ATTR_POSITIONS, viewOf(positions));
  }
  for (const BodySnapshot &body : snapshot->bodies) {
    auto found = bodies_.find(body.id);
    if (found == bodies_.end()) found = bodies_.emplace(body.id, makeBody(body)).first;
    const BodyView &view = found->second;
    if (style_ != SurfaceStyle::phyxelsOnly) {
      (void)services_.render.update(view.surface.handle(), C3DE_ATTR_POSITIONS, viewOf(body.surfels));
      (void)services_.render.update(view.surface.handle(), C3DE_ATTR_NORMALS, viewOf(body.normals));
    }
    if (style_ != SurfaceStyle::opaque)
      (void)services_.render.update(view.phyxels.handle(), C3DE_ATTR_POSITIONS, viewOf(body.phyxels));
    Vec3 min = Vec3::Constant(1e300), max = Vec3::Constant(-1e300);
    for (const Vec3 &x : body.surfels) {
      min = min.cwiseMin(x);
      max = max.cwiseMax(x);
    }
    if (!body.surfels.empty()) (void)services_.scene.setBounds(view.node.handle(), toArray(min), toArray(max));
  }
  updateBox(snapshot->box);
}

}  // namespace pointbased
