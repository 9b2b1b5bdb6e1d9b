// SPDX-License-Identifier: Apache-2.0
#include "pointbased/singular_regions.h"

#include <algorithm>
#include <limits>

#include "base/point_tree.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr double kOnBorder = 1e-6;  // spacings: rounding of points on the border of a region
constexpr double kMinShare = 0.1;   // of the weights of a point: less is rounding of its position

class Finder {
 public:
  Finder(const Body &body, SingularRegions &out)
      : body_(body), rest_(body.rest()), out_(out), points_(rest_.pointCentres),
        skin_(rest_.contact.binding.positions) {
    for (const Vec3 &x : rest_.pointCentres) {
      low_ = low_.cwiseMin(x);
      high_ = high_.cwiseMax(x);
    }
  }

  void addSupports() {
    const std::size_t fixes = std::min(rest_.conditions.fixes.size(), rest_.conditions.held.size());
    for (std::size_t f = 0; f < fixes; ++f) {
      const Region &region = rest_.conditions.fixes[f].region;
      const bool isTissue = std::holds_alternative<VoxelRegion>(region);
      std::vector<Vec3> edge = isTissue ? rimOfTissue(rest_.conditions.held[f]) : falloff(region);
      if (const auto *box = std::get_if<BoxRegion>(&region)) addBoxEdges(*box, edge);
      if (edge.empty()) continue;
      out_.fixes.push_back(f);
      leaveOutAround(edge);
    }
  }

  void addContact(std::span<const double> pressures) {
    if (pressures.size() != rest_.phyxelCount()) return;
    std::vector<std::uint8_t> isPressed(rest_.contact.count());
    for (std::size_t p = 0; p < isPressed.size(); ++p)
      isPressed[p] = shareOf(p, [&](Index j) { return pressures[j] > 0.0; }) > 0.5 ? 1 : 0;
    std::vector<Vec3> edge;
    forEdge(isPressed, [&](const Vec3 &pressed, const Vec3 &free) { edge.push_back(0.5 * (pressed + free)); });
    out_.contact = !edge.empty();
    leaveOutAround(edge);
  }

  void addHands() {
    std::vector<Vec3> held;
    for (const ActiveGrab &hand : body_.grabs)
      for (const Index j : hand.grab.phyxels)
        if (j < rest_.phyxelCount()) held.push_back(rest_.positions[j]);
    out_.grabs = !held.empty();
    leaveOutAround(held);
  }

  void sumVolume() {
    double all = 0.0, left = 0.0;
    for (std::size_t q = 0; q < rest_.pointCount(); ++q) {
      all += rest_.stencils.volumes[q];
      if (out_.points[q] != 0) left += rest_.stencils.volumes[q];
    }
    out_.volumePart = all > 0.0 ? left / all : 0.0;
  }

 private:
  // Calls found(in, out) for the points of the skin that are inside and have points outside within a spacing, with the
  // nearest of these.
  template <class Found>
  void forEdge(const std::vector<std::uint8_t> &isIn, const Found &found) {
    const std::vector<Vec3> &at = rest_.contact.binding.positions;
    for (std::size_t p = 0; p < at.size(); ++p) {
      if (isIn[p] == 0) continue;
      skin_.within(at[p], rest_.spacing, found_);
      const std::pair<Index, double> *nearest = nullptr;
      for (const auto &near : found_)
        if (isIn[near.first] == 0 && (nearest == nullptr || near.second < nearest->second)) nearest = &near;
      if (nearest != nullptr) found(at[p], at[nearest->first]);
    }
  }

  // Where a held region meets the free skin.
  [[nodiscard]] std::vector<Vec3> falloff(const Region &region) {
    const std::vector<Vec3> &at = rest_.contact.binding.positions;
    std::vector<std::uint8_t> isHeld(at.size());
    for (std::size_t p = 0; p < at.size(); ++p)
      isHeld[p] = signedDistance(region, rest_.origin + at[p]) <= kOnBorder * rest_.spacing ? 1 : 0;
    std::vector<Vec3> edge;
    forEdge(isHeld, [&](const Vec3 &held, const Vec3 &) { edge.push_back(held); });
    return edge;
  }

  // The skin of a tissue follows its voxels, with some points just inside and others just outside, and other skin may
  // be as near across a gap. The phyxels that carry a point decide to which side it belongs.
  [[nodiscard]] std::vector<Vec3> rimOfTissue(const ConstrainedRegion &held) const {
    std::vector<std::uint8_t> isHeld(rest_.phyxelCount(), 0);
    for (const Index j : held.phyxels) isHeld[j] = 1;
    std::vector<Vec3> edge;
    for (std::size_t p = 0; p < rest_.contact.count(); ++p) {
      const double share = shareOf(p, [&](Index j) { return isHeld[j] != 0; });
      if (share > kMinShare && share < 1.0 - kMinShare) edge.push_back(rest_.contact.binding.positions[p]);
    }
    return edge;
  }

  // Part of the weights of a skin point that belongs to selected phyxels.
  template <class Is>
  [[nodiscard]] double shareOf(std::size_t p, const Is &is) const {
    const Interpolation &binding = rest_.contact.binding;
    double share = 0.0;
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
      if (is(binding.phyxels.indices[e])) share += binding.weights[e];
    return share;
  }

  // Stress is unbounded in tissue around a held part with edges. Boxes are the only regions that have edges.
  void addBoxEdges(const BoxRegion &box, std::vector<Vec3> &edge) const {
    const double half = 0.5 * rest_.spacing;
    const Vec3 low = (box.min - rest_.origin).cwiseMax(low_), high = (box.max - rest_.origin).cwiseMin(high_);
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const double atU : {box.min[u], box.max[u]})
        for (const double atV : {box.min[v], box.max[v]})
          for (double along = low[axis]; along <= high[axis]; along += half) {
            Vec3 x;
            x[axis] = along;
            x[u] = atU - rest_.origin[u];
            x[v] = atV - rest_.origin[v];
            Index cell = 0;
            double squared = 0.0;
            const bool isNear = points_.nearest(x, 1, &cell, &squared) == 1;
            if (isNear && squared < rest_.spacing * rest_.spacing) edge.push_back(x);
          }
    }
  }

  void leaveOutAround(std::span<const Vec3> edge) {
    for (const Vec3 &x : edge) {
      points_.within(x, kSingularSpacings * rest_.spacing, found_);
      for (const auto &near : found_) out_.points[near.first] = 1;
    }
  }

  const Body &body_;
  const RestState &rest_;
  SingularRegions &out_;
  PointTree points_, skin_;
  Vec3 low_ = Vec3::Constant(std::numeric_limits<double>::infinity()), high_ = -low_;  // m, of the points
  std::vector<std::pair<Index, double>> found_;
};

}  // namespace

SingularRegions findSingularRegions(const Body &body, std::span<const double> pressures) {
  SingularRegions out;
  out.points.assign(body.rest().pointCount(), 0);
  Finder finder(body, out);
  finder.addSupports();
  finder.addContact(pressures);
  finder.addHands();
  finder.sumVolume();
  return out;
}

}  // namespace pointbased
