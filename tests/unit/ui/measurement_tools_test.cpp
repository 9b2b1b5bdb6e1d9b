// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/measurement_tools.h"

#include "c3de/render/renderer.h"
#include "c3de/ui/commands.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

/// The tools over an empty 3D view in which presses hit the inside of a body at a depth of 100 mm; a pixel is 1 mm.
struct Fixture {
  MeasurementList list;
  registry::ToolRegistry registry;
  std::vector<std::pair<MeasureKind, std::vector<MeasurementPick>>> placed;
  std::vector<std::pair<std::string, MeasurementPick>> moved;
  std::vector<std::string> removed;
  std::vector<std::pair<std::string, Vec3>> targeted;
  MeasurementTools tools{
      {list, nullptr, nullptr, [](const Vec3 &) { return 1.0; },
       [this](MeasureKind kind, std::vector<MeasurementPick> picks) { placed.emplace_back(kind, std::move(picks)); },
       [this](const std::string &name, const MeasurementPick &pick) { moved.emplace_back(name, pick); },
       [this](const std::string &name) { removed.push_back(name); },
       [this](const std::string &name, const Vec3 &at, bool) { targeted.emplace_back(name, at); }}};

  Fixture() { tools.addTo(registry); }

  void use(const std::string &id) {
    for (const auto &entry : registry.tools())
      if (entry.tool->id == id) REQUIRE(registry.activate(entry.handle));
  }
  bool send(std::uint32_t type, double x, double y, double inside_mm = 100.0) {
    c3de_event event{};
    event.size = sizeof event;
    event.type = type;
    event.button = type == C3DE_EVENT_MOVE ? 0 : C3DE_BUTTON_LEFT;
    event.x_px = x;
    event.y_px = y;
    event.ray_origin_mm[0] = x;
    event.ray_origin_mm[1] = y;
    event.ray_direction[2] = event.view_direction[2] = 1.0;
    event.inside_mm = type == C3DE_EVENT_PRESS ? inside_mm : -1.0;
    return registry.dispatch(event);
  }
  bool click(double x, double y, double inside_mm = 100.0) {
    const bool isUsed = send(C3DE_EVENT_PRESS, x, y, inside_mm);
    (void)send(C3DE_EVENT_RELEASE, x, y);
    return isUsed;
  }
};

}  // namespace

TEST_CASE("One click places a landmark, one that hits nothing is left to the camera") {
  Fixture f;
  f.use("measure.landmark");
  CHECK_FALSE(f.click(5, 6, -1.0));
  CHECK(f.placed.empty());
  CHECK(f.click(5, 6));
  REQUIRE(f.placed.size() == 1);
  CHECK(f.placed[0].second.at(0).at_mm == Vec3{5, 6, 100});
}

TEST_CASE("A distance takes two clicks, an angle three, an existing point is used") {
  Fixture f;
  MeasurementSet set;
  set.points = {{"tip", {}, {50, 0, 100}, {}, false, false}};
  f.list.edit("add", set);
  f.use("measure.distance");
  CHECK(f.click(0, 0));
  CHECK(f.tools.pending().size() == 1);
  (void)f.send(C3DE_EVENT_MOVE, 20, 0);
  CHECK(f.tools.follower() == Vec3{20, 0, 100});
  CHECK(f.click(53, 4));  // within reach
  REQUIRE(f.placed.size() == 1);
  CHECK(f.placed[0].second.at(0).name.empty());
  CHECK(f.placed[0].second.at(1).name == "tip");
  f.use("measure.angle");
  f.click(0, 0);
  f.click(0, 30);
  CHECK(f.placed.size() == 1);
  f.click(30, 30);
  REQUIRE(f.placed.size() == 2);
  CHECK(f.placed[1].first == MeasureKind::angle);
  CHECK(f.placed[1].second.size() == 3);
}

TEST_CASE("Escape cancels an unfinished measurement, and another tool does, too") {
  Fixture f;
  f.use("measure.distance");
  f.click(0, 0);
  f.registry.cancelActive();
  CHECK(f.tools.pending().empty());
  f.click(0, 0);
  f.use("measure.angle");
  CHECK(f.tools.pending().empty());
  CHECK(f.placed.empty());
}

TEST_CASE("A landmark is dragged, selected and deleted") {
  Fixture f;
  MeasurementSet set;
  set.points = {{"tip", {}, {50, 0, 100}, {}, false, false}};
  f.list.edit("add", set);
  f.use("measure.landmark");
  f.click(52, 1);
  CHECK(f.list.selected == "tip");
  CHECK(f.placed.empty());
  CHECK(f.moved.empty());  // a click does not move it
  (void)f.send(C3DE_EVENT_PRESS, 50, 0);
  (void)f.send(C3DE_EVENT_MOVE, 80, 10);
  CHECK(f.tools.dragged()->second == Vec3{80, 10, 100});
  (void)f.send(C3DE_EVENT_RELEASE, 80, 10);
  REQUIRE(f.moved.size() == 1);
  CHECK(f.moved[0].first == "tip");
  CHECK(f.moved[0].second.at_mm == Vec3{80, 10, 100});
  c3de_event key{};
  key.size = sizeof key;
  key.type = C3DE_EVENT_KEY;
  key.key = keyDelete;
  CHECK(f.registry.dispatch(key));
  CHECK(f.removed == std::vector<std::string>{"tip"});
}

TEST_CASE("The target of a landmark is the next click, and Escape or another tool cancels it") {
  Fixture f;
  MeasurementSet set;
  set.points = {{"tip", {}, {50, 0, 100}, {}, false, false}};
  f.list.edit("add", set);
  f.use("measure.distance");
  f.tools.placeTargetOf("tip");
  CHECK(f.tools.targetOf() == "tip");
  (void)f.send(C3DE_EVENT_MOVE, 20, 0);
  CHECK(f.tools.follower() == Vec3{20, 0, 100});
  CHECK_FALSE(f.click(9, 9, -1.0));  // nothing is there
  CHECK(f.targeted.empty());
  // Also over the landmark itself, which would be dragged otherwise.
  CHECK(f.click(51, 0));
  REQUIRE(f.targeted.size() == 1);
  CHECK(f.targeted.front() == std::pair(std::string("tip"), Vec3{51, 0, 100}));
  CHECK(f.placed.empty());
  CHECK(f.moved.empty());
  CHECK(f.tools.targetOf().empty());
  // Only one click.
  CHECK(f.click(5, 6));
  CHECK(f.placed.size() == 1);
  CHECK(f.targeted.size() == 1);
  f.tools.placeTargetOf("tip");
  (void)f.registry.activate({});
  CHECK(f.tools.targetOf().empty());
  f.tools.placeTargetOf("tip");
  f.use("measure.angle");
  CHECK(f.click(9, 9));
  CHECK(f.targeted.size() == 1);
}
