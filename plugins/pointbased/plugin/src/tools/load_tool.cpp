// SPDX-License-Identifier: Apache-2.0
#include "tools/load_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr sdk::Material kSelected{{1.0f, 0.62f, 0.10f, 1.0f}, true};
constexpr sdk::Material kSupport{{0.30f, 0.62f, 0.95f, 1.0f}, true};
constexpr sdk::Material kLoaded{{1.0f, 0.85f, 0.2f, 1.0f}, true};
constexpr double kLift = 2e-4;        // m, of a highlight above the surface
constexpr double kRadiusStep = 1.15;  // factor per notch of the wheel

Vec3 centroidOf(const BodySnapshot &body, const std::array<std::uint32_t, 3> &t) {
  return (vectorOf(body.surfels[t[0]]) + vectorOf(body.surfels[t[1]]) + vectorOf(body.surfels[t[2]])) / 3.0;
}

Vec3 normalOf(const std::vector<Vec3> &x, const std::array<std::uint32_t, 3> &t) {
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).normalized();
}

Vec3 presentNormalOf(const BodySnapshot &body, const std::array<std::uint32_t, 3> &t) {
  const Vec3 a = vectorOf(body.surfels[t[0]]);
  return (vectorOf(body.surfels[t[1]]) - a).cross(vectorOf(body.surfels[t[2]]) - a).normalized();
}

/// Moves points away from the surface, so that what is drawn there is seen.
std::vector<Vec3> lifted(std::vector<Vec3> points, const std::vector<std::array<std::uint32_t, 3>> &triangles) {
  std::vector<Vec3> normals(points.size(), Vec3::Zero());
  for (const auto &t : triangles) {
    const Vec3 n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (const std::uint32_t corner : t) normals[corner] += n;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (normals[i].squaredNorm() > 0.0) points[i] += kLift * normals[i].normalized();
  return points;
}

std::string valueText(const ConditionSnapshot &one) {
  switch (one.condition.kind) {
    case ConditionKind::fix: return one.condition.name;
    case ConditionKind::displace: return fixed(1e3 * one.condition.vector.norm(), 1) + " mm";
    case ConditionKind::force: return fixed(one.condition.vector.norm(), 2) + " N";
    case ConditionKind::pressure: return fixed(1e-3 * one.condition.pressure, 2) + " kPa";
  }
  return {};
}

}  // namespace

bool LoadTool::onEvent(const c3de_event &event) {
  if (!simulator_) return false;
  const auto resize = [this](double factor) { radius_mm = std::clamp(factor * radius_mm, kMinRadius, kMaxRadius); };
  if (event.type == C3DE_EVENT_PRESS && event.button == C3DE_BUTTON_LEFT) {
    isPainting_ = false;
    paint(event);
    return isPainting_;
  }
  if (event.type == C3DE_EVENT_MOVE && isPainting_) {
    if (mode == Mode::brush) paint(event);
    return true;
  }
  if (event.type == C3DE_EVENT_RELEASE && event.button == C3DE_BUTTON_LEFT && isPainting_) {
    isPainting_ = false;
    return true;
  }
  if (event.type == C3DE_EVENT_WHEEL && isPainting_ && mode == Mode::brush) {
    resize(std::pow(kRadiusStep, event.wheel));
    return true;
  }
  if (event.type == C3DE_EVENT_KEY && (event.key == '[' || event.key == ']')) {
    resize(event.key == ']' ? kRadiusStep : 1.0 / kRadiusStep);
    return true;
  }
  if (event.type == C3DE_EVENT_KEY && event.key == 'E') {
    isRemoving = !isRemoving;
    return true;
  }
  if (event.type == C3DE_EVENT_KEY && event.key == 27 && !selected_.empty()) {
    clear();
    return true;
  }
  return false;
}

void LoadTool::choose(const BodySnapshot &body) {
  if (body_ == body.id && surface_ == body.surface) return;
  clear();
  body_ = body.id;
  surface_ = body.surface;
}

void LoadTool::paint(const c3de_event &event) {
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return;
  if (sdk::isInSlice(event)) {
    const NearSkin near = Skins(services_, *snapshot).near(ray->origin);
    if (!near.body || (isPainting_ && near.body->id != body_)) return;
    choose(*near.body);
    isPainting_ = true;
    return paintAround(*near.body, ray->origin, std::nullopt);
  }
  const std::optional<PickedSurface> picked = pick(services_, *snapshot, *ray);
  // A stroke does not leave its body.
  if (!picked || !picked->body || (isPainting_ && picked->body->id != body_)) return;
  choose(*picked->body);
  isPainting_ = true;
  if (mode == Mode::face) return selectFace(picked->triangle);
  const Vec3 normal = presentNormalOf(*picked->body, surface_->triangles[picked->triangle]);
  paintAround(*picked->body, picked->at, normal);
  // A triangle larger than the brush is painted where it was hit.
  select(picked->triangle);
}

void LoadTool::select(std::uint32_t triangle) {
  if (isRemoving)
    selected_.erase(triangle);
  else
    selected_.insert(triangle);
  isChanged_ = true;
}

// In 3D only what faces the same side as the point under the mouse: not the other side of a thin part.
void LoadTool::paintAround(const BodySnapshot &body, const Vec3 &at, const std::optional<Vec3> &normal) {
  const double radius = 1e-3 * radius_mm;
  for (std::uint32_t t = 0; t < surface_->triangles.size(); ++t) {
    const auto &triangle = surface_->triangles[t];
    if ((centroidOf(body, triangle) - at).squaredNorm() > radius * radius) continue;
    if (normal && presentNormalOf(body, triangle).dot(*normal) <= 0.0) continue;
    select(t);
  }
}

