// SPDX-License-Identifier: Apache-2.0
// How the program passes on supports, loads, parts and limits of a run, with a simulator that reports its input.
#include <algorithm>
#include <chrono>

#include "program.h"

namespace {

c3de::ProcessResult runRecorder(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin() + 1, {"--no-plugins", "--plugin", C3DE_RECORDER});
  return runC3de(std::move(arguments));
}

/// A scene of the recorder; begins with 5 lines of body and probe.
std::filesystem::path writeRecorded(const std::filesystem::path &folder, const std::string &more) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(
      folder / "scene.toml",
      "format = 1\nprobe = [ { name = \"tip\", body = \"box\", at = [0, 0, 0] } ]\n[[body]]\nname = \"box\"\n"
      "mesh = \"box.obj\"\nmesh_unit = \"m\"\n" +
          more);
}

}  // namespace

TEST_CASE("Everything that a scene says of supports and parts arrives at the simulator") {
  const auto folder = freshFolder("recorded");
  const auto report = folder / "report.json";
  const auto scene = writeRecorded(folder, R"(velocity = [1, 2, 3]
angular_velocity = [4, 5, 6]
material = { density = 500, plastic = { yield = inf }, prony = [ { share = 0.25, time = 2 } ] }
sampling = { refine = [ { region = { sphere = { centre = [1, 0, 0], radius = 0.5 } }, spacing = 0.01 } ] }
[[body.parts]]
region = { box = { min = [0, 0, 0], max = [1, 2, 3] } }
material = { density = 700 }
[[body]]
name = "other"
mesh = "box.obj"
mesh_unit = "m"
[[fix]]
body = "other"
region = { everywhere = true }
[[fix]]
name = "grip"
body = "box"
region = { half_space = { point = [1, 2, 3], normal = [0, 0, 1] } }
displacement = [0.1, 0, 0]
rotation_deg = [0, 0, 90]
centre = [7, 8, 9]
ramp = 0.5
[[load]]
body = "box"
region = { everywhere = true }
force = [0, -2, 0]
ramp = 1
[[load]]
body = "box"
region = { everywhere = true }
pressure = 300
follower = false
[[load]]
body = "box"
region = { everywhere = true }
pressure = 20
[[obstacle]]
name = "press"
mesh = "box.obj"
mesh_unit = "m"
displacement = [0, -1, 0]
motion_rotation_deg = [10, 0, 0]
ramp = 2
[[obstacle]]
name = "floor"
mesh = "box.obj"
mesh_unit = "m"
)");
  const auto result = runRecorder({"run", scene.string(), "--steps", "1", "--report", report.string(), "-q"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto json = readJson(report);
  using Json = nlohmann::json;

  const Json &box = json.at("bodies").at(0);
  CHECK(box.at("velocity") == Json{1, 2, 3});
  CHECK(box.at("angular_velocity") == Json{4, 5, 6});
  CHECK(box.at("params").at("material.density") == 500);
  CHECK(box.at("params").at("material.plastic.yield") == "inf");
  CHECK(box.at("params").at("material.prony1.time") == 2);
  REQUIRE(box.at("refinements").size() == 1);
  CHECK(box.at("refinements").at(0).at("spacing_m") == 0.01);
  CHECK(box.at("refinements").at(0).at("region") ==
        Json{{"kind", 2}, {"a", {1, 0, 0}}, {"b", {0, 0, 0}}, {"radius", 0.5}});
  REQUIRE(box.at("parts").size() == 1);
  CHECK(box.at("parts").at(0).at("params") == Json{{"material.density", 700}});
  CHECK(box.at("parts").at(0).at("region") == Json{{"kind", 1}, {"a", {0, 0, 0}}, {"b", {1, 2, 3}}, {"radius", 0}});

  // Numbers count through the scene, not through the body.
  REQUIRE(box.at("fixes").size() == 1);
  const Json &grip = box.at("fixes").at(0);
  CHECK(grip.at("index") == 1);
  CHECK(grip.at("name") == "grip");
  CHECK(grip.at("region") == Json{{"kind", 3}, {"a", {1, 2, 3}}, {"b", {0, 0, 1}}, {"radius", 0}});
  CHECK(grip.at("motion") == Json{{"has_centre", true},
                                  {"displacement_m", {0.1, 0, 0}},
                                  {"rotation_deg", {0, 0, 90}},
                                  {"centre_m", {7, 8, 9}},
                                  {"ramp_s", 0.5}});
  const Json &held = json.at("bodies").at(1).at("fixes").at(0);
  CHECK(held.at("index") == 0);
  CHECK(held.at("region").at("kind") == 0);
  CHECK(held.at("motion").at("has_centre") == false);
  CHECK(json.at("bodies").at(1).at("loads").empty());

  REQUIRE(box.at("loads").size() == 3);
  CHECK(box.at("loads").at(0).at("flags") == 0);
  CHECK(box.at("loads").at(0).at("force_N") == Json{0, -2, 0});
  CHECK(box.at("loads").at(0).at("ramp_s") == 1);
  CHECK(box.at("loads").at(1).at("flags") == 3);  // a pressure that keeps its direction
  CHECK(box.at("loads").at(1).at("pressure_Pa") == 300);
  CHECK(box.at("loads").at(2).at("flags") == 1);
  CHECK(box.at("loads").at(2).at("index") == 2);

  const Json obstacles = Json::parse(json.at("events").at(0).at("text").get<std::string>());
  CHECK(obstacles.at(0).at("motion").at("displacement_m") == Json{0, -1, 0});
  CHECK(obstacles.at(0).at("motion").at("rotation_deg") == Json{10, 0, 0});
  CHECK(obstacles.at(0).at("motion").at("ramp_s") == 2);
  CHECK(obstacles.at(1).at("motion").is_null());
  // The simulator's reactions are in the report unchanged.
  CHECK(json.at("reactions").at(0).at("torque_Nm") == Json{0, 0, 1});
}

TEST_CASE("A simulator's refusal of a support or part leads to its line in the scene") {
  const auto folder = freshFolder("refused-tables");
  const std::string nothing = "region = { sphere = { centre = [0, 0, 0], radius = 666 } }\n";
  const std::string something = "region = { everywhere = true }\n";
  const struct {
    std::string more;
    const char *contains;
  } cases[] = {
      {"[[fix]]\n" + something + "[[fix]]\n" + nothing, "scene.toml:9: fix 1: the region meets no part of the body"},
      {"[[load]]\nforce = [0, 0, 1]\n" + nothing, "scene.toml:7: load 0: the region meets"},
      {"[[body.parts]]\nmaterial = { density = 1 }\n" + something + "[[body.parts]]\nmaterial = { density = 1 }\n" +
           nothing,
       "scene.toml:10: part 1: the region meets"},
      {"[[body.sampling.refine]]\nspacing = 0.1\n" + nothing, "scene.toml:7: refinement 0: the region meets"},
  };
  for (const auto &one : cases) {
    INFO(one.contains);
    const auto result = runRecorder({"run", writeRecorded(folder, one.more).string(), "--steps", "1"});
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains(one.contains));
  }
}

TEST_CASE("What a simulator does not declare for a part is refused with the line of the part") {
  const auto folder = freshFolder("unknown-in-part");
  const auto scene =
      writeRecorded(folder, "[[body.parts]]\nregion = { everywhere = true }\nmaterial = { densty = 3 }\n");
  const auto result = runRecorder({"run", scene.string(), "--steps", "1"});
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("scene.toml:9: ") && Contains("did you mean 'material.density'?"));
}

