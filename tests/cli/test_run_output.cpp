// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <sstream>

#include "program.h"

TEST_CASE("An output that cannot be written ends with 7 before anything is simulated") {
  const auto folder = freshFolder("unwritable");
  const auto scene = writeBoxScene(folder).string();
  for (const std::string option : {"--report", "--probes", "--screenshot", "--export", "--export-surface"}) {
    INFO(option);
    const std::string file = option == "--export" ? "file.pvd" : option == "--export-surface" ? "file.stl" : "file";
    // Simulating this long would take longer than the test is given.
    const auto absent = runC3de({"run", scene, "--until", "1e6", option, (folder / "absent" / file).string()});
    CHECK(absent.exitCode == 7);
    CHECK_THAT(absent.errorOutput, Contains("c3de: error: ") && Contains("there is no folder"));
    std::filesystem::create_directories(folder / ("folder-" + file));
    const auto isFolder = runC3de({"run", scene, "--until", "1e6", option, (folder / ("folder-" + file)).string()});
    CHECK(isFolder.exitCode == 7);
  }
}

TEST_CASE("Asking whether a file can be written leaves nothing behind and keeps what is there") {
  const auto folder = freshFolder("left-behind");
  const auto kept = writeFile(folder / "kept.json", "before");
  const auto result = runC3de({"run", (folder / "absent.toml").string(), "--report", (folder / "new.json").string(),
                               "--probes", kept.string()});
  CHECK(result.exitCode == 3);
  CHECK_FALSE(std::filesystem::exists(folder / "new.json"));
  CHECK(readFile(kept) == "before");
}

TEST_CASE("Probes are written as a table with units, one row per sample") {
  const auto folder = freshFolder("probes");
  const auto table = folder / "probes.csv";
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--steps", "10", "--probes", table.string(),
                               "--probes-every", "4"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  std::istringstream lines(readFile(table));
  std::string line;
  REQUIRE(std::getline(lines, line));
  CHECK(line == "time [s],tip.x [m],tip.y [m],tip.z [m],tip.vx [m/s],tip.vy [m/s],tip.vz [m/s]");
  std::vector<double> times, heights;
  while (std::getline(lines, line)) {
    double time = 0, x = 0, y = 0;
    REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &time, &x, &y) == 3);
    times.push_back(time);
    heights.push_back(y);
    CHECK(std::count(line.begin(), line.end(), ',') == 6);
  }
  // The beginning, steps 4 and 8, and the end.
  REQUIRE(times.size() == 4);
  CHECK(times.front() == 0.0);
  CHECK_THAT(heights.front(), WithinAbs(0.1, 1e-9));
  CHECK(times[3] > times[2]);
  CHECK(heights[3] < heights[0]);
}

TEST_CASE("A screenshot of the end state has the size that was asked for", "[gpu]") {
  const auto folder = freshFolder("screenshot");
  const auto picture = folder / "scene.png";
  const auto result = runWithoutDisplay({"run", writeBoxScene(folder).string(), "--steps", "2", "--screenshot",
                                         picture.string(), "--size", "320x200"});
  INFO(result.errorOutput);
  if (result.exitCode == 6) C3DE_SKIP("no OpenGL here: " + result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const std::string png = readFile(picture);
  REQUIRE(png.size() > 2000);  // an empty background would be smaller
  const auto bigEndian = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value * 256 + static_cast<unsigned char>(png[at + i]);
    return value;
  };
  CHECK(png.substr(1, 3) == "PNG");
  CHECK(bigEndian(16) == 320);
  CHECK(bigEndian(20) == 200);
}

#if !defined(_WIN32)
TEST_CASE("Ctrl-C ends a run with 130 and still leaves the report") {
  const auto folder = freshFolder("interrupt");
  const auto report = folder / "report.json";
  const auto result = c3de::runProcess({"timeout", "--foreground", "--preserve-status", "-s", "INT", "3", C3DE_PROGRAM, "run",
                                        writeBoxScene(folder).string(), "--until", "1e6", "--report", report.string()},
                                       60.0);
  REQUIRE(result.has_value());
  INFO(result->errorOutput);
  CHECK(result->exitCode == 130);
  CHECK_THAT(result->errorOutput, Contains("interrupted at"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "interrupted");
  CHECK(json.at("steps").get<int>() > 0);
}
#endif
