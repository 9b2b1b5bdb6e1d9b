// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <sstream>

#include "program.h"

TEST_CASE("A run writes a report of the shape that the contract names") {
  const auto folder = freshFolder("report");
  const auto report = folder / "report.json";
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--steps", "50", "--report", report.string(),
                               "--threads", "2", "--seed", "7"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(result.output, Contains("Falling box") && Contains("50 steps"));
  const auto json = readJson(report);
  CHECK(json.at("format") == 1);
  CHECK(json.at("scene") == "Falling box");
  CHECK(json.at("outcome") == "done");
  CHECK(json.at("version").is_string());
  CHECK(json.at("machine").at("threads") == 2);
  CHECK(json.at("machine").at("cpu").is_string());
  CHECK(json.at("seed") == 7);
  CHECK(json.at("steps") == 50);
  CHECK(json.at("integrator") == "explicit");
  const double time_s = json.at("time_s"), dt_s = json.at("dt_s"), wall_s = json.at("wall_s");
  CHECK(dt_s > 0.0);
  CHECK_THAT(time_s, WithinRel(50 * dt_s, 1e-9));
  CHECK(wall_s > 0.0);
  CHECK_THAT(json.at("real_time_factor").get<double>(), WithinRel(time_s / wall_s, 1e-9));
  CHECK(json.at("state_hash").get<std::string>().size() == 16);
  CHECK(json.at("state_hash") != "0000000000000000");
  CHECK(json.at("reactions").is_array());
  CHECK(json.at("events").is_array());
  CHECK(json.at("stages").is_object());
  CHECK_FALSE(json.at("stages").empty());

  REQUIRE(json.at("bodies").size() == 1);
  const auto &body = json.at("bodies").at(0);
  CHECK(body.at("name") == "box");
  CHECK(body.at("phyxels").get<int>() > 20);
  CHECK_THAT(body.at("mass_kg").get<double>(), WithinRel(40.0, 0.01));  // 1 x 0.2 x 0.2 m of water
  CHECK_THAT(body.at("mesh_volume_m3").get<double>(), WithinRel(0.04, 1e-6));
  for (const char *key : {"surfels", "volume_m3", "neighbours", "stable_dt_s", "energy_J", "momentum",
                          "angular_momentum", "centre_of_mass_m", "min_J", "max_stretch"}) {
    INFO(key);
    CHECK(body.contains(key));
  }
  REQUIRE(json.at("probes").size() == 1);
  CHECK(json.at("probes").at(0).at("name") == "tip");
  CHECK(json.at("probes").at(0).at("reference_m").at(0) == 0.9);
}

