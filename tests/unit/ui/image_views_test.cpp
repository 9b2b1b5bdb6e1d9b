// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/image_views.h"

#include <array>
#include <cmath>
#include <set>

#include "c3de/abi/tools.h"
#include "c3de/ui/commands.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

/// 60 x 80 x 40 voxels of 2 x 1 x 3 mm; value = i + 1000 k, in HU.
std::shared_ptr<scene::StoredImage> testImage() {
  auto image = std::make_shared<scene::StoredImage>();
  imaging::Volume &v = image->volume;
  v.geometry = {{60, 80, 40}, {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0, -60, -40, -60, 1}};
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 80; ++j)
      for (int i = 0; i < 60; ++i) voxels.push_back(static_cast<std::int16_t>(i + 10 * k));
  v.voxels = std::move(voxels);
  v.unit = "HU";
  image->range = imaging::robustRange(v);
  return image;
}

struct Fixture {
  ImageViews views;
  Fixture() {
    views.setImage(testImage());
    for (const Pane pane : kSlicePanes) views.view(pane).setSize(400, 300);
  }
  ViewInput at(ViewInput::Kind kind, double x, double y, std::uint32_t modifiers = 0, std::uint32_t button = 0) {
    ViewInput input;
    input.kind = kind;
    input.x = x;
    input.y = y;
    input.modifiers = modifiers;
    input.button = button;
    return input;
  }
  void drag(Pane pane, double x0, double y0, double x1, double y1, std::uint32_t button, std::uint32_t modifiers = 0) {
    using Kind = ViewInput::Kind;
    views.handle(pane, at(Kind::move, x0, y0, modifiers));
    views.handle(pane, at(Kind::press, x0, y0, modifiers, button));
    views.handle(pane, at(Kind::move, 0.5 * (x0 + x1), 0.5 * (y0 + y1), modifiers));
    views.handle(pane, at(Kind::move, x1, y1, modifiers));
    views.handle(pane, at(Kind::release, x1, y1, modifiers, button));
  }
  bool key(Pane pane, std::uint32_t key, std::uint32_t modifiers = 0) {
    ViewInput input = at(ViewInput::Kind::key, 10, 10, modifiers);
    input.key = key;
    return views.handle(pane, input);
  }
  bool wheel(Pane pane, double steps, std::uint32_t modifiers = 0) {
    ViewInput input = at(ViewInput::Kind::wheel, 100, 90, modifiers);
    input.wheel = steps;
    return views.handle(pane, input);
  }
  SliceView &axial() { return views.view(Pane::axial); }
};

}  // namespace

TEST_CASE("The wheel goes through slices, ten with Shift, and zooms with Ctrl", "[image_views]") {
  Fixture f;
  const int first = f.axial().slice();
  CHECK(f.wheel(Pane::axial, 1));
  CHECK(f.axial().slice() == first + 1);
  f.wheel(Pane::axial, -1, C3DE_MOD_SHIFT);
  CHECK(f.axial().slice() == first - 9);
  const double scale = f.axial().millimetresPerPixel();
  const Vec3 under = f.axial().worldAt(100, 90);
  f.wheel(Pane::axial, 2, C3DE_MOD_CTRL);
  CHECK(f.axial().millimetresPerPixel() < scale);
  CHECK(norm(f.axial().worldAt(100, 90) - under) < 1e-9);
  CHECK(f.views.view(Pane::coronal).slice() == f.views.view(Pane::coronal).slice());
}

TEST_CASE("A click sets the cross-hair, a drag and Shift+move carry it, and the other views follow", "[image_views]") {
  Fixture f;
  const int coronalBefore = f.views.view(Pane::coronal).slice(), axialBefore = f.axial().slice();
  f.drag(Pane::axial, 210, 160, 260, 230, C3DE_BUTTON_LEFT);
  CHECK(norm(f.views.crossHair() - f.axial().worldAt(260, 230)) < 1e-9);
  CHECK(f.axial().slice() == axialBefore);
  for (const Pane pane : kSlicePanes) CHECK(f.views.view(pane).isOnSlice(f.views.crossHair()));
  CHECK(f.views.view(Pane::coronal).slice() != coronalBefore);
  f.views.handle(Pane::coronal, f.at(ViewInput::Kind::move, 90, 40));
  const Vec3 before = f.views.crossHair();
  f.views.handle(Pane::coronal, f.at(ViewInput::Kind::move, 91, 41));
  CHECK(f.views.crossHair() == before);
  f.views.handle(Pane::coronal, f.at(ViewInput::Kind::move, 92, 42, C3DE_MOD_SHIFT));
  CHECK(norm(f.views.crossHair() - f.views.view(Pane::coronal).worldAt(92, 42)) < 1e-9);
  CHECK(f.axial().isOnSlice(f.views.crossHair()));
  // Scrolling away leaves it in place.
  f.wheel(Pane::axial, 3);
  CHECK_FALSE(f.axial().isOnSlice(f.views.crossHair()));
}

