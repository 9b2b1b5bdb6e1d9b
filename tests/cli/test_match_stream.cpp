// SPDX-License-Identifier: Apache-2.0
// `c3de match --stream`: points that a tracking system sends.
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>
#include <thread>

#include "json_schema.h"
#include "program.h"
#include "support/tracking_server.h"

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

using NamedPoints = std::vector<std::pair<std::string, std::array<float, 3>>>;

fs::path resource(const char *name) { return fs::path(testResourcesFolder()) / name; }
std::string organScene() { return resource("scenes/first_light.toml").string(); }

/// The points of resources/match in RAS, moved by x mm to the left.
NamedPoints pointsAt(double x_mm) {
  std::istringstream in(readFile(resource("match/organ_points.csv")));
  NamedPoints out;
  std::string row;
  while (std::getline(in, row)) {
    std::array<double, 3> p{};
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &p[0], &p[1], &p[2]) != 3) continue;
    out.push_back({"", {static_cast<float>(-(p[0] + x_mm)), static_cast<float>(-p[1]), static_cast<float>(p[2])}});
  }
  return out;
}

std::string message(const NamedPoints &points, std::uint32_t seconds) {
  return packedWire({"POINT", "Tracker", pointBody(points)}, seconds);
}

}  // namespace

TEST_CASE("Frames of a tracking system are matched as they arrive, and their motions are sent back") {
  const fs::path folder = freshFolder("match_stream");
  TrackingServer server;
  std::vector<std::optional<WireMessage>> motions;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    for (int k = 0; k < 3; ++k) {
      server.send(message(pointsAt(4.0 * k), 1000 + static_cast<std::uint32_t>(k)));
      motions.push_back(server.receive("TRANSFORM", 120.0));
    }
  });
  const auto result = runC3de({"match", organScene(), "--stream", server.address(), "--stream-frames", "3", "--report",
                               (folder / "report.json").string(), "--frame-table", (folder / "table.csv").string()});
  tracker.join();
  INFO(result.errorOutput << result.output);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("3 of 3 frames") && Contains("not for clinical use"));
  const json report = readJson(folder / "report.json");
  const json schema = readJson(resource("schemas/report.schema.json"));
  for (const std::string &departure : departuresFrom(schema, report)) FAIL_CHECK(departure);
  const json &stream = report["match"]["stream"];
  CHECK(stream["address"] == server.address());
  CHECK(stream["received"] == 3);
  CHECK(stream["unmatched"] == 0);
  const json &frames = report["match"]["frames"];
  REQUIRE(frames.size() == 3);
  REQUIRE(motions.size() == 3);
  double first = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(frames[k]["frame"] == std::to_string(k + 1));
    CHECK(frames[k]["time_s"] == static_cast<double>(k));
    REQUIRE(motions[k]);
    CHECK(motions[k]->device == "C3DE_Motion");
    REQUIRE(motions[k]->body.size() == 48);
    // RAS: the points move to the left, which is -x.
    const double x = floatAt(motions[k]->body, 36);
    if (k == 0) first = x;
    // The measurement moves as a whole. A third of the surface determines the motion to some millimetres.
    CHECK_THAT(first - x, WithinAbs(4.0 * static_cast<double>(k), 3.0));
    CHECK_THAT(frames[k]["motion"]["matrix"][0][3].get<double>(), WithinAbs(-x, 1e-3));
  }
}

