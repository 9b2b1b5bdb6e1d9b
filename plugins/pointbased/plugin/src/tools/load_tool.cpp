// SPDX-License-Identifier: Apache-2.0
#include "tools/load_tool.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/number_text.h"
#include "tools/drawn_marks.h"

namespace pointbased {
namespace {

constexpr sdk::Material kSelected{{1.0f, 0.62f, 0.10f, 1.0f}, true};
constexpr sdk::Material kOutline{{1.0f, 1.0f, 1.0f, 1.0f}, false, true};
constexpr double kSizeStep = 1.15;  // factor per notch of the wheel
constexpr double kAngleStep = 5.0;  // degrees, per key
constexpr std::uint32_t kKeyDelete = 127;

Vec3 presentNormalOf(const BodySnapshot &body, const SurfaceTriangle &t) {
  const Vec3 a = vectorOf(body.surfels[t[0]]);
  return (vectorOf(body.surfels[t[1]]) - a).cross(vectorOf(body.surfels[t[2]]) - a).normalized();
}

/// The triangles of a selection with corners of their own.
struct PatchCorners {
  std::vector<std::uint32_t> corners;  // of the surface
  std::vector<SurfaceTriangle> triangles;

  PatchCorners(const std::vector<SurfaceTriangle> &all, const std::set<std::uint32_t> &selected) {
    std::map<std::uint32_t, std::uint32_t> indices;
    for (const std::uint32_t t : selected) {
      SurfaceTriangle &triangle = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [found, isNew] = indices.emplace(all[t][k], static_cast<std::uint32_t>(indices.size()));
        if (isNew) corners.push_back(all[t][k]);
        triangle[k] = found->second;
      }
    }
  }
};

}  // namespace

bool LoadTool::onEvent(const c3de_event &event) {
  if (!simulator_) return false;
  const bool isLeft = event.button == C3DE_BUTTON_LEFT;
  if (event.type == C3DE_EVENT_PRESS && isLeft) return press(event);
  if (event.type == C3DE_EVENT_MOVE) {
    move(event);
    return gesture_ != Gesture::none;
  }
  if (event.type == C3DE_EVENT_RELEASE && isLeft && gesture_ != Gesture::none) {
    release(event);
    return true;
  }
  if (event.type == C3DE_EVENT_WHEEL && gesture_ == Gesture::brush) {
    changeSize(event.wheel);
    return true;
  }
  // The camera does not move while a rectangle or an arrow is dragged; a slice may.
  if (event.type == C3DE_EVENT_WHEEL) return gesture_ != Gesture::none && !sdk::isInSlice(event);
  return event.type == C3DE_EVENT_KEY && pressKey(event.key);
}

bool LoadTool::pressKey(std::uint32_t key) {
  switch (key) {
    case '[':
    case ']': changeSize(key == ']' ? 1.0 : -1.0); return true;
    case 'E': isRemoving = !isRemoving; return true;
    case 'Q': mode = static_cast<Mode>((static_cast<std::uint32_t>(mode) + 1) % 3); return true;
    case 'X': through = !through; return true;
    case kKeyDelete: break;
    default: return false;
  }
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  if (snapshot && marks_.chosen != 0) {
    for (const ConditionSnapshot &one : snapshot->conditions)
      if (one.number == marks_.chosen) edits_.remove(one);
    marks_.chosen = 0;
  } else if (gesture_ == Gesture::none) {
    clear();
  }
  return true;
}

void LoadTool::changeSize(double notches) {
  const double factor = std::pow(kSizeStep, notches);
  if (mode == Mode::brush) radius_mm = std::clamp(factor * radius_mm, kMinRadius, kMaxRadius);
  if (mode == Mode::box) depth_mm = std::clamp(factor * depth_mm, kMinDepth, kMaxDepth);
  if (mode == Mode::face) angle_deg = std::clamp(angle_deg + kAngleStep * notches, kMinAngle, kMaxAngle);
}