TEST_CASE("Middle and Shift+left shift the view, right and Ctrl+left zoom it, and none of them moves the cross-hair",
          "[image_views]") {
  Fixture f;
  const Vec3 cross = f.views.crossHair();
  for (const auto &[button, modifiers] : {std::pair{C3DE_BUTTON_MIDDLE, 0u}, {C3DE_BUTTON_LEFT, C3DE_MOD_SHIFT}}) {
    const Vec3 under = f.axial().worldAt(150, 150);
    // Shift+move would move the cross-hair: the press comes without one.
    f.views.handle(Pane::axial, f.at(ViewInput::Kind::move, 150, 150));
    f.views.handle(Pane::axial, f.at(ViewInput::Kind::press, 150, 150, modifiers, button));
    f.views.handle(Pane::axial, f.at(ViewInput::Kind::move, 170, 140, modifiers));
    f.views.handle(Pane::axial, f.at(ViewInput::Kind::release, 170, 140, modifiers, button));
    CHECK(norm(f.axial().worldAt(170, 140) - under) < 1e-9);
  }
  for (const auto &[button, modifiers] : {std::pair{C3DE_BUTTON_RIGHT, 0u}, {C3DE_BUTTON_LEFT, C3DE_MOD_CTRL}}) {
    const double before = f.axial().millimetresPerPixel();
    const Vec3 under = f.axial().worldAt(60, 200);
    f.drag(Pane::axial, 60, 200, 60, 160, button, modifiers);
    CHECK(f.axial().millimetresPerPixel() < before);
    CHECK(norm(f.axial().worldAt(60, 200) - under) < 1e-9);
  }
  CHECK(f.views.crossHair() == cross);
}

TEST_CASE("Window and level change by a drag in their own mode only", "[image_views]") {
  Fixture f;
  const WindowLevel automatic = f.views.options().windowLevel;
  f.drag(Pane::axial, 100, 100, 180, 60, C3DE_BUTTON_LEFT);
  CHECK(f.views.options().windowLevel == automatic);
  ImageOptions options = f.views.options();
  options.isWindowLevelMode = true;
  f.views.setOptions(options);
  const Vec3 cross = f.views.crossHair();
  f.drag(Pane::axial, 100, 100, 180, 60, C3DE_BUTTON_LEFT);
  const WindowLevel dragged = f.views.options().windowLevel;
  CHECK(dragged.window > automatic.window);  // to the right: wider
  CHECK(dragged.level < automatic.level);    // upwards: brighter
  CHECK(f.views.crossHair() == cross);
  f.drag(Pane::axial, 300, 100, -30000, 100, C3DE_BUTTON_LEFT);
  CHECK(f.views.options().windowLevel.window > 0.0);
  CHECK(f.key(Pane::axial, '0'));
  CHECK(f.views.options().windowLevel == automatic);
}

TEST_CASE("Keys: presets and slices", "[image_views]") {
  Fixture f;
  CHECK(f.key(Pane::axial, '2'));
  CHECK(f.views.options().windowLevel == WindowLevel{1500, -600});
  const int first = f.axial().slice();
  for (const auto &[key, expected] :
       {std::pair<std::uint32_t, int>{keyUp, 1}, {'F', 2}, {keyRight, 3}, {keyDown, 2}, {'B', 1}, {keyLeft, 0}}) {
    CHECK(f.key(Pane::axial, key));
    CHECK(f.axial().slice() == first + expected);
  }
  f.key(Pane::axial, keyUp, C3DE_MOD_SHIFT);
  CHECK(f.axial().slice() == first + 10);
  CHECK_FALSE(f.key(Pane::axial, 'Q'));
  CHECK_FALSE(f.key(Pane::space, '2'));
}

