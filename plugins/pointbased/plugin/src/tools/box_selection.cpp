// SPDX-License-Identifier: Apache-2.0
#include "tools/box_selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace pointbased {
namespace {

constexpr double kTolerance = 1e-4;  // of the distance: a surface is not hidden by itself
constexpr std::size_t kRaysGrain = 256;

double nearestDepth(const Snapshot &snapshot, const PickRay &ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const BodySnapshot &body : snapshot.bodies)
    for (const Vec3f &x : body.surfels)
      if (const double depth = (vectorOf(x) - ray.origin).dot(ray.view); depth > 0.0)
        nearest = std::min(nearest, depth);
  return std::isfinite(nearest) ? nearest : 1.0;
}

}  // namespace

BoxSelection::BoxSelection(const Services &services, std::shared_ptr<const Snapshot> snapshot, bool isSlice,
                           const PickRay &first, double x_px, double y_px)
    : services_(services), snapshot_(std::move(snapshot)),
      isSlice_(isSlice), first_{x_px, y_px, first.origin, first.direction}, last_(first_), view_(first.view) {
  if (isSlice_) {
    if (const NearSkin near = Skins(services_, *snapshot_).nearestSkin(first.origin); near.body && near.distance < 0.0)
      pressed_ = near.body->id;
    return;
  }
  outlineDepth_ = nearestDepth(*snapshot_, first);
  if (const auto picked = pick(services_, *snapshot_, first); picked && picked->body) pressed_ = picked->body->id;
}

void BoxSelection::moveTo(const PickRay &ray, double x_px, double y_px) {
  PixelRay last{x_px, y_px, ray.origin, ray.direction};
  if (isSlice_) {
    // The wheel moves the plane during the drag: the selection has both planes between its depths.
    const double depth = (ray.origin - first_.origin).dot(view_);
    lowest_ = std::min(lowest_, depth);
    highest_ = std::max(highest_, depth);
    last.origin -= depth * view_;
  }
  last_ = last;
  restart();
}

void BoxSelection::set(bool through, double depth_m) {
  if (through == through_ && depth_m == depth_) return;
  through_ = through;
  depth_ = depth_m;
  restart();
}

void BoxSelection::restart() {
  frame_ = ViewFrame::fromRays(first_, last_, view_);
  candidates_.clear();
  found_.clear();
  isComplete_ = !frame_;
  tested_ = wanted_ = 0;
  if (!frame_) return;
  const PixelRect rect = PixelRect::between(first_, last_);
  for (const BodySnapshot &body : snapshot_->bodies) {
    const auto &triangles = body.surface->triangles;
    std::vector<std::uint32_t> inside =
        isSlice_ ? trianglesInSlab(body.surfels, triangles, *frame_, rect, lowest_ - depth_, highest_ + depth_)
                 : trianglesInRect(body.surfels, triangles, *frame_, rect, !through_);
    if (inside.empty()) continue;
    if (isSlice_ || through_)
      found_.emplace(body.id, std::move(inside));
    else
      candidates_.emplace(body.id, std::move(inside));
  }
  for (const auto &[body, triangles] : candidates_) wanted_ += triangles.size();
}

double BoxSelection::progress() const {
  return isComplete_ || wanted_ == 0 ? 1.0 : static_cast<double>(tested_) / static_cast<double>(wanted_);
}

bool BoxSelection::advance() {
  if (isComplete_) return true;
  std::size_t left = kRaysPerFrame;
  tested_ = 0;
  for (const auto &[body, triangles] : candidates_) {
    auto [known, isNew] = visibility_.try_emplace(body);
    if (isNew) known->second.resize(snapshot_->body(body)->surface->triangles.size(), Visibility::unknown);
    std::vector<std::uint32_t> next;
    for (const std::uint32_t t : triangles) {
      if (known->second[t] != Visibility::unknown)
        ++tested_;
      else if (next.size() < left)
        next.push_back(t);
    }
    left -= next.size();
    tested_ += next.size();
    if (!next.empty()) testVisibility(body, next);
  }
  for (const auto &[body, triangles] : candidates_) {
    const std::vector<Visibility> &known = visibility_[body];
    std::vector<std::uint32_t> seen;
    std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(seen),
                 [&](std::uint32_t t) { return known[t] == Visibility::seen; });
    if (seen.empty())
      found_.erase(body);
    else
      found_.insert_or_assign(body, std::move(seen));
  }
  isComplete_ = tested_ == wanted_;
  if (isComplete_ && !isSlice_) addMiddle();
  return isComplete_;
}