TEST_CASE("A stream names landmarks, sends those that it does not measure, and leaves out what cannot be matched") {
  const fs::path folder = freshFolder("match_stream_landmarks");
  TrackingServer server;
  std::optional<WireMessage> landmarks;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    NamedPoints points = pointsAt(0.0);
    points.push_back({"rim", {-0.31f, -50.13f, 208.93f}});
    server.send(message(NamedPoints(points.begin(), points.begin() + 2), 0));  // too few
    // The next one replaces no other: it is sent after the first has been taken.
    std::this_thread::sleep_for(std::chrono::seconds(2));
    server.send(message(points, 0));
    landmarks = server.receive("POINT", 120.0);
  });
  const auto result =
      runC3de({"match", organScene(), "--landmarks", resource("match/organ_landmarks.csv").string(), "--stream",
               server.address(), "--stream-frames", "2", "--report", (folder / "report.json").string()});
  tracker.join();
  INFO(result.errorOutput << result.output);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(result.errorOutput, Contains("frame 1") && Contains("it is left out"));
  const json match = readJson(folder / "report.json")["match"];
  CHECK(match["stream"]["unmatched"] == 1);
  REQUIRE(match["frames"].size() == 1);
  REQUIRE(match["frames"][0]["landmarks"].size() == 1);
  CHECK(match["frames"][0]["landmarks"][0]["name"] == "rim");
  REQUIRE(landmarks);
  CHECK(landmarks->device == "C3DE_Landmarks");
  REQUIRE(landmarks->body.size() == 3 * 136);
  // The second one was not measured. Where it was is known: (-71.16, -13.35, 166.03) in LPS.
  CHECK(landmarks->body.substr(136, 4) == std::string("top\0", 4));
  CHECK_THAT(floatAt(landmarks->body, 136 + 100), WithinAbs(71.16, 10.0));
  CHECK_THAT(floatAt(landmarks->body, 136 + 104), WithinAbs(13.35, 10.0));
  CHECK_THAT(floatAt(landmarks->body, 136 + 108), WithinAbs(166.03, 10.0));
}

TEST_CASE("A slice of the deformed image is sent at its measured place") {
  const fs::path folder = freshFolder("match_stream_slice");
  const std::string scene = resource("scenes/living_scan.toml").string();
  // The skin at rest is measured 7 mm farther to the left, and nothing else.
  REQUIRE(runC3de({"run", scene, "--steps", "0", "-q", "--set", "body.liver.sampling.count=400", "--export-surface",
                   (folder / "liver.obj").string()})
              .exitCode == 0);
  std::istringstream in(readFile(folder / "liver.obj"));
  NamedPoints points;
  std::string row;
  for (int n = 0; std::getline(in, row);) {
    double x = 0.0, y = 0.0, z = 0.0;
    if (std::sscanf(row.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3 && n++ % 5 == 0)
      points.push_back({"", {static_cast<float>(-(x + 7.0)), static_cast<float>(-y), static_cast<float>(z)}});
  }
  REQUIRE(points.size() > 300);
  TrackingServer server;
  std::optional<WireMessage> slice;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    server.send(message(points, 0));
    slice = server.receive("IMAGE", 120.0);
  });
  const auto result = runC3de({"match", scene, "--set", "body.liver.sampling.count=400", "--stream", server.address(),
                               "--stream-frames", "1", "--stream-slice", "-q"});
  tracker.join();
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  REQUIRE(slice);
  CHECK(slice->device == "C3DE_Slice");
  const std::string &body = slice->body;
  REQUIRE(shortAt(body, 6) == 112);
  REQUIRE(shortAt(body, 8) == 80);
  REQUIRE(shortAt(body, 10) == 1);
  REQUIRE(body.size() == 72 + 112 * 80 * sizeof(float));
  // i goes to the left, and the middle of the image is at x = 0, so the slice is 7 mm to the left.
  CHECK_THAT(floatAt(body, 12), WithinAbs(-2.9, 0.05));
  CHECK_THAT(floatAt(body, 48), WithinAbs(-7.0, 2.0));
  // Air at the corner, soft tissue in the middle.
  const auto valueAt = [&](std::size_t i, std::size_t j) {
    float value = 0.0f;
    std::memcpy(&value, body.data() + 72 + (i + 112 * j) * sizeof value, sizeof value);
    return value;
  };
  CHECK(valueAt(0, 0) < -900.0f);
  CHECK(valueAt(56, 40) > -200.0f);
}