TEST_CASE("No two meanings of a key meet in a slice", "[image_views]") {
  std::set<std::uint32_t> keys;
  for (const WindowLevelPreset &preset : windowLevelPresets()) CHECK(keys.insert(preset.key).second);
  for (const std::uint32_t key : {std::uint32_t{keyUp}, std::uint32_t{keyDown}, std::uint32_t{keyLeft},
                                  std::uint32_t{keyRight}, std::uint32_t{'B'}, std::uint32_t{'F'}})
    CHECK(keys.insert(key).second);
  for (const std::uint32_t key : keys) {
    CHECK(ImageViews::isSliceKey(key, 0));
    CHECK_FALSE(ImageViews::isSliceKey(key, C3DE_MOD_CTRL));  // Ctrl belongs to commands
  }
  for (const Command command :
       {Command::playPause, Command::screenshot, Command::crossHair, Command::windowLevelMode, Command::orbitTool})
    CHECK_FALSE(ImageViews::isSliceKey(commandInfo(command).key, commandInfo(command).modifiers));
  for (const CommandInfo &one : commands())
    for (const CommandInfo &other : commands())
      if (one.command != other.command && one.key != 0)
        CHECK_FALSE((one.key == other.key && one.modifiers == other.modifiers));
}

TEST_CASE("The read-out tells position, voxel, value with unit, label and displacement of the material that is there",
          "[image_views]") {
  Fixture f;
  auto labels = std::make_shared<scene::StoredLabels>();
  labels->map.geometry = {{1, 1, 1}, {20, 0, 0, 0, 0, 20, 0, 0, 0, 0, 20, 0, 0, 0, 0, 1}};
  labels->map.voxels = {4};
  labels->map.labels = {{4, "liver", {1, 0, 0}}};
  f.views.setLabels(labels);
  Readout readout = f.views.readout({-1.5, 3.2, 0.4});
  REQUIRE(readout.index);
  CHECK(*readout.index == std::array<std::size_t, 3>{29, 43, 20});
  CHECK(readout.value == 229.0);
  CHECK(readout.text() == "LPS -1.5, 3.2, 0.4 mm   [29, 43, 20]   229 HU   liver");
  CHECK_FALSE(f.views.readout({0, 0, 100}).index);
  CHECK(f.views.readout({0, 0, 100}).text() == "LPS 0.0, 0.0, 100.0 mm");

  auto displacement = std::make_shared<imaging::DisplacementGrid>();
  displacement->geometry = {{2, 2, 2}, {400, 0, 0, 0, 0, 400, 0, 0, 0, 0, 400, 0, -200, -200, -200, 1}};
  for (int i = 0; i < 8; ++i) displacement->xyz_mm.insert(displacement->xyz_mm.end(), {4.0f, 0.0f, -3.0f});
  f.views.setDisplacement(displacement);
  readout = f.views.readout({-1.5, 3.2, 0.4});
  CHECK(*readout.index == std::array<std::size_t, 3>{27, 43, 21});
  CHECK_THAT(*readout.shift, WithinAbs(5.0, 1e-6));
  CHECK_FALSE(readout.volumeRatio);
  CHECK_THAT(readout.text(), Catch::Matchers::EndsWith("   |u| 5.00 mm"));
  CHECK(readout.tissueText() == "|u| 5.00 mm");
}

namespace {

/// The whole image has moved by 5 mm and been compressed; a stress of 1500 Pa where z < 0.
std::shared_ptr<const imaging::DisplacementGrid> compressed(double ratio, double stress_Pa) {
  auto u = std::make_shared<imaging::DisplacementGrid>();
  u->geometry = {{2, 2, 3}, {400, 0, 0, 0, 0, 400, 0, 0, 0, 0, 200, 0, -200, -200, -200, 1}};
  for (int i = 0; i < 12; ++i) u->xyz_mm.insert(u->xyz_mm.end(), {4.0f, 0.0f, -3.0f});
  const auto value = static_cast<float>(stress_Pa);
  u->fields.push_back({imaging::kVolumeRatio, "1", std::vector<float>(12, static_cast<float>(ratio)), ratio, ratio});
  u->fields.push_back({"stress_of_it", "Pa", std::vector<float>(12, value), 0.0, stress_Pa});
  for (std::size_t p = 4; p < 12; ++p) u->fields[1].values[p] = std::nanf("");
  return u;
}

}  // namespace

TEST_CASE("The read-out tells det F and the field where they are known, and nothing where they are not",
          "[image_views]") {
  Fixture f;
  f.views.setDisplacement(compressed(0.953, 1500.0));
  const Readout below = f.views.readout({-1.5, 3.2, -50}), above = f.views.readout({-1.5, 3.2, 10});
  REQUIRE(below.index);
  CHECK(below.tissueText() == "|u| 5.00 mm   det F 0.953   stress of it 1.5 kPa");
  CHECK(below.text() == below.placeText() + "   " + below.tissueText());
  CHECK(above.tissueText() == "|u| 5.00 mm   det F 0.953");
  CHECK(f.views.readout({0, 0, 100}).tissueText().empty());
}

