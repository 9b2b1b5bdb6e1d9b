// SPDX-License-Identifier: Apache-2.0
#include "logic/modes.h"

#include "../segmentation/workflow_fixture.h"
#include "c3de/abi/tools.h"
#include "c3de/registry/command_registry.h"

using namespace c3de;
using namespace c3de::segmentation;
using namespace c3de::segmentation::test;
using namespace c3de::ui;
using Event = OsEvent::Kind;

namespace {

constexpr float kSide = 400.0f;

/// Four views of 400 x 400 pixels around a scan, a tool that receives presses in the 3D view, a command of a plugin.
struct Window : Fixture {
  registry::ToolRegistry tools;
  registry::CommandRegistry commands;
  ImageViews views;
  render::Camera camera;
  Modes modes{camera};
  Modes::Above above;
  Handle tool, command;
  std::vector<c3de_event> events;  ///< of the tool
  int cancels = 0;

  Window() {
    auto labels = std::make_shared<scene::StoredLabels>(*sources.labels);
    views.setImage(sources.image);
    scan.setSources({sources.image, "ct.nii.gz", "", "labels.nii.gz", {labels}});
    registry::Tool one;
    one.id = "test.tool";
    one.shortcut = 'P';
    one.self = this;
    one.cancel = [](void *self) { ++static_cast<Window *>(self)->cancels; };
    one.onEvent = [](void *self, const c3de_event *event, std::uint32_t *consumed) -> c3de_status {
      static_cast<Window *>(self)->events.push_back(*event);
      *consumed = 1;
      return C3DE_OK;
    };
    tool = tools.add(one);
    registry::PluginCommand ofPlugin;
    ofPlugin.id = "test.command";
    ofPlugin.key = 'J';
    ofPlugin.run = [] { return registry::CommandResult(); };
    command = commands.add(ofPlugin)->handle;
    WindowServices services;
    services.tools = &tools;
    services.commands = &commands;
    services.images = &views;
    services.scanBody = &scan;
    modes.connect(services);
    frame();
  }
  void frame(const std::vector<PixelRect> &overlays = {}) {
    std::array<PixelRect, 4> panes;
    for (const Pane pane : {Pane::axial, Pane::sagittal, Pane::coronal, Pane::space}) {
      const auto p = static_cast<std::size_t>(pane);
      panes[p] = {kSide * static_cast<float>(p % 2), kSide * static_cast<float>(p / 2), kSide, kSide};
      if (pane != Pane::space) views.view(pane).setSize(kSide, kSide);
    }
    modes.beginFrame(panes, overlays);
  }
  /// From the upper left corner of a view, in pixels.
  void mouse(Event kind, Pane pane, double x, double y, std::uint32_t button = C3DE_BUTTON_LEFT) {
    const auto p = static_cast<std::size_t>(pane);
    OsEvent event;
    event.kind = kind;
    event.button = kind == Event::move ? 0 : button;
    event.x = kSide * static_cast<double>(p % 2) + x;
    event.y = kSide * static_cast<double>(p / 2) + y;
    event.time_s = time_s;
    modes.handleMouse(event, above);
  }
  Modes::Answer key(std::uint32_t key, Pane pane = Pane::space, std::uint32_t modifiers = 0) {
    const auto p = static_cast<std::size_t>(pane);
    OsEvent event;
    event.kind = Event::keyDown;
    event.key = key;
    event.modifiers = modifiers;
    event.x = kSide * static_cast<double>(p % 2) + 10.0;
    event.y = kSide * static_cast<double>(p / 2) + 10.0;
    return modes.handleKey(event, above);
  }
  /// Requested, then drawn.
  void draw() {
    scan.show(true);
    settle();
    modes.beginRegion(10.0);
    REQUIRE(modes.region());
  }
  double time_s = 0.0;
};

bool isNothing(const Modes::Answer &answer) {
  return answer.command == Command::none && answer.pluginCommand.isNull() && !answer.closesMenus &&
         !answer.endsLongStep;
}

}  // namespace

