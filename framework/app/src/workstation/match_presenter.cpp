// SPDX-License-Identifier: Apache-2.0
#include "workstation/match_presenter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace c3de::app {
namespace {

using render::Colour;
using render::Vec3f;

/// From blue over yellow to red, distinguishable with any colour vision.
constexpr std::array<Colour, 5> kColours{{{0.27f, 0.46f, 0.90f, 1.0f},
                                          {0.60f, 0.83f, 0.96f, 1.0f},
                                          {1.00f, 1.00f, 0.75f, 1.0f},
                                          {0.99f, 0.68f, 0.38f, 1.0f},
                                          {0.88f, 0.19f, 0.15f, 1.0f}}};
constexpr Colour kUnused{0.55f, 0.55f, 0.58f, 1.0f}, kTarget{0.47f, 0.90f, 0.55f, 1.0f};
constexpr double kColouredNoise = 3.0;  // standard deviations
constexpr double kColouredPart = 0.95;  // of the used points
constexpr double kSphereShare = 0.005;  // of the diagonal of the points
constexpr float kArrowWidth_px = 1.6f;
constexpr double kRaised = 0.3;     // radii of a sphere, from the skin of the body
constexpr double kHeadShare = 0.3;  // of the length of an arrow

/// The colours of the points replace that of the material.
render::Material ofOwnColours() {
  render::Material material;
  material.colour = {1.0f, 1.0f, 1.0f, 1.0f};
  return material;
}

Vec3f single(const Vec3 &v) { return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}; }

double diagonalOf(const std::vector<MatchedPoint> &points) {
  Vec3 low = points.front().measured_mm, high = low;
  for (const MatchedPoint &one : points)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], one.measured_mm[a]);
      high[a] = std::max(high[a], one.measured_mm[a]);
    }
  return norm(high - low);
}

/// The colour of a value from 0 to `high`.
Colour colourAt(double value, double high) {
  const double at = std::clamp(value / high, 0.0, 1.0) * static_cast<double>(kColours.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kColours.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(below));
  Colour out{};
  for (std::size_t c = 0; c < out.size(); ++c)
    out[c] = (1.0f - part) * kColours[below][c] + part * kColours[below + 1][c];
  return out;
}

/// The vertices, moved outwards by a length.
std::vector<Vec3f> raised(const geometry::TriangleMesh &mesh, double by) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3{});
  for (const Triangle &t : mesh.triangles) {
    const Vec3 area = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const std::uint32_t vertex : t) normals[vertex] = normals[vertex] + area;
  }
  std::vector<Vec3f> out;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double length = norm(normals[i]);
    out.push_back(single(length > 0.0 ? mesh.vertices[i] + (by / length) * normals[i] : mesh.vertices[i]));
  }
  return out;
}

/// The largest distance that colours distinguish.
double highestOf(const std::vector<MatchedPoint> &points, double noise_mm) {
  std::vector<double> used;
  for (const MatchedPoint &one : points)
    if (one.isUsed) used.push_back(one.distance_mm());
  double high = kColouredNoise * noise_mm;
  if (used.empty()) return high;
  const auto at = used.begin() + static_cast<std::ptrdiff_t>(kColouredPart * static_cast<double>(used.size() - 1));
  std::nth_element(used.begin(), at, used.end());
  return std::max(high, *at);
}

/// Adds the three lines of an arrow.
void addArrow(const Vec3 &from, const Vec3 &to, std::vector<Vec3f> &lines) {
  const Vec3 along = to - from;
  const double length = norm(along);
  const Vec3 other = std::abs(along[0]) < 0.6 * length ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  Vec3 side = other - (dot(other, along) / (length * length)) * along;
  side = (0.5 * kHeadShare * length / norm(side)) * side;
  const Vec3 neck = to - kHeadShare * along;
  for (const Vec3 &end : {from, neck + side, neck - side}) {
    lines.push_back(single(end));
    lines.push_back(single(to));
  }
}

}  // namespace

void MatchPresenter::show(std::vector<MatchedPoint> points, const std::vector<ShownLandmark> &landmarks,
                          double noise_mm, Handle parent) {
  forget();
  if (points.empty()) return;
  points_ = std::move(points);
  high_mm_ = highestOf(points_, noise_mm);
  radius_mm_ = std::max(kSphereShare * diagonalOf(points_), 1e-3);
  group_ = scene_.add(parent, "match");
  addPoints();
  drawArrows();
  addLandmarks(landmarks);
  followTree();
}

void MatchPresenter::forget() {
  for (const Part &part : parts_)
    for (const Handle proxy : part.proxies) renderer_.destroy(proxy);
  parts_.clear();
  points_.clear();
  scene_.remove(std::exchange(group_, {}));
  arrows_ = legend_ = {};
}