TEST_CASE("An overlay is told to the renderer in the numbers of the field, its range in those for people",
          "[image_views]") {
  Fixture f;
  f.views.setOfferedFields({{"stress_of_it", "Pa"}});
  f.views.setDisplacement(compressed(0.953, 1500.0));
  CHECK_FALSE(f.views.wantsFields());
  f.views.setPointedAt(true);
  CHECK(f.views.wantsFields());
  f.views.setPointedAt(false);
  const auto choose = [&](Overlay overlay, const std::string &field) {
    ImageOptions options = f.views.options();
    options.overlay = overlay;
    options.overlayField = field;
    f.views.setOptions(options);
  };
  choose(Overlay::shift, "");
  CHECK_FALSE(f.views.wantsFields());
  CHECK(f.views.look().overlay == render::Overlay::shift);
  CHECK(f.views.overlayRange() == OverlayRange{0.0, 5.0});
  choose(Overlay::volumeChange, "");
  CHECK(f.views.wantsFields());
  CHECK(f.views.overlayRange() == OverlayRange{-5.0, 5.0});
  CHECK(f.views.look().overlay == render::Overlay::field);
  CHECK(f.views.look().labelOpacity < 0.5 * f.views.options().labelOpacity);
  CHECK_THAT(f.views.look().overlayLow, WithinAbs(0.95, 1e-9));
  CHECK_THAT(f.views.look().overlayHigh, WithinAbs(1.05, 1e-9));
  choose(Overlay::field, "stress_of_it");
  CHECK(f.views.overlayQuantity().title == "stress of it");
  CHECK(f.views.overlayRange() == OverlayRange{0.0, 1.5});
  CHECK(f.views.look().overlayHigh == 1500.0);
  CHECK(f.views.shownField()->name == "stress_of_it");
  // It follows, and stays when it is fixed.
  f.views.setDisplacement(compressed(0.953, 2100.0));
  CHECK(f.views.overlayRange() == OverlayRange{0.0, 2.5});
  ImageOptions options = f.views.options();
  options.hasFixedRange = true;
  options.fixedRange = {1.0, 3.0};
  f.views.setOptions(options);
  f.views.setDisplacement(compressed(0.953, 9000.0));
  CHECK(f.views.overlayRange() == OverlayRange{1.0, 3.0});
  CHECK(f.views.look().overlayLow == 1000.0);
  // A field that has not arrived yet is not shown.
  choose(Overlay::field, "other");
  CHECK_FALSE(f.views.shownField());
  CHECK(f.views.look().overlay == render::Overlay::none);
  f.views.setDisplacement(nullptr);
  CHECK_FALSE(f.views.wantsFields());
  f.views.setImage(testImage());
  CHECK(f.views.options().overlay == Overlay::none);
}

TEST_CASE("Another image starts with its own window, level and views, and without the old labels", "[image_views]") {
  Fixture f;
  f.views.setLabels(std::make_shared<scene::StoredLabels>());
  f.key(Pane::axial, '3');
  f.wheel(Pane::axial, 4);
  f.views.setMaximised(Pane::axial);
  f.views.setImage(testImage());
  CHECK(f.views.options().windowLevel == automaticWindowLevel(testImage()->range));
  CHECK_FALSE(f.views.labels());
  CHECK_FALSE(f.views.maximised());
  CHECK(f.axial().slice() == 19);
  for (const Pane pane : kSlicePanes) CHECK(f.views.view(pane).isOnSlice(f.views.crossHair()));
  f.views.setImage(nullptr);
  CHECK_FALSE(f.views.image());
  CHECK_FALSE(f.wheel(Pane::axial, 1));
}

TEST_CASE("The convention turns the views where they are", "[image_views]") {
  Fixture f;
  f.wheel(Pane::axial, 5);
  const Vec3 middle = f.axial().worldAt(200, 150);
  ImageOptions options = f.views.options();
  options.convention = Convention::neurological;
  f.views.setOptions(options);
  CHECK(orientationLetters(f.axial().frame().right) == "R");
  CHECK(norm(f.axial().worldAt(200, 150) - middle) < 1e-9);
}

TEST_CASE("What the renderer is told follows the views", "[image_views]") {
  Fixture f;
  f.views.setHandles({{1, 1}, {2, 1}, {}});
  CHECK(f.views.look().image == Handle{1, 1});
  CHECK(f.views.look().window == f.views.options().windowLevel.window);
  CHECK(f.views.scene().slices.size() == 3);
  const render::ImageScene before = f.views.scene();
  CHECK(before == f.views.scene());
  f.wheel(Pane::axial, 1);
  CHECK_FALSE(before == f.views.scene());
  ImageOptions options = f.views.options();
  options.showsSlicesInSpace = false;
  options.showsVolume = true;
  f.views.setOptions(options);
  CHECK(f.views.scene().slices.empty());
  CHECK(f.views.scene().showsVolume);
  CHECK(f.views.scene().volume.points.size() >= 2);
}

