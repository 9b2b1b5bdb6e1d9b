// SPDX-License-Identifier: Apache-2.0
// Jaws of a scene: their pulling and squeezing forces, without a window.
#include <cmath>

#include "program.h"

namespace {

using Json = nlohmann::json;

/// A bar of 1 x 0.2 x 0.2 m on its lower side.
const std::string kHeld =
    "[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n"
    "material = { youngs_modulus = 2e4, poisson_ratio = 0.3 }\nsampling = { spacing = 0.05 }\n"
    "[[fix]]\nbody = \"bar\"\nregion = { half_space = { point = [0, 0, 0], normal = [0, 1, 0] } }\n";

std::string tongs(const std::string &more = "") {
  return "[[grasp]]\nname = \"tongs\"\nat = [0.5, 0.2, 0.1]\naxis = [1, 0, 0]\njaw_mm = 100\nopening_mm = 200\n"
         "closed_mm = 180\n" +
         more;
}

std::filesystem::path scene(const std::filesystem::path &folder, const std::string &text) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "scene.toml", "format = 1\n" + text);
}

}  // namespace

TEST_CASE("Jaws of a scene squeeze and lift, and the report says with what, against what holds the body", "[grasp]") {
  const auto folder = freshFolder("grasp-lift");
  const auto file = scene(folder, "[solver]\ndamping = 10\n" + kHeld +
                                      tongs("path = [ { time = 0.5, at = [0.5, 0.2, 0.1] }, { time = 1, at = [0.5, "
                                            "0.24, 0.1] } ]\n"));
  const auto graspAt = [&](const std::string &until, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--until", until});
    return runToReport(file, more).at("grasps").at(0);
  };
  // Before the time of the first position they do not hold.
  const Json before = graspAt("0.3");
  CHECK(before.at("name") == "tongs");
  CHECK(before.at("holds") == false);
  CHECK(before.at("squeeze_N") == 0.0);

  const Json report = runToReport(file, {"--until", "2.5"});
  const Json &grasp = report.at("grasps").at(0);
  CHECK(grasp.at("holds") == true);
  CHECK(grasp.at("gap_m").get<double>() < 0.1805);
  CHECK(grasp.at("squeeze_N").get<double>() > 1.0);
  // The lifting force appears at the support; damping carries damping dt/2 of it.
  const double lift = grasp.at("force_N").at(1).get<double>();
  CHECK(lift > 1.0);
  CHECK(std::abs(report.at("reactions").at(0).at("force_N").at(1).get<double>() + lift) < 0.05 * lift);
  // A force limit is where they stop closing.
  const Json limited =
      graspAt("2.5", {"--set", "grasp.tongs.force_limit=1", "--set", "grasp.tongs.path=[{time=0.5,at=[0.5,0.2,0.1]}]"});
  CHECK(limited.at("squeeze_N").get<double>() < 1.05);
  CHECK(limited.at("squeeze_N").get<double>() > 0.9);
  CHECK(limited.at("gap_m").get<double>() > grasp.at("gap_m").get<double>());
  // Rotated about the skin's normal, they rotate the tissue.
  const Json turned =
      runToReport(file, {"--until", "2.5", "--set",
                         "grasp.tongs.path=[{time=0,at=[0.5,0.2,0.1]},{time=1,at=[0.5,0.2,0.1],turn_deg=[0,20,0]}]"});
  const auto torque = [](const Json &of) { return of.at("reactions").at(0).at("torque_Nm").at(1).get<double>(); };
  CAPTURE(torque(report), torque(turned));
  CHECK(torque(turned) < -0.01);
  CHECK(std::abs(torque(report)) < 1e-3);
}

TEST_CASE("The same grasp gives the same bits with one thread and with several", "[grasp]") {
  const auto folder = freshFolder("grasp-bits");
  const auto file = scene(folder, kHeld + tongs());
  const auto hash = [&](const char *threads) {
    return runToReport(file, {"--until", "0.4", "--threads", threads}).at("state_hash");
  };
  CHECK(hash("1") == hash("3"));
  const auto alone = scene(folder, kHeld);
  CHECK(runToReport(alone, {"--until", "0.4"}).at("grasps").empty());
}

TEST_CASE("A grasp that finds no skin, or no hands, is refused with its line", "[grasp]") {
  const auto folder = freshFolder("grasp-refused");
  const auto refusal = [&](const std::string &text, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"run", scene(folder, text).string(), "--steps", "1", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto ran = runC3de(arguments);
    CHECK(ran.exitCode != 0);
    return ran.errorOutput;
  };
  const auto with = [&](const std::string &setting) {
    return refusal(kHeld + tongs(), {"--set", "grasp.tongs." + setting});
  };
  CHECK_THAT(with("at=[0.95,0.2,0.1]"), Contains("scene.toml:11: ") && Contains("grasp 'tongs'") &&
                                            Contains("one of the jaws misses the body, which ends 50 mm"));
  CHECK_THAT(with("axis=[0,1,0]"), Contains("is perpendicular to the skin"));
  CHECK_THAT(with("at=[0.5,0.9,0.1]"), Contains("(0.5, 0.9, 0.1) m lies 700 mm off body 'bar'"));
  CHECK_THAT(refusal(kHeld + tongs("body = \"bar\"\n"),
                     {"--set", "grasp.tongs.axis=[0,0,1]", "--set", "grasp.tongs.opening_mm=300"}),
             Contains("the body is 200 mm wide there"));
  CHECK_THAT(refusal("[solver]\nintegrator = \"quasistatic\"\n" + kHeld + tongs()),
             Contains("scene.toml:13: ") && Contains("a quasi-static solution supports no grasps") &&
                 Contains("solver.integrator"));
  CHECK_THAT(refusal(kHeld + tongs(), {"--set", "body.bar.rigid=true"}), Contains("rigid"));
  const std::vector<std::string> recorder{"--no-plugins", "--plugin", C3DE_RECORDER};
  const std::string plain = "[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n";
  CHECK_THAT(refusal(plain + tongs(), recorder),
             Contains("scene.toml:6: '[[grasp]]' is not supported by this simulator"));
}

TEST_CASE("Info says what the grasps are", "[grasp]") {
  const auto folder = freshFolder("grasp-info");
  const auto file = scene(folder, kHeld + tongs("force_limit = 2\npath = [ { time = 0, at = [0.5, 0.2, 0.1] } ]\n"));
  CHECK_THAT(runC3de({"info", file.string()}).output,
             Contains("grasp \"tongs\" of \"bar\": jaws of 100 mm, from 200 to 180 mm or 2 N, 1 place"));
  const auto json = Json::parse(runC3de({"info", file.string(), "--json", "--quick"}).output);
  CHECK(json.at("grasps").at(0).at("jaw_mm") == 100.0);
  CHECK(json.at("grasps").at(0).at("path").at(0).at("turn_deg") == Json({0.0, 0.0, 0.0}));
}
