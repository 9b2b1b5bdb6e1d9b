// SPDX-License-Identifier: Apache-2.0
#include "logic/region_drawing.h"

#include "../segmentation/workflow_fixture.h"
#include "c3de/abi/tools.h"

using namespace c3de;
using namespace c3de::segmentation;
using namespace c3de::segmentation::test;
using namespace c3de::ui;
using Input = ViewInput::Kind;

namespace {

/// The scan of the fixture, its grid rotated about z by this angle, in slices of its size.
struct Slices : Fixture {
  ImageViews views;

  explicit Slices(double turned_rad = 0.0) {
    auto image = std::make_shared<scene::StoredImage>(*sources.image);
    auto labels = std::make_shared<scene::StoredLabels>(*sources.labels);
    const double c = 5.0 * std::cos(turned_rad), s = 5.0 * std::sin(turned_rad);
    image->volume.geometry.indexToWorld = {c, s, 0, 0, -s, c, 0, 0, 0, 0, 5, 0, 0, 0, 0, 1};
    labels->map.geometry = image->volume.geometry;
    views.setImage(image);
    for (const Pane pane : kSlicePanes) views.view(pane).setSize(500, 500);
    scan.setSources({image, "ct.nii.gz", "", "labels.nii.gz", {labels}});
    scan.show(true);
    settle();
  }
  void at(RegionDrawing &drawing, Pane pane, Input kind, const Vec3 &world, std::uint32_t button = C3DE_BUTTON_LEFT,
          std::uint32_t modifiers = 0) {
    const SliceView::Pixel pixel = views.view(pane).pixelOf(world);
    ViewInput input;
    input.kind = kind;
    input.x = pixel.x;
    input.y = pixel.y;
    input.button = button;
    input.modifiers = modifiers;
    isTaken = drawing.handle(pane, input);
  }
  void drag(RegionDrawing &drawing, Pane pane, const Vec3 &from, const Vec3 &to) {
    at(drawing, pane, Input::press, from);
    at(drawing, pane, Input::move, 0.5 * (from + to));
    at(drawing, pane, Input::move, to);
    at(drawing, pane, Input::release, to);
  }
  bool isTaken = false;
};

void checkBox(const Box &box, const Vec3 &low, const Vec3 &high) {
  for (std::size_t a = 0; a < 3; ++a) {
    CAPTURE(a);
    CHECK_THAT(box[0][a], WithinAbs(low[a], 1e-6));
    CHECK_THAT(box[1][a], WithinAbs(high[a], 1e-6));
  }
}

}  // namespace

TEST_CASE("A region is drawn in two slices, and the scan has it once it is kept", "[region_drawing]") {
  Slices f;
  RegionDrawing drawing(f.views, f.scan, 10.0);
  checkBox(drawing.region().box(), {-2.5, -2.5, -2.5}, {97.5, 97.5, 97.5});
  f.drag(drawing, Pane::axial, {20, 30, 0}, {60, 80, 0});
  checkBox(drawing.region().box(), {20, 30, -2.5}, {60, 80, 97.5});
  f.drag(drawing, Pane::coronal, {40, 0, 97.5}, {40, 0, 55});
  checkBox(drawing.region().box(), {20, 30, -2.5}, {60, 80, 55});
  CHECK_FALSE(f.scan.settings().region);
  drawing.undo();
  drawing.undo();
  drawing.redo();
  checkBox(drawing.region().box(), {20, 30, -2.5}, {60, 80, 97.5});
  drawing.keep();
  drawing.end();
  REQUIRE(f.scan.settings().region);
  checkBox(*f.scan.settings().region, {20, 30, -2.5}, {60, 80, 97.5});
  f.scan.undo();
  CHECK_FALSE(f.scan.settings().region);
}

