// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/segmentation_panel.h"

#include "../segmentation/workflow_fixture.h"
#include "c3de/abi/tools.h"
#include "c3de/imaging/masks.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/text_panel.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/ui/edit_history.h"
#include "c3de/ui/image_views.h"

using namespace c3de;
using namespace c3de::segmentation;
using namespace c3de::segmentation::test;
using namespace c3de::registry;
using namespace c3de::ui;

TEST_CASE("Undo takes back what was edited last, of the parameters or of the organ", "[organ]") {
  Fixture f;
  registry::ParameterRegistry parameters;
  registry::ParameterSet set;
  set.decls.emplace_back();
  set.decls[0].id = "x";
  set.decls[0].label = "X";
  set.decls[0].max = 100.0;
  const Handle handle = parameters.declare(set);
  const auto setX = [&](double to) {
    ParameterValue value = parameters.find(handle)->values[0];
    value.num = to;
    REQUIRE(parameters.edit(handle, value));
    parameters.history().endGesture();
  };
  const auto x = [&] { return parameters.find(handle)->values[0].num; };
  EditHistory history;
  const auto follow = [&] { history.follow(&parameters, &f.guide); };
  follow();
  CHECK(history.undoLabel().empty());
  f.guide.setLow(60.0);
  follow();
  CHECK(history.undoLabel().empty());  // it is being computed
  f.settle();
  setX(2.0);
  follow();
  CHECK(history.undoLabel() == "X");
  f.guide.applyStep(Kind::largest);
  f.settle();
  follow();
  CHECK(history.undoLabel() == "the largest part");
  history.undo();
  CHECK(history.undoLabel().empty());  // not the parameter, while the organ is being removed
  f.settle();
  CHECK(f.voxels() == Fixture::kLarge + Fixture::kSmall);
  CHECK(x() == 2.0);
  CHECK(history.redoLabel() == "the largest part");
  setX(3.0);
  follow();
  history.undo();
  CHECK(x() == 2.0);
  history.undo();
  CHECK(x() == 0.0);
  CHECK(history.undoLabel() == "threshold 60 … 100");  // the parameters have nothing left to undo
  history.undo();
  CHECK_FALSE(f.guide.mask().mask());
  follow();
  history.redo();
  f.settle();
  CHECK(f.guide.mask().mask());
}

TEST_CASE("Undo does not lay what a body was created of over it, whatever else is still picked", "[organ]") {
  Fixture f;
  EditHistory history;
  const auto undoLabel = [&] {
    history.follow(nullptr, &f.guide);
    return history.undoLabel();
  };
  const auto make = [&] {
    REQUIRE(f.guide.blockingReason() == "");
    f.guide.createBodies();
    const std::vector<segmentation::BodyRequest> made = std::move(f.made);
    f.made.clear();
    return made;
  };
  f.guide.setSources(f.sources);
  f.settle();
  f.guide.chooseLabels({3, 8});
  f.guide.chooseMaterialOf(8, "liver");
  CHECK_FALSE(undoLabel().empty());
  std::vector<segmentation::BodyRequest> made = make();
  REQUIRE(made.size() == 2);
  made.pop_back();  // the other one could not be created
  f.guide.onBodiesCreated(made);
  f.settle();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8});
  CHECK(undoLabel() == "");
  history.undo();
  f.settle();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{8});
  // A component picked after that can be undone, up to that point.
  f.guide.applyStep(Kind::fillHoles);
  f.settle();
  CHECK(undoLabel() == "holes filled");
  history.undo();
  f.settle();
  CHECK(undoLabel() == "");
  // The same for a threshold.
  f.guide.setFromLabel(false);
  f.guide.setLow(60.0);
  f.settle();
  f.guide.setName("box");
  f.guide.chooseMaterial("liver");
  f.guide.onBodiesCreated(make());
  CHECK_FALSE(f.guide.mask().mask());
  CHECK(undoLabel() == "");
}

