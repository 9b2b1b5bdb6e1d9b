// SPDX-License-Identifier: Apache-2.0
#include "tools/condition_marks.h"

#include <algorithm>
#include <cmath>

#include "tools/drawn_marks.h"

namespace pointbased {
namespace {

constexpr sdk::Material kSupport{{0.30f, 0.62f, 0.95f, 1.0f}, true};
constexpr sdk::Material kLoaded{{1.0f, 0.85f, 0.2f, 1.0f}, true};
constexpr sdk::Material kChosen{{0.80f, 0.47f, 0.90f, 1.0f}, true};
constexpr sdk::Material kArrow{{1.0f, 0.85f, 0.2f, 1.0f}, false, true};
constexpr sdk::Material kHandle{{1.0f, 0.85f, 0.2f, 1.0f}, false, true};
constexpr sdk::Material kHovered{{1.0f, 1.0f, 1.0f, 1.0f}, false, true};
constexpr sdk::Material kChosenHandle{{0.80f, 0.47f, 0.90f, 1.0f}, false, true};

constexpr double kLift = 2e-4;  // m, of a highlight above the surface
// Of the size of the body:
constexpr double kArrowLength = 0.28, kShortest = 0.06, kLongest = 0.7;  // of the longest arrow of a load
constexpr double kHandleRadius = 0.014, kHandleReach = 0.026;

}  // namespace

std::vector<Vec3> liftedFrom(std::vector<Vec3> points, const std::vector<std::array<std::uint32_t, 3>> &triangles) {
  std::vector<Vec3> normals(points.size(), Vec3::Zero());
  for (const auto &t : triangles) {
    const Vec3 n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (const std::uint32_t corner : t) normals[corner] += n;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (normals[i].squaredNorm() > 0.0) points[i] += kLift * normals[i].normalized();
  return points;
}

double ConditionMarks::sizeOf(const Snapshot &snapshot, std::uint64_t body) {
  const BodySnapshot *found = snapshot.body(body);
  return found ? (found->surface->max - found->surface->min).norm() : 0.1;
}

// It changes only when the arrows have become too long or too short: a dragged tip remains where it was released.
void ConditionMarks::chooseScale(const Snapshot &snapshot) {
  double longest = 0.0, size = 0.0;
  for (const ConditionSnapshot &one : snapshot.conditions) {
    const double force = forceOf(one);
    if (!(force > longest)) continue;
    longest = force;
    size = sizeOf(snapshot, one.body);
  }
  if (!(longest > 0.0)) return;
  const double length = metresPerNewton_ * longest;
  if (length < kShortest * size || length > kLongest * size) metresPerNewton_ = kArrowLength * size / longest;
}

void ConditionMarks::update(const Frame &frame) {
  if (!frame.snapshot) return shown_.clear();
  if (frame.dragged == 0) chooseScale(*frame.snapshot);
  std::set<std::uint64_t> present;
  for (const ConditionSnapshot &one : frame.snapshot->conditions) {
    present.insert(one.number);
    Shown &shown = shown_[one.number];
    if (makeNode(frame, one, shown)) show(frame, one, shown);
  }
  std::erase_if(shown_, [&](const auto &entry) { return !present.contains(entry.first); });
  if (!present.contains(chosen)) chosen = 0;
  if (!present.contains(hovered)) hovered = 0;
}

// A node is removed with that of its body, for example when the body is rebuilt.
bool ConditionMarks::makeNode(const Frame &frame, const ConditionSnapshot &one, Shown &shown) {
  if (!services_.scene) return false;
  const auto bodyNode = frame.view ? frame.view->nodeOf(one.body) : std::nullopt;
  const c3de_handle parent = bodyNode.value_or(frame.node);
  if (shown.node && shown.parent.v == parent.v) {
    const auto isParentVisible = services_.scene.isVisible(parent);
    if (const auto isVisible = services_.scene.isVisible(shown.node.handle()); isVisible && isParentVisible) {
      shown.isVisible = *isVisible;
      // Below a hidden node nothing is visible, whatever its own checkbox is.
      if (*isParentVisible && *isVisible) hidden_.erase(one.number);
      if (*isParentVisible && !*isVisible) hidden_.insert(one.number);
      return true;
    }
  }
  shown.reset();
  auto made = services_.scene.addNode(parent, one.condition.name);
  if (!made) return false;
  shown.node = std::move(*made);
  shown.parent = parent;
  if (hidden_.contains(one.number)) (void)services_.scene.setVisible(shown.node.handle(), false);
  return true;
}

void ConditionMarks::setShown(std::uint64_t number, bool isShown) {
  if (isShown)
    hidden_.erase(number);
  else
    hidden_.insert(number);
  if (const auto found = shown_.find(number); found != shown_.end() && found->second.node)
    (void)services_.scene.setVisible(found->second.node.handle(), isShown);
}

void ConditionMarks::showPatch(const ConditionSnapshot &one, Shown &shown) {
  const SurfacePatch &patch = one.condition.patch;
  const std::vector<Vec3> points = liftedFrom(one.positions, patch.triangles);
  const sdk::Material &material = chosen == one.number ? kChosen : one.condition.isSupport() ? kSupport : kLoaded;
  if (shown.patch && shown.triangles == patch.triangles.size()) {
    (void)services_.render.update(shown.patch.handle(), C3DE_ATTR_POSITIONS, viewOf(std::span<const Vec3>(points)));
    (void)services_.render.setMaterial(shown.patch.handle(), material);
    return;
  }
  shown.patch.reset();
  shown.triangles = patch.triangles.size();
  if (auto made = services_.render.createMesh(shown.node.handle(), viewOf(std::span<const Vec3>(points)),
                                              sdk::rows<std::uint32_t, 3>(std::span(patch.triangles)), material))
    shown.patch = std::move(*made);
}

void ConditionMarks::show(const Frame &frame, const ConditionSnapshot &one, Shown &shown) {
  if (one.positions.size() != one.condition.patch.positions.size() || one.positions.empty()) return;
  showPatch(one, shown);
  const SurfaceCondition &value = frame.value && frame.dragged == one.number ? *frame.value : one.condition;
  const ConditionArrow arrow = arrowOf(one, value, metresPerNewton_);
  const DrawnMarks marks(services_, shown.node.handle());
  marks.arrow(shown.arrow, arrow.from, arrow.vector, kArrow);
  marks.label(shown.label, arrow.tip(), valueText(value), kArrow);
  // The middle of a fix may be behind the body: a handle there would take the clicks on the surface before it.
  if (!frame.hasHandles || value.kind == ConditionKind::fix) return shown.handle.reset();
  const double radius = kHandleRadius * sizeOf(*frame.snapshot, one.body);
  if (radius != shown.handleRadius) shown.handle.reset();
  shown.handleRadius = radius;
  const sdk::Material &material = hovered == one.number || frame.dragged == one.number ? kHovered
                                  : chosen == one.number                               ? kChosenHandle
                                                                                       : kHandle;
  marks.sphere(shown.handle, arrow.tip(), radius, material);
  if (shown.handle) (void)services_.render.setMaterial(shown.handle.handle(), material);
}

std::optional<std::uint64_t> ConditionMarks::handleUnder(const Snapshot &snapshot, const PickRay &ray,
                                                         bool isSlice) const {
  std::optional<std::uint64_t> nearest;
  double least = 1.0;
  for (const ConditionSnapshot &one : snapshot.conditions) {
    const auto shown = shown_.find(one.number);
    if (shown == shown_.end() || !shown->second.handle || !shown->second.isVisible || one.positions.empty()) continue;
    const Vec3 off = arrowOf(one, metresPerNewton_).tip() - ray.origin;
    const double size = sizeOf(snapshot, one.body), along = off.dot(ray.direction);
    // A slice shows the handles that it cuts.
    if (isSlice ? std::abs(along) > kHandleRadius * size : along <= 0.0) continue;
    const double away = off.cross(ray.direction).norm() / (kHandleReach * size);
    if (away >= least) continue;
    least = away;
    nearest = one.number;
  }
  return nearest;
}

void ConditionMarks::clear() {
  shown_.clear();
  hidden_.clear();
  chosen = hovered = 0;
  metresPerNewton_ = 0.0;
}

}  // namespace pointbased