TEST_CASE("A click while a region is drawn sets the cross-hair, and other buttons stay the slice's",
          "[region_drawing]") {
  Slices f;
  RegionDrawing drawing(f.views, f.scan, 10.0);
  f.at(drawing, Pane::axial, Input::press, {20, 30, 0});
  CHECK(f.isTaken);
  f.at(drawing, Pane::axial, Input::move, {20.3, 30, 0});  // the mouse is never completely still
  f.at(drawing, Pane::axial, Input::release, {20.3, 30, 0});
  CHECK(f.views.crossHair()[0] == Approx(20.0));
  CHECK_FALSE(drawing.region().canUndo());
  for (const auto &[button, modifiers] : {std::pair{C3DE_BUTTON_MIDDLE, 0},
                                          {C3DE_BUTTON_RIGHT, 0},
                                          {C3DE_BUTTON_LEFT, C3DE_MOD_SHIFT},
                                          {C3DE_BUTTON_LEFT, C3DE_MOD_CTRL}}) {
    f.at(drawing, Pane::axial, Input::press, {20, 30, 0}, static_cast<std::uint32_t>(button),
         static_cast<std::uint32_t>(modifiers));
    CHECK_FALSE(f.isTaken);
    f.at(drawing, Pane::axial, Input::move, {50, 60, 0}, 0, static_cast<std::uint32_t>(modifiers));
    CHECK_FALSE(f.isTaken);
    f.at(drawing, Pane::axial, Input::release, {50, 60, 0}, static_cast<std::uint32_t>(button));
    CHECK_FALSE(f.isTaken);
  }
  // The same for picks and for changes of window and level.
  Vec3 picked{};
  f.views.pickNext([&](const Vec3 &at) { picked = at; });
  f.at(drawing, Pane::axial, Input::press, {20, 30, 0});
  CHECK_FALSE(f.isTaken);
  f.at(drawing, Pane::axial, Input::release, {20, 30, 0});
  f.views.cancelPick();
  ImageOptions options = f.views.options();
  options.isWindowLevelMode = true;
  f.views.setOptions(options);
  f.at(drawing, Pane::axial, Input::press, {20, 30, 0});
  CHECK_FALSE(f.isTaken);
}

TEST_CASE("A drag of a region is taken back while the button is down, and what follows of it is ignored",
          "[region_drawing]") {
  Slices f;
  RegionDrawing drawing(f.views, f.scan, 10.0);
  CHECK_FALSE(drawing.cancelDrag());
  f.at(drawing, Pane::axial, Input::press, {20, 30, 0});
  f.at(drawing, Pane::axial, Input::move, {60, 70, 0});
  CHECK(drawing.region().box()[0][0] == 20.0);
  CHECK(drawing.cancelDrag());
  f.at(drawing, Pane::axial, Input::move, {80, 70, 0});
  f.at(drawing, Pane::axial, Input::release, {80, 70, 0});
  checkBox(drawing.region().box(), {-2.5, -2.5, -2.5}, {97.5, 97.5, 97.5});
  CHECK_FALSE(drawing.region().canUndo());
  // Where the window has lost the mouse, no button release arrives.
  f.at(drawing, Pane::axial, Input::press, {20, 30, 0});
  CHECK(drawing.cancelDrag());
  f.drag(drawing, Pane::axial, {20, 30, 0}, {60, 80, 0});
  CHECK(drawing.region().box()[1][1] == 80.0);
}

TEST_CASE("While a region is drawn slices are along the axes of the patient, and then as they were",
          "[region_drawing]") {
  Slices f(0.4);
  const Vec3 oblique = f.views.view(Pane::axial).frame().right;
  ImageOptions options = f.views.options();
  options.isWindowLevelMode = true;
  f.views.setOptions(options);
  f.views.setMaximised(Pane::space);
  {
    RegionDrawing drawing(f.views, f.scan, 10.0);
    CHECK(drawing.isTurned());
    CHECK(f.views.view(Pane::axial).frame().right == Vec3{1, 0, 0});
    CHECK_FALSE(f.views.options().isWindowLevelMode);
    CHECK_FALSE(f.views.maximised());
    f.drag(drawing, Pane::sagittal, {0, 20, 30}, {0, 50, 70});
    CHECK(drawing.region().box()[0][1] == 20.0);
    CHECK(drawing.region().box()[1][2] == 70.0);
    // The user rotates them back.
    options = f.views.options();
    options.isAlignedWithImage = true;
    f.views.setOptions(options);
    CHECK(drawing.follow());
    CHECK(f.views.view(Pane::axial).frame().right == Vec3{1, 0, 0});
    drawing.end();
  }
  CHECK(f.views.view(Pane::axial).frame().right == oblique);
  CHECK(f.views.options().isWindowLevelMode);

  Slices straight;
  options = straight.views.options();
  options.isAlignedWithImage = false;
  straight.views.setOptions(options);
  RegionDrawing drawing(straight.views, straight.scan, 10.0);
  CHECK_FALSE(drawing.isTurned());
  drawing.end();
  CHECK_FALSE(straight.views.options().isAlignedWithImage);
}

