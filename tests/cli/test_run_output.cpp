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
    // Simulating this long would exceed the time of the test.
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

TEST_CASE("One file for two outputs, or for an input, is refused before anything runs") {
  const auto folder = freshFolder("same-file");
  const auto scene = writeBoxScene(folder).string();
  const auto a = (folder / "a.json").string(), again = (folder / "." / "a.json").string();
  const struct {
    std::vector<std::string> options;
    const char *contains;
  } cases[] = {
      {{"--report", a, "--probes", again}, "is named for two outputs"},
      {{"--report", a, "--screenshot", again}, "is named for two outputs"},
      {{"--report", scene}, "is read by this run"},
      {{"--probes", (folder / "." / "box.obj").string()}, "is read by this run"},
      {{"--export-surface", (folder / "." / "box.obj").string()}, "is read by this run"},
      {{"--export", (folder / "e.pvd").string(), "--report", (folder / "e_frames" / "skin_000000.vtp").string()},
       "fills with frames"},
  };
  std::filesystem::create_directories(folder / "e_frames");
  for (const auto &one : cases) {
    std::vector<std::string> arguments{"run", scene, "--until", "1e6"};
    arguments.insert(arguments.end(), one.options.begin(), one.options.end());
    const auto result = runC3de(arguments);
    INFO(one.options.back() << ": " << result.errorOutput);
    CHECK(result.exitCode == 2);
    CHECK_THAT(result.errorOutput, Contains(one.contains));
  }
  CHECK_FALSE(std::filesystem::exists(a));
  CHECK(readFile(folder / "box.obj") == boxObj());
}

#if !defined(_WIN32)
TEST_CASE("A full disk is named, what fits is written whole, and the rest is said") {
  const auto folder = freshFolder("full-disk");
  const auto scene = writeBoxScene(folder).string();
  const auto at = [&](const char *name) { return (folder / name).string(); };
  // One kilobyte or two, depending on the shell: less than the report and the frames, more than the skin.
  const auto result = c3de::runProcess(
      {"sh", "-c", "ulimit -f 2; exec \"$0\" \"$@\"", C3DE_PROGRAM, "run", scene, "--steps", "200", "--probes",
       at("probes.csv"), "--export", at("e.pvd"), "--report", at("report.json"), "--export-surface", at("skin.stl")},
      60.0);
  REQUIRE(result.has_value());
  INFO(result->errorOutput);
  CHECK(result->exitCode == 7);
  CHECK_THAT(result->errorOutput, Contains("probes.csv: could not be written: File too large") &&
                                      Contains("report.json: could not be written: File too large") &&
                                      Contains("points_000000.vtu: could not be written: File too large") &&
                                      Contains("not completely written: ") && Contains("; written: " + at("skin.stl")));
  CHECK_THAT(result->errorOutput, !Contains("No such file"));
  CHECK_FALSE(std::filesystem::exists(folder / "report.json"));
  const std::string table = readFile(folder / "probes.csv");
  REQUIRE(table.size() > 300);
  CHECK(table.back() == '\n');
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) CHECK(std::count(line.begin(), line.end(), ',') == 6);
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder))
    CHECK(entry.path().extension() != ".part");
}

TEST_CASE("An output on a full device does not keep the others from being written") {
  if (!std::filesystem::exists("/dev/full")) C3DE_SKIP("there is no /dev/full");
  const auto folder = freshFolder("full-device");
  const auto scene = writeBoxScene(folder).string(), report = (folder / "report.json").string(),
             skin = (folder / "skin.stl").string();
  const auto probes =
      runC3de({"run", scene, "--steps", "20", "--probes", "/dev/full", "--report", report, "--export-surface", skin});
  CHECK(probes.exitCode == 7);
  CHECK_THAT(probes.errorOutput,
             Contains("/dev/full: could not be written: No space left on device") && Contains("written: " + report));
  CHECK(readJson(report).at("steps") == 20);
  CHECK(std::filesystem::exists(skin));
  std::filesystem::remove(skin);
  CHECK(runC3de({"run", scene, "--steps", "2", "--report", "/dev/full", "--export-surface", skin}).exitCode == 7);
  CHECK(std::filesystem::exists(skin));
}