TEST_CASE("A body in free fall falls as it must") {
  const auto folder = freshFolder("free-fall");
  const auto report = folder / "report.json";
  const auto result =
      runC3de({"run", writeBoxScene(folder).string(), "--until", "0.2", "--report", report.string(), "-q"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  CHECK(result.output.empty());
  CHECK(result.errorOutput.empty());
  const auto json = readJson(report);
  const double time_s = json.at("time_s"), dt_s = json.at("dt_s");
  CHECK(time_s >= 0.2 - 1e-6 * dt_s);
  CHECK(time_s < 0.2 + dt_s);
  const double fallen_m = 0.1 - json.at("bodies").at(0).at("centre_of_mass_m").at(1).get<double>();
  // The step's discrete parabola differs from g t^2 / 2 by at most g t dt / 2.
  CHECK_THAT(fallen_m, WithinAbs(0.5 * 9.81 * time_s * time_s, 0.5 * 9.81 * time_s * dt_s + 1e-4));
}

TEST_CASE("The same run gives the same state at any number of threads") {
  const auto folder = freshFolder("threads");
  const auto scene = writeBoxScene(folder);
  std::vector<std::string> hashes;
  for (const char *threads : {"1", "2", "5"}) {
    const auto report = folder / (std::string("report-") + threads + ".json");
    REQUIRE(runC3de({"run", scene.string(), "--steps", "40", "--threads", threads, "--report", report.string(), "-q"})
                .exitCode == 0);
    hashes.push_back(readJson(report).at("state_hash"));
  }
  CHECK(hashes[0] == hashes[1]);
  CHECK(hashes[0] == hashes[2]);
}

TEST_CASE("The option --set changes what is simulated, and a wrong path ends with 2") {
  const auto folder = freshFolder("set");
  const auto scene = writeBoxScene(folder).string();
  const auto report = folder / "report.json";
  const auto result = runC3de({"run", scene, "--steps", "5", "--set", "body.box.material.density=500", "--set",
                               "world.gravity=[0, 0, 0]", "--report", report.string(), "-q"});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  CHECK_THAT(readJson(report).at("bodies").at(0).at("mass_kg").get<double>(), WithinRel(20.0, 0.01));
  CHECK_THAT(readJson(report).at("bodies").at(0).at("centre_of_mass_m").at(1).get<double>(), WithinAbs(0.1, 1e-4));

  const struct {
    const char *assignment, *contains;
  } cases[] = {{"body.bxo.scale=2", "did you mean 'box'?"},
               {"body.box.material.yungs_modulus=1", "did you mean 'material.youngs_modulus'?"},
               {"body.box.material.poisson_ratio=0.7", "poisson_ratio"},
               {"solver.integrator=implict", "explicit"},
               {"body.box.material.law=rubber", "neo_hookean"},
               {"fix.0.displacement=[0, 0, 1]", "the scene has none"}};
  for (const auto &one : cases) {
    INFO(one.assignment);
    const auto refused = runC3de({"run", scene, "--steps", "1", "--set", one.assignment});
    CHECK(refused.exitCode == 2);
    CHECK_THAT(refused.errorOutput, Contains("c3de: error: --set ") && Contains(one.contains));
  }
}

TEST_CASE("A scene with a mistake ends with 3 and names file and line") {
  const auto folder = freshFolder("mistakes");
  const auto scene = writeBoxScene(folder, "[[fix]]\nbody = \"box\"\n");
  const auto fix = runC3de({"run", scene.string()});
  CHECK(fix.exitCode == 3);
  CHECK_THAT(fix.errorOutput, Contains("c3de: error: ") && Contains("box.toml:18: the fix has no 'region'"));

  const auto range = writeFile(
      folder / "range.toml",
      "format = 1\n[[body]]\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n\n[body.material]\npoisson_ratio = 0.5\n");
  const auto refused = runC3de({"run", range.string()});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("range.toml:7: ") && Contains("material.poisson_ratio = 0.5"));

  CHECK(runC3de({"run", (folder / "absent.toml").string()}).exitCode == 3);
  CHECK(runC3de({"run", (folder / "absent.obj").string()}).exitCode == 3);
}

TEST_CASE("A mesh can be run as it is") {
  const auto folder = freshFolder("mesh-run");
  const auto mesh = writeFile(folder / "brick.obj", boxObj());
  const auto report = folder / "report.json";
  const auto result = runC3de({"run", mesh.string(), "--unit", "m", "--steps", "3", "--report", report.string(), "-q"});
  INFO(result.errorOutput);
  CHECK(result.exitCode == 0);
  CHECK(readJson(report).at("bodies").at(0).at("name") == "brick");
}

TEST_CASE("A mesh that says its unit is read in it, alone and in a scene that states none") {
  const auto folder = freshFolder("mesh_that_says_its_unit");
  const auto report = folder / "report.json";
  const auto volumeOf = [&](const std::string &file, const std::vector<std::string> &more) {
    std::vector<std::string> arguments{"run", file, "--steps", "0", "--report", report.string(), "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = runC3de(arguments);
    INFO(result.errorOutput);
    REQUIRE(result.exitCode == 0);
    return readJson(report).at("bodies")[0].at("mesh_volume_m3").get<double>();
  };
  for (const auto &[unit, m3] : {std::pair{"m", 0.04}, {"cm", 4e-8}, {"mm", 4e-11}}) {
    const auto mesh = writeFile(folder / "box.obj", "# SPACE=LPS UNITS=" + std::string(unit) + "\n" + boxObj());
    CHECK(volumeOf(mesh.string(), {}) == Approx(m3));
    const auto scene = writeFile(folder / "scene.toml", "format = 1\n[[body]]\nmesh = \"box.obj\"\n");
    CHECK(volumeOf(scene.string(), {}) == Approx(m3));
    CHECK(volumeOf(mesh.string(), {"--unit", "m"}) == Approx(0.04));
  }
}

TEST_CASE("Nothing to do is done: zero steps report the initial state") {
  const auto folder = freshFolder("zero");
  const auto report = folder / "report.json";
  REQUIRE(runC3de({"run", writeBoxScene(folder).string(), "--steps", "0", "--report", report.string()}).exitCode == 0);
  CHECK(readJson(report).at("steps") == 0);
  CHECK(readJson(report).at("time_s") == 0.0);
}

TEST_CASE("A simulation that diverges ends with 5, says what helps and reports the last good state") {
  const auto folder = freshFolder("diverged");
  const auto report = folder / "report.json";
  // 1000 rad/s tear a body apart whose waves travel at 4 m/s.
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--steps", "5", "--set", "solver.dt=0.02",
                               "--set", "body.box.material.law=neo_hookean", "--set",
                               "body.box.angular_velocity=[0,0,1000]", "--report", report.string()});
  CHECK(result.exitCode == 5);
  CHECK_THAT(result.errorOutput, Contains("c3de: error: the simulation diverged") && Contains("report.json"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "diverged");
  CHECK_FALSE(json.at("failure").get<std::string>().empty());
  CHECK(json.at("bodies").at(0).at("centre_of_mass_m").at(1).is_number());
}

TEST_CASE("The time limit ends a run within a step, and the state before it is reported") {
  const auto folder = freshFolder("limit_in_step");
  const auto report = folder / "report.json";
  // A minute and more for a step of so many nearly incompressible phyxels.
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runC3de({"run",          writeBoxScene(folder).string(),
                               "--steps",      "1",
                               "--time-limit", "8",
                               "--set",        "solver.integrator=backward_euler",
                               "--set",        "solver.dt=0.05",
                               "--set",        "body.box.sampling.count=20000",
                               "--set",        "body.box.material.poisson_ratio=0.4999",
                               "--set",        "body.box.material.youngs_modulus=2e6",
                               "--set",        "body.box.angular_velocity=[0,0,30]",
                               "--report",     report.string()});
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  CHECK(result.exitCode == 124);
  CHECK(took_s < 8.0 + 8.0);  // 2 on a quiet machine, with the report
  CHECK_THAT(result.errorOutput, Contains("time limit of 8 s"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "time_limit");
  CHECK(json.at("steps") == 0);
  CHECK(json.at("bodies").at(0).at("centre_of_mass_m").at(1).is_number());
}

TEST_CASE("The time limit ends a run while a body is built, and says that there is no state") {
  const auto folder = freshFolder("limit_in_build");
  const auto report = folder / "report.json";
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--steps", "1", "--time-limit", "2", "--set",
                               "body.box.sampling.count=400000", "--report", report.string()});
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  CHECK(result.exitCode == 124);
  CHECK(took_s < 2.0 + 6.0);
  CHECK_THAT(result.errorOutput, Contains("time limit of 2 s") && Contains("box") && Contains("no step was made"));
  CHECK_FALSE(std::filesystem::exists(report));
}
