// SPDX-License-Identifier: Apache-2.0
// The surface of a body as contact sees it.
#include <algorithm>
#include <utility>
#include <vector>

#include "contact/contact_skin.h"
#include "shapes.h"
#include "support/catch.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;
using Catch::Matchers::WithinRel;

TEST_CASE("faces beside a sharp edge know each other, although each has a vertex of its own there") {
  const auto body = block(Vec3::Zero(), Vec3::Constant(0.05), 0.01, soft(1e4, 0.3), 6);
  const RestState &rest = body->rest();
  const Interpolation vertices = rest.surfels.expanded(rest.positions);
  std::size_t doubled = 0;
  for (std::size_t v = 0; v < vertices.count(); ++v)
    for (std::size_t w = 0; w < v; ++w)
      doubled += (vertices.positions[v] - vertices.positions[w]).norm() < 1e-9 ? 1 : 0;
  REQUIRE(doubled > 0);
  const auto skin = detail::makeContactSkin(vertices, rest.skin, {rest.spacing}, rest.bind, rest.maxInfluence);
  for (const detail::SkinEdge &edge : skin->edges) REQUIRE(edge.triangles[1] != detail::kNoTriangle);
  double area = 0.0;
  for (const double a : skin->areas) area += a;
  CHECK_THAT(area, WithinRel(6.0 * 0.05 * 0.05, 1e-9));
}

TEST_CASE("a coarse contact skin is closed, lies on the drawn one, and its vertices are some of the same points") {
  // A ball with edges of a tenth of a spacing.
  const double radius = 0.03;
  const auto body = ball(Vec3::Zero(), radius, 0.02, soft(1e4, 0.3), 60);
  const RestState &rest = body->rest();
  const Interpolation drawn = rest.surfels.expanded(rest.positions);
  const detail::SkinResolution asDrawn{0.75 * rest.spacing},
      coarse{0.75 * rest.spacing, 0.5 * rest.spacing, 0.05 * rest.spacing};
  const auto fine = detail::makeContactSkin(drawn, rest.skin, asDrawn, rest.bind, rest.maxInfluence);
  const auto skin = detail::makeContactSkin(drawn, rest.skin, coarse, rest.bind, rest.maxInfluence);
  REQUIRE(fine->triangles.size() == rest.skin.size());
  CHECK(10 * skin->triangles.size() < fine->triangles.size());
  for (const detail::SkinEdge &edge : skin->edges) REQUIRE(edge.triangles[1] != detail::kNoTriangle);
  std::size_t shared = 0;
  double farthest = 0.0;
  for (std::size_t v = 0; v < skin->count(); ++v) {
    REQUIRE(skin->areas[v] > 0.0);  // every remaining vertex has a triangle
    const Vec3 x = skin->vertices.positions[v];
    const auto same = std::find(drawn.positions.begin(), drawn.positions.end(), x);
    if (same == drawn.positions.end()) continue;
    ++shared;
    // Bound as before.
    const auto p = static_cast<std::size_t>(same - drawn.positions.begin());
    Vec3 before = Vec3::Zero(), now = Vec3::Zero();
    for (Index e = drawn.phyxels.offsets[p]; e < drawn.phyxels.offsets[p + 1]; ++e)
      before += drawn.weights[e] * rest.positions[drawn.phyxels.indices[e]];
    for (Index e = skin->vertices.phyxels.offsets[v]; e < skin->vertices.phyxels.offsets[v + 1]; ++e)
      now += skin->vertices.weights[e] * rest.positions[skin->vertices.phyxels.indices[e]];
    REQUIRE((before - now).norm() < 1e-12);
  }
  CHECK(shared > skin->count() / 3);  // others halve long edges
  for (const auto &[a, b, c] : skin->triangles) {
    const std::vector<Vec3> &x = skin->vertices.positions;
    for (const auto &[p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      REQUIRE((x[p] - x[q]).norm() < 0.75 * rest.spacing * (1.0 + 1e-6));
    farthest = std::max(farthest, radius - ((x[a] + x[b] + x[c]) / 3.0).norm());
  }
  // The limit is a root mean square of all deviations given up around a vertex.
  CHECK(farthest < 3.0 * coarse.deviation);
  // However large the permitted deviation, some contact surface remains.
  const auto least = detail::makeContactSkin(drawn, rest.skin, {1.0, 1.0, 1.0}, rest.bind, rest.maxInfluence);
  CHECK(least->triangles.size() >= 2);
  // A surface that is already as coarse is unchanged.
  const auto again = detail::makeContactSkin(drawn, rest.skin, {1.0, 1e-6, 1.0}, rest.bind, rest.maxInfluence);
  CHECK(again->triangles.size() == fine->triangles.size());
}
