// SPDX-License-Identifier: Apache-2.0
#include "pointbased/singular_places.h"

#include <algorithm>
#include <cmath>

#include "base/point_tree.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr double kOnBorder = 1e-6;  // spacings: rounding of what lies on the border of a region

/// Calls found(q) for the evaluation points that have a phyxel with isOf and one without.
template <class IsOf, class IsOther, class Found>
void forMixedPoints(const StencilSet &s, const IsOf &isOf, const IsOther &isOther, const Found &found) {
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    bool of = false, other = false;
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      of = of || isOf(s.phyxels.indices[e]);
      other = other || isOther(s.phyxels.indices[e]);
    }
    if (of && other) found(q);
  }
}

class Finder {
 public:
  Finder(const Body &body, SingularPlaces &out)
      : body_(body), rest_(body.rest()), out_(out), points_(rest_.pointCentres),
        skin_(rest_.contact.binding.positions) {}

  void addSupports() {
    const BoundaryConditions &conditions = rest_.conditions;
    for (std::size_t f = 0; f < conditions.fixes.size() && f < conditions.held.size(); ++f) {
      std::vector<Vec3> edge = rim(conditions.fixes[f].region);
      if (edge.empty()) edge = border(conditions.held[f]);
      if (edge.empty()) continue;
      out_.fixes.push_back(f);
      leaveOutAround(edge);
    }
  }

  void addContact(std::span<const double> pressures) {
    if (pressures.size() != rest_.phyxelCount()) return;
    const auto presses = [&](Index j) { return pressures[j] > 0.0; };
    if (std::none_of(pressures.begin(), pressures.end(), [](double p) { return p > 0.0; })) return;
    std::vector<std::uint8_t> onSkin(rest_.phyxelCount(), 0);
    for (const Index j : rest_.contact.binding.phyxels.indices) onSkin[j] = 1;
    std::vector<Vec3> edge;
    forMixedPoints(
        rest_.stencils, presses, [&](Index j) { return onSkin[j] != 0 && !presses(j); },
        [&](std::size_t q) { edge.push_back(rest_.pointCentres[q]); });
    out_.contact = !edge.empty();
    leaveOutAround(edge);
  }

  void addHands() {
    std::vector<Vec3> held;
    for (const Hand &hand : body_.hands)
      for (const Index j : hand.grab.phyxels)
        if (j < rest_.phyxelCount()) held.push_back(rest_.positions[j]);
    out_.hands = !held.empty();
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
  // Where a region that is held meets the free skin.
  [[nodiscard]] std::vector<Vec3> rim(const Region &region) {
    const std::vector<Vec3> &at = rest_.contact.binding.positions;
    std::vector<std::uint8_t> isHeld(at.size());
    for (std::size_t p = 0; p < at.size(); ++p)
      isHeld[p] = signedDistance(region, rest_.origin + at[p]) <= kOnBorder * rest_.spacing ? 1 : 0;
    std::vector<Vec3> edge;
    for (std::size_t p = 0; p < at.size(); ++p) {
      if (isHeld[p] == 0) continue;
      skin_.within(at[p], rest_.spacing, found_);
      if (std::any_of(found_.begin(), found_.end(), [&](const auto &near) { return isHeld[near.first] == 0; }))
        edge.push_back(at[p]);
    }
    return edge;
  }

  // What is held beside what is not, inside of the body.
  [[nodiscard]] std::vector<Vec3> border(const ConstrainedRegion &held) const {
    std::vector<std::uint8_t> isHeld(rest_.phyxelCount(), 0), isSupported(rest_.phyxelCount(), 0);
    for (const Index j : held.phyxels) isHeld[j] = isSupported[j] = 1;
    for (const Index j : held.rows.indices) isSupported[j] = 1;
    std::vector<Vec3> edge;
    forMixedPoints(
        rest_.stencils, [&](Index j) { return isSupported[j] != 0; }, [&](Index j) { return isHeld[j] == 0; },
        [&](std::size_t q) { edge.push_back(rest_.pointCentres[q]); });
    return edge;
  }

  void leaveOutAround(std::span<const Vec3> edge) {
    for (const Vec3 &x : edge) {
      points_.within(x, kSingularSpacings * rest_.spacing, found_);
      for (const auto &near : found_) out_.points[near.first] = 1;
    }
  }

  const Body &body_;
  const RestState &rest_;
  SingularPlaces &out_;
  PointTree points_, skin_;
  std::vector<std::pair<Index, double>> found_;
};

}  // namespace

SingularPlaces findSingularPlaces(const Body &body, std::span<const double> pressures) {
  SingularPlaces out;
  out.points.assign(body.rest().pointCount(), 0);
  Finder finder(body, out);
  finder.addSupports();
  finder.addContact(pressures);
  finder.addHands();
  finder.sumVolume();
  return out;
}

}  // namespace pointbased
