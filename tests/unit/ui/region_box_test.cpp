// SPDX-License-Identifier: Apache-2.0
#include "logic/region_box.h"

#include <algorithm>
#include <string>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

using Kind = BoxGrip::Kind;
constexpr double kSize_px = 10.0;

/// 100 x 80 x 60 voxels of 1 x 1 x 2 mm from 0.
const imaging::VolumeGeometry kGrid{{100, 80, 60}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0.5, 0.5, 1, 1}};
const Box kLimits{{{0, 0, 0}, {100, 80, 120}}};
const Vec3 kVoxel{1, 1, 2};

SliceView viewOf(SliceAxis axis, Convention convention = Convention::radiological) {
  SliceView view;
  view.setGrid(kGrid);
  view.setSize(400, 400);
  view.setFrame(sliceFrame(axis, convention, nullptr));
  view.reset();
  return view;
}

void drag(RegionBox &box, const BoxGrip &grip, const Vec3 &from, const Vec3 &to) {
  box.begin(grip, from);
  box.dragTo(0.5 * (from + to));
  box.dragTo(to);
  box.finish();
}

/// As a user does it: from a pixel to one at this distance in the world.
void dragIn(const SliceView &view, RegionBox &box, double x, double y, const Vec3 &by) {
  const Vec3 from = view.worldAt(x, y);
  drag(box, gripAt(view, box, kSize_px, x, y), from, from + by);
}

BoxHandle handleOf(const SliceView &view, const RegionBox &box, const std::string &name) {
  for (const BoxHandle &handle : boxHandles(view, box, kSize_px))
    if (handle.name == name) return handle;
  FAIL("there is no handle " + name);
  return {};
}

bool hasHandle(const SliceView &view, const RegionBox &box, const std::string &name) {
  const auto handles = boxHandles(view, box, kSize_px);
  return std::any_of(handles.begin(), handles.end(), [&](const BoxHandle &h) { return h.name == name; });
}

void checkBox(const RegionBox &box, const Vec3 &low, const Vec3 &high) {
  for (std::size_t a = 0; a < 3; ++a) {
    CAPTURE(a);
    CHECK_THAT(box.box()[0][a], WithinAbs(low[a], 1e-9));
    CHECK_THAT(box.box()[1][a], WithinAbs(high[a], 1e-9));
  }
}

}  // namespace

TEST_CASE("A region is put in order and within its limits, and is a voxel wide at least", "[region_box]") {
  checkBox(RegionBox(kLimits, kVoxel), {0, 0, 0}, {100, 80, 120});
  checkBox(RegionBox(kLimits, kVoxel, Box{{{90, -30, 7}, {20, 40, 7.5}}}), {20, 0, 7}, {90, 40, 9});
  // Beyond an end, one voxel remains.
  checkBox(RegionBox(kLimits, kVoxel, Box{{{200, 0, -9}, {300, 80, -5}}}), {99, 0, 0}, {100, 80, 2});
  CHECK(RegionBox(kLimits, kVoxel, Box{{{10, 20, 30}, {30, 50, 70}}}).volume_ml() == Approx(24.0));
}

TEST_CASE("Sides follow the drag, stop at the limits and never cross", "[region_box]") {
  RegionBox box(kLimits, kVoxel, Box{{{20, 20, 20}, {60, 60, 60}}});
  drag(box, {Kind::sides, {-1, 0, 1}}, {20, 5, 60}, {33.333, 70, 50.04});
  checkBox(box, {33.3, 20, 20}, {60, 60, 50});  // to tenths of a millimetre
  drag(box, {Kind::sides, {1, 0, 0}}, {60, 0, 0}, {-40, 0, 0});
  checkBox(box, {33.3, 20, 20}, {34.3, 60, 50});
  drag(box, {Kind::sides, {0, 0, -1}}, {0, 0, 20}, {0, 0, 400});
  checkBox(box, {33.3, 20, 48}, {34.3, 60, 50});
  drag(box, {Kind::sides, {0, -1, 0}}, {0, 20, 0}, {0, -50, 0});
  drag(box, {Kind::sides, {0, 1, 0}}, {0, 60, 0}, {0, 400, 0});
  checkBox(box, {33.3, 0, 48}, {34.3, 80, 50});
}