TEST_CASE(
    "The surface is measured by the tip of a tracked tool, and each frame is matched while the next is collected") {
  const fs::path folder = freshFolder("match_stream_tool");
  TrackingServer server;
  std::optional<WireMessage> first, second;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    const auto sweep = [&](double x_mm) {
      for (const auto &[name, at] : pointsAt(x_mm)) {
        server.send(packedWire({"TRANSFORM", "Needle", transformBody({at[0] + 90.0f, at[1], at[2]})}, 1000));
        server.send(packedWire({"TRANSFORM", "Stylus", transformBody(at)}, 1001));
      }
    };
    sweep(0.0);
    first = server.receive("TRANSFORM", 120.0);
    sweep(5.0);
    second = server.receive("TRANSFORM", 120.0);
  });
  const auto result =
      runC3de({"match", organScene(), "--stream", server.address(), "--stream-frames", "2", "--stream-tool", "Stylus",
               "--stream-tool-points", "300", "--report", (folder / "report.json").string()});
  tracker.join();
  INFO(result.errorOutput << result.output);
  REQUIRE(result.exitCode == 0);
  REQUIRE(first);
  REQUIRE(second);
  const json match = readJson(folder / "report.json")["match"];
  REQUIRE(match["frames"].size() == 2);
  CHECK(match["frames"][0]["points"] == 300);
  CHECK(match["frames"][0]["verdict"] == "found");
  // The remaining points of the first sweep begin the second frame.
  CHECK(match["stream"]["received"].get<int>() >= 2);
}

TEST_CASE("A tool that is not tracked is reported with those that are") {
  TrackingServer server;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    server.send(packedWire({"TRANSFORM", "Stylus", transformBody({1.0f, 2.0f, 3.0f})}));
    server.receive("TRANSFORM", 10.0);  // until the connection ends
  });
  const auto result = runC3de(
      {"match", organScene(), "--stream", server.address(), "--stream-timeout", "2", "--stream-tool", "Styles"});
  tracker.join();
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("no points for 2") && Contains("0 of 200 points of tool 'Styles'") &&
                                     Contains("tracked tools: Stylus"));
}

TEST_CASE("A stream that is lost ends the match with what was matched, and is reported at once") {
  const fs::path folder = freshFolder("match_stream_lost");
  TrackingServer server;
  std::thread tracker([&] {
    if (!server.accept(120.0)) return;
    server.send(message(pointsAt(0.0), 0));
    server.receive("TRANSFORM", 120.0);
    server.disconnect();
  });
  const auto result = runC3de({"match", organScene(), "--stream", server.address(), "--stream-timeout", "2", "--report",
                               (folder / "report.json").string()});
  tracker.join();
  INFO(result.errorOutput << result.output);
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("the server has closed the connection") && Contains("no points for 2"));
  const json report = readJson(folder / "report.json");
  CHECK(report["match"]["frames"].size() == 1);
  CHECK_THAT(report["failure"].get<std::string>(), Contains("no points for 2"));
}

TEST_CASE("Options of a stream without effect, and wrong addresses, are refused") {
  const auto refusal = [](std::vector<std::string> options) {
    options.insert(options.begin(), {"match", organScene()});
    const auto result = runC3de(options);
    CHECK(result.exitCode == 2);
    return result.errorOutput;
  };
  CHECK_THAT(refusal({"--stream", "nobody:0"}), Contains("'nobody:0'") && Contains("accepted: HOST or HOST:PORT"));
  CHECK_THAT(refusal({"--stream-frames", "3"}), Contains("--stream"));
  CHECK_THAT(refusal({"--stream", "localhost", "--frames", "x.csv"}), Contains("excludes"));
  CHECK_THAT(refusal({"--stream", "localhost", "--stream-slice"}), Contains("the scene has no image"));
  CHECK_THAT(refusal({"--stream", "localhost", "--use", "fit"}), Contains("landmarks"));
  CHECK_THAT(refusal({"--stream-tool", "Stylus"}), Contains("--stream"));
  CHECK_THAT(refusal({"--stream", "localhost", "--stream-tool", ""}), Contains("the name is empty"));
  CHECK_THAT(refusal({"--stream", "localhost", "--stream-tool-points", "100"}), Contains("--stream-tool"));
  CHECK_THAT(refusal({"--stream", "localhost", "--stream-tool", "Stylus", "--stream-tool-points", "11"}),
             Contains("12") && Contains("2000"));
  CHECK_THAT(refusal({"--stream", "localhost", "--stream-tool", "Stylus", "--use", "fit"}),
             Contains("a tool measures no landmarks"));
  CHECK_THAT(refusal({"--frame-table", "t.csv", "--points", "p.csv"}), Contains("with --frames or --stream"));
}