TEST_CASE("Cuts of the 3D view lie in the slices, and leave out the near side first", "[image_views]") {
  Fixture f;
  CHECK(f.views.scene().cuts.empty());
  ImageOptions options = f.views.options();
  options.convention = GENERATE(Convention::radiological, Convention::neurological);
  f.views.setOptions(options);
  f.views.setCrossHair({10, -5, 3});
  // Above, left, in front: towards the initial viewer of a patient.
  const std::array<Vec3, 3> sides{{{0, 0, 1}, {1, 0, 0}, {0, -1, 0}}};
  for (const Pane pane : kSlicePanes) {
    const Vec3 side = sides[static_cast<std::size_t>(pane)];
    for (const double sign : {1.0, -1.0}) {
      f.views.cycleCut(pane);
      const render::ImageScene scene = f.views.scene();
      REQUIRE(scene.cuts.size() == 1);
      CHECK(norm(scene.cuts[0].normal - sign * side) < 1e-12);
      CHECK_THAT(dot(scene.cuts[0].point - f.views.crossHair(), side), WithinAbs(0.0, 1.6));  // whole slices of 3 mm
      const render::SliceInSpace &slice = scene.slices[static_cast<std::size_t>(pane)];
      CHECK(dot(scene.cuts[0].point - slice.point, slice.normal) == 0.0);
    }
    f.views.cycleCut(pane);
    CHECK(f.views.scene().cuts.empty());
  }
  for (const Pane pane : kSlicePanes) f.views.cycleCut(pane);
  CHECK(f.views.scene().cuts.size() == 3);
  CHECK(f.views.scene().cutsProxies);
  f.views.setImage(testImage());
  CHECK(f.views.scene().cuts.empty());
}

TEST_CASE("Two quick presses at one place are a double click, others are not", "[image_views]") {
  DoubleClick clicks;
  ViewInput input;
  input.kind = ViewInput::Kind::press;
  input.button = C3DE_BUTTON_LEFT;
  input.x = input.y = 50;
  const auto press = [&](Pane pane, double time_s) {
    input.time_s = time_s;
    return clicks.press(pane, input);
  };
  CHECK_FALSE(press(Pane::axial, 1.0));
  CHECK(press(Pane::axial, 1.2));
  CHECK_FALSE(press(Pane::axial, 1.3));  // the third counts as a first one
  CHECK_FALSE(press(Pane::axial, 2.0));
  CHECK_FALSE(press(Pane::coronal, 2.1));
  input.x = 60;
  CHECK_FALSE(press(Pane::coronal, 2.2));
  input.modifiers = C3DE_MOD_SHIFT;
  CHECK_FALSE(press(Pane::coronal, 2.3));
}

TEST_CASE("The cross-hair stays in the image", "[image_views]") {
  Fixture f;
  const imaging::VolumeGeometry &grid = f.views.image()->volume.geometry;
  for (const Vec3 &beside : {Vec3{1e4, 0, 0}, Vec3{0, -1e4, 0}, Vec3{-1e4, 1e4, -1e4}}) {
    f.views.setCrossHair(beside);
    const Vec3 index = transformPoint(imaging::affineInverse(grid.indexToWorld), f.views.crossHair());
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(index[a] >= -0.5);
      CHECK(index[a] < static_cast<double>(grid.size[a]) - 0.5);
    }
    CHECK(f.views.readout(f.views.crossHair()).index.has_value());
    for (const Pane pane : kSlicePanes) CHECK(f.views.view(pane).isOnSlice(f.views.crossHair()));
  }
  const Vec3 inside = f.views.view(Pane::axial).worldAt(0.5 * f.axial().width(), 0.5 * f.axial().height());
  f.views.setCrossHair(inside);
  CHECK(f.views.crossHair() == inside);
}

TEST_CASE("A click that began a double click is taken back", "[image_views]") {
  Fixture f;
  const Vec3 before = f.views.crossHair();
  const int coronal = f.views.view(Pane::coronal).slice();
  f.drag(Pane::axial, 100, 80, 100, 80, C3DE_BUTTON_LEFT);
  REQUIRE(f.views.crossHair() != before);
  f.views.undoClick();
  CHECK(f.views.crossHair() == before);
  CHECK(f.views.view(Pane::coronal).slice() == coronal);
  f.views.undoClick();
  CHECK(f.views.crossHair() == before);
}