TEST_CASE("A box that is moved keeps its size, also at the limits", "[region_box]") {
  RegionBox box(kLimits, kVoxel, Box{{{20, 20, 20}, {60, 45.5, 60}}});
  drag(box, {Kind::whole, {1, 1, 0}}, {40, 40, 40}, {55, 30, 90});
  checkBox(box, {35, 10, 20}, {75, 35.5, 60});
  drag(box, {Kind::whole, {1, 1, 0}}, {40, 40, 40}, {400, -400, 40});
  checkBox(box, {60, 0, 20}, {100, 25.5, 60});
}

TEST_CASE("A box that is drawn lies between begin and end, in the plane of the drag only", "[region_box]") {
  RegionBox box(kLimits, kVoxel, Box{{{20, 20, 20}, {60, 60, 60}}});
  drag(box, {Kind::drawn, {0, 1, 1}}, {5, 70, 100}, {5, 12, 84});
  checkBox(box, {20, 12, 84}, {60, 70, 100});
  drag(box, {Kind::drawn, {0, 1, 1}}, {5, -20, 119.8}, {5, -10, 119.9});
  checkBox(box, {20, 0, 118}, {60, 1, 120});
}

TEST_CASE("Drags of a region are undone and redone one by one, and a drag in progress is taken back", "[region_box]") {
  RegionBox box(kLimits, kVoxel);
  CHECK_FALSE(box.canUndo());
  drag(box, {Kind::sides, {-1, 0, 0}}, {0, 0, 0}, {30, 0, 0});
  drag(box, {Kind::sides, {0, 0, 1}}, {0, 0, 120}, {0, 0, 90});
  drag(box, {Kind::sides, {0, 0, 1}}, {0, 0, 90}, {0, 0, 90});  // changes nothing: no step
  box.begin({Kind::sides, {1, 0, 0}}, {100, 0, 0});
  box.dragTo({50, 0, 0});
  REQUIRE(box.grip() != nullptr);
  box.takeBack();
  CHECK(box.grip() == nullptr);
  checkBox(box, {30, 0, 0}, {100, 80, 90});
  box.undo();
  checkBox(box, {30, 0, 0}, {100, 80, 120});
  box.undo();
  checkBox(box, {0, 0, 0}, {100, 80, 120});
  CHECK_FALSE(box.canUndo());
  box.redo();
  box.redo();
  checkBox(box, {30, 0, 0}, {100, 80, 90});
  CHECK_FALSE(box.canRedo());
  box.takeAll();
  checkBox(box, {0, 0, 0}, {100, 80, 120});
  box.undo();
  checkBox(box, {30, 0, 0}, {100, 80, 90});
  drag(box, {Kind::sides, {-1, 0, 0}}, {0, 0, 0}, {5, 0, 0});
  CHECK_FALSE(box.canRedo());
}

TEST_CASE("Sides are at round numbers that are finer than the voxels", "[region_box]") {
  const auto draggedTo = [](double voxel_mm, double at) {
    RegionBox box({{{0, 0, 0}, {100, 100, 100}}}, {voxel_mm, voxel_mm, voxel_mm});
    drag(box, {Kind::sides, {-1, 0, 0}}, {0, 0, 0}, {at, 0, 0});
    return box.box()[0][0];
  };
  CHECK(draggedTo(8.0, 12.3456) == 12.0);
  CHECK(draggedTo(1.0, 12.3456) == 12.3);
  CHECK(draggedTo(0.03, 12.3456) == 12.346);
}

