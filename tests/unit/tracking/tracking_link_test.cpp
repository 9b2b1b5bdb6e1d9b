// SPDX-License-Identifier: Apache-2.0
#include "c3de/tracking/tracking_link.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "support/catch.h"
#include "support/tracking_server.h"

using namespace c3de;
using namespace c3de::tracking;
using namespace std::chrono_literals;

namespace {

constexpr auto kLong = 20000ms;  // far longer than needed, for slow machines

std::unique_ptr<TrackingLink> linkTo(TrackingServer &server, const std::optional<TrackedTool> &tool = {}) {
  auto link = TrackingLink::open(*parseTrackingAddress(server.address()), tool);
  REQUIRE(link);
  REQUIRE(server.accept());
  return std::move(*link);
}

bool waitFor(const TrackingLink &link, const std::function<bool(const LinkStatus &)> &holds) {
  for (int k = 0; k < 2000; ++k) {
    if (holds(link.status())) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

std::string pointMessage(const std::vector<std::pair<std::string, std::array<float, 3>>> &points,
                         std::uint32_t seconds = 0) {
  return packedWire({"POINT", "Probe", pointBody(points)}, seconds);
}

}  // namespace

TEST_CASE("Points of a tracking system arrive in LPS, with names and time") {
  TrackingServer server;
  const auto link = linkTo(server);
  REQUIRE(server.send(pointMessage({{"tumour", {1.0f, 2.0f, 3.0f}}, {"", {-4.5f, 0.0f, 0.25f}}}, 1234)));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->device == "Probe");
  CHECK(frame->time_s == Approx(1234.0));
  REQUIRE(frame->points.size() == 2);
  CHECK(frame->points[0].name == "tumour");
  CHECK(frame->points[0].at_mm == Vec3{-1.0, -2.0, 3.0});
  CHECK(frame->points[1].at_mm == Vec3{4.5, 0.0, 0.25});
  CHECK(link->status().state == LinkState::receiving);
  CHECK_FALSE(link->takeFrame(0ms));
}

TEST_CASE("Of frames that were not taken the newest remains, and the others are counted") {
  TrackingServer server;
  const auto link = linkTo(server);
  std::string all;
  for (int k = 1; k <= 5; ++k) all += pointMessage({{"", {static_cast<float>(k), 0.0f, 0.0f}}});
  // In parts that end within headers and bodies.
  for (std::size_t at = 0; at < all.size(); at += 37) {
    REQUIRE(server.send(all.substr(at, 37)));
    std::this_thread::sleep_for(1ms);
  }
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.received == 5; }));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->points.at(0).at_mm[0] == -5.0);
  CHECK_FALSE(frame->time_s);
  CHECK(link->status().replaced == 4);
}

TEST_CASE("Invalid messages of a tracking system are refused and counted, others are skipped") {
  TrackingServer server;
  const auto link = linkTo(server);
  std::string damaged = pointMessage({{"", {1.0f, 0.0f, 0.0f}}});
  damaged[58 + 100] ^= 1;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::string cut = pointBody({{"", {1.0f, 0.0f, 0.0f}}});
  cut.resize(cut.size() - 7);
  REQUIRE(server.send(damaged));
  REQUIRE(server.send(pointMessage({{"", {nan, 0.0f, 0.0f}}})));
  REQUIRE(server.send(pointMessage({{"", {0.0f, 2e6f, 0.0f}}})));
  REQUIRE(server.send(packedWire({"STATUS", "Probe", std::string(30, '\0')})));
  REQUIRE(server.send(packedWire({"GET_CAPABIL", "", ""})));
  REQUIRE(server.send(packedWire({"TRANSFORM", std::string(20, 'x'), std::string(48, '\0')})));
  REQUIRE(server.send(pointMessage({{std::string(64, 'n'), {1.0f, 0.0f, 0.0f}}})));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->points.at(0).at_mm[0] == -1.0);
  CHECK(frame->points.at(0).name.find_first_not_of('n') == std::string::npos);
  CHECK(link->status().received == 1);
  CHECK(link->status().refused == 3);
  // A body that is no whole number of points.
  REQUIRE(server.send(packedWire({"POINT", "Probe", cut}) + pointMessage({{"", {7.0f, 0.0f, 0.0f}}})));
  const auto next = link->takeFrame(kLong);
  REQUIRE(next);
  CHECK(next->points.back().at_mm[0] == -7.0);
}

