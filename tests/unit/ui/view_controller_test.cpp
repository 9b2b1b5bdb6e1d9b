// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/view_controller.h"

#include <vector>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;
using Kind = ViewInput::Kind;

namespace {

struct Recorder {
  std::vector<c3de_event> events;
  int cancels = 0;
  bool consumes = true;

  registry::Tool asTool() {
    registry::Tool tool;
    tool.id = "recorder";
    tool.self = this;
    tool.cancel = [](void *self) { ++static_cast<Recorder *>(self)->cancels; };
    tool.onEvent = [](void *self, const c3de_event *event, std::uint32_t *consumed) -> c3de_status {
      static_cast<Recorder *>(self)->events.push_back(*event);
      *consumed = static_cast<Recorder *>(self)->consumes;
      return C3DE_OK;
    };
    return tool;
  }
};

struct View {
  registry::ToolRegistry tools;
  render::Camera camera;
  ViewController controller{tools, camera};
  Recorder recorder;

  View() { controller.setViewSize(800, 600); }
  void activate() { tools.activate(tools.add(recorder.asTool())); }
  bool at(Kind kind, double x, double y, std::uint32_t button = 0, std::uint32_t modifiers = 0) {
    ViewInput input;
    input.kind = kind;
    input.x = x;
    input.y = y;
    input.button = button;
    input.modifiers = modifiers;
    return controller.handle(input);
  }
  void drag(std::uint32_t button, std::uint32_t modifiers = 0) {
    at(Kind::press, 400, 300, button, modifiers);
    at(Kind::move, 440, 330, 0, modifiers);
    at(Kind::release, 440, 330, button, modifiers);
  }
};

}  // namespace

TEST_CASE("without a tool the left button turns the camera") {
  View view;
  const render::Camera before = view.camera;
  view.drag(C3DE_BUTTON_LEFT);
  CHECK(view.camera.yaw != before.yaw);
  CHECK(view.camera.pitch != before.pitch);
  CHECK(view.camera.focus == before.focus);
  CHECK(view.camera.distance == before.distance);
  CHECK_FALSE(view.controller.isDragging());
}

TEST_CASE("middle and Shift+left shift, right and Ctrl+left zoom, the wheel zooms") {
  View view;
  view.activate();
  for (const auto &[button, modifiers] :
       {std::pair{C3DE_BUTTON_MIDDLE, 0u}, std::pair{C3DE_BUTTON_LEFT, C3DE_MOD_SHIFT}}) {
    const render::Camera before = view.camera;
    view.drag(button, modifiers);
    CHECK(view.camera.focus != before.focus);
    CHECK(view.camera.yaw == before.yaw);
  }
  for (const auto &[button, modifiers] :
       {std::pair{C3DE_BUTTON_RIGHT, 0u}, std::pair{C3DE_BUTTON_LEFT, C3DE_MOD_CTRL}}) {
    const render::Camera before = view.camera;
    view.drag(button, modifiers);
    CHECK(view.camera.distance > before.distance);
    CHECK(view.camera.yaw == before.yaw);
  }
  CHECK(view.recorder.events.empty());
  view.recorder.consumes = false;
  ViewInput wheel;
  wheel.kind = Kind::wheel;
  wheel.wheel = 1.0;
  const double distance = view.camera.distance;
  view.controller.handle(wheel);
  CHECK(view.camera.distance < distance);
}

TEST_CASE("a tool that takes the press gets the whole drag, with ray and view direction") {
  View view;
  view.activate();
  const render::Camera before = view.camera;
  view.drag(C3DE_BUTTON_LEFT);
  REQUIRE(view.recorder.events.size() == 3);
  CHECK(view.camera.yaw == before.yaw);
  const c3de_event &press = view.recorder.events[0], &move = view.recorder.events[1],
                   &release = view.recorder.events[2];
  CHECK(press.type == C3DE_EVENT_PRESS);
  CHECK(press.buttons == C3DE_BUTTON_LEFT);
  CHECK(move.type == C3DE_EVENT_MOVE);
  CHECK(move.buttons == C3DE_BUTTON_LEFT);
  CHECK(release.type == C3DE_EVENT_RELEASE);
  CHECK(release.buttons == 0);
  const render::Ray ray = before.pickRay(440, 330, 800, 600);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(move.ray_origin_mm[i] == ray.origin[i]);
    CHECK(move.ray_direction[i] == ray.direction[i]);
    CHECK(move.view_direction[i] == before.forward()[i]);
  }
}

