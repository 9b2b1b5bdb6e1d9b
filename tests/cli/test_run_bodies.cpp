// SPDX-License-Identifier: Apache-2.0
// Messages of the program about bodies whose scene or sampling cannot deliver what it seems to promise.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "program.h"

namespace {

using Json = nlohmann::json;

/// Three boxes of 1 x 0.2 x 0.2 m at most; lines are counted from "format".
std::filesystem::path writeScene(const std::filesystem::path &folder, const std::string &world, const std::string &more,
                                 const std::string &sampling = "spacing = 0.05") {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "scene.toml", "format = 1\n[world]\n" + world +
                                              "\n[[body]]\nname = \"box\"\nmesh = \"box.obj\"\n"
                                              "mesh_unit = \"m\"\nsampling = { " +
                                              sampling + " }\n" + more);
}

}  // namespace

TEST_CASE("A probe off its body is refused with its line, one near the surface is not") {
  const auto folder = freshFolder("probe-off");
  for (const char *at : {"[0.5, 0.3, 0.1]", "[0.5, 1e300, 0.1]", "[-0.2, 0.1, 0.1]"}) {
    const auto scene = writeScene(folder, "gravity = [0, 0, 0]",
                                  std::string("[[probe]]\nname = \"p\"\nbody = \"box\"\nat = ") + at + "\n");
    const auto result = runC3de({"run", scene.string(), "--steps", "1"});
    INFO(at << ": " << result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains("scene.toml:9"));
    CHECK_THAT(result.errorOutput, Contains("probe 'p'") && Contains("off body 'box'") && Contains("accepted"));
  }
  for (const char *at : {"[0.5, 0.22, 0.1]", "[0.5, 0.2, 0.1]", "[0.5, 0.1, 0.1]"}) {
    const auto scene = writeScene(folder, "gravity = [0, 0, 0]",
                                  std::string("[[probe]]\nname = \"p\"\nbody = \"box\"\nat = ") + at + "\n");
    CHECK(runC3de({"run", scene.string(), "--steps", "1", "-q"}).exitCode == 0);
  }
}

TEST_CASE("A body outside of the world's box is refused with its line") {
  const auto folder = freshFolder("body-outside");
  const std::string world = "box = { min = [-1, 0, -1], max = [2, 2, 1] }";
  for (const char *position : {"[0, -0.43, 0]", "[1e9, 0, 0]", "[0, 1.9, 0]"}) {
    const auto scene = writeScene(folder, world, std::string("position = ") + position + "\n");
    const auto result = runC3de({"run", scene.string(), "--steps", "1"});
    INFO(position << ": " << result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains("scene.toml:4") && Contains("world.box.") && Contains("accepted"));
  }
  const auto inside = writeScene(folder, world, "position = [0, -0.01, 0]\n");
  CHECK(runC3de({"run", inside.string(), "--steps", "1", "-q"}).exitCode == 0);
}

TEST_CASE("A region to refine off the body is refused with its line") {
  const auto folder = freshFolder("refine-off");
  const auto scene = writeScene(
      folder, "gravity = [0, 0, 0]", "",
      "spacing = 0.05, refine = [ { region = { sphere = { centre = [9, 0, 0], radius = 0.1 } }, spacing = 0.025 } ]");
  const auto result = runC3de({"run", scene.string(), "--steps", "1"});
  INFO(result.errorOutput);
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("scene.toml:8") && Contains("refinement 0") && Contains("accepted"));
}

TEST_CASE("A body in balance with the gravity of its scan stays, and falls by what gravity differs from it") {
  const auto folder = freshFolder("scan-gravity");
  const auto report = folder / "report.json";
  const auto fallen = [&](const std::string &gravity) {
    const auto scene = writeScene(folder, "gravity = " + gravity + "\nscan_gravity = [0, -9.81, 0]", "");
    const auto at = [&](const char *until) {
      const auto result = runC3de({"run", scene.string(), "--until", until, "-q", "--report", report.string()});
      INFO(result.errorOutput);
      REQUIRE(result.exitCode == 0);
      const Json json = readJson(report);
      return std::pair(json["bodies"][0]["centre_of_mass_m"][1].get<double>(), json["time_s"].get<double>());
    };
    const auto [from, begin] = at("0.001");
    const auto [to, end] = at("0.2");
    return std::pair(to - from, 0.5 * (end * end - begin * begin));
  };
  CHECK(std::abs(fallen("[0, -9.81, 0]").first) < 1e-12);
  const auto [way, halfSquare] = fallen("[0, -10.81, 0]");
  CHECK_THAT(way, Catch::Matchers::WithinRel(-halfSquare, 1e-6));
}

