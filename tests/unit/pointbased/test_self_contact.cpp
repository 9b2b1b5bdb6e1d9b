// SPDX-License-Identifier: Apache-2.0
// A body whose parts touch each other.
#include <array>
#include <map>
#include <utility>

#include "contact_cases.h"
#include "crossing_triangles.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;

namespace {

// Surface of the cubes of `size` for which `inside` holds, in an nx x ny x nz grid.
template <class Inside>
Surface surfaceOfCubes(const std::array<int, 3> &n, double size, const Inside &inside) {
  Surface surface;
  std::map<std::array<int, 3>, Index> numbers;
  const auto vertex = [&](const std::array<int, 3> &at) {
    const auto [found, isNew] = numbers.try_emplace(at, static_cast<Index>(surface.positions.size()));
    if (isNew) surface.positions.push_back(size * Vec3(at[0], at[1], at[2]));
    return found->second;
  };
  const auto isIn = [&](const std::array<int, 3> &c) {
    for (std::size_t a = 0; a < 3; ++a)
      if (c[a] < 0 || c[a] >= n[a]) return false;
    return inside(c[0], c[1], c[2]);
  };
  std::array<int, 3> c{};
  for (c[0] = 0; c[0] < n[0]; ++c[0])
    for (c[1] = 0; c[1] < n[1]; ++c[1])
      for (c[2] = 0; c[2] < n[2]; ++c[2]) {
        if (!isIn(c)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> other = c;
            other[axis] += side == 1 ? 1 : -1;
            if (isIn(other)) continue;
            std::array<Index, 4> corners{};
            for (int k = 0; k < 4; ++k) {
              std::array<int, 3> at = c;
              at[axis] += side;
              at[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
              at[(axis + 2) % 3] += k >= 2 ? 1 : 0;
              corners[static_cast<std::size_t>(k)] = vertex(at);
            }
            if (side == 0) std::swap(corners[1], corners[3]);
            surface.triangles.push_back({corners[0], corners[1], corners[2]});
            surface.triangles.push_back({corners[0], corners[2], corners[3]});
          }
      }
  return surface;
}

}  // namespace

TEST_CASE("the arms of a body that are pressed together touch and do not cross") {
  for (const bool self : {true, false}) {
    Simulator simulator;
    simulator.world().setContact({true, self, 0.1});
    simulator.setWorld({.damping = 10.0});
    // A C: arms of 30 mm, 30 mm apart.
    const Surface surface =
        surfaceOfCubes({12, 9, 3}, 0.01, [](int x, int y, int) { return x < 3 || y < 3 || y >= 6; });
    const Load down{
        .region = HalfSpaceRegion{Vec3(0, 0.0899, 0), Vec3(0, -1, 0)}, .force = Vec3(0, -1.0, 0), .ramp = 0.3};
    const Load up{.region = HalfSpaceRegion{Vec3(0, 0.0001, 0), Vec3(0, 1, 0)}, .force = Vec3(0, 1.0, 0), .ramp = 0.3};
    const std::size_t id = simulator.addBody(bodyOf(shapes::inside(surface), 0.01, soft(5e3, 0.3), {}, {up, down}));
    std::size_t crossed = 0;
    while (simulator.time() < 0.6) {
      REQUIRE(simulator.step());
      if (simulator.steps() % 20 == 0) crossed += shapes::crossings(simulator, id);
    }
    CAPTURE(self, simulator.diagnostics().contacts().size());
    if (!self) {
      CHECK(crossed > 0);  // the tested situation occurs
      continue;
    }
    CHECK(crossed == 0);
    const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
    const ContactSummary *found = between(contacts, id, id);
    REQUIRE(found);
    CHECK(found->normalForce > 0.1);
    CHECK(found->depth < 1e-4);
  }
}

TEST_CASE("a body whose folds its cells do not tell apart does not touch itself, and says so") {
  Simulator simulator;
  simulator.setWorld({.damping = 10.0});
  // A C of arms of 10 mm: 8 mm thick in the mean, of cells of 15 mm.
  const Surface surface = surfaceOfCubes({9, 5, 3}, 0.01, [](int x, int y, int) { return x < 1 || y < 1 || y >= 4; });
  const Load down{
      .region = HalfSpaceRegion{Vec3(0, 0.0499, 0), Vec3(0, -1, 0)}, .force = Vec3(0, -0.5, 0), .ramp = 0.1};
  const Fix foot{.region = HalfSpaceRegion{Vec3(0, 0.001, 0), Vec3(0, 1, 0)}};
  const std::size_t id = simulator.addBody(bodyOf(shapes::inside(surface), 0.015, soft(5e3, 0.3), {foot}, {down}));
  while (simulator.time() < 0.4) REQUIRE(simulator.step());
  CHECK(!between(simulator.diagnostics().contacts(), id, id));
  const auto told = shapes::countEvents(simulator, "warning", "does not touch itself: it is ");
  CHECK(told == 1);
}
