// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/slice_controller.h"

#include <vector>

#include "c3de/abi/tools.h"
#include "c3de/ui/commands.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
using Kind = ViewInput::Kind;

namespace {

/// 40 x 40 x 40 voxels of 2 mm, rotated about z by 30 degrees.
std::shared_ptr<scene::StoredImage> turnedImage() {
  auto image = std::make_shared<scene::StoredImage>();
  const double c = 2.0 * std::cos(0.5236), s = 2.0 * std::sin(0.5236);
  image->volume.geometry = {{40, 40, 40}, {c, s, 0, 0, -s, c, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1}};
  image->volume.voxels = std::vector<std::int16_t>(64000, 7);
  image->range = imaging::robustRange(image->volume);
  return image;
}

struct Slices {
  registry::ToolRegistry tools;
  ImageViews views;
  SliceController controller{tools};
  std::vector<c3de_event> events;
  bool consumes = true;

  Slices() {
    views.setImage(turnedImage());
    for (const Pane pane : kSlicePanes) views.view(pane).setSize(400, 300);
  }
  Handle activate(bool inSlices = true) {
    registry::Tool tool;
    tool.id = "recorder";
    tool.self = this;
    tool.inSlices = inSlices;
    tool.onEvent = [](void *self, const c3de_event *event, std::uint32_t *consumed) -> c3de_status {
      static_cast<Slices *>(self)->events.push_back(*event);
      *consumed = static_cast<Slices *>(self)->consumes;
      return C3DE_OK;
    };
    const Handle handle = tools.add(tool);
    tools.activate(handle);
    return handle;
  }
  bool at(Pane pane, Kind kind, double x, double y, std::uint32_t button = 0, std::uint32_t modifiers = 0) {
    ViewInput input;
    input.kind = kind;
    input.x = x;
    input.y = y;
    input.button = button;
    input.modifiers = modifiers;
    return controller.handle(views, pane, input);
  }
  bool wheel(Pane pane, double steps) {
    ViewInput input;
    input.kind = Kind::wheel;
    input.wheel = steps;
    input.x = 150;
    input.y = 100;
    return controller.handle(views, pane, input);
  }
  bool key(Pane pane, std::uint32_t key) {
    ViewInput input;
    input.kind = Kind::key;
    input.key = key;
    return controller.handle(views, pane, input);
  }
  void click(Pane pane, std::uint32_t button, std::uint32_t modifiers = 0) {
    at(pane, Kind::press, 150, 100, button, modifiers);
    at(pane, Kind::release, 150, 100, button, modifiers);
  }
};

Vec3 vec(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

TEST_CASE("A tool that works in slices gets the drag, with the point of the plane under the mouse", "[slice_tool]") {
  Slices f;
  f.activate();
  const Vec3 crossHair = f.views.crossHair();
  for (const auto &[pane, where] : {std::pair{Pane::axial, C3DE_IN_AXIAL}, std::pair{Pane::sagittal, C3DE_IN_SAGITTAL},
                                    std::pair{Pane::coronal, C3DE_IN_CORONAL}}) {
    INFO(paneName(pane));
    f.events.clear();
    SliceView &view = f.views.view(pane);
    view.zoom(5, 10, 20);
    view.pan(30, -12);
    f.at(pane, Kind::press, 150, 100, C3DE_BUTTON_LEFT);
    f.at(pane, Kind::move, 170, 500);  // beyond the lower edge
    f.at(pane, Kind::release, 170, 500, C3DE_BUTTON_LEFT);
    REQUIRE(f.events.size() == 3);
    CHECK(f.events[0].type == C3DE_EVENT_PRESS);
    CHECK(f.events[0].buttons == C3DE_BUTTON_LEFT);
    CHECK(f.events[1].type == C3DE_EVENT_MOVE);
    CHECK(f.events[2].type == C3DE_EVENT_RELEASE);
    CHECK(f.events[2].buttons == 0);
    for (const c3de_event &event : f.events) {
      CHECK(event.where == where);
      CHECK(vec(event.ray_origin_mm) == view.worldAt(event.x_px, event.y_px));
      CHECK(norm(vec(event.ray_direction) - view.frame().normal()) < 1e-12);
      CHECK(vec(event.view_direction) == vec(event.ray_direction));
    }
  }
  CHECK(f.views.crossHair() == crossHair);
}

TEST_CASE("A tool that does not know of slices sees none of their events", "[slice_tool]") {
  Slices f;
  f.activate(false);
  const Vec3 crossHair = f.views.crossHair();
  f.click(Pane::axial, C3DE_BUTTON_LEFT);
  f.wheel(Pane::axial, 1);
  f.key(Pane::axial, 'X');
  CHECK(f.events.empty());
  CHECK(f.views.crossHair() != crossHair);
}

TEST_CASE("What a tool does not take, modifiers, other buttons and picks are the slice's", "[slice_tool]") {
  Slices f;
  f.activate();
  const Vec3 crossHair = f.views.crossHair();
  f.click(Pane::axial, C3DE_BUTTON_LEFT, C3DE_MOD_SHIFT);
  f.click(Pane::axial, C3DE_BUTTON_LEFT, C3DE_MOD_CTRL);
  f.click(Pane::axial, C3DE_BUTTON_RIGHT);
  f.click(Pane::axial, C3DE_BUTTON_MIDDLE);
  CHECK(f.events.empty());
  int picks = 0;
  f.views.pickNext([&](const Vec3 &) { ++picks; });
  f.click(Pane::axial, C3DE_BUTTON_LEFT);
  CHECK(picks == 1);
  CHECK(f.events.empty());
  CHECK(f.views.crossHair() == crossHair);
  f.at(Pane::axial, Kind::press, 150, 100, C3DE_BUTTON_RIGHT);  // during a zoom a second button is not a pull
  f.at(Pane::axial, Kind::press, 150, 100, C3DE_BUTTON_LEFT);
  f.at(Pane::axial, Kind::release, 150, 100, C3DE_BUTTON_LEFT);
  f.at(Pane::axial, Kind::release, 150, 100, C3DE_BUTTON_RIGHT);
  CHECK(f.events.empty());
  f.consumes = false;
  f.click(Pane::axial, C3DE_BUTTON_LEFT);
  CHECK(f.events.size() == 1);  // the release is the slice's
  CHECK(f.views.crossHair() != crossHair);
  const int slice = f.views.view(Pane::axial).slice();
  f.wheel(Pane::axial, 2);
  CHECK(f.views.view(Pane::axial).slice() == slice + 2);
}

TEST_CASE("A slice that changes under a drag is told as a move to where the mouse is now", "[slice_tool]") {
  Slices f;
  f.activate();
  f.at(Pane::axial, Kind::press, 150, 100, C3DE_BUTTON_LEFT);
  f.consumes = false;
  const Vec3 before = vec(f.events.back().ray_origin_mm);
  f.wheel(Pane::axial, 3);
  REQUIRE(f.events.size() == 3);
  CHECK(f.events[1].type == C3DE_EVENT_WHEEL);
  CHECK(f.events[2].type == C3DE_EVENT_MOVE);
  CHECK(norm(vec(f.events[2].ray_origin_mm) - before - Vec3{0, 0, 6}) < 1e-9);
  f.key(Pane::axial, 'F');
  CHECK(f.events.back().type == C3DE_EVENT_MOVE);
  f.consumes = true;
  const int slice = f.views.view(Pane::axial).slice();
  f.wheel(Pane::axial, 1);  // the tool keeps it
  CHECK(f.views.view(Pane::axial).slice() == slice);
}

TEST_CASE("A tool that is cancelled or put away during a drag hears no more of it", "[slice_tool]") {
  Slices f;
  const Handle tool = f.activate();
  const Vec3 crossHair = f.views.crossHair();
  f.at(Pane::axial, Kind::press, 150, 100, C3DE_BUTTON_LEFT);
  f.controller.cancel();
  f.at(Pane::axial, Kind::move, 190, 100);
  f.at(Pane::axial, Kind::release, 190, 100, C3DE_BUTTON_LEFT);
  CHECK(f.events.size() == 1);
  f.at(Pane::axial, Kind::press, 150, 100, C3DE_BUTTON_LEFT);
  CHECK(f.events.size() == 2);
  f.tools.activate({});
  f.at(Pane::axial, Kind::move, 190, 100);
  f.at(Pane::axial, Kind::release, 190, 100, C3DE_BUTTON_LEFT);
  f.tools.activate(tool);
  f.at(Pane::axial, Kind::move, 180, 100);  // no button is down: it hovers
  CHECK(f.events.size() == 3);
  CHECK(f.views.crossHair() == crossHair);
}
