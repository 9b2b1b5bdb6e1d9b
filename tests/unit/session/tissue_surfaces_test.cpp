// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_surfaces.h"

#include <cmath>

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;

namespace {

// A cube of 40 mm in voxels of 1 mm: a hollow ball of 15 mm in a background, over a rigid plate; a speck next to it.
TissueVoxels cube() {
  auto map = std::make_shared<imaging::LabelMap>();
  map->geometry.size = {40, 40, 40};
  map->geometry.indexToWorld[12] = map->geometry.indexToWorld[13] = map->geometry.indexToWorld[14] = 0.5;
  for (std::size_t v = 0; v < 64000; ++v) {
    const Vec3 x = map->geometry.worldAt({double(v % 40), double(v / 40 % 40), double(v / 1600)});
    const double r = norm(x - Vec3{20, 20, 22});
    map->voxels.push_back(x[2] < 5.0 ? 2 : r < 15.0 && r > 4.0 ? 1 : 3);
  }
  map->voxels[0] = 1;
  TissueVoxels places;
  places.body = "body";
  places.voxel_mm3 = 1.0;
  places.tissues.resize(2);
  places.tissues[0].label = "liver";
  places.tissues[1].label = "bone";
  places.tissues[1].isRigid = true;
  places.labels.push_back({"liver left", 1, 0, 4000, {1.0f, 0.0f, 0.0f}, {}});
  places.labels.push_back({"liver right", 2, 0, 9000, {0.0f, 1.0f, 0.0f}, {}});
  places.labels.push_back({"spine", 3, 1, 8000, {0.0f, 0.0f, 1.0f}, {}});
  places.map = map;
  return places;
}

TissueSnapshot turned(double angle) {
  auto u = std::make_shared<imaging::DisplacementGrid>();
  u->geometry.size = {31, 31, 31};
  u->geometry.indexToWorld = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -10, -10, -10, 1};
  for (std::size_t v = 0; v < u->geometry.voxelCount(); ++v) {
    const Vec3 x = u->geometry.worldAt({double(v % 31), double(v / 31 % 31), double(v / 961)});
    const double c = std::cos(angle), s = std::sin(angle), dx = x[0] - 20.0, dy = x[1] - 20.0;
    u->xyz_mm.insert(u->xyz_mm.end(), {float(dx - c * dx - s * dy), float(dy + s * dx - c * dy), 0.0f});
  }
  u->gap_mm.assign(u->geometry.voxelCount(), 0.0f);
  return {u, {}};
}

}  // namespace

TEST_CASE("Tissues have surfaces around their voxels, without cavities and specks, coloured as their largest label",
          "[tissue_surfaces]") {
  TissueVoxels places = cube();
  places.placement.position_m = {0.1, 0.0, 0.0};
  auto made = tissueSurfaces({places}, {});
  REQUIRE(made);
  REQUIRE(made->size() == 2);
  const TissueSurface &liver = made->front(), &bone = made->back();
  CHECK((liver.body == "body" && liver.name == "liver" && !liver.isRigid));
  CHECK((bone.name == "bone" && bone.isRigid));
  const double ball = 4.0 / 3.0 * 3.14159265 * 15.0 * 15.0 * 15.0;
  CHECK(geometry::signedVolume(liver.reference) == Approx(ball).epsilon(0.02));
  CHECK(geometry::signedVolume(bone.reference) == Approx(40.0 * 40.0 * 5.0).epsilon(0.02));
  for (const Vec3 &x : liver.reference.vertices) REQUIRE(std::abs(norm(x - Vec3{120, 20, 22}) - 15.0) < 1.0);
  CHECK(liver.colour[1] > 0.9f);
  CHECK(liver.colour[0] == 0.0f);
  CHECK(bone.colour[2] > 0.5f);
  CHECK(bone.colour[0] > bone.colour[2]);
  // The scene may override it.
  places.tissues[0].colour = Vec3{0.5, 0.25, 0.75};
  places.tissues[1].isShown = false;
  made = tissueSurfaces({places}, {});
  REQUIRE(made);
  REQUIRE(made->size() == 1);
  CHECK(made->front().colour == std::array<float, 3>{0.5f, 0.25f, 0.75f});
  const auto ended = tissueSurfaces({places}, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(ended);
  CHECK(ended.error().code == ErrorCode::cancelled);
}

TEST_CASE("Surfaces go where their tissue has gone, from where they were", "[tissue_surfaces]") {
  auto made = tissueSurfaces({cube()}, {});
  REQUIRE(made);
  const auto surfaces = std::make_shared<const std::vector<TissueSurface>>(std::move(*made));
  SurfacePositions before;
  // A rotation of 90 degrees in two steps; also at once from the rest position.
  for (const double angle : {0.7, 1.5707963}) {
    for (const bool isKnown : {true, false}) {
      const bool hasBefore = isKnown && before.of != nullptr;
      auto now = followSurfaces(turned(angle), surfaces, hasBefore ? &before : nullptr);
      REQUIRE(now);
      REQUIRE(now->vertices.size() == 2);
      CHECK(now->vertices[1].empty());  // rigid
      const auto &vertices = surfaces->front().reference.vertices;
      REQUIRE(now->vertices[0].size() == vertices.size());
      for (std::size_t v = 0; v < vertices.size(); ++v) {
        const double c = std::cos(angle), s = std::sin(angle), dx = vertices[v][0] - 20.0, dy = vertices[v][1] - 20.0;
        REQUIRE(std::abs(double(now->vertices[0][v][0]) - (20.0 + c * dx - s * dy)) < 0.05);
        REQUIRE(std::abs(double(now->vertices[0][v][1]) - (20.0 + s * dx + c * dy)) < 0.05);
        REQUIRE(std::abs(double(now->vertices[0][v][2]) - vertices[v][2]) < 0.05);
      }
      if (isKnown) before = std::move(*now);
    }
  }
  CHECK_FALSE(followSurfaces(turned(0.0), surfaces, nullptr, [] { return false; }));
}
