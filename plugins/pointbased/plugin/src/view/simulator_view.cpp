// SPDX-License-Identifier: Apache-2.0
#include "view/simulator_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pointbased {
namespace {

/// Distinguishable with every type of colour vision.
/// @source  Okabe and Ito, Color Universal Design, 2008; the first one darkened to that of an organ
constexpr std::array<std::array<float, 3>, 8> kBodies{{{0.66f, 0.27f, 0.22f},
                                                       {0.34f, 0.71f, 0.91f},
                                                       {0.94f, 0.89f, 0.26f},
                                                       {0.00f, 0.62f, 0.45f},
                                                       {0.80f, 0.47f, 0.65f},
                                                       {0.00f, 0.45f, 0.70f},
                                                       {0.90f, 0.62f, 0.00f},
                                                       {0.86f, 0.86f, 0.86f}}};
constexpr float kTransparent = 0.32f;
constexpr sdk::Material kPoints{{0.95f, 0.78f, 0.42f, 1.0f}, false};
constexpr sdk::Material kObstacle{{0.55f, 0.60f, 0.66f, 1.0f}, false};
constexpr sdk::Material kInstrument{{0.45f, 0.75f, 0.95f, 1.0f}, false};
constexpr sdk::Material kJaw{{0.93f, 0.93f, 0.96f, 1.0f}, false};
constexpr sdk::Material kBox{{0.45f, 0.52f, 0.62f, 1.0f}, false};
constexpr sdk::Material kFloor{{0.24f, 0.28f, 0.33f, 1.0f}, false};  // one-sided: transparent from below
constexpr sdk::Material kFloorGrid{{0.36f, 0.42f, 0.49f, 1.0f}, false};
constexpr float kArmWidth = 4.0f;      // px
constexpr double kPointRadius = 0.22;  // of the spacing: dense enough to show the shape, open enough to see through
constexpr double kMinRadius = 0.06;    // of the spacing: a point of a cell that is almost empty remains visible

c3de_view coloursView(std::span<const Rgba8> colours) { return {colours.data(), colours.size(), 4, C3DE_U8, 0}; }

/// The colour of its label. Otherwise by its index among the bodies without one; from the ninth on, colours repeat.
sdk::Material materialOf(const Snapshot *snapshot, const BodySnapshot &body, bool isOpaque) {
  std::size_t number = 0;
  if (snapshot)
    for (const BodySnapshot &other : snapshot->bodies) number += other.id < body.id && !other.colour ? 1u : 0u;
  const std::array<float, 3> c = body.colour.value_or(kBodies[number % kBodies.size()]);
  return {{c[0], c[1], c[2], isOpaque ? 1.0f : kTransparent}, !isOpaque};
}

/// Radii proportional to the cube root of the represented volume; equal for all phyxels.
std::vector<double> radiiOf(const RestState &rest, PointsShown points) {
  if (points == PointsShown::phyxels) return std::vector<double>(rest.phyxelCount(), kPointRadius * rest.spacing);
  std::vector<double> radii;
  for (const double volume : rest.stencils.volumes)
    radii.push_back(std::max(kPointRadius * std::cbrt(volume), kMinRadius * rest.spacing));
  return radii;
}

}  // namespace

SimulatorView::SimulatorView(const Services &services, WorldSimulator &simulator, c3de_handle node)
    : services_(services), simulator_(simulator), node_(node) {}

SimulatorView::BodyView SimulatorView::makeBody(const BodySnapshot &body) const {
  BodyView view;
  view.node = sdk::orThrow(services_.scene.addNode(node_, body.name));
  view.surface = sdk::orThrow(services_.render.createMesh(
      view.node.handle(), viewOf(body.surfels), sdk::rows<std::uint32_t, 3>(std::span(body.surface->triangles)),
      materialOf(nullptr, body, true)));
  view.rest = body.rest.get();
  return view;
}

void SimulatorView::updateBody(BodyView &view, const BodySnapshot &body, const ViewSettings &settings) const {
  const c3de_handle surface = view.surface.handle();
  (void)services_.render.setVisible(surface, settings.surface != SurfaceShown::hidden);
  if (settings.surface != SurfaceShown::hidden) {
    const auto snapshot = simulator_.snapshot();
    (void)services_.render.setMaterial(surface,
                                       materialOf(snapshot.get(), body, settings.surface == SurfaceShown::opaque));
    if (!view.changes || *view.changes != body.changes) {
      (void)services_.render.update(surface, C3DE_ATTR_POSITIONS, viewOf(body.surfels));
      (void)services_.render.update(surface, C3DE_ATTR_NORMALS, viewOf(body.normals));
      view.changes = body.changes;
    }
    const bool coloured = body.surfelColours.size() == body.surfels.size();
    if (coloured != view.surfaceColoured || (coloured && view.colours != body.colours))
      (void)services_.render.update(surface, C3DE_ATTR_COLOURS,
                                    coloured ? coloursView(body.surfelColours) : coloursView({}));
    view.surfaceColoured = coloured;
    view.colours = body.colours;
  }
  updatePoints(view, body, settings);
}