TEST_CASE("A quasi-static run goes on to its full load whatever --until says, or for the steps that are asked for") {
  const auto folder = freshFolder("load-steps");
  const auto report = folder / "report.json", probes = folder / "probes.csv";
  const auto scene = writeRecorded(folder, "[solver]\nintegrator = \"quasistatic\"\nload_steps = 7\n").string();
  for (const char *until : {"0", "1e6"}) {
    const auto full =
        runRecorder({"run", scene, "--until", until, "--report", report.string(), "--probes", probes.string()});
    INFO(full.errorOutput);
    REQUIRE(full.exitCode == 0);
    CHECK_THAT(full.output, Contains("7 load steps"));
    const auto json = readJson(report);
    CHECK(json.at("outcome") == "done");
    CHECK(json.at("steps") == 7);
    CHECK(json.at("time_s") == 0.0);
    CHECK(json.at("integrator") == "quasistatic");
    const std::string table = readFile(probes);
    CHECK(std::count(table.begin(), table.end(), '\n') == 9);  // heading, start, seven steps
  }
  REQUIRE(runRecorder({"run", scene, "--steps", "3", "--report", report.string(), "-q"}).exitCode == 0);
  CHECK(readJson(report).at("steps") == 3);
  REQUIRE(runRecorder({"run", scene, "--steps", "100", "--report", report.string(), "-q"}).exitCode == 0);
  CHECK(readJson(report).at("steps") == 7);
}