TEST_CASE("Points in messages with an extended header and metadata are read, as 3D Slicer sends them") {
  TrackingServer server;
  const auto link = linkTo(server);
  const WireMessage message{"POINT", "Probe", pointBody({{"tumour", {1.0f, 2.0f, 3.0f}}, {"", {4.0f, 0.0f, 0.0f}}})};
  const std::string whole = packedExtendedWire(message);
  // Damaged: a byte of the points; a header and metadata that are longer than the body; a body that is too short.
  std::string damaged = whole;
  damaged[58 + 12 + 100] ^= 1;
  REQUIRE(server.send(damaged));
  REQUIRE(server.send(packedExtendedWire({"POINT", "Probe", std::string(100, 'x')})));
  for (const std::size_t size : {1, 7, 11, 20}) {
    WireMessage cut = message;
    cut.body = whole.substr(58, size);
    std::string bytes = packedWire(cut);
    bytes[1] = 2;
    REQUIRE(server.send(bytes));
  }
  REQUIRE(server.send(whole));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->device == "Probe");
  REQUIRE(frame->points.size() == 2);
  CHECK(frame->points[0].name == "tumour");
  CHECK(frame->points[0].at_mm == Vec3{-1.0, -2.0, 3.0});
  CHECK(link->status().refused == 6);
}

TEST_CASE("Positions of a tool's tip are collected into frames") {
  TrackingServer server;
  const auto link = linkTo(server, TrackedTool{"StylusTipToReferenceOfTheTable", 3});
  const auto tip = [](const char *name, float x) {
    return packedWire({"TRANSFORM", name, transformBody({x, 1.0f, 2.0f})}, 100 + static_cast<std::uint32_t>(x));
  };
  // A name is cut to 20 bytes in a message. Points that are sent together are no positions of the tool.
  const char *own = "StylusTipToReference";
  REQUIRE(server.send(pointMessage({{"", {0.0f, 0.0f, 0.0f}}})));
  REQUIRE(server.send(tip("Needle", 50.0f)));
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return !status.others.empty(); }));
  CHECK_THAT(textOf(link->status()), Contains("0 of 3 points of tool 'StylusTipToReference'; tracked tools: Needle"));
  REQUIRE(server.send(tip(own, 1.0f)));
  REQUIRE(server.send(tip(own, 2.5f)));  // nearer than 2 mm
  REQUIRE(server.send(tip(own, std::numeric_limits<float>::infinity())));
  REQUIRE(server.send(packedWire({"TRANSFORM", own, std::string(40, '\0')})));
  REQUIRE(server.send(packedExtendedWire({"TRANSFORM", own, transformBody({4.0f, 1.0f, 2.0f})})));
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.tips == 3; }));
  CHECK_THAT(textOf(link->status()),
             Contains("0 frames received, 2 refused as invalid; 2 of 3 points of tool") && !Contains("Needle"));
  CHECK_FALSE(link->takeFrame(0ms));
  REQUIRE(server.send(tip(own, 7.0f)));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->device == own);
  CHECK(frame->time_s == Approx(107.0));
  REQUIRE(frame->points.size() == 3);
  CHECK(frame->points[0].at_mm == Vec3{-1.0, -1.0, 2.0});
  CHECK(frame->points[1].at_mm == Vec3{-4.0, -1.0, 2.0});
  CHECK(frame->points[2].at_mm == Vec3{-7.0, -1.0, 2.0});
  // The next frame begins without the points of this one.
  const std::string position = transformBody({0.0f, 0.0f, 0.0f}).substr(0, 12);  // (1, 0, 0)
  REQUIRE(server.send(packedWire({"POSITION", own, position})));
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.collected == 1; }));
  REQUIRE(server.send(tip(own, 11.0f) + tip(own, 15.0f)));
  const auto next = link->takeFrame(kLong);
  REQUIRE(next);
  CHECK(next->points.at(0).at_mm == Vec3{-1.0, 0.0, 0.0});
  CHECK(link->status().received == 2);
}

TEST_CASE("A lost tracking system is reported within a second, and connected again") {
  TrackingServer server;
  const auto link = linkTo(server);
  REQUIRE(server.send(pointMessage({{"", {1.0f, 0.0f, 0.0f}}})));
  REQUIRE(link->takeFrame(kLong));
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::silent; }));
  CHECK(link->status().silence_s >= kSilence_s);
  CHECK_THAT(textOf(link->status()), Contains("no points for 1.") && Contains("1 frame received"));
  server.disconnect();
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::lost; }));
  CHECK_THAT(textOf(link->status()), Contains("the server has closed the connection"));
  REQUIRE(server.accept());
  REQUIRE(server.send(pointMessage({{"", {2.0f, 0.0f, 0.0f}}})));
  const auto frame = link->takeFrame(kLong);
  REQUIRE(frame);
  CHECK(frame->points.at(0).at_mm[0] == -2.0);
  CHECK(link->status().reason.empty());
}