void SimulatorView::updatePoints(BodyView &view, const BodySnapshot &body, const ViewSettings &settings) const {
  if (body.points.empty()) {
    view.points.reset();
    view.pointCount = 0;
    return;
  }
  const bool coloured = body.pointColours.size() == body.points.size();
  // Recreated if the shown points change or the colours are removed; otherwise only moved.
  if (view.pointCount != body.points.size() || view.pointsShown != settings.points || view.pointsColoured != coloured) {
    auto made = services_.render.createSpheres(view.node.handle(), viewOf(body.points),
                                               kPointRadius * body.rest->spacing, kPoints);
    if (!made) return;
    view.points = std::move(*made);
    view.pointCount = body.points.size();
    view.pointsShown = settings.points;
    view.pointsColoured = coloured;
    const std::vector<double> radii = radiiOf(*body.rest, settings.points);
    (void)services_.render.update(view.points.handle(), C3DE_ATTR_RADII, sdk::scalars(std::span<const double>(radii)));
  } else {
    (void)services_.render.update(view.points.handle(), C3DE_ATTR_POSITIONS, viewOf(body.points));
  }
  if (coloured) (void)services_.render.update(view.points.handle(), C3DE_ATTR_COLOURS, coloursView(body.pointColours));
}

void SimulatorView::updateLegend(const Snapshot &snapshot) {
  if (!snapshot.colours) {
    legend_.reset();
    return;
  }
  if (!services_.render.hasLegends()) return;
  const ColourScale &scale = *snapshot.colours;
  const sdk::Legend legend{scale.title, scale.unit, scale.note, scale.low, scale.high, coloursView(colourMap())};
  if (legend_) {
    (void)services_.render.setLegend(legend_.handle(), legend);
  } else if (auto made = services_.render.createLegend(node_, legend)) {
    legend_ = std::move(*made);
  }
}

SimulatorView::ObstacleView SimulatorView::makeObstacle(const ObstacleSnapshot &obstacle) const {
  ObstacleView view;
  view.node = sdk::orThrow(services_.scene.addNode(node_, obstacle.name));
  view.mesh = sdk::orThrow(services_.render.createMesh(view.node.handle(), viewOf(obstacle.mesh->positions),
                                                       sdk::rows<std::uint32_t, 3>(std::span(obstacle.mesh->triangles)),
                                                       obstacle.isInstrument ? kInstrument : kObstacle));
  (void)services_.scene.setBounds(view.node.handle(), toArray(obstacle.mesh->min), toArray(obstacle.mesh->max));
  return view;
}

// Discs on the held patches, and the arms of a forceps.
void SimulatorView::updateJaws(const Snapshot &snapshot) {
  std::erase_if(jaws_, [&](const auto &entry) {
    return std::none_of(snapshot.grasps.begin(), snapshot.grasps.end(),
                        [&](const GraspSnapshot &g) { return g.id == entry.first; });
  });
  for (const GraspSnapshot &grasp : snapshot.grasps) {
    const BodySnapshot *body = snapshot.body(grasp.body);
    if (!body) continue;
    JawView &view = jaws_[grasp.id];
    if (!view.node) view.node = sdk::orThrow(services_.scene.addNode(node_, grasp.name.empty() ? "Jaws" : grasp.name));
    std::array<Vec3, 2> at;
    for (std::size_t k = 0; k < 2; ++k) at[k] = grasp.points[k].at(body->surfels);
    const Vec3 hinge = grasp.hinge(*body);
    std::vector<Vec3> arms;
    for (std::size_t k = 0; k < 2; ++k) {
      const Surface disc = discOf(at[k], k == 0 ? Vec3(-grasp.axis) : grasp.axis, grasp.settings.jaw);
      if (view.discs[k])
        (void)services_.render.update(view.discs[k].handle(), C3DE_ATTR_POSITIONS, viewOf(disc.positions));
      else
        view.discs[k] = sdk::orThrow(services_.render.createMesh(
            view.node.handle(), viewOf(disc.positions), sdk::rows<std::uint32_t, 3>(std::span(disc.triangles)), kJaw));
      arms.insert(arms.end(), {Vec3(at[k] + 0.5 * grasp.settings.jaw * grasp.normal), hinge});
    }
    if (view.arms)
      (void)services_.render.update(view.arms.handle(), C3DE_ATTR_POSITIONS, viewOf(arms));
    else
      view.arms = sdk::orThrow(services_.render.createLines(view.node.handle(), viewOf(arms), kArmWidth, kJaw));
  }
}