TEST_CASE("Two bodies that overlap are told of in the summary, the report and info, with what each costs") {
  const auto folder = freshFolder("bodies-overlap");
  const auto report = folder / "report.json";
  const auto scene =
      writeScene(folder, "gravity = [0, 0, 0]",
                 "[[body]]\nname = \"other\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nposition = [0.9, 0, 0]\n"
                 "sampling = { spacing = 0.05 }\nmaterial = { youngs_modulus = 1e8 }\n");
  const auto result =
      runC3de({"run", scene.string(), "--steps", "200", "--set", "contact.enabled=false", "--report", report.string()});
  INFO(result.output << result.errorOutput);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("contact between them is switched off") && Contains("overlap from the start"));
  const Json json = readJson(report);
  std::size_t overlaps = 0;
  for (const Json &event : json["events"]) overlaps += event["kind"] == "overlap" ? 1 : 0;
  CHECK(overlaps == 1);
  for (const Json &body : json["bodies"]) CHECK(body["cost_ms_per_s"].get<double>() > 0.0);
  CHECK_THAT(runC3de({"info", scene.string()}).output, Contains("contact between bodies: on"));
}

TEST_CASE("A stress figure above a tenth is said in the summary and as an event, and the count it proposes keeps it") {
  const auto folder = freshFolder("error-told");
  const auto report = folder / "report.json";
  // A plate on edge that sags: two cells over its thickness.
  writeFile(folder / "box.obj", boxObj());
  const auto run = [&](const std::string &sampling) {
    const auto scene = writeFile(
        folder / "scene.toml",
        "format = 1\n[world]\ngravity = [0, -9.81, 0]\n[solver]\nintegrator = \"quasistatic\"\nload_steps = "
        "1\n[[body]]\nname = \"box\"\n"
        "mesh = \"box.obj\"\nmesh_unit = \"m\"\nmaterial = { youngs_modulus = 1e6 }\nsampling = { " +
            sampling +
            " }\n[[fix]]\nbody = \"box\"\nregion = { half_space = { point = [0.001, 0, 0], normal = [1, 0, 0] } }\n");
    const auto result = runC3de({"run", scene.string(), "--report", report.string()});
    INFO(result.output << result.errorOutput);
    REQUIRE(result.exitCode == 0);
    return std::pair(result.output, readJson(report));
  };
  const auto [coarse, coarseJson] = run("count = 150");
  const double estimate = coarseJson["bodies"][0]["accuracy_statement"]["stress_error"].get<double>();
  REQUIRE(estimate > 0.1);
  CHECK_THAT(coarse, Contains("Stress and strain: ± ") && Contains("sampling.count = "));
  CHECK(coarseJson["events"].back()["kind"] == "sampling");
  const std::string key = "sampling.count = ";
  const auto count = std::stoul(coarse.substr(coarse.find(key) + key.size()));
  CHECK(count > 150);
  const auto [fine, fineJson] = run("count = " + std::to_string(std::min<unsigned long>(count, 12000)));
  if (count <= 12000) CHECK(fineJson["bodies"][0]["accuracy_statement"]["stress_error"].get<double>() < 0.12);
}

TEST_CASE("With the count that is proposed the stress figure of bars is below a tenth") {
  const auto folder = freshFolder("error-kept");
  const auto report = folder / "report.json";
  writeFile(folder / "box.obj", boxObj());
  const auto end = std::string("region = { half_space = { point = [0.9999, 0, 0], normal = [-1, 0, 0] } }\n");
  struct Case {
    std::string what;
    unsigned long coarse;  // too few phyxels for it
  };
  for (const auto &[what, few] :
       {Case{"[[load]]\n" + end + "force = [15, 0, 0]\n", 200},
        Case{"[[fix]]\n" + end + "displacement = [-0.05, 0, 0]\n", 40},
        Case{"[[fix]]\n" + end + "displacement = [0.03, 0, 0]\nrotation_deg = [3, 0, 0]\n", 40}}) {
    std::string coarse;
    const auto estimateAt = [&](unsigned long count) {
      const auto scene = writeFile(
          folder / "scene.toml",
          "format = 1\n[solver]\nintegrator = \"quasistatic\"\nload_steps = 1\n[[body]]\nmesh = \"box.obj\"\n"
          "mesh_unit = \"m\"\nsampling = { count = " +
              std::to_string(count) +
              " }\n[[fix]]\nregion = { half_space = { point = [0.0001, 0, 0], normal = [1, 0, 0] } }\n" + what);
      const auto result = runC3de({"run", scene.string(), "--report", report.string()});
      INFO(result.output << result.errorOutput);
      REQUIRE(result.exitCode == 0);
      coarse = result.output;
      return readJson(report)["bodies"][0]["accuracy_statement"]["stress_error"].get<double>();
    };
    REQUIRE(estimateAt(few) > 0.1);
    INFO(what << coarse);
    const std::string key = "sampling.count = ";
    REQUIRE_THAT(coarse, Contains(key));
    const auto count = std::stoul(coarse.substr(coarse.find(key) + key.size()));
    CHECK(count < 6000);
    CHECK(estimateAt(count) < 0.1);
  }
}