void LoadTool::setRemoving(const c3de_event &event) {
  removesNow_ = isRemoving != ((event.modifiers & C3DE_MOD_ALT) != 0);
}

bool LoadTool::press(const c3de_event &event) {
  if (gesture_ != Gesture::none) return true;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  if (box_) endBox();
  if (beginArrow(*snapshot, *ray, sdk::isInSlice(event))) return true;
  marks_.chosen = 0;
  before_ = {body_, surface_, selected_};
  setRemoving(event);
  if (mode == Mode::box) {
    if (snapshot->bodies.empty()) return false;
    gesture_ = Gesture::box;
    isBoxReleased_ = false;
    box_.emplace(services_, snapshot, sdk::isInSlice(event), *ray, event.x_px, event.y_px);
    return true;
  }
  paint(event);
  return gesture_ != Gesture::none;
}

void LoadTool::move(const c3de_event &event) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray) return;
  setRemoving(event);
  switch (gesture_) {
    case Gesture::none:
      marks_.hovered = 0;
      if (const auto snapshot = simulator_->snapshot())
        marks_.hovered = marks_.handleUnder(*snapshot, *ray, sdk::isInSlice(event)).value_or(0);
      break;
    case Gesture::brush: paint(event); break;
    case Gesture::face: paint(event); break;
    case Gesture::box: box_->moveTo(*ray, event.x_px, event.y_px); break;
    case Gesture::arrow: dragArrow(*ray); break;
  }
}

void LoadTool::release(const c3de_event &event) {
  const Gesture ended = gesture_;
  if (ended == Gesture::box) {
    move(event);
    isBoxReleased_ = true;
  }
  gesture_ = Gesture::none;
  if (ended == Gesture::arrow) commitArrow();
}

// Also called when the window loses the focus.
void LoadTool::cancel() {
  const bool isSelecting = gesture_ == Gesture::brush || gesture_ == Gesture::face || box_;
  gesture_ = Gesture::none;
  arrow_.reset();
  box_.reset();
  outline_.reset();
  if (!isSelecting) return;
  body_ = before_.body;
  surface_ = before_.surface;
  selected_ = before_.selected;
  note_.clear();
  isChanged_ = true;
}

bool LoadTool::beginArrow(const Snapshot &snapshot, const PickRay &ray, bool isSlice) {
  const auto number = marks_.handleUnder(snapshot, ray, isSlice);
  if (!number) return false;
  marks_.chosen = *number;
  gesture_ = Gesture::arrow;
  for (const ConditionSnapshot &one : snapshot.conditions) {
    if (one.number != *number) continue;
    arrow_.emplace();
    arrow_->number = *number;
    arrow_->before = arrow_->value = one.condition;
    arrow_->arrow = arrowOf(one, marks_.metresPerNewton());
    arrow_->isSlice = isSlice;
    if (const auto tip = tipUnder(ray, arrow_->arrow, one.condition.kind, isSlice))
      arrow_->offset = arrow_->arrow.tip() - *tip;
  }
  return true;
}

void LoadTool::dragArrow(const PickRay &ray) {
  if (!arrow_) return;
  const auto tip = tipUnder(ray, arrow_->arrow, arrow_->before.kind, arrow_->isSlice);
  if (!tip) return;
  arrow_->value =
      withArrow(arrow_->before, arrow_->arrow, *tip + arrow_->offset - arrow_->arrow.from, marks_.metresPerNewton());
}

// A click on the handle chooses the condition and leaves its value as it was typed.
void LoadTool::commitArrow() {
  if (!arrow_) return;
  const ArrowDrag drag = *arrow_;
  arrow_.reset();
  const bool isEqual = drag.value.vector == drag.before.vector && drag.value.pressure == drag.before.pressure;
  if (!isEqual) edits_.change("drag " + drag.before.name, drag.number, drag.before, drag.value);
}

std::string LoadTool::draggedText() const {
  return arrow_ ? arrow_->before.name + ": " + valueText(arrow_->value) : std::string();
}