// The first hit of the ray from the eye to the centre of a triangle is the triangle itself, or it is hidden.
void BoxSelection::testVisibility(std::uint64_t id, std::span<const std::uint32_t> chosen) {
  const BodySnapshot &body = *snapshot_->body(id);
  std::vector<sdk::Vec3> origins, directions;
  std::vector<double> distances;
  for (const std::uint32_t t : chosen) {
    const Vec3 centre = centreOf(body.surfels, body.surface->triangles[t]);
    const ViewFrame::Pixel pixel = frame_->project(centre);
    const PixelRay ray = frame_->ray(pixel.x, pixel.y);
    origins.push_back(toArray(ray.origin));
    directions.push_back(toArray(ray.direction));
    distances.push_back((centre - ray.origin).dot(ray.direction));
  }
  std::vector<std::uint8_t> isHidden(chosen.size(), 0);
  const auto cast = [&](c3de_handle tree, std::span<const sdk::Vec3> from, std::span<const sdk::Vec3> along) {
    services_.parallelFor()(chosen.size(), kRaysGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<c3de_ray_hit> hits(end - begin);
      if (!services_.collision.rays(tree, from.subspan(begin, end - begin), along.subspan(begin, end - begin),
                                    std::numeric_limits<double>::infinity(), hits))
        return;
      for (std::size_t i = begin; i < end; ++i) {
        const c3de_ray_hit &hit = hits[i - begin];
        const double limit = distances[i] - kTolerance * std::abs(distances[i]);
        if (hit.t >= 0.0 && hit.t < limit) isHidden[i] = 1;
      }
    });
  };
  for (const BodySnapshot &other : snapshot_->bodies)
    if (const auto tree = presentTree(services_, *other.surface, viewOf(other.surfels)))
      cast(*tree, origins, directions);
  for (const ObstacleSnapshot &obstacle : snapshot_->obstacles) {
    const RigidMotion &motion = obstacle.motion;
    const Mat3 back = motion.rotation.transpose();
    std::vector<sdk::Vec3> from, along;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      from.push_back(toArray(back * (Vec3(origins[i].data()) - motion.centre - motion.displacement) + motion.centre));
      along.push_back(toArray(back * Vec3(directions[i].data())));
    }
    cast(obstacle.mesh->tree.handle(), from, along);
  }
  std::vector<Visibility> &known = visibility_[id];
  for (std::size_t i = 0; i < chosen.size(); ++i)
    known[chosen[i]] = isHidden[i] != 0 ? Visibility::hidden : Visibility::seen;
}

// A rectangle within one triangle contains no centre.
void BoxSelection::addMiddle() {
  const PixelRay ray = frame_->ray(0.5 * (first_.x + last_.x), 0.5 * (first_.y + last_.y));
  const auto picked = pick(services_, *snapshot_, {ray.origin, ray.direction, view_});
  if (!picked || !picked->body) return;
  std::vector<std::uint32_t> &triangles = found_[picked->body->id];
  const auto at = std::lower_bound(triangles.begin(), triangles.end(), picked->triangle);
  if (at == triangles.end() || *at != picked->triangle) triangles.insert(at, picked->triangle);
}

std::uint64_t BoxSelection::chosenBody(std::uint64_t preferred) const {
  for (const std::uint64_t body : {preferred, pressed_})
    if (found_.contains(body)) return body;
  std::uint64_t largest = 0;
  double most = -1.0;
  for (const auto &[id, triangles] : found_) {
    const BodySnapshot &body = *snapshot_->body(id);
    double area = 0.0;
    for (const std::uint32_t t : triangles) area += areaOf(body.surfels, body.surface->triangles[t]);
    if (area <= most) continue;
    most = area;
    largest = id;
  }
  return largest;
}

std::vector<Vec3> BoxSelection::outline() const {
  if (!frame_) return {};
  const std::array<Vec3, 4> corners =
      frame_->corners(PixelRect::between(first_, last_), frame_->isPerspective() ? outlineDepth_ : 0.0);
  std::vector<Vec3> lines;
  for (std::size_t k = 0; k < 4; ++k) lines.insert(lines.end(), {corners[k], corners[(k + 1) % 4]});
  return lines;
}

}  // namespace pointbased