TEST_CASE("A tube far thinner than the spacing is refused, with what would do", "[slow]") {
  C3DE_DATA_OR_SKIP(scene, "found/energy_from_nothing.toml");
  const auto folder = freshFolder("too-coarse");
  const auto refused = runC3de({"run", scene.string(), "--until", "0.1"});
  INFO(refused.errorOutput);
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("too coarse") && Contains("sampling.count = "));
  const std::string key = "sampling.count = ";
  const auto at = refused.errorOutput.find(key);
  REQUIRE(at != std::string::npos);
  const auto count = std::stoul(refused.errorOutput.substr(at + key.size()));
  // The scene without its probe, which is off the body: nearer than half a spacing only while that is 61 mm.
  std::string text = readFile(scene);
  text.resize(text.find("[[probe]]"));
  text.replace(text.find("small-intestine.vtk"), 19, (scene.parent_path() / "small-intestine.vtk").generic_string());
  const auto fine = writeFile(folder / "fine.toml", text);
  // With that it rests on the floor and has no more energy than when it was dropped.
  const auto report = folder / "report.json";
  const auto done = runC3de({"run", fine.string(), "--until", "4", "-q", "--report", report.string(), "--set",
                             "body.smallint.sampling.count=" + std::to_string(count)});
  INFO(done.errorOutput);
  REQUIRE(done.exitCode == 0);
  const Json body = readJson(report)["bodies"][0];
  double total = 0.0;
  for (const char *part : {"kinetic", "elastic", "stabilisation", "gravity"})
    total += body["energy_J"][part].get<double>();
  CHECK(total < 0.0);
  CHECK(body["centre_of_mass_m"][1].get<double>() > 0.0);
  CHECK(body["energy_J"]["kinetic"].get<double>() < 1e-3);
  CHECK(body["deepest_penetration_m"].get<double>() < body["spacing_m"].get<double>());
}

TEST_CASE("A soft kidney that buckles under its weight finds its rest") {
  C3DE_DATA_OR_SKIP(scene, "found/buckling_kidney.toml");
  const auto report = freshFolder("buckling-kidney") / "report.json";
  const auto result = runC3de({"run", scene.string(), "-q", "--report", report.string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto body = nlohmann::json::parse(readFile(report))["bodies"][0];
  CHECK(body["energy_J"]["kinetic"].get<double>() == 0.0);
  CHECK(body["inverted_points"].get<int>() == 0);
  // Its free end hangs next to its support: far below its initial position.
  CHECK(body["energy_J"]["gravity"].get<double>() < -1e-3);
}

TEST_CASE("The skin of a thin organ stays with its points, and its depth is told as it is drawn") {
  C3DE_DATA_OR_SKIP(scene, "found/skin_spikes.toml");
  const auto folder = freshFolder("skin-spikes");
  const auto report = folder / "report.json", skin = folder / "skin.obj";
  const auto result = runC3de(
      {"run", scene.string(), "--until", "0.6", "-q", "--export-surface", skin.string(), "--report", report.string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  std::istringstream lines(readFile(skin));
  std::string word;
  double lowest = 1e300, x = 0.0, y = 0.0, z = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream row(line);
    if (row >> word && word == "v" && row >> x >> y >> z) lowest = std::min(lowest, y);
  }
  const Json body = readJson(report)["bodies"][0];
  const double depth = body["deepest_penetration_m"].get<double>(), spacing = body["spacing_m"].get<double>();
  INFO("lowest vertex " << lowest << ", told " << depth << ", spacing " << spacing);
  CHECK(depth > -1e-3 * lowest - 1e-6);  // the file is in millimetres or metres: at least as deep
  CHECK(depth < spacing);
}

TEST_CASE("A held body in short implicit steps swings from the first step on") {
  C3DE_DATA_OR_SKIP(scene, "found/steps/freeze.toml");
  const auto report = freshFolder("freeze") / "report.json";
  const auto result = runC3de({"run", scene.string(), "--steps", "40", "-q", "--report", report.string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const Json body = readJson(report)["bodies"][0];
  // The part that no wave has reached in 1.2 ms falls with 0.1 m/s².
  const double t = 40 * 3e-5, speed = 0.1 * t, mass = body["mass_kg"].get<double>();
  CHECK(body["energy_J"]["kinetic"].get<double>() > 0.5 * 0.5 * mass * speed * speed);
  // Where lumped masses differ from the shares of the weight, phyxels begin with another acceleration: 1.2 % of energy.
  CHECK(body["energy_J"]["kinetic"].get<double>() < 0.5 * mass * speed * speed * 1.02);
  CHECK(body["energy_J"]["gravity"].get<double>() < 0.0);
}

TEST_CASE("A weight on an attachment that is stiffer across than along its normal makes no energy") {
  C3DE_DATA_OR_SKIP(scene, "found/attachment/weight_n1e7_t1e8.toml");
  const auto report = freshFolder("attached-weight") / "report.json";
  const auto result = runC3de({"run", scene.string(), "--until", "0.1", "-q", "--report", report.string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  double total = 0.0, given = 0.0;
  const Json end = readJson(report);
  for (const Json &body : end["bodies"]) {
    for (const char *part : {"kinetic", "elastic", "stabilisation", "gravity", "attachment", "supports"})
      total += body["energy_J"][part].get<double>();
    given += std::abs(body["energy_J"]["gravity"].get<double>());
  }
  CHECK(std::abs(total) < 0.02 * given);
}
