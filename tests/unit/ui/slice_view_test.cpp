// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/slice_view.h"

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
using imaging::VolumeGeometry;

namespace {

VolumeGeometry plain() { return {{100, 120, 50}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0, -50, -60, -70, 1}}; }

/// Rotated by 20° about z and 15° about x, 0.5 x 0.7 x 2 mm.
VolumeGeometry oblique() {
  const double c = std::cos(0.349), s = std::sin(0.349), d = std::cos(0.262), e = std::sin(0.262);
  const Vec3 x{c, s, 0}, y{-s * d, c * d, e}, z{s * e, -c * e, d};
  return {{200, 180, 60},
          {0.5 * x[0], 0.5 * x[1], 0.5 * x[2], 0, 0.7 * y[0], 0.7 * y[1], 0.7 * y[2], 0, 2.0 * z[0], 2.0 * z[1],
           2.0 * z[2], 0, -30, -80, -40, 1}};
}

void checkNear(const Vec3 &a, const Vec3 &b, double tolerance = 1e-9) {
  for (std::size_t k = 0; k < 3; ++k) CHECK_THAT(a[k], WithinAbs(b[k], tolerance));
}

SliceView viewOf(SliceAxis axis, const VolumeGeometry &grid, Convention convention = Convention::radiological) {
  SliceView view;
  view.setGrid(grid);
  view.setSize(300, 200);
  view.setFrame(sliceFrame(axis, convention, &grid));
  view.reset();
  return view;
}

std::string sides(const SliceFrame &frame) {
  return orientationLetters(-1.0 * frame.right) + "|" + orientationLetters(frame.right) + "|" +
         orientationLetters(-1.0 * frame.down) + "|" + orientationLetters(frame.down);
}

}  // namespace

TEST_CASE("Radiological views have the patient's right on the left, neurological ones on the right", "[slice_view]") {
  using enum Convention;
  CHECK(sides(sliceFrame(SliceAxis::axial, radiological, nullptr)) == "R|L|A|P");
  CHECK(sides(sliceFrame(SliceAxis::coronal, radiological, nullptr)) == "R|L|S|I");
  CHECK(sides(sliceFrame(SliceAxis::sagittal, radiological, nullptr)) == "A|P|S|I");
  CHECK(sides(sliceFrame(SliceAxis::axial, neurological, nullptr)) == "L|R|A|P");
  CHECK(sides(sliceFrame(SliceAxis::coronal, neurological, nullptr)) == "L|R|S|I");
  CHECK(sides(sliceFrame(SliceAxis::sagittal, neurological, nullptr)) == "A|P|S|I");
}

TEST_CASE("Letters follow the direction, two when it is oblique", "[slice_view]") {
  CHECK(orientationLetters({1, 0, 0}) == "L");
  CHECK(orientationLetters({-2, 0.1, 0}) == "R");
  CHECK(orientationLetters({0.1, -5, 0.2}) == "A");
  CHECK(orientationLetters({0, 0.5, -0.8}) == "IP");
  CHECK(orientationLetters({-0.7, 0, 0.6}) == "RS");
  CHECK(orientationLetters({0.6, 0.6, 0}) == "LP");
  CHECK(orientationLetters({0, 0, 0}).empty());
}

TEST_CASE("Views follow the axes of the image that are nearest to the patient's, however they are stored",
          "[slice_view]") {
  // i runs to the feet, j to the right, k to the front: left-handed.
  const VolumeGeometry stored{{40, 50, 60}, {0, 0, -1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1}};
  CHECK(sides(sliceFrame(SliceAxis::axial, Convention::radiological, &stored)) == "R|L|A|P");
  const VolumeGeometry turned = oblique();
  const SliceFrame axial = sliceFrame(SliceAxis::axial, Convention::radiological, &turned);
  checkNear(axial.forward, {std::sin(0.349) * std::sin(0.262), -std::cos(0.349) * std::sin(0.262), std::cos(0.262)});
  CHECK(sides(axial) == "RA|LP|AL|PR");
  CHECK_THAT(dot(axial.right, axial.down), WithinAbs(0.0, 1e-12));
  // Sheared as by a tilted gantry: still orthogonal.
  VolumeGeometry tilted = plain();
  tilted.indexToWorld[9] = 0.7;
  for (const SliceAxis axis : {SliceAxis::axial, SliceAxis::sagittal, SliceAxis::coronal}) {
    const SliceFrame f = sliceFrame(axis, Convention::radiological, &tilted);
    CHECK_THAT(dot(f.right, f.down), WithinAbs(0.0, 1e-12));
    checkNear(f.normal(), dot(f.normal(), f.forward) * f.forward);
  }
}