TEST_CASE("A map of many labels has a filter, and several are ticked at once", "[organ]") {
  Fixture f;
  auto labels = std::make_shared<scene::StoredLabels>(*f.sources.labels);
  for (std::uint16_t value = 20; value < 40; ++value)
    labels->map.labels.push_back({value, "Rib_left_" + std::to_string(value), {0, 0, 1}});
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(f.sources.image);
  registry::ToolRegistry tools;
  MaskBrush brush(tools, views, f.guide);
  const SegmentationPanel panel(panels, {views, f.guide, f.scan, brush, {}});
  registry::TextPanel text(nullptr);
  const auto draw = [&] {
    const std::string shown = text.draw(*panels.panels().front());
    f.settle();
    return shown;
  };
  f.guide.setSources({f.sources.image, labels});
  f.settle();
  CHECK_THAT(draw(), Contains("label.8") && Contains("label.39"));
  REQUIRE(text.find("labels"));
  text.setText("label_filter", "left RIB 3");
  draw();
  CHECK_THAT(draw(), !Contains("label.8") && !Contains("label.29") && Contains("label.30") && Contains("label.39"));
  text.setText("label_filter", "nothing of the kind");
  draw();
  CHECK_THAT(draw(), Contains("No label matches.") && Contains("[disabled button: Tick the listed]"));
  text.setText("label_filter", "KIDNEY left");
  text.press("tick_listed");
  draw();
  draw();
  text.press("tick_listed");
  draw();
  CHECK(f.guide.pickedLabels() == std::vector<std::uint16_t>{3});
  text.setText("label_filter", "thing");
  draw();
  text.press("tick_listed");
  draw();
  CHECK_THAT(draw(), Contains("Ticked: kidney_left, thing") && Contains("Picked: 2 labels, 35.0 ml") &&
                         Contains("Source: PMID 21862792") && Contains("Young's modulus: 5 kPa (2 kPa … 15 kPa)") &&
                         Contains("[disabled button: Create 2 bodies]") && Contains("no material is chosen for thing"));
  text.setText("material.8", "fat");
  draw();
  text.press("create");
  draw();
  REQUIRE(f.made.size() == 2);
  CHECK(f.made[1].material == "fat");
  text.press("untick");
  draw();
  CHECK(f.guide.pickedLabels().empty());
}

TEST_CASE("The panel leads from labels to the button", "[organ]") {
  Fixture f;
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(f.sources.image);
  registry::ToolRegistry tools;
  MaskBrush brush(tools, views, f.guide);
  const SegmentationPanel panel(panels, {views, f.guide, f.scan, brush, {}});
  registry::TextPanel text(nullptr);
  const auto draw = [&] {
    const std::string shown = text.draw(*panels.panels().front());
    f.settle();
    return shown;
  };
  f.guide.setSources(f.sources);
  f.settle();
  CHECK_THAT(draw(), Contains("[#ff0000]  [ ] kidney_left   27.0 ml (label.3)") && Contains("Picked: nothing yet") &&
                         !Contains("Create body"));
  text.check("label.3", true);
  draw();
  CHECK_THAT(draw(), Contains("[x] kidney_left") && Contains("Picked: 27.0 ml, 216 voxels") &&
                         Contains("Material = kidney_cortex") && Contains("Young's modulus: 5 kPa (2 kPa … 15 kPa)") &&
                         Contains("Source: PMID 21862792"));
  text.setText("source", "values between");
  draw();
  text.setNumber("low", 60.0);
  draw();
  text.press("component");
  draw();
  REQUIRE(views.isPicking());
  CHECK_THAT(draw(), Contains("Click it in a slice…"));
  text.press("component");
  draw();
  CHECK_FALSE(views.isPicking());
  text.setNumber("radius", 6.0);
  text.press("close");
  draw();
  text.press("create");
  draw();
  CHECK(text.problems().empty());
  REQUIRE(f.made.size() == 1);
  CHECK(imaging::voxelCount(*f.made[0].mask) == 216 + 64);
}