TEST_CASE("A table of probes has whole rows after a kill") {
  const auto folder = freshFolder("killed");
  const auto table = folder / "probes.csv";
  const auto result = c3de::runProcess({"timeout", "-s", "KILL", "2", C3DE_PROGRAM, "run",
                                        writeBoxScene(folder).string(), "--until", "1e6", "--probes", table.string()},
                                       60.0);
  REQUIRE(result.has_value());
  const std::string text = readFile(table);
  REQUIRE(text.size() > 1000);
  CHECK(text.back() == '\n');
  CHECK(std::count(text.begin(), text.end(), ',') == 6 * std::count(text.begin(), text.end(), '\n'));
}

TEST_CASE("What cannot be said on standard output is an error") {
  if (!std::filesystem::exists("/dev/full")) C3DE_SKIP("there is no /dev/full");
  const auto folder = freshFolder("full-output");
  const auto scene = writeBoxScene(folder).string(), mesh = (folder / "box.obj").string();
  const std::vector<std::vector<std::string>> commands{
      {"info", scene, "--json"},      {"info", mesh}, {"plugins"}, {"plugins", "--json"},
      {"run", scene, "--steps", "1"}, {"--version"},  {"--help"},  {"run", "--help"}};
  for (const auto &command : commands) {
    std::vector<std::string> arguments{"sh", "-c", "exec \"$0\" \"$@\" > /dev/full", C3DE_PROGRAM};
    arguments.insert(arguments.end(), command.begin(), command.end());
    const auto result = c3de::runProcess(arguments, 60.0);
    REQUIRE(result.has_value());
    INFO(command.front() << " " << command.back() << ": " << result->errorOutput);
    CHECK(result->exitCode == 7);
    CHECK_THAT(result->errorOutput, Contains("standard output: could not be written: No space left on device"));
  }
}
#endif

TEST_CASE("Probes are written as a table with units, one row per sample") {
  const auto folder = freshFolder("probes");
  const auto table = folder / "probes.csv";
  const auto result = runC3de(
      {"run", writeBoxScene(folder).string(), "--steps", "10", "--probes", table.string(), "--probes-every", "4"});
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
  const auto result = runWithoutDisplay(
      {"run", writeBoxScene(folder).string(), "--steps", "2", "--screenshot", picture.string(), "--size", "320x200"});
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

TEST_CASE("The 3D view of a screenshot is seen from the direction that was asked for", "[gpu]") {
  const auto folder = freshFolder("camera");
  const auto scene = writeBoxScene(folder);
  const auto run = [&](const std::string &name, std::vector<std::string> options) {
    std::vector<std::string> all{"run",          scene.string(),           "--steps", "1",    "-q",
                                 "--screenshot", (folder / name).string(), "--size",  "64x48"};
    all.insert(all.end(), options.begin(), options.end());
    return runWithoutDisplay(all);
  };
  const auto first = run("first.ppm", {});
  if (first.exitCode == 6) C3DE_SKIP("no OpenGL here: " + first.errorOutput);
  const auto draw = [&](const std::string &name, std::vector<std::string> options) {
    const auto result = run(name, std::move(options));
    INFO(result.errorOutput);
    REQUIRE(result.exitCode == 0);
    return readFile(folder / name);
  };
  const std::string header = "P6\n64 48\n255\n", usual = draw("usual.ppm", {});
  CHECK(bool(usual.substr(0, header.size()) == header));
  CHECK(usual.size() == header.size() + std::size_t{3} * 64 * 48);
  const std::string side = draw("side.PPM", {"--camera", "90,0"});
  // As bool: on a failure the bytes would fill the output.
  CHECK(bool(side != usual));
  CHECK(bool(draw("again.ppm", {"--camera=+90.0,0", "--up", "y"}) == side));
  CHECK(bool(draw("up.ppm", {"--camera", "90,0", "--up", "z"}) != side));
  CHECK(bool(draw("other.ppm", {"--camera=-90,0"}) != side));
  CHECK(draw("png.png", {}).substr(1, 3) == "PNG");
}

#if !defined(_WIN32)
TEST_CASE("Ctrl-C ends a run with 130 and still leaves the report") {
  const auto folder = freshFolder("interrupt");
  const auto report = folder / "report.json";
  const auto result =
      c3de::runProcess({"timeout", "--foreground", "--preserve-status", "-s", "INT", "3", C3DE_PROGRAM, "run",
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