void LoadTool::selectFace(std::uint32_t triangle) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> byEdge;
  const auto &all = surface_->triangles;
  const auto edgeOf = [&](std::uint32_t t, std::size_t k) { return std::minmax(all[t][k], all[t][(k + 1) % 3]); };
  for (std::uint32_t t = 0; t < all.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) byEdge[edgeOf(t, k)].push_back(t);
  const Vec3 normal = normalOf(surface_->positions, all[triangle]);
  const double least = std::cos(std::clamp(angle_deg, 0.0, 180.0) * std::numbers::pi / 180.0) - 1e-9;
  std::set<std::uint32_t> face{triangle};
  std::vector<std::uint32_t> next{triangle};
  while (!next.empty()) {
    const std::uint32_t t = next.back();
    next.pop_back();
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::uint32_t other : byEdge[edgeOf(t, k)])
        if (normalOf(surface_->positions, all[other]).dot(normal) >= least && face.insert(other).second)
          next.push_back(other);
  }
  for (const std::uint32_t t : face) select(t);
}

SurfacePatch LoadTool::patch(const Snapshot &snapshot) const {
  SurfacePatch out;
  const BodySnapshot *body = snapshot.body(body_);
  if (!body || body->surface != surface_) return out;
  std::map<std::uint32_t, std::uint32_t> corners;
  for (const std::uint32_t t : selected_) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = surface_->triangles[t][k];
      const auto [found, isNew] = corners.emplace(corner, static_cast<std::uint32_t>(corners.size()));
      if (isNew) out.positions.push_back(surface_->positions[corner]);
      triangle[k] = found->second;
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

void LoadTool::clear() {
  selected_.clear();
  body_ = 0;
  surface_.reset();
  highlight_.reset();
  isChanged_ = true;
}

void LoadTool::detach() {
  clear();
  shown_.clear();
  hidden.clear();
  isPainting_ = false;
}

void LoadTool::showSelection(const Snapshot *snapshot) {
  const BodySnapshot *body = snapshot ? snapshot->body(body_) : nullptr;
  if (!body || body->surface != surface_ || selected_.empty()) return highlight_.reset();
  std::map<std::uint32_t, std::uint32_t> corners;
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const std::uint32_t t : selected_) {
    std::array<std::uint32_t, 3> &triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = surface_->triangles[t][k];
      const auto [found, isNew] = corners.emplace(corner, static_cast<std::uint32_t>(corners.size()));
      if (isNew) points.push_back(vectorOf(body->surfels[corner]));
      triangle[k] = found->second;
    }
  }
  points = lifted(std::move(points), triangles);
  if (highlight_ && !isChanged_) {
    (void)services_.render.update(highlight_.handle(), C3DE_ATTR_POSITIONS, viewOf(std::span<const Vec3>(points)));
    return;
  }
  isChanged_ = false;
  highlight_.reset();
  if (auto made = services_.render.createMesh(simulator_->node(), viewOf(std::span<const Vec3>(points)),
                                              sdk::rows<std::uint32_t, 3>(std::span(triangles)), kSelected))
    highlight_ = std::move(*made);
}

void LoadTool::showCondition(const ConditionSnapshot &one, Shown &shown) {
  const SurfacePatch &patch = one.condition.patch;
  if (one.positions.size() != patch.positions.size()) return shown.reset();
  const std::vector<Vec3> points = lifted(one.positions, patch.triangles);
  const sdk::Material &material = one.condition.isSupport() ? kSupport : kLoaded;
  if (shown.patch && shown.triangles == patch.triangles.size()) {
    (void)services_.render.update(shown.patch.handle(), C3DE_ATTR_POSITIONS, viewOf(std::span<const Vec3>(points)));
  } else {
    shown.patch.reset();
    shown.triangles = patch.triangles.size();
    if (auto made = services_.render.createMesh(simulator_->node(), viewOf(std::span<const Vec3>(points)),
                                                sdk::rows<std::uint32_t, 3>(std::span(patch.triangles)), material))
      shown.patch = std::move(*made);
  }
  const Vec3 area = areaVectorOf({one.positions, patch.triangles});
  Vec3 middle = Vec3::Zero();
  for (const Vec3 &x : one.positions) middle += x / static_cast<double>(one.positions.size());
  Vec3 direction = one.condition.vector;
  if (one.condition.kind == ConditionKind::pressure) direction = -one.condition.pressure * area;
  Vec3 tip = middle;
  if (one.condition.kind == ConditionKind::displace) {
    showArrow(shown.arrow, middle, direction);
    tip = middle + direction;
  } else {
    tip = showArrow(shown.arrow, middle, direction, direction.norm());
  }
  showLabel(shown.label, tip, valueText(one), kForce);
}

void LoadTool::update() {
  history_.update();
  if (!simulator_ || !services_.render) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  showSelection(snapshot.get());
  std::set<std::uint64_t> present;
  if (snapshot)
    for (const ConditionSnapshot &one : snapshot->conditions) {
      if (hidden.contains(one.number)) continue;
      present.insert(one.number);
      showCondition(one, shown_[one.number]);
    }
  std::erase_if(shown_, [&](const auto &entry) { return !present.contains(entry.first); });
}

}  // namespace pointbased