TEST_CASE("A click in a slice that picks does not move the cross-hair, and Escape ends it", "[organ]") {
  const Fixture f;
  ImageViews views;
  views.setImage(f.sources.image);
  for (const Pane pane : kSlicePanes) views.view(pane).setSize(200, 200);
  const Vec3 cross = views.crossHair();
  std::vector<Vec3> picked;
  ViewInput press;
  press.kind = ViewInput::Kind::press;
  press.button = C3DE_BUTTON_LEFT;
  press.x = 30;
  press.y = 40;
  ViewInput release = press;
  release.kind = ViewInput::Kind::release;
  views.pickNext([&](const Vec3 &at) { picked.push_back(at); });
  views.handle(Pane::axial, press);
  views.handle(Pane::axial, release);
  REQUIRE(picked.size() == 1);
  CHECK(norm(picked[0] - views.view(Pane::axial).worldAt(30, 40)) < 1e-12);
  CHECK(norm(views.crossHair() - cross) == 0.0);
  views.handle(Pane::axial, press);
  views.handle(Pane::axial, release);
  CHECK(picked.size() == 1);
  CHECK(norm(views.crossHair() - cross) > 1.0);

  // The image is shown 10 mm further left: the picked tissue is the one shown there.
  auto shift = std::make_shared<imaging::DisplacementGrid>();
  shift->geometry = f.sources.image->volume.geometry;
  for (std::size_t v = 0; v < 8000; ++v) shift->xyz_mm.insert(shift->xyz_mm.end(), {10.0f, 0.0f, 0.0f});
  views.setDisplacement(shift);
  press.x = press.y = 100;
  views.pickNext([&](const Vec3 &at) { picked.push_back(at); });
  views.handle(Pane::axial, press);
  REQUIRE(picked.size() == 2);
  CHECK(norm(picked[1] + Vec3{10, 0, 0} - views.view(Pane::axial).worldAt(100, 100)) < 1e-9);
}

TEST_CASE("The panel asks for the body of the whole scan where labels lie over an image", "[organ]") {
  Fixture f;
  registry::PanelRegistry panels;
  ImageViews views;
  views.setImage(f.sources.image);
  registry::ToolRegistry tools;
  MaskBrush brush(tools, views, f.guide);
  const SegmentationPanel panel(panels, {views, f.guide, f.scan, brush, {}});
  registry::TextPanel text(nullptr);
  const auto draw = [&] {
    (void)text.draw(*panels.panels().front());
    f.settle();
  };
  draw();
  CHECK(text.find("create_scan_body") == nullptr);
  f.scan.setSources({f.sources.image, "ct.nii.gz", "", "labels.nii.gz", {f.sources.labels}});
  draw();
  REQUIRE(text.find("create_scan_body"));
  CHECK_FALSE(f.scan.isShown());
  text.press("create_scan_body");
  draw();
  CHECK(f.scan.isShown());
}

namespace {

/// Events of a slice, in world coordinates.
struct BrushedImage {
  Fixture f;
  registry::ToolRegistry tools;
  ImageViews views;
  MaskBrush brush{tools, views, f.guide};

  BrushedImage() {
    views.setImage(f.sources.image);
    brush.offer(true);
    brush.toggle();
  }
  bool send(std::uint32_t type, const Vec3 &at, std::uint32_t where = C3DE_IN_AXIAL, std::uint32_t key = 0) {
    c3de_event event{};
    event.size = sizeof(event);
    event.type = type;
    event.button = type == C3DE_EVENT_PRESS || type == C3DE_EVENT_RELEASE ? C3DE_BUTTON_LEFT : 0;
    event.key = key;
    event.where = where;
    const Vec3 normal{0, 0, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      event.ray_origin_mm[a] = at[a];
      event.view_direction[a] = event.ray_direction[a] = normal[a];
    }
    return tools.dispatch(event);
  }
  void key(char letter) {
    CHECK(send(C3DE_EVENT_KEY, {50, 50, 50}, C3DE_IN_AXIAL, static_cast<std::uint32_t>(letter)));
  }
};

}  // namespace

