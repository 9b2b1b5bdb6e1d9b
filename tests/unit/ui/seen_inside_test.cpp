// SPDX-License-Identifier: Apache-2.0
// Slices shown as planes in the 3D view: which of them is visible under the mouse.
#include "logic/seen_inside.h"

#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::WithinAbs;

namespace {

/// An image of 100 mm about the origin, with a slice across its centre, viewed from above.
struct Room {
  std::unique_ptr<render::Renderer> renderer = render::createNullRenderer();
  render::GridGeometry place{{100, 100, 100}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -49.5, -49.5, -49.5, 1}};
  render::ImageScene scene;
  Room() { scene.slices.push_back({{0, 0, 0}, {0, 0, 1}}); }
  [[nodiscard]] std::optional<double> seen(const Vec3 &from, const Vec3 &direction = {0, 0, -1}) const {
    return ui::seenInside(*renderer, scene, &place, {from, direction});
  }
  /// A lid over the quarter where x and y are positive, seen from above, 20 mm over the slice.
  Handle cover(float opacity, bool twoSided, bool isTurned = false, bool isInside = false) {
    const std::vector<render::Vec3f> corners{{0, 0, 2}, {10, 0, 2}, {0, 10, 2}, {10, 10, 2}};
    using Triangles = std::vector<Triangle>;
    const Handle lid =
        renderer->createMesh(corners, isTurned ? Triangles{{0, 2, 1}, {1, 2, 3}} : Triangles{{0, 1, 2}, {1, 3, 2}},
                             {{1, 1, 1, opacity}, twoSided, false, isInside});
    renderer->setTransform(lid, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1});
    return lid;
  }
};

}  // namespace

TEST_CASE("A slice is seen within the image, from both sides, and the nearest of several", "[seen_inside]") {
  Room room;
  CHECK_THAT(room.seen({10, 20, 70}).value_or(-1), WithinAbs(70, 1e-9));
  CHECK_THAT(room.seen({10, 20, -30}, {0, 0, 1}).value_or(-1), WithinAbs(30, 1e-9));
  CHECK_FALSE(room.seen({10, 20, -30}));            // behind
  CHECK_FALSE(room.seen({51, 20, 70}));             // outside the image
  CHECK_FALSE(room.seen({10, 20, 70}, {1, 0, 0}));  // along it
  room.scene.slices.push_back({{30, 0, 0}, {1, 0, 0}});
  const Vec3 oblique{0.6, 0, -0.8};
  CHECK_THAT(room.seen({0, 0, 70}, oblique).value_or(-1), WithinAbs(50, 1e-9));
  CHECK_THAT(room.seen({0, 0, 20}, oblique).value_or(-1), WithinAbs(25, 1e-9));
  room.scene.slices.clear();
  CHECK_FALSE(room.seen({10, 20, 70}));
}

TEST_CASE("What is opaque hides a slice, what is transparent, hidden or turned away does not", "[seen_inside]") {
  const Vec3 below{20, 20, 70}, beside{-20, 20, 70};
  Room room;
  const Handle lid = room.cover(1.0f, false);
  CHECK_FALSE(room.seen(below));
  CHECK(room.seen(beside));
  CHECK(room.seen({20, 20, 10}));  // it begins under the lid
  room.renderer->setVisible(lid, false);
  CHECK(room.seen(below));
  CHECK(Room().seen(below));
  Room transparent, turned, both;
  transparent.cover(0.3f, false);
  CHECK(transparent.seen(below));
  turned.cover(1.0f, false, true);
  CHECK(turned.seen(below));
  both.cover(1.0f, true, true);
  CHECK_FALSE(both.seen(below));
}

TEST_CASE("A slice is seen on the face of a cut, where the ray begins, and not where it is cut away", "[seen_inside]") {
  Room room;
  room.scene.cuts.push_back({{0, 0, 0}, {0, 0, 1}});  // without what is above the slice
  CHECK_THAT(room.seen({10, 20, 0}).value_or(-1), WithinAbs(0, 1e-9));
  CHECK_THAT(room.seen({10, 20, -1e-7}).value_or(-1), WithinAbs(0, 1e-9));
  room.scene.cuts.push_back({{5, 0, 0}, {1, 0, 0}});
  CHECK_FALSE(room.seen({10, 20, 0}));
  CHECK(room.seen({0, 20, 0}));
}

TEST_CASE("The surface of a tissue is of the inside, with and without slices behind it", "[seen_inside]") {
  const Vec3 below{20, 20, 70}, beside{-20, 20, 70};
  Room room;
  const Handle organ = room.cover(1.0f, false, false, true);
  CHECK_THAT(room.seen(below).value_or(-1), WithinAbs(50, 1e-6));
  CHECK_THAT(room.seen(beside).value_or(-1), WithinAbs(70, 1e-9));
  room.scene.slices.clear();
  CHECK_THAT(room.seen(below).value_or(-1), WithinAbs(50, 1e-6));
  CHECK_THAT(ui::seenInside(*room.renderer, {}, nullptr, {below, {0, 0, -1}}).value_or(-1), WithinAbs(50, 1e-6));
  CHECK_FALSE(room.seen(beside));
  const Handle skin = room.cover(1.0f, false);
  room.renderer->setTransform(skin, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 10, 1});
  CHECK_FALSE(room.seen(below));
  room.renderer->setMaterial(skin, {{1, 1, 1, 0.4f}});
  CHECK(room.seen(below));
  room.renderer->setVisible(organ, false);
  CHECK_FALSE(room.seen(below));
}