TEST_CASE("Pixels and world points lead to each other, after zoom and pan too", "[slice_view]") {
  for (const VolumeGeometry &grid : {plain(), oblique()}) {
    SliceView view = viewOf(SliceAxis::coronal, grid);
    view.zoom(4.0, 30.0, 150.0);
    view.pan(-17.0, 42.0);
    for (const auto &[x, y] : {std::pair{0.0, 0.0}, {12.5, 190.0}, {300.0, 77.0}}) {
      const Vec3 world = view.worldAt(x, y);
      const SliceView::Pixel back = view.pixelOf(world);
      CHECK_THAT(back.x, WithinAbs(x, 1e-9));
      CHECK_THAT(back.y, WithinAbs(y, 1e-9));
      const render::SlicePlane plane = view.plane();
      checkNear(plane.origin + x * plane.right + y * plane.down, world);
      CHECK(view.isOnSlice(world));
    }
  }
}

TEST_CASE("The point under the mouse stays there while zooming, and a pan moves with the hand", "[slice_view]") {
  SliceView view = viewOf(SliceAxis::axial, plain());
  const Vec3 under = view.worldAt(40, 60);
  const double before = view.millimetresPerPixel();
  view.zoom(3.0, 40, 60);
  CHECK_THAT(view.millimetresPerPixel(), WithinAbs(before * 0.9 * 0.9 * 0.9, 1e-12));
  checkNear(view.worldAt(40, 60), under);
  view.pan(25, -10);
  checkNear(view.worldAt(65, 50), under);
}

TEST_CASE("A whole image fills the view until somebody zooms", "[slice_view]") {
  SliceView view = viewOf(SliceAxis::axial, plain());  // 100 x 120 mm in 300 x 200 pixels
  CHECK_THAT(view.millimetresPerPixel(), WithinAbs(1.04 * 120.0 / 200.0, 1e-9));
  view.setSize(600, 400);
  CHECK_THAT(view.millimetresPerPixel(), WithinAbs(1.04 * 120.0 / 400.0, 1e-9));
  view.zoom(1.0, 300, 200);
  const double zoomed = view.millimetresPerPixel();
  view.setSize(300, 200);
  CHECK(view.millimetresPerPixel() == zoomed);
  view.reset();
  CHECK_THAT(view.millimetresPerPixel(), WithinAbs(1.04 * 120.0 / 200.0, 1e-9));
}

TEST_CASE("Slices go from voxel to voxel along the view, and end with the image", "[slice_view]") {
  SliceView axial = viewOf(SliceAxis::axial, plain());
  CHECK(axial.sliceCount() == 50);
  CHECK(axial.step() == 3.0);
  CHECK(axial.slice() == 24);
  const auto height = [&] { return axial.worldAt(7, 9)[2]; };
  CHECK_THAT(height(), WithinAbs(-70.0 + 3.0 * 24, 1e-9));
  axial.scroll(1);
  CHECK_THAT(height(), WithinAbs(-70.0 + 3.0 * 25, 1e-9));
  axial.scroll(1000);
  CHECK_THAT(height(), WithinAbs(-70.0 + 3.0 * 49, 1e-9));
  axial.scroll(-1000);
  CHECK_THAT(height(), WithinAbs(-70.0, 1e-9));

  const VolumeGeometry grid = oblique();
  SliceView own = viewOf(SliceAxis::axial, grid);
  CHECK(own.sliceCount() == 60);
  CHECK_THAT(own.step(), WithinAbs(2.0, 1e-9));
  own.showSlice(11);
  const Vec3 index = transformPoint(imaging::affineInverse(grid.indexToWorld), own.worldAt(100, 20));
  CHECK_THAT(index[2], WithinAbs(11.0, 1e-9));

  // Across the image: no voxel is skipped, and all of it can be reached.
  SliceView across;
  across.setGrid(grid);
  across.setFrame(sliceFrame(SliceAxis::axial, Convention::radiological, nullptr));
  CHECK(across.step() <= 2.0 / std::cos(0.262) + 1e-9);
  across.showSlice(0);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3 at = grid.worldAt({corner & 1 ? 199.0 : 0.0, corner & 2 ? 179.0 : 0.0, corner & 4 ? 59.0 : 0.0});
    across.showPoint(at);
    CHECK(across.isOnSlice(at));
  }
}

TEST_CASE("A point shows in the nearest slice only", "[slice_view]") {
  SliceView view = viewOf(SliceAxis::sagittal, plain());
  const Vec3 point{12.3, 4.0, 5.0};
  view.showPoint(point);
  CHECK(view.isOnSlice(point));
  CHECK(view.slice() == 62);  // x = -50 + 62
  view.scroll(1);
  CHECK_FALSE(view.isOnSlice(point));
  view.scroll(-1);
  CHECK(view.isOnSlice(point));
}

TEST_CASE("The scale bar has a round length that fits", "[slice_view]") {
  CHECK(scaleBar(0.5, 120).text == "5 cm");
  CHECK_THAT(scaleBar(0.5, 120).length_px, WithinAbs(100.0, 1e-9));
  CHECK(scaleBar(0.5, 99).text == "2 cm");
  CHECK(scaleBar(0.02, 100).text == "2 mm");
  CHECK(scaleBar(0.0021, 100).text == "200 µm");
  CHECK(scaleBar(0.1, 100).text == "1 cm");
  CHECK(scaleBar(0.0, 100).text.empty());
}