TEST_CASE("A drag of the brush is one step, and erases, and is undone", "[brush]") {
  BrushedImage b;
  segmentation::BrushSettings settings;
  settings.radius_mm = 11.0;
  b.f.guide.setBrush(settings);
  CHECK(b.send(C3DE_EVENT_PRESS, {50, 50, 50}));
  CHECK(b.send(C3DE_EVENT_MOVE, {60, 50, 50}));
  REQUIRE(b.brush.marker());
  CHECK(b.brush.marker()->path.size() == 2);
  CHECK(b.f.guide.mask().steps().empty());
  CHECK(b.send(C3DE_EVENT_RELEASE, {60, 50, 50}));
  b.f.settle();
  REQUIRE(b.f.guide.mask().steps().size() == 1);
  // A disc of 13 voxels of 5 mm, moved by two of them: rows of 3, 5, 7, 5, 3.
  CHECK(b.f.voxels() == 23);
  b.key('E');
  CHECK(b.send(C3DE_EVENT_PRESS, {50, 50, 50}));
  CHECK(b.send(C3DE_EVENT_RELEASE, {50, 50, 50}));
  b.f.settle();
  CHECK(b.f.voxels() == 10);
  EditHistory history;
  history.follow(nullptr, &b.f.guide);
  CHECK(history.undoLabel() == "erased");
  history.undo();
  b.f.settle();
  CHECK(b.f.voxels() == 23);
  history.undo();
  b.f.settle();
  CHECK_FALSE(b.f.guide.mask().mask());
  history.redo();
  b.f.settle();
  CHECK(b.f.voxels() == 23);
}

TEST_CASE("The brush changes with keys within its range, and leaves the 3D view alone", "[brush]") {
  BrushedImage b;
  const double radius = b.f.guide.settings().brush.radius_mm;
  b.key(']');
  CHECK(b.f.guide.settings().brush.radius_mm > radius);
  for (int i = 0; i < 100; ++i) b.key(']');
  CHECK(b.f.guide.settings().brush.radius_mm == MaskBrush::kLargest_mm);
  for (int i = 0; i < 100; ++i) b.key('[');
  CHECK(b.f.guide.settings().brush.radius_mm == MaskBrush::kSmallest_mm);
  CHECK_FALSE(b.send(C3DE_EVENT_KEY, {}, C3DE_IN_AXIAL, 'J'));
  CHECK_FALSE(b.send(C3DE_EVENT_PRESS, {50, 50, 50}, C3DE_IN_SPACE));
  CHECK_FALSE(b.send(C3DE_EVENT_WHEEL, {50, 50, 50}));

  // Where a slice moves under the brush, each has a stroke.
  CHECK(b.send(C3DE_EVENT_PRESS, {50, 50, 50}));
  CHECK(b.send(C3DE_EVENT_MOVE, {50, 50, 60}));
  CHECK(b.send(C3DE_EVENT_RELEASE, {50, 50, 60}));
  b.f.settle();
  CHECK(b.f.guide.mask().steps().size() == 2);
  CHECK(b.f.voxels() == 2);
  // A drag that is cancelled has no effect, nor does the rest of it.
  CHECK(b.send(C3DE_EVENT_PRESS, {20, 20, 20}));
  b.tools.cancelActive();
  CHECK_FALSE(b.send(C3DE_EVENT_MOVE, {30, 20, 20}));
  CHECK_FALSE(b.send(C3DE_EVENT_RELEASE, {30, 20, 20}));
  b.f.settle();
  CHECK(b.f.voxels() == 2);
  b.brush.offer(false);
  CHECK(b.tools.tools().empty());
  CHECK_FALSE(b.brush.marker());
}