TEST_CASE("the ray of a press begins where it enters what cuts have left, that of a move at the eye") {
  View view;
  view.activate();
  const Vec3 towards = view.camera.forward(), focus = view.camera.focus;
  const auto originOfPress = [&](std::vector<render::CutPlane> cuts) {
    view.controller.setCuts(std::move(cuts));
    view.recorder.events.clear();
    view.drag(C3DE_BUTTON_LEFT);
    REQUIRE(view.recorder.events.size() == 3);
    for (std::size_t i = 0; i < 3; ++i)
      CHECK_THAT(view.recorder.events[1].ray_origin_mm[i], WithinAbs(view.camera.eye()[i], 1e-9));
    const double *at = view.recorder.events[0].ray_origin_mm;
    return Vec3{at[0], at[1], at[2]};
  };
  CHECK(norm(originOfPress({}) - view.camera.eye()) < 1e-9);
  // The middle of the view, at 400, 300: along `towards`.
  CHECK(norm(originOfPress({{focus, -2.0 * towards}}) - focus) < 1e-6);
  CHECK(norm(originOfPress({{focus, -1.0 * towards}, {focus + 30.0 * towards, -1.0 * towards}}) -
             (focus + 30.0 * towards)) < 1e-6);
  CHECK(norm(originOfPress({{focus, towards}}) - view.camera.eye()) < 1e-9);  // the far side is excluded
  // The eye is beyond a plane that the ray runs along: nothing can be reached.
  CHECK(norm(originOfPress({{focus - 1.0 * view.camera.up(), view.camera.up()}}) - focus) > 1e6);
}

TEST_CASE("a tool that does not want the press leaves it to the camera") {
  View view;
  view.activate();
  view.recorder.consumes = false;
  const render::Camera before = view.camera;
  view.drag(C3DE_BUTTON_LEFT);
  CHECK(view.camera.yaw != before.yaw);
  CHECK(view.recorder.events.size() == 1);
}

TEST_CASE("after cancel neither tool nor camera hears of the drag that is still held") {
  View view;
  view.activate();
  view.at(Kind::press, 400, 300, C3DE_BUTTON_LEFT);
  view.controller.cancel();
  CHECK(view.recorder.cancels == 1);
  const render::Camera before = view.camera;
  view.at(Kind::move, 500, 300);
  view.at(Kind::release, 500, 300, C3DE_BUTTON_LEFT);
  CHECK(view.recorder.events.size() == 1);
  CHECK(view.camera.yaw == before.yaw);
  // The next press starts a new one.
  view.at(Kind::press, 400, 300, C3DE_BUTTON_LEFT);
  CHECK(view.recorder.events.size() == 2);
}

TEST_CASE("when another tool takes over in the middle of a drag, it gets nothing of that drag") {
  View view;
  view.activate();
  Recorder other;
  const Handle second = view.tools.add(other.asTool());
  view.at(Kind::press, 400, 300, C3DE_BUTTON_LEFT);
  view.tools.activate(second);
  CHECK(view.recorder.cancels == 1);
  view.at(Kind::move, 500, 300);
  view.at(Kind::release, 500, 300, C3DE_BUTTON_LEFT);
  CHECK(other.events.empty());
}

TEST_CASE("the camera can be made to look along every axis") {
  for (const Vec3 &direction :
       {Vec3{0, 0, -1}, Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}}) {
    render::Camera camera;
    lookAlong(camera, direction);
    CHECK(dot(camera.forward(), direction) > 0.99999);
  }
}

TEST_CASE("The six directions are reached with the patient's z upwards as well", "[view]") {
  for (const Vec3 &direction :
       {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    render::Camera camera;
    camera.upAxis = render::UpAxis::z;
    ui::lookAlong(camera, direction);
    CHECK(dot(camera.forward(), direction) > 0.999);
  }
}