TEST_CASE("A region is drawn as long as its scan is asked about", "[region_drawing]") {
  Slices f;
  RegionDrawing drawing(f.views, f.scan, 10.0);
  CHECK(drawing.follow());
  ScanBody::Sources other = f.scan.sources();
  auto labels = std::make_shared<scene::StoredLabels>(*other.layers.front());
  labels->map.geometry.indexToWorld[12] = 40.0;
  other.layers = {labels};
  f.scan.setSources(other);
  CHECK_FALSE(drawing.follow());
  RegionDrawing again(f.views, f.scan, 10.0);
  CHECK(again.follow());
  f.scan.show(false);
  CHECK_FALSE(again.follow());
}

TEST_CASE("Whoever asks for the dialog while a region is drawn has it there, as drawn", "[region_drawing]") {
  Slices f;
  RegionDrawing drawing(f.views, f.scan, 10.0);
  CHECK(f.scan.isShown());
  CHECK(f.scan.isHiddenTemporarily());
  f.drag(drawing, Pane::axial, {20, 30, 0}, {60, 80, 0});
  CHECK(drawing.follow());
  CHECK_FALSE(f.scan.settings().region);
  f.scan.show(true);
  CHECK_FALSE(drawing.follow());
  drawing.end();
  CHECK(f.scan.isShown());
  CHECK_FALSE(f.scan.isHiddenTemporarily());
  REQUIRE(f.scan.settings().region);
  checkBox(*f.scan.settings().region, {20, 30, -2.5}, {60, 80, 97.5});
}

TEST_CASE("A body that could not be made does not end the drawing of a region, and is told after it",
          "[region_drawing]") {
  Slices f;
  f.scan.setUse({0}, {LabelUse::Kind::material, "liver"});
  f.scan.make();
  f.scan.show(true);
  RegionDrawing drawing(f.views, f.scan, 10.0);
  CHECK(f.scan.finished(fail(ErrorCode::input, "nothing is left")));
  CHECK(drawing.follow());
  drawing.end();
  CHECK(f.scan.isShown());
  CHECK_FALSE(f.scan.isHiddenTemporarily());
  CHECK(f.scan.problem() == "nothing is left");
}

TEST_CASE("While a region is drawn the scan is shown as it was read, and then as bodies have moved it",
          "[region_drawing]") {
  Slices f;
  auto moved = std::make_shared<imaging::DisplacementGrid>();
  moved->geometry = {{2, 2, 2}, {400, 0, 0, 0, 0, 400, 0, 0, 0, 0, 400, 0, -200, -200, -200, 1}};
  for (int i = 0; i < 8; ++i) moved->xyz_mm.insert(moved->xyz_mm.end(), {20.0f, 0.0f, 0.0f});
  moved->fields.push_back({imaging::kVolumeRatio, "1", std::vector<float>(8, 0.9f), 0.9, 0.9});
  ImageHandles handles = f.views.handles();
  handles.displacement = {7, 1};
  f.views.setHandles(handles);
  f.views.setDisplacement(moved);
  ImageOptions options = f.views.options();
  options.overlay = Overlay::volumeChange;
  f.views.setOptions(options);
  const Vec3 at{50, 50, 50};
  const auto isMoved = [&] {
    CHECK_FALSE(f.views.isAtRest());
    CHECK((*f.views.readout(at).index)[0] == 6);
    CHECK(f.views.look().displacement == Handle{7, 1});
    CHECK(f.views.look().overlay == render::Overlay::field);
    CHECK(f.views.wantsFields());
  };
  isMoved();
  RegionDrawing drawing(f.views, f.scan, 10.0);
  CHECK(f.views.isAtRest());
  CHECK((*f.views.readout(at).index)[0] == 10);
  CHECK_FALSE(f.views.readout(at).shift);
  CHECK(f.views.look().displacement.isNull());
  CHECK(f.views.look().overlay == render::Overlay::none);
  CHECK_FALSE(f.views.wantsFields());
  Vec3 picked{};
  f.views.pickNext([&](const Vec3 &reference) { picked = reference; });
  const SliceView::Pixel pixel = f.views.view(Pane::axial).pixelOf({20, 30, 0});
  (void)f.views.handle(Pane::axial, {Input::press, C3DE_BUTTON_LEFT, 0, 0, pixel.x, pixel.y});
  CHECK_THAT(picked[0], WithinAbs(20.0, 1e-6));
  // Bodies move in the meantime.
  f.views.setDisplacement(moved);
  CHECK(f.views.isAtRest());
  drawing.end();
  isMoved();
  f.views.setDisplacement(nullptr);
  RegionDrawing again(f.views, f.scan, 10.0);
  CHECK_FALSE(f.views.isAtRest());
}