TEST_CASE("A handle changes the sides that it lies at, in each view and convention", "[region_box]") {
  const Box start{{{30, 20, 40}, {70, 60, 80}}};
  RegionBox box(kLimits, kVoxel, start);
  const SliceView axial = viewOf(SliceAxis::axial), mirrored = viewOf(SliceAxis::axial, Convention::neurological),
                  coronal = viewOf(SliceAxis::coronal), sagittal = viewOf(SliceAxis::sagittal);
  CHECK(handleOf(axial, box, "left").grip.sides == std::array<int, 3>{-1, 0, 0});
  CHECK(handleOf(mirrored, box, "left").grip.sides == std::array<int, 3>{1, 0, 0});
  CHECK(handleOf(axial, box, "bottom_right").grip.sides == std::array<int, 3>{1, 1, 0});
  CHECK(handleOf(coronal, box, "top").grip.sides == std::array<int, 3>{0, 0, 1});
  CHECK(handleOf(sagittal, box, "bottom_left").grip.sides == std::array<int, 3>{0, -1, -1});
  CHECK(boxHandles(axial, box, kSize_px).size() == 9);

  const BoxHandle corner = handleOf(coronal, box, "top_right");
  CHECK(directionOf(coronal, corner.grip) == std::array<int, 2>{1, -1});
  CHECK(directionOf(mirrored, handleOf(mirrored, box, "left").grip) == std::array<int, 2>{-1, 0});
  dragIn(coronal, box, corner.x + 6, corner.y - 6, {-10, 0, 20});
  checkBox(box, {30, 20, 40}, {60, 60, 100});
}

TEST_CASE("Inside and on its outline a box is moved, outside another one is drawn", "[region_box]") {
  const SliceView axial = viewOf(SliceAxis::axial);
  const RegionBox box(kLimits, kVoxel, Box{{{30, 20, 40}, {70, 60, 80}}});
  const BoxInSlice at = boxInSlice(axial, box.box());
  const double quarter = 0.25 * (at.bottom - at.top);
  const auto grip = [&](double x, double y) { return gripAt(axial, box, kSize_px, x, y); };
  CHECK(grip(at.left + 20, at.top + quarter).kind == Kind::whole);
  CHECK(grip(at.left - 3, at.top + quarter).kind == Kind::whole);
  CHECK(grip(at.left - 5, at.top + quarter).kind == Kind::drawn);
  CHECK(grip(at.left - 5, at.top + quarter).sides == std::array<int, 3>{1, 1, 0});
  CHECK(grip(at.left - 7, at.top + 7).kind == Kind::sides);
  // With no free space in this slice, another region is drawn inside, and there is no handle.
  const RegionBox whole(kLimits, kVoxel), slab(kLimits, kVoxel, Box{{{0, 0, 40}, {100, 80, 80}}});
  CHECK(gripAt(axial, whole, kSize_px, 150, 150).kind == Kind::drawn);
  CHECK(gripAt(axial, slab, kSize_px, 150, 150).kind == Kind::drawn);
  CHECK_FALSE(hasHandle(axial, slab, "middle"));
  CHECK(gripAt(viewOf(SliceAxis::coronal), slab, kSize_px, 150, 200).kind == Kind::whole);
}

TEST_CASE("A small box has corners only, and handles stand where its edges are seen", "[region_box]") {
  SliceView axial = viewOf(SliceAxis::axial);
  const RegionBox small(kLimits, kVoxel, Box{{{50, 40, 60}, {52, 70, 62}}});
  CHECK_FALSE(hasHandle(axial, small, "top"));
  CHECK(hasHandle(axial, small, "left"));
  const RegionBox box(kLimits, kVoxel, Box{{{10, 10, 0}, {90, 70, 120}}});
  axial.zoom(10, 0, 0);
  const BoxHandle top = handleOf(axial, box, "top");
  CHECK(top.x > handleOf(axial, box, "top_left").x);
  CHECK(top.x < 400);
  CHECK(handleOf(axial, box, "top_right").x > 400);
}

TEST_CASE("It is told whether a slice goes through the box", "[region_box]") {
  SliceView axial = viewOf(SliceAxis::axial);
  const Box box{{{30, 20, 40}, {70, 60, 80}}};
  axial.showPoint({0, 0, 41});
  CHECK(boxInSlice(axial, box).isCut);
  axial.showPoint({0, 0, 39});
  const BoxInSlice beside = boxInSlice(axial, box);
  CHECK_FALSE(beside.isCut);
  CHECK_THAT(axial.worldAt(beside.left, beside.bottom)[0], WithinAbs(30.0, 1e-9));
  CHECK_THAT(axial.worldAt(beside.left, beside.bottom)[1], WithinAbs(60.0, 1e-9));
}