TEST_CASE("A run that diverges leaves report and probes with the last good state and says where") {
  const auto folder = freshFolder("diverged-recorded");
  const auto report = folder / "report.json", probes = folder / "probes.csv";
  const auto scene = writeRecorded(folder, "velocity = [13, 0, 0]\n").string();
  const auto result = runRecorder(
      {"run", scene, "--until", "1", "--report", report.string(), "--probes", probes.string(), "--probes-every", "2"});
  CHECK(result.exitCode == 5);
  CHECK_THAT(result.errorOutput,
             Contains("c3de: error: the simulation diverged: step 4 at 0.003 s failed: it left the finite") &&
                 Contains("the last good state is in ") && Contains("report.json") && Contains("probes.csv"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "diverged");
  CHECK(json.at("steps") == 3);
  // The start, step 2, and the last valid state.
  CHECK_THAT(readFile(probes), Contains("\n0,") && Contains("\n0.002,2,") && Contains("\n0.003,3,"));
}

TEST_CASE("A time limit ends a run between two steps with 124 and leaves its outputs") {
  const auto folder = freshFolder("time-limit");
  const auto report = folder / "report.json", probes = folder / "probes.csv";
  const auto scene = writeRecorded(folder, "").string();
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runRecorder({"run", scene, "--until", "1e9", "--time-limit", "0.5", "--report", report.string(),
                                   "--probes", probes.string(), "--probes-every", "1000000"});
  CHECK(result.exitCode == 124);
  // Far below the 120 s that a run of the tests may take; a busy machine is slow to start a program.
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
  CHECK_THAT(result.errorOutput, Contains("the time limit of 0.5 s was reached at ") && Contains("report.json"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "time_limit");
  CHECK_FALSE(json.at("failure").get<std::string>().empty());
  const std::string table = readFile(probes);
  CHECK(std::count(table.begin(), table.end(), '\n') >= 2);

  const auto inTime = runRecorder({"run", scene, "--steps", "5", "--time-limit", "1000", "-q"});
  CHECK(inTime.exitCode == 0);
  CHECK(runRecorder({"run", scene, "--time-limit", "-1"}).exitCode == 2);
}

TEST_CASE("info tells of supports, loads, parts and motions") {
  const auto folder = freshFolder("info-supports");
  const auto scene = writeRecorded(folder, R"(material = { plastic = { yield = inf } }
parts = [ { region = { everywhere = true }, material = { density = 700 } } ]
[[fix]]
region = { box = { min = [0, 0, 0], max = [0, 1, 1] } }
[[load]]
name = "press"
region = { everywhere = true }
pressure = 20
[[obstacle]]
mesh = "box.obj"
mesh_unit = "m"
displacement = [0, -1, 0]
)");
  const auto text = runRecorder({"info", scene.string()});
  INFO(text.errorOutput);
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("fix 0 of body \"box\"") && Contains("load 0 \"press\"") && Contains("20.0 Pa") &&
                              Contains("part 0 in"));
  const auto result = runRecorder({"info", scene.string(), "--json"});
  REQUIRE(result.exitCode == 0);
  const auto json = nlohmann::json::parse(result.output);
  using Json = nlohmann::json;
  CHECK(json.at("fixes").at(0).at("region") == Json{{"box", {{"min", {0, 0, 0}}, {"max", {0, 1, 1}}}}});
  CHECK(json.at("loads").at(0).at("pressure_Pa") == 20);
  CHECK(json.at("bodies").at(0).at("parts").at(0).at("region") == Json{{"everywhere", true}});
  CHECK(json.at("bodies").at(0).at("params").at("material.plastic.yield") == "inf");
  CHECK(json.at("obstacles").at(0).at("motion").at("displacement") == Json{0, -1, 0});
}

TEST_CASE("Where two plugins simulate the scene says which, else the program's own does, and the report names it") {
  const auto folder = freshFolder("two_simulators");
  const auto scene = writeRecorded(folder, ""), report = folder / "report.json";
  const auto run = [&](const std::vector<std::string> &more) {
    std::vector<std::string> arguments{"run",     "--plugin", C3DE_RECORDER, scene.string(),
                                       "--steps", "1",        "--report",    report.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runC3de(arguments);
  };
  // "a.test" comes first by name; the program's own is used nevertheless.
  const auto box = writeBoxScene(freshFolder("two_simulators_box"));
  const auto neither =
      runC3de({"run", "--plugin", C3DE_RECORDER, box.string(), "--steps", "1", "--report", report.string()});
  INFO(neither.errorOutput);
  CHECK(neither.exitCode == 0);
  CHECK(nlohmann::json::parse(readFile(report)).at("simulator").at("class") == "c3de.pointbased.WorldSimulator/1");
  const std::pair<std::string, std::string> classes[] = {{"a.test.Recorder/0", "test.recorder"},
                                                         {"c3de.pointbased.WorldSimulator/1", "c3de.pointbased"}};
  for (const auto &[id, plugin] : classes) {
    // The scene's settings belong to the recorder; the other simulator refuses them, and the message names the
    // requested one.
    const auto chosen = run({"--set", "simulator.class=" + id});
    if (plugin != "test.recorder") {
      CHECK_THAT(chosen.errorOutput, !Contains("several classes"));
      continue;
    }
    CHECK(chosen.exitCode == 0);
    const nlohmann::json said = nlohmann::json::parse(readFile(report)).at("simulator");
    CHECK(said.at("class") == id);
    CHECK(said.at("plugin") == plugin);
    CHECK(said.at("version") == "1.0.0");
  }
  CHECK(run({"--no-plugins"}).exitCode == 0);
  const auto unknown = run({"--set", "simulator.class=org.example.None/1"});
  CHECK(unknown.exitCode != 0);
  CHECK_THAT(unknown.errorOutput, Contains("'org.example.None/1'; there are: a.test.Recorder/0"));
}
