// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/image_panel.h"

#include "c3de/registry/text_panel.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

std::shared_ptr<scene::StoredImage> headImage() {
  auto image = std::make_shared<scene::StoredImage>();
  image->name = "head";
  image->volume.geometry.size = {10, 10, 10};
  std::vector<std::int16_t> voxels(1000);
  for (std::size_t i = 0; i < 1000; ++i) voxels[i] = static_cast<std::int16_t>(i);
  image->volume.voxels = voxels;
  image->volume.unit = "HU";
  image->range = imaging::robustRange(image->volume);
  return image;
}

}  // namespace

TEST_CASE("The panel of an image shows and changes what the views show", "[image_panel]") {
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(headImage());
  const ImagePanel panel(panels, views);
  REQUIRE(panels.panels().size() == 1);
  registry::TextPanel text(nullptr);
  const auto draw = [&] { return text.draw(*panels.panels().front()); };
  CHECK_THAT(draw(), Contains("head") && Contains("10 × 10 × 10"));
  text.setNumber("window", 123.0);
  text.setNumber("level", 45.0);
  text.check("volume", true);
  text.check("outlines", false);
  draw();
  CHECK(views.options().windowLevel == WindowLevel{123.0, 45.0});
  CHECK(views.options().showsVolume);
  CHECK_FALSE(views.options().showsOutlines);
  text.setText("preset", "CT lung (2)");
  text.setText("interpolation", "nearest voxel");
  text.setText("convention", "neurological (right on the right)");
  text.setText("volume_preset", "MIP");
  draw();
  CHECK(views.options().windowLevel == WindowLevel{1500, -600});
  CHECK_FALSE(views.options().isSmooth);
  CHECK(views.options().convention == Convention::neurological);
  CHECK(views.options().volumePreset == VolumePreset::maximum);
  CHECK(text.problems().empty());
  CHECK_FALSE(text.find("label_opacity"));
  CHECK_FALSE(text.find("overlay"));
}

TEST_CASE("One choice lays |u|, the change of volume or a field of the simulator over the slices", "[image_panel]") {
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(headImage());
  auto u = std::make_shared<imaging::DisplacementGrid>();
  u->geometry = views.image()->volume.geometry;
  for (std::size_t v = 0; v < 1000; ++v) u->xyz_mm.insert(u->xyz_mm.end(), {3.0f, 0.0f, 0.0f});
  u->fields.push_back({"stress_of_it", "Pa", std::vector<float>(1000, 700.0f), 700.0, 700.0});
  views.setDisplacement(u);
  views.setOfferedFields({{"heat", "K"}, {"stress_of_it", "Pa"}});
  const ImagePanel panel(panels, views);
  registry::TextPanel text(nullptr);
  const auto draw = [&] { return text.draw(*panels.panels().front()); };
  draw();
  CHECK_FALSE(text.find("overlay_fixed"));
  text.setText("overlay", "|u|");
  draw();
  CHECK(views.options().overlay == Overlay::shift);
  CHECK_THAT(draw(), Contains("0 … 3 mm"));
  text.setText("overlay", "volume change");
  draw();
  CHECK(views.options().overlay == Overlay::volumeChange);
  text.setText("overlay", "stress of it");
  draw();
  CHECK(views.options().overlay == Overlay::field);
  CHECK(views.options().overlayField == "stress_of_it");
  CHECK_THAT(draw(), Contains("0 … 0.8 kPa"));
  CHECK_FALSE(text.find("overlay_high"));
  text.check("overlay_fixed", true);
  draw();
  draw();
  CHECK(views.options().fixedRange == OverlayRange{0.0, 0.8});
  text.setNumber("overlay_high", 0.5);
  text.setNumber("overlay_low", 0.6);
  draw();
  CHECK(views.options().fixedRange.high == 0.5);
  CHECK(views.options().fixedRange.low < 0.5);
  text.setText("overlay", "heat");
  draw();
  CHECK(views.options().overlayField == "heat");
  CHECK_FALSE(views.options().hasFixedRange);
  text.setText("overlay", "none");
  draw();
  CHECK(views.options().overlay == Overlay::none);
  CHECK(text.problems().empty());
}

TEST_CASE("Labels are listed by name and hidden one by one", "[image_panel]") {
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(headImage());
  auto labels = std::make_shared<scene::StoredLabels>();
  labels->map.labels = {{5, "liver", {1, 0, 0}}, {7, "spleen", {0, 1, 0}}};
  views.setLabels(labels);
  const ImagePanel panel(panels, views);
  registry::TextPanel text(nullptr);
  CHECK_THAT(text.draw(*panels.panels().front()), Contains("5  liver") && Contains("7  spleen"));
  text.check("label.7", false);
  text.setNumber("label_opacity", 0.75);
  text.draw(*panels.panels().front());
  CHECK(views.options().labelOpacity == 0.75);
  REQUIRE(views.labelColours().size() == 2);
  CHECK(views.labelColours()[0].second[3] == 1.0f);
  CHECK(views.labelColours()[1].second[3] == 0.0f);
}

TEST_CASE("The panel goes with the image", "[image_panel]") {
  registry::PanelRegistry panels;
  ImageViews views;
  {
    const ImagePanel panel(panels, views);
    CHECK(panels.panels().size() == 1);
  }
  CHECK(panels.panels().empty());
}

TEST_CASE("A time point is chosen in the panel and by T, and everything else stays", "[image_panel]") {
  registry::PanelRegistry panels;
  ImageViews views;
  std::vector<std::size_t> asked;
  views.setTimeChooser([&](std::size_t time) { asked.push_back(time); });
  views.setImage(headImage());
  const ImagePanel panel(panels, views);
  registry::TextPanel text(nullptr);
  const auto draw = [&] { return text.draw(*panels.panels().front()); };
  draw();
  CHECK_FALSE(text.find("time"));  // it has one
  const auto at = [](std::size_t time) {
    auto image = headImage();
    image->time = time;
    image->times = 4;
    return image;
  };
  views.setImage(at(0));
  draw();
  REQUIRE(text.find("time"));
  text.setNumber("time", 2.2);
  draw();
  CHECK(asked == std::vector<std::size_t>{2});
  ImageOptions options = views.options();
  options.windowLevel = {77.0, 33.0};
  views.setOptions(options);
  views.setCrossHair({3, 4, 5});
  views.replaceImage(at(2), Handle{});
  CHECK(views.image()->time == 2);
  CHECK(views.options().windowLevel == WindowLevel{77.0, 33.0});
  CHECK(views.crossHair() == Vec3{3, 4, 5});

  const auto press = [&](std::uint32_t modifiers) {
    ViewInput input;
    input.kind = ViewInput::Kind::key;
    input.key = 'T';
    input.modifiers = modifiers;
    REQUIRE(ImageViews::isSliceKey('T', modifiers));
    (void)views.handle(Pane::axial, input);
  };
  asked.clear();
  press(0);
  press(C3DE_MOD_SHIFT);
  views.replaceImage(at(3), Handle{});
  press(0);  // the last one
  views.replaceImage(at(0), Handle{});
  press(C3DE_MOD_SHIFT);  // the first one
  CHECK(asked == std::vector<std::size_t>{3, 1});
}
