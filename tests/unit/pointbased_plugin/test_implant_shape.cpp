// SPDX-License-Identifier: Apache-2.0
// Shapes of implants: closed, oriented, and of the size that was asked for.
#include <map>
#include <numbers>

#include "instruments/implant_shape.h"
#include "support/catch.h"

using namespace pointbased;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

const ImplantShape &shapeOf(std::string_view name) {
  for (const ImplantShape &shape : implantShapes())
    if (shape.name == name) return shape;
  throw std::runtime_error("no shape of this name");
}

Vec3 extentOf(const ImplantSurface &surface) {
  Vec3 low = surface.positions_mm.front(), high = low;
  for (const Vec3 &at : surface.positions_mm) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  return high - low;
}

double volumeOf(const ImplantSurface &surface) {
  double volume = 0.0;
  for (const auto &[a, b, c] : surface.triangles)
    volume += surface.positions_mm[a].dot(surface.positions_mm[b].cross(surface.positions_mm[c])) / 6.0;
  return volume;
}

/// Every edge is passed once in each direction.
bool isClosed(const ImplantSurface &surface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto &t : surface.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto &[edge, count] : edges)
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  return true;
}

}  // namespace

TEST_CASE("shapes of implants are closed at the ends of the ranges of their sizes") {
  CHECK(implantShapes().size() == 4);
  for (const ImplantShape &shape : implantShapes())
    for (std::size_t ends = 0; ends < (std::size_t{1} << shape.sizes.size()); ++ends) {
      std::vector<double> sizes;
      for (std::size_t i = 0; i < shape.sizes.size(); ++i)
        sizes.push_back((ends >> i & 1) != 0 ? shape.sizes[i].most_mm : shape.sizes[i].least_mm);
      CAPTURE(shape.name, ends);
      const ImplantSurface surface = shape.surface(sizes);
      CHECK(isClosed(surface));
      CHECK(volumeOf(surface) > 0.0);
      for (const Vec3 &at : surface.positions_mm) REQUIRE(at.allFinite());
    }
}

TEST_CASE("shapes of implants have the size that was asked for") {
  const ImplantSurface plate = shapeOf("plate").surface(std::array{40.0, 12.0, 3.0});
  CHECK((extentOf(plate) - Vec3(40.0, 12.0, 3.0)).norm() < 1e-9);
  // The outline without its four rounded corners of radius 3.6 mm.
  CHECK_THAT(volumeOf(plate), WithinRel(3.0 * (480.0 - (4.0 - std::numbers::pi) * 3.6 * 3.6), 0.01));

  const ImplantSurface sphere = shapeOf("sphere").surface(std::array{20.0});
  CHECK_THAT(extentOf(sphere)[2], WithinAbs(20.0, 1e-9));
  CHECK(sphere.contactPlane_mm == -10.0);
  // 32 facets around: 2 % below the ball.
  CHECK_THAT(volumeOf(sphere), WithinRel(4000.0 / 3.0 * std::numbers::pi, 0.02));

  const ImplantSurface wedge = shapeOf("wedge").surface(std::array{30.0, 20.0, 10.0});
  CHECK((extentOf(wedge) - Vec3(30.0, 20.0, 10.0)).norm() < 1e-9);
  CHECK_THAT(volumeOf(wedge), WithinRel(3000.0, 1e-9));

  const ImplantSurface screw = shapeOf("screw").surface(std::array{30.0, 4.5});
  double below = 0.0, shaft = 0.0;
  for (const Vec3 &at : screw.positions_mm) {
    below = std::min(below, at[2]);
    if (at[2] < -1.0) shaft = std::max(shaft, at.head<2>().norm());
  }
  CHECK(screw.contactPlane_mm == 0.0);
  CHECK(below == -30.0);
  CHECK_THAT(shaft, WithinAbs(2.25, 0.05));
}