void SimulatorView::updateBox(const WorldBox &box, const Vec3 &gravity) {
  if (box.enabled == shownBox_.enabled && box.min == shownBox_.min && box.max == shownBox_.max &&
      gravity == shownGravity_)
    return;
  shownBox_ = box;
  shownGravity_ = gravity;
  box_.reset();
  floor_.reset();
  floorGrid_.reset();
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
  if (gravity != Vec3::Zero()) drawFloor(box, gravity);
}

// The wall on which bodies come to rest, with lines at round distances.
void SimulatorView::drawFloor(const WorldBox &box, const Vec3 &gravity) {
  Eigen::Index down = 0;
  gravity.cwiseAbs().maxCoeff(&down);
  const Eigen::Index u = (down + 1) % 3, v = (down + 2) % 3;
  const bool isLow = gravity[down] < 0.0;
  const Vec3 extent = box.max - box.min;
  const auto at = [&](double along, double across, double above) {
    Vec3 p;
    p[u] = along;
    p[v] = across;
    p[down] = isLow ? box.min[down] + above : box.max[down] - above;
    return p;
  };
  std::vector<Vec3> corners{at(box.min[u], box.min[v], 0.0), at(box.max[u], box.min[v], 0.0),
                            at(box.max[u], box.max[v], 0.0), at(box.min[u], box.max[v], 0.0)};
  if (!isLow) std::reverse(corners.begin(), corners.end());
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  floor_ = sdk::orThrow(services_.render.createMesh(boxNode_.handle(), viewOf(corners),
                                                    sdk::rows<std::uint32_t, 3>(std::span(triangles)), kFloor));
  // 1, 2 or 5 times a power of ten.
  const double wanted = std::max(extent[u], extent[v]) / 16.0, ten = std::pow(10.0, std::floor(std::log10(wanted)));
  const double step = wanted <= ten         ? ten
                      : wanted <= 2.0 * ten ? 2.0 * ten
                      : wanted <= 5.0 * ten ? 5.0 * ten
                                            : 10.0 * ten;
  const double above = 1e-3 * step;
  std::vector<Vec3> lines;
  for (double x = std::ceil(box.min[u] / step) * step; x <= box.max[u]; x += step)
    lines.insert(lines.end(), {at(x, box.min[v], above), at(x, box.max[v], above)});
  for (double y = std::ceil(box.min[v] / step) * step; y <= box.max[v]; y += step)
    lines.insert(lines.end(), {at(box.min[u], y, above), at(box.max[u], y, above)});
  if (!lines.empty())
    floorGrid_ = sdk::orThrow(services_.render.createLines(boxNode_.handle(), viewOf(lines), 1.0f, kFloorGrid));
}

void SimulatorView::update() {
  const std::shared_ptr<const Snapshot> snapshot = simulator_.snapshot();
  if (!snapshot || snapshot->generation == shown_) return;
  shown_ = snapshot->generation;

  // Removed bodies, and those rebuilt under the same id.
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
    const Vec3 &rest = obstacle.mesh->min;
    if (found->second.turned == obstacle.motion.rotation && found->second.moved == obstacle.motion.displacementOf(rest))
      continue;
    found->second.turned = obstacle.motion.rotation;
    found->second.moved = obstacle.motion.displacementOf(rest);
    std::vector<Vec3> positions = obstacle.mesh->positions;
    for (Vec3 &x : positions) x += obstacle.motion.displacementOf(x);
    (void)services_.render.update(found->second.mesh.handle(), C3DE_ATTR_POSITIONS, viewOf(positions));
  }
  for (const BodySnapshot &body : snapshot->bodies) {
    auto found = bodies_.find(body.id);
    if (found == bodies_.end()) found = bodies_.emplace(body.id, makeBody(body)).first;
    const bool moved = found->second.changes != body.changes;
    updateBody(found->second, body, snapshot->view);
    if (!moved) continue;
    Vec3f low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-low[0]);
    for (const Vec3f &x : body.surfels)
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], x[a]);
        high[a] = std::max(high[a], x[a]);
      }
    const Vec3 min(low[0], low[1], low[2]), max(high[0], high[1], high[2]);
    if (!body.surfels.empty()) (void)services_.scene.setBounds(found->second.node.handle(), toArray(min), toArray(max));
  }
  updateJaws(*snapshot);
  updateBox(snapshot->box, snapshot->gravity);
  updateLegend(*snapshot);
  // While it plays, a newer snapshot follows automatically.
  if (snapshot->areColoursOutdated && services_.simulation)
    if (const auto state = services_.simulation.state(node_); state && state->mode != C3DE_SIM_PLAYING)
      (void)services_.simulation.post(node_, [] {});
}

}  // namespace pointbased