TEST_CASE("A key is the slice's under the mouse, else the program's, a plugin's, a tool's", "[modes]") {
  Window w;
  CHECK(w.key('1').command == Command::viewFront);
  CHECK(w.key('1', Pane::axial).command == Command::none);
  CHECK(w.views.options().windowLevel.window == Approx(80.0));  // CT brain
  CHECK(w.key('J').pluginCommand == w.command);
  CHECK(isNothing(w.key('P')));
  CHECK(w.tools.active() == w.tool);
  CHECK(isNothing(w.key('X')));
  REQUIRE(w.events.size() == 1);
  CHECK(w.events.front().key == 'X');
}

TEST_CASE("What is open above the views has mouse and keys, but for Ctrl+Q", "[modes]") {
  Window w;
  w.tools.activate(w.tool);
  for (const char *what : {"a menu", "typing", "a widget"}) {
    CAPTURE(what);
    w.above = {};
    (what[0] == 'a' && what[2] == 'm' ? w.above.isPopup : what[0] == 't' ? w.above.isTyping : w.above.takesKeys) = true;
    CHECK(isNothing(w.key('1')));
    CHECK(isNothing(w.key('J')));
    CHECK(isNothing(w.key('Z', Pane::space, C3DE_MOD_CTRL)));
    CHECK(w.key('Q', Pane::space, C3DE_MOD_CTRL).command == Command::quit);
  }
  w.above = {};
  w.above.isPopup = true;
  w.mouse(Event::press, Pane::space, 100, 100);
  w.mouse(Event::release, Pane::space, 100, 100);
  CHECK(w.events.empty());
  w.above = {};
  w.frame({{kSide + 90, kSide + 90, 20, 20}});
  w.mouse(Event::press, Pane::space, 100, 100);
  w.mouse(Event::release, Pane::space, 100, 100);
  CHECK(w.events.empty());
  w.mouse(Event::press, Pane::space, 200, 100);
  REQUIRE(w.events.size() == 1);
  CHECK(w.events.front().x_px == 200.0);
  // During a drag in a view, its keys are not those of a widget that has been used before.
  w.above.takesKeys = true;
  CHECK(w.key('J').pluginCommand == w.command);
}

TEST_CASE("A button that is held stays with the view where it was pressed", "[modes]") {
  Window w;
  w.tools.activate(w.tool);
  w.mouse(Event::press, Pane::space, 100, 100);
  w.mouse(Event::move, Pane::axial, 100, 100);
  CHECK(w.modes.buttons() == C3DE_BUTTON_LEFT);
  w.mouse(Event::release, Pane::axial, 100, 100);
  CHECK(w.modes.buttons() == 0);
  REQUIRE(w.events.size() == 3);
  CHECK(w.events.back().type == C3DE_EVENT_RELEASE);
  CHECK(w.events.back().x_px == 100.0 - kSide);
  w.mouse(Event::press, Pane::axial, 100, 100);
  w.mouse(Event::release, Pane::axial, 100, 100);
  w.time_s = 0.2;
  w.mouse(Event::press, Pane::axial, 100, 100);
  CHECK(w.views.maximised() == Pane::axial);
  w.mouse(Event::release, Pane::axial, 100, 100);
  CHECK(w.events.size() == 3);
}

TEST_CASE("While a region is drawn plain drags in slices are its own, and the tool keeps the 3D view", "[modes]") {
  Window w;
  w.tools.activate(w.tool);
  w.draw();
  const Vec3 cross = w.views.crossHair();
  w.mouse(Event::press, Pane::axial, 150, 150);
  w.mouse(Event::move, Pane::axial, 250, 250);
  w.mouse(Event::release, Pane::axial, 250, 250);
  CHECK(w.modes.undoLabel() == "region");
  CHECK(w.views.crossHair() == cross);
  w.modes.undo(w.above);
  CHECK(w.modes.undoLabel().empty());
  CHECK(w.modes.redoLabel() == "region");
  w.modes.redo();
  CHECK(w.modes.undoLabel() == "region");
  CHECK(w.events.empty());
  w.mouse(Event::press, Pane::space, 100, 100);
  CHECK(w.events.size() == 1);
  CHECK(w.key('Z', Pane::space, C3DE_MOD_CTRL).command == Command::undo);
  // The window has lost the mouse.
  w.mouse(Event::release, Pane::space, 100, 100);
  const Box box = w.modes.region()->region().box();
  w.mouse(Event::press, Pane::axial, 200, 200);
  w.mouse(Event::move, Pane::axial, 220, 240);
  CHECK(w.modes.region()->region().box() != box);
  w.modes.loseFocus();
  CHECK(w.modes.region()->region().box() == box);
  CHECK(w.modes.buttons() == 0);
}