TEST_CASE("Messages report connections that were made or lost, and no silence") {
  ConnectionChange change;
  CHECK_FALSE(change.update(LinkState::connecting));
  CHECK(change.update(LinkState::receiving));
  CHECK_FALSE(change.update(LinkState::silent));
  CHECK_FALSE(change.update(LinkState::receiving));
  CHECK(change.update(LinkState::lost));
  CHECK_FALSE(change.update(LinkState::lost));
  CHECK(change.update(LinkState::silent));
}

TEST_CASE("A tracking system that announces too large a message is disconnected") {
  TrackingServer server;
  const auto link = linkTo(server);
  std::string message = packedWire({"IMAGE", "Huge", ""});
  message.replace(42, 8, std::string(8, '\x7f'));
  REQUIRE(server.send(message));
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::lost; }));
  CHECK_THAT(link->status().reason, Contains("accepted: at most 67108864"));
}

TEST_CASE("Where no tracking system listens the link says so") {
  std::string address;
  {
    const TrackingServer closed;
    address = closed.address();
  }
  const auto link = TrackingLink::open(*parseTrackingAddress(address), {});
  REQUIRE(link);
  REQUIRE(waitFor(**link, [](const LinkStatus &status) { return status.state == LinkState::lost; }));
  CHECK_THAT(textOf((*link)->status()), Contains("no server accepts connections there") && Contains("0 frames"));
  (*link)->sendTransform("C3DE_Motion", kIdentity4);  // discarded
}

TEST_CASE("A motion is sent in RAS") {
  TrackingServer server;
  const auto link = linkTo(server);
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::receiving; }));
  // A quarter turn about x, which keeps LPS and RAS apart: y to z. Column-major.
  const Mat4 motion{1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 10, 20, 30, 1};
  link->sendTransform("C3DE_Motion", motion);
  const auto message = server.receive("TRANSFORM");
  REQUIRE(message);
  CHECK(message->device == "C3DE_Motion");
  REQUIRE(message->body.size() == 48);
  const std::array<float, 12> expected{1, 0, 0, 0, 0, -1, 0, 1, 0, -10, -20, 30};  // columns
  for (std::size_t i = 0; i < 12; ++i) CHECK(floatAt(message->body, 4 * i) == expected[i]);
}

TEST_CASE("Points are sent in RAS") {
  TrackingServer server;
  const auto link = linkTo(server);
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::receiving; }));
  link->sendPoints("C3DE_Landmarks", {{"apex", {1.0, 2.0, 3.0}}, {std::string(100, 'a'), {4.0, 5.0, 6.0}}});
  const auto message = server.receive("POINT");
  REQUIRE(message);
  REQUIRE(message->body.size() == 2 * 136);
  CHECK(message->body.substr(0, 5) == std::string("apex\0", 5));
  CHECK(floatAt(message->body, 100) == -1.0f);
  CHECK(floatAt(message->body, 104) == -2.0f);
  CHECK(floatAt(message->body, 136 + 108) == 6.0f);
}

TEST_CASE("An image is sent in RAS, about its centre, with rescaled values") {
  TrackingServer server;
  const auto link = linkTo(server);
  REQUIRE(waitFor(*link, [](const LinkStatus &status) { return status.state == LinkState::receiving; }));
  imaging::Volume image;
  image.geometry.size = {3, 2, 1};
  // i along y of LPS with 2 mm, j along x with 0.5 mm, k downwards with 4 mm.
  image.geometry.indexToWorld = {0, 2, 0, 0, 0.5, 0, 0, 0, 0, 0, -4, 0, 100, 200, 300, 1};
  image.voxels = std::vector<std::int16_t>{0, 1, 2, 3, 4, -5};
  image.slope = 2.0;
  image.intercept = -1.0;
  link->sendImage("C3DE_Slice", image);
  const auto message = server.receive("IMAGE");
  REQUIRE(message);
  const std::string &body = message->body;
  REQUIRE(body.size() == 72 + 6 * sizeof(float));
  CHECK(shortAt(body, 0) == 1);  // version
  CHECK(body[2] == 1);           // components
  CHECK(body[3] == 10);          // float32
  CHECK(body[5] == 1);           // RAS
  CHECK(shortAt(body, 6) == 3);
  CHECK(shortAt(body, 8) == 2);
  CHECK(shortAt(body, 10) == 1);
  // Steps along i, j and k, then the centre: (100.25, 202, 300) in LPS.
  const std::array<float, 12> expected{0, -2, 0, -0.5f, 0, 0, 0, 0, -4, -100.25f, -202.0f, 300.0f};
  for (std::size_t i = 0; i < 12; ++i) CHECK(floatAt(body, 12 + 4 * i) == expected[i]);
  REQUIRE(body[4] == 2);  // little endian
  std::array<float, 6> values{};
  std::memcpy(values.data(), body.data() + 72, sizeof values);
  CHECK(values == std::array<float, 6>{-1, 1, 3, 5, 7, -11});
}
