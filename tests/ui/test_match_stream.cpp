// SPDX-License-Identifier: Apache-2.0
// A body follows the points of a tracking system, in the panel *Match*.
#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "support/folders.h"
#include "support/tracking_server.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

fs::path resource(const char *name) { return fs::path(testResourcesFolder()) / name; }

/// The measured points of the organ in RAS, moved by x mm to the left.
using NamedPoints = std::vector<std::pair<std::string, std::array<float, 3>>>;
NamedPoints pointsAt(double x_mm, int most = 100000) {
  std::ifstream in(resource("match/organ_points.csv"));
  NamedPoints points;
  std::string row;
  while (static_cast<int>(points.size()) < most && std::getline(in, row)) {
    double x = 0.0, y = 0.0, z = 0.0;
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &x, &y, &z) != 3) continue;
    points.push_back({"", {static_cast<float>(-(x + x_mm)), static_cast<float>(-y), static_cast<float>(z)}});
  }
  return points;
}

std::string frame(double x_mm, int most = 100000) {
  return packedWire({"POINT", "Tracker", pointBody(pointsAt(x_mm, most))});
}

}  // namespace

TEST_CASE("the organ follows a tracking system until it is stopped, as one step of undo", "[match_stream]") {
  C3DE_ORGAN_OR_SKIP();
  TrackingServer server;
  WorkstationDriver window("match_stream");
  openOrgan(window, {resource("scenes/first_light.toml").string()});
  window.key("ctrl+shift+m");
  C3DE_WAIT(window, "the panel is open", s["widgets"].contains("match/source"));
  window.choose("match/source", "points of a tracking system");
  C3DE_WAIT(window, "an address can be entered", s["widgets"].contains("match/server"));
  window.click("match/server");
  window.key("ctrl+a");
  window.type(server.address());
  window.key("Return");
  const std::string before = row(window.state(), "State hash");
  window.click("match/match");
  REQUIRE(server.accept(60.0));
  C3DE_WAIT(window, "it is connected", textOf(s, "match/Stream").starts_with("connected; 0 frames"));

  REQUIRE(server.send(frame(0.0)));
  const auto first = server.receive("TRANSFORM", 120.0);
  REQUIRE(first);
  CHECK(first->device == "C3DE_Motion");
  const Json matched = C3DE_WAIT(window, "it is matched",
                                 textOf(s, "match/Stream").find("1 matched, the last one in") != std::string::npos);
  CHECK(row(matched, "State hash") != before);
  CHECK(numberOf(matched, "match/Points, deformed") < 1.25);
  window.screenshotAtRest("following");

  REQUIRE(server.send(frame(6.0)));
  const auto second = server.receive("TRANSFORM", 120.0);
  REQUIRE(second);
  // RAS: to the left is -x. A third of the surface determines the motion to some millimetres.
  CHECK_THAT(floatAt(first->body, 36) - floatAt(second->body, 36), WithinAbs(6.0, 3.0));
  C3DE_WAIT(window, "the second frame is matched", textOf(s, "match/Stream").find("2 matched") != std::string::npos);

  // Too few points: left out, and the stream continues.
  REQUIRE(server.send(frame(0.0, 5)));
  C3DE_WAIT(window, "a frame is left out", textOf(s, "match/Stream").find("1 left out") != std::string::npos);
  C3DE_WAIT(window, "the silence is reported", textOf(s, "match/Stream").starts_with("no points for"));
  server.disconnect();
  C3DE_WAIT(window, "the loss is reported", textOf(s, "match/Stream").starts_with("not connected for"));
  waitForMessage(window, "the server has closed the connection");
  window.screenshotAtRest("lost");
  REQUIRE(server.accept(60.0));
  REQUIRE(server.send(frame(3.0)));
  REQUIRE(server.receive("TRANSFORM", 120.0));
  C3DE_WAIT(window, "it follows again", textOf(s, "match/Stream").find("3 matched") != std::string::npos);

  window.click("match/cancel");
  C3DE_WAIT(window, "it has stopped", s["widgets"].contains("match/match") && !s["values"].contains("match/Stream"));
  CHECK(row(window.state(), "State hash") != before);
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  C3DE_WAIT(window, "the body is as before the stream", row(s, "State hash") == before);

  // Undo opens the simulation again. Stopped at once, whatever has begun, and connected again.
  const auto connect = [&] {
    window.click("match/match");
    REQUIRE(server.accept(60.0));
    REQUIRE(server.send(frame(1.0)));
  };
  server.disconnect();
  connect();
  window.click("match/cancel");
  C3DE_WAIT(window, "it has stopped", s["jobs"].empty() && s["widgets"].contains("match/match"));
  server.disconnect();
  connect();
  REQUIRE(server.receive("TRANSFORM", 120.0));
  C3DE_WAIT(window, "it follows", textOf(s, "match/Stream").find("1 matched") != std::string::npos);
  window.click("match/cancel");
  C3DE_WAIT(window, "it has stopped again", s["widgets"].contains("match/match"));

  // The tip of a tool.
  window.click("match/tool");
  window.type("Stylus");
  window.key("Return");
  C3DE_WAIT(window, "its number of points can be set", s["widgets"].contains("match/tool_points"));
  window.screenshotAtRest("tool");
  server.disconnect();
  window.click("match/match");
  REQUIRE(server.accept(60.0));
  for (const auto &[name, at] : pointsAt(0.0, 100))
    REQUIRE(server.send(packedWire({"TRANSFORM", "Stylus", transformBody(at)})));
  C3DE_WAIT(window, "the collected points are counted",
            textOf(s, "match/Stream").find(" of 200 points of tool 'Stylus'") != std::string::npos &&
                textOf(s, "match/Stream").find("; 0 of 200") == std::string::npos);
  CHECK(textOf(window.state(), "match/Stream").find("0 matched") != std::string::npos);
  window.screenshotAtRest("collecting");
  for (const auto &[name, at] : pointsAt(0.0))
    REQUIRE(server.send(packedWire({"TRANSFORM", "Stylus", transformBody(at)})));
  REQUIRE(server.receive("TRANSFORM", 120.0));
  C3DE_WAIT(window, "a frame of the tool is matched", textOf(s, "match/Stream").find("1 matched") != std::string::npos);
  window.click("match/cancel");
  C3DE_WAIT(window, "it has stopped", s["jobs"].empty() && s["widgets"].contains("match/match"));

  // An address that is none.
  window.click("match/server");
  window.key("ctrl+a");
  window.type("nobody:0");
  window.key("Return");
  window.click("match/match");
  waitForMessage(window, "a port is a number from 1 to 65535");
}