TEST_CASE("Escape ends the uppermost thing that is in progress, one at a time", "[modes]") {
  Window w;
  w.tools.activate(w.tool);
  w.draw();
  w.views.pickNext([](const Vec3 &) {});
  w.mouse(Event::press, Pane::axial, 150, 150);  // it picks
  w.mouse(Event::release, Pane::axial, 150, 150);
  w.views.pickNext([](const Vec3 &) {});

  w.above.isPopup = true;
  CHECK(w.key(keyEscape).closesMenus);
  w.above.isFile = true;
  CHECK(isNothing(w.key(keyEscape)));
  w.above = {};
  w.above.isTyping = true;
  CHECK(isNothing(w.key(keyEscape)));
  w.above = {};
  CHECK(w.views.isPicking());

  CHECK(w.key(keyEscape).endsLongStep);
  CHECK_FALSE(w.views.isPicking());
  CHECK(w.modes.region());

  w.mouse(Event::press, Pane::space, 100, 100);
  const int cancels = w.cancels;
  CHECK(w.key(keyEscape).endsLongStep);
  CHECK(w.cancels == cancels + 1);
  CHECK(w.modes.region());
  CHECK_FALSE(w.modes.isEscapeTaken());
  w.mouse(Event::release, Pane::space, 100, 100);

  const Box box = w.modes.region()->region().box();
  w.mouse(Event::press, Pane::axial, 200, 200);
  w.mouse(Event::move, Pane::axial, 220, 240);
  CHECK(w.modes.region()->region().box() != box);
  CHECK(isNothing(w.key(keyEscape)));
  REQUIRE(w.modes.region());
  CHECK(w.modes.region()->region().box() == box);
  CHECK(w.modes.isEscapeTaken());
  w.mouse(Event::release, Pane::axial, 220, 240);

  CHECK(isNothing(w.key(keyEscape)));
  CHECK_FALSE(w.modes.region());
  CHECK(w.modes.isEscapeTaken());
  CHECK(w.scan.isShown());
  CHECK_FALSE(w.scan.isHiddenTemporarily());
  CHECK_FALSE(w.scan.settings().region);
  w.frame();
  CHECK_FALSE(w.modes.isEscapeTaken());
  CHECK(w.key(keyEscape).endsLongStep);
  CHECK(w.cancels == cancels + 2);
}

TEST_CASE("Undo in the dialog of the scan's body is of its choices, unless something else is asked above it",
          "[modes]") {
  Window w;
  w.scan.show(true);
  w.settle();
  w.above.isPopup = true;
  const LabelUse before = w.scan.rows().front().use;
  w.scan.setUse({0}, {LabelUse::Kind::rigid, {}});
  for (bool Modes::Above::*other : {&Modes::Above::isFile, &Modes::Above::isQuestion, &Modes::Above::isTyping}) {
    w.above.*other = true;
    CHECK(isNothing(w.key('Z', Pane::space, C3DE_MOD_CTRL)));
    w.above.*other = false;
  }
  CHECK(w.key('Z', Pane::space, C3DE_MOD_CTRL).command == Command::undo);
  w.modes.undo(w.above);
  CHECK(w.scan.rows().front().use == before);
  CHECK(w.cancels == 0);
  w.scan.show(false);
  CHECK(isNothing(w.key('Z', Pane::space, C3DE_MOD_CTRL)));
  w.tools.activate(w.tool);
  w.modes.undo({});
  CHECK(w.cancels == 1);  // the tool releases its grab first
}

TEST_CASE("The drawing of a region ends with its image, and by being asked back to the dialog", "[modes]") {
  Window w;
  w.draw();
  w.modes.followRegion();
  REQUIRE(w.modes.region());
  w.scan.show(true);
  w.modes.followRegion();
  CHECK_FALSE(w.modes.region());
  CHECK(w.scan.isShown());
  w.draw();
  w.views.setImage(nullptr);
  w.scan.setSources({});
  w.modes.followRegion();
  CHECK_FALSE(w.modes.region());
  w.modes.beginRegion(10.0);
  CHECK_FALSE(w.modes.region());
}