void LoadTool::choose(std::uint64_t body, const std::shared_ptr<const PlacedMesh> &surface) {
  if (body_ == body && surface_ == surface) return;
  selected_.clear();
  body_ = body;
  surface_ = surface;
  isChanged_ = true;
}

void LoadTool::choose(const BodySnapshot &body) { choose(body.id, body.surface); }

void LoadTool::paint(const c3de_event &event) {
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return;
  const bool isBegun = gesture_ != Gesture::none;
  const auto begin = [&](const BodySnapshot &body) {
    choose(body);
    gesture_ = mode == Mode::face ? Gesture::face : Gesture::brush;
    note_.clear();
  };
  if (sdk::isInSlice(event)) {
    const NearSkin near = Skins(services_, *snapshot).nearestSkin(ray->origin);
    if (!near.body || (isBegun && near.body->id != body_)) return;
    begin(*near.body);
    if (mode == Mode::brush) return paintAround(*near.body, ray->origin, std::nullopt);
    return selectFace(closestOn(services_, surface_->pickTree.handle(), ray->origin).triangle);
  }
  const std::optional<PickedSurface> picked = pick(services_, *snapshot, *ray);
  // A stroke does not leave its body.
  if (!picked || !picked->body || (isBegun && picked->body->id != body_)) return;
  begin(*picked->body);
  if (mode == Mode::face) return selectFace(picked->triangle);
  const Vec3 normal = presentNormalOf(*picked->body, surface_->triangles[picked->triangle]);
  paintAround(*picked->body, picked->at, normal);
  // A triangle larger than the brush is painted where it was hit.
  select(picked->triangle);
}

void LoadTool::select(std::uint32_t triangle) {
  if (removesNow_)
    selected_.erase(triangle);
  else
    selected_.insert(triangle);
  isChanged_ = true;
}

// In 3D only what faces the same side as the point under the mouse: not the other side of a thin part.
void LoadTool::paintAround(const BodySnapshot &body, const Vec3 &at, const std::optional<Vec3> &normal) {
  const double radius = 1e-3 * radius_mm;
  for (std::uint32_t t = 0; t < surface_->triangles.size(); ++t) {
    const SurfaceTriangle &triangle = surface_->triangles[t];
    if ((centreOf(body.surfels, triangle) - at).squaredNorm() > radius * radius) continue;
    if (normal && presentNormalOf(body, triangle).dot(*normal) <= 0.0) continue;
    select(t);
  }
}

// While the button is pressed, the face under the mouse is a preview: it replaces the one before.
void LoadTool::selectFace(std::uint32_t triangle) {
  if (triangle >= surface_->triangles.size()) return;
  if (neighboursOf_ != surface_) {
    neighbours_.emplace(surface_->triangles);
    neighboursOf_ = surface_;
  }
  selected_ = before_.surface == surface_ && before_.body == body_ ? before_.selected : Selected();
  isChanged_ = true;
  for (const std::uint32_t t :
       faceAround(surface_->positions, surface_->triangles, *neighbours_, triangle, border, angle_deg))
    select(t);
}

void LoadTool::takeBox() {
  const std::uint64_t body = box_->chosenBody(before_.selected.empty() ? 0 : before_.body);
  if (body == 0) {
    choose(before_.body, before_.surface);
    if (selected_ != before_.selected) isChanged_ = true;
    selected_ = before_.selected;
    return;
  }
  choose(*box_->snapshot().body(body));
  selected_ = before_.surface == surface_ && before_.body == body_ ? before_.selected : Selected();
  for (const std::uint32_t t : box_->found().at(body)) select(t);
  isChanged_ = true;
}

void LoadTool::endBox() {
  note_.clear();
  if (box_->found().empty()) {
    note_ = box_->isSlice() ? "The box meets no surface within " + significant(depth_mm) + " mm of the slice"
                            : "The box meets no visible surface";
  } else if (box_->found().size() > 1) {
    note_ = "Only '" + box_->snapshot().body(body_)->name + "' is selected; the box also meets";
    for (const auto &[body, triangles] : box_->found())
      if (body != body_) note_ += " '" + box_->snapshot().body(body)->name + "'";
  }
  box_.reset();
  outline_.reset();
}