void MatchPresenter::setArrowScale(double scale) {
  if (scale == std::exchange(arrowScale_, scale) || points_.empty()) return;
  drawArrows();
  renderer_.setLegend(legend_, legend());
}

void MatchPresenter::followTree() {
  for (Part &part : parts_) {
    const bool isVisible = scene_.isVisible(part.node);
    if (isVisible == std::exchange(part.isVisible, isVisible)) continue;
    for (const Handle proxy : part.proxies) renderer_.setVisible(proxy, isVisible);
  }
}

render::Legend MatchPresenter::legend() const {
  const auto used = std::count_if(points_.begin(), points_.end(), [](const MatchedPoint &one) { return one.isUsed; });
  render::Legend out;
  out.title = "Distance to surface";
  out.unit = "mm";
  out.note = fmt::format("{} of {} points used", used, points_.size());
  if (static_cast<std::size_t>(used) < points_.size()) out.note += "\ngrey: outliers";
  if (arrowScale_ > 1.0) out.note += fmt::format("\narrows {:.3g} times as long", arrowScale_);
  out.high = high_mm_;
  out.colours.assign(kColours.begin(), kColours.end());
  return out;
}

Colour MatchPresenter::colourOf(const MatchedPoint &point) const {
  return point.isUsed ? colourAt(point.distance_mm(), high_mm_) : kUnused;
}

void MatchPresenter::addPoints() {
  std::vector<Vec3f> centres;
  std::vector<Colour> colours;
  for (const MatchedPoint &one : points_) {
    centres.push_back(single(one.measured_mm));
    colours.push_back(colourOf(one));
  }
  const Handle spheres = renderer_.createSpheres(centres, static_cast<float>(radius_mm_), ofOwnColours());
  renderer_.setColours(spheres, colours);
  legend_ = renderer_.createLegend(legend());
  parts_.push_back({scene_.add(group_, "measured points"), {spheres, legend_}});
}

void MatchPresenter::drawArrows() {
  std::vector<Vec3f> lines;
  std::vector<Colour> colours;
  for (const MatchedPoint &one : points_) {
    const Vec3 residual = one.measured_mm - one.surface_mm;
    // One of an outlier crosses the whole view.
    if (!one.isUsed || !(norm(residual) > 1e-6)) continue;
    addArrow(one.surface_mm, one.surface_mm + arrowScale_ * residual, lines);
    colours.resize(lines.size(), colourOf(one));
  }
  if (arrows_.isNull()) {
    arrows_ = renderer_.createLines(lines, kArrowWidth_px, ofOwnColours());
    parts_.push_back({scene_.add(group_, "residuals"), {arrows_}});
  } else {
    renderer_.setPositions(arrows_, lines);
  }
  renderer_.setColours(arrows_, colours);
}

void MatchPresenter::addErrors(const ShownErrors &errors) {
  if (group_.isNull() || errors.errors_mm.empty() || errors.errors_mm.size() != errors.skin.vertices.size()) return;
  double high = 0.0;
  for (const auto &one : errors.errors_mm) high = std::max(high, one.value_or(0.0));
  if (!(high > 0.0)) return;
  std::vector<Colour> colours;
  for (const auto &one : errors.errors_mm) colours.push_back(one ? colourAt(*one, high) : kUnused);
  render::Material material = ofOwnColours();
  material.isInside = true;  // tools grab the body
  const Handle mesh = renderer_.createMesh(raised(errors.skin, kRaised * radius_mm_), errors.skin.triangles, material);
  renderer_.setColours(mesh, colours);
  render::Legend legend;
  legend.title = "Expected error";
  legend.unit = "mm";
  legend.note = "when matched\ngrey: not known here";
  legend.high = high;
  legend.colours.assign(kColours.begin(), kColours.end());
  const Handle node = scene_.add(group_, "expected error");
  if (scene::Node *added = scene_.find(node)) added->visible = false;
  parts_.push_back({node, {mesh, renderer_.createLegend(legend)}});
  followTree();
}

void MatchPresenter::addLandmarks(const std::vector<ShownLandmark> &landmarks) {
  if (landmarks.empty()) return;
  std::vector<Vec3f> targets, lines;
  for (const ShownLandmark &one : landmarks) {
    targets.push_back(single(one.target_mm));
    lines.push_back(single(one.at_mm));
    lines.push_back(single(one.target_mm));
  }
  render::Material material;
  material.colour = kTarget;
  parts_.push_back({scene_.add(group_, "targets of landmarks"),
                    {renderer_.createSpheres(targets, static_cast<float>(2.0 * radius_mm_), material),
                     renderer_.createLines(lines, kArrowWidth_px, material)}});
}

}  // namespace c3de::app