SurfacePatch LoadTool::patch(const Snapshot &snapshot) const {
  SurfacePatch out;
  const BodySnapshot *body = snapshot.body(body_);
  if (!body || body->surface != surface_) return out;
  const PatchCorners part(surface_->triangles, selected_);
  for (const std::uint32_t corner : part.corners) out.positions.push_back(surface_->positions[corner]);
  out.triangles = part.triangles;
  return out;
}

void LoadTool::clear() {
  selected_.clear();
  body_ = 0;
  surface_.reset();
  highlight_.reset();
  note_.clear();
  isChanged_ = true;
}

void LoadTool::detach() {
  cancel();
  clear();
  before_ = {};
  neighbours_.reset();
  neighboursOf_.reset();
  marks_.clear();
  edits_.clear();
}

void LoadTool::showSelection(const Snapshot *snapshot) {
  const BodySnapshot *body = snapshot ? snapshot->body(body_) : nullptr;
  if (!body || body->surface != surface_ || selected_.empty()) return highlight_.reset();
  const PatchCorners part(surface_->triangles, selected_);
  std::vector<Vec3> points;
  for (const std::uint32_t corner : part.corners) points.push_back(vectorOf(body->surfels[corner]));
  points = liftedFrom(std::move(points), part.triangles);
  if (highlight_ && !isChanged_) {
    (void)services_.render.update(highlight_.handle(), C3DE_ATTR_POSITIONS, viewOf(std::span<const Vec3>(points)));
    return;
  }
  isChanged_ = false;
  highlight_.reset();
  if (auto made = services_.render.createMesh(simulator_->node(), viewOf(std::span<const Vec3>(points)),
                                              sdk::rows<std::uint32_t, 3>(std::span(part.triangles)), kSelected))
    highlight_ = std::move(*made);
}

void LoadTool::showBox() {
  if (!box_) return outline_.reset();
  const std::vector<Vec3> lines = box_->outline();
  if (lines.empty()) return outline_.reset();
  DrawnMarks(services_, simulator_->node()).lines(outline_, lines, kOutline);
}

void LoadTool::forgetRemovedBody(const Snapshot *snapshot) {
  const auto isPresent = [&](std::uint64_t id, const std::shared_ptr<const PlacedMesh> &surface) {
    const BodySnapshot *body = snapshot ? snapshot->body(id) : nullptr;
    return body && body->surface == surface;
  };
  if (!isPresent(before_.body, before_.surface)) before_ = {};
  if (box_ && std::any_of(box_->found().begin(), box_->found().end(), [&](const auto &entry) {
        return !isPresent(entry.first, box_->snapshot().body(entry.first)->surface);
      }))
    cancel();
  if (selected_.empty() || isPresent(body_, surface_)) return;
  clear();
  note_ = "The selection was cleared, because its body was removed or resampled";
}

void LoadTool::update(const SimulatorView *view) {
  history_.update();
  edits_.update();
  if (!simulator_ || !services_.render) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  forgetRemovedBody(snapshot.get());
  if (box_) {
    box_->set(through, 1e-3 * depth_mm);
    const bool isComplete = box_->advance();
    takeBox();
    if (!isComplete) note_ = "Selecting, " + fixed(100.0 * box_->progress(), 0) + " %";
    if (isComplete && isBoxReleased_) endBox();
  }
  showBox();
  showSelection(snapshot.get());
  const bool isGone = arrow_ && snapshot &&
                      std::none_of(snapshot->conditions.begin(), snapshot->conditions.end(),
                                   [&](const ConditionSnapshot &one) { return one.number == arrow_->number; });
  if (isGone) arrow_.reset();
  marks_.update({snapshot.get(), view, simulator_->node(), isActive(), arrow_ ? arrow_->number : 0,
                 arrow_ ? &arrow_->value : nullptr});
}

}  // namespace pointbased
