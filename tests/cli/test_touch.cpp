// SPDX-License-Identifier: Apache-2.0
// Forces of contact in reports, pairs, and probe tools: touch without a window.
#include <cmath>
#include <sstream>

#include "program.h"

namespace {

using Json = nlohmann::json;

std::string body(const std::string &name, const std::string &more = "") {
  return "[[body]]\nname = \"" + name +
         "\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nmaterial = { youngs_modulus = 2e4, poisson_ratio = 0.3 }\n"
         "sampling = { spacing = 0.05 }\n" +
         more;
}

/// A bar of 1 x 0.2 x 0.2 m, lines counted from "format".
std::filesystem::path scene(const std::filesystem::path &folder, const std::string &text) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "scene.toml", "format = 1\n" + text);
}

const std::string kHeld = body("bar") +
                          "[[fix]]\nbody = \"bar\"\nregion = { half_space = { point = [0, 0, 0], normal = [0, 1, 0] } "
                          "}\n";

std::string finger(const std::string &more = "") {
  return "[[probe_tool]]\nname = \"finger\"\nradius_mm = 80\npath = [ { time = 0, at = [0.5, 0.281, 0.1] }, "
         "{ time = 0.2, at = [0.5, 0.26, 0.1] } ]\n" +
         more;
}

double norm(const Json &v) {
  return std::sqrt(std::pow(v.at(0).get<double>(), 2) + std::pow(v.at(1).get<double>(), 2) +
                   std::pow(v.at(2).get<double>(), 2));
}

}  // namespace

TEST_CASE("A probe tool presses, and report and table say with what force, against what holds the body", "[touch]") {
  const auto folder = freshFolder("touch-press");
  const auto file = scene(folder,
                          "[solver]\ndamping = 5\n[[probe]]\nname = \"top\"\nbody = \"bar\"\nat = [0.5, 0.2, "
                          "0.1]\n" +
                              kHeld + finger());
  const auto table = folder / "probes.csv";
  const Json report = runToReport(file, {"--until", "1", "--probes", table.string()});
  REQUIRE(report.at("probe_tools").size() == 1);
  const Json &tool = report.at("probe_tools").at(0);
  CHECK(tool.at("name") == "finger");
  CHECK(std::abs(tool.at("position_m").at(1).get<double>() - 0.26) < 1e-12);
  const double force = tool.at("force_N").at(1).get<double>();
  CHECK(force > 1.0);
  CHECK(tool.at("depth_m").get<double>() < 0.002);
  CHECK(tool.at("points").get<int>() >= 4);
  // At rest the pressing force appears at the support; damping carries damping dt/2 of it, 0.8 %.
  const Json &reaction = report.at("reactions").at(0).at("force_N");
  CHECK(std::abs(reaction.at(1).get<double>() - force) < 0.03 * force);
  REQUIRE(report.at("contacts").size() == 1);
  const Json &contact = report.at("contacts").at(0);
  CHECK(contact.at("bodies") == Json({"bar", "finger"}));
  CHECK(contact.at("force_N").at(1).get<double>() == -force);
  CHECK(contact.at("pressing_N").get<double>() >= force * 0.9);

  std::istringstream rows(readFile(table));
  std::string head, row, last;
  std::getline(rows, head);
  CHECK_THAT(head, Contains(",finger.x [m],finger.y [m],finger.z [m],finger.Fx [N],finger.Fy [N],finger.Fz [N]"));
  std::getline(rows, row);
  CHECK_THAT(row, Catch::Matchers::EndsWith(",0.5,0.281,0.1,0,0,0"));
  while (std::getline(rows, row)) last = row;
  std::vector<double> cells;
  std::istringstream line(last);
  for (std::string cell; std::getline(line, cell, ',');) cells.push_back(std::stod(cell));
  REQUIRE(cells.size() == 1 + 6 + 6);
  CHECK(std::abs(cells[11] - force) < 1e-6 * force);
}

TEST_CASE("A probe tool presses by load steps, and goes where the command line says", "[touch]") {
  const auto folder = freshFolder("touch-static");
  const auto file = scene(folder, "[solver]\nintegrator = \"quasistatic\"\nload_steps = 4\n" + kHeld + finger());
  const auto forceWith = [&](std::vector<std::string> more) {
    return runToReport(file, std::move(more)).at("probe_tools").at(0).at("force_N").at(1).get<double>();
  };
  // The load factor replaces the time: 0.2 is the end of the path.
  const double force = forceWith({});
  CHECK(force > 1.0);
  const double less =
      forceWith({"--set", "probe_tool.finger.path=[{time=0,at=[0.5,0.281,0.1]},{time=1,at=[0.5,0.27,0.1]}]"});
  CHECK(less > 0.0);
  CHECK(less < 0.6 * force);
  CHECK(forceWith({"--set", "probe_tool.finger.radius_mm=60"}) == 0.0);  // too small to reach
}

TEST_CASE("What holds a body up is reported by name, and a pair lets it through or slide", "[touch]") {
  const auto folder = freshFolder("touch-pairs");
  writeFile(folder / "table.obj",
            "v -2 -1 -2\nv 3 -1 -2\nv 3 0 -2\nv -2 0 -2\nv -2 -1 2\nv 3 -1 2\nv 3 0 2\nv -2 0 "
            "2\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const std::string table = "[[obstacle]]\nname = \"table\"\nmesh = \"table.obj\"\nmesh_unit = \"m\"\n";
  const auto file = scene(folder,
                          "[world]\ngravity = [1.5, -9.81, 0]\n[solver]\ndt = 0.01\nintegrator = "
                          "\"implicit\"\n" +
                              body("bar", "position = [0, 0.0005, 0]\n") + table +
                              "[[contact.pair]]\nbodies = [\"table\", \"bar\"]\nfriction = 0.3\n");
  const std::vector<std::string> toRest{"--until", "0.8", "--set", "solver.damping=20"};
  const Json held = runToReport(file, toRest);
  REQUIRE(held.at("contacts").size() == 1);
  const Json &contact = held.at("contacts").at(0);
  CHECK(contact.at("bodies") == Json({"bar", "table"}));
  const double mass = held.at("bodies").at(0).at("mass_kg").get<double>();
  CHECK(std::abs(contact.at("force_N").at(1).get<double>() - 9.81 * mass) < 0.02 * 9.81 * mass);
  CHECK(std::abs(contact.at("force_N").at(0).get<double>() + 1.5 * mass) < 0.1 * mass);
  CHECK(contact.at("depth_m").get<double>() > 0.0);
  CHECK(contact.at("points").get<int>() > 10);
  CHECK(norm(held.at("bodies").at(0).at("momentum")) < 0.02 * mass);

  const Json slid = runToReport(file, {"--until", "0.4", "--set", "contact.pair.0.friction=0"});
  CHECK(slid.at("bodies").at(0).at("momentum").at(0).get<double>() > 0.9 * 1.5 * 0.4 * mass);
  const Json fallen = runToReport(file, {"--until", "0.4", "--set", "contact.pair.0.enabled=false"});
  CHECK(fallen.at("contacts").empty());
  CHECK(fallen.at("bodies").at(0).at("momentum").at(1).get<double>() < -0.95 * 9.81 * 0.4 * mass);
  // Friction between bodies does not belong to the table.
  const Json general =
      runToReport(file, {"--until", "0.8", "--set", "solver.damping=20", "--set", "contact.friction=0.1"});
  CHECK(general.at("state_hash") == held.at("state_hash"));
}

TEST_CASE("A state belongs to its pairs and probe tools", "[touch][saved_state]") {
  const auto folder = freshFolder("touch-state");
  const auto file =
      scene(folder, kHeld + finger() + "[[contact.pair]]\nbodies = [\"bar\", \"finger\"]\nfriction = 0.1\n");
  const auto state = (folder / "state.bin").string();
  const Json whole = runToReport(file, {"--until", "0.2"});
  (void)runToReport(file, {"--until", "0.1", "--save-state", state});
  const Json continued = runToReport(file, {"--until", "0.2", "--from-state", state});
  CHECK(continued.at("state_hash") == whole.at("state_hash"));
  for (const char *other :
       {"contact.pair.0.friction=0.2", "contact.pair.0.enabled=false", "probe_tool.finger.radius_mm=81",
        "probe_tool.finger.path=[{time=0,at=[0.5,0.281,0.1]},{time=1,at=[0.5,0.26,0.1]}]"}) {
    const auto refused = runC3de({"run", file.string(), "--until", "0.2", "--from-state", state, "--set", other, "-q"});
    INFO(other);
    CHECK(refused.exitCode != 0);
    CHECK_THAT(refused.errorOutput, Contains("belongs to another scene"));
  }
}

TEST_CASE("A probe tool that is thin, or begins inside a body, is told of, and one that turns over is refused",
          "[touch]") {
  const auto folder = freshFolder("touch-warned");
  const auto events = [&](const std::string &tool) {
    const Json report = runToReport(scene(folder, kHeld + tool), {"--steps", "1"});
    std::string all;
    for (const Json &event : report.at("events"))
      if (event.at("kind") == "warning") all += event.at("text").get<std::string>() + "\n";
    return all;
  };
  CHECK(events(finger()).empty());
  const std::string path = "path = [ { time = 0, at = [0.5, 0.4, 0.1] }, { time = 1, at = [0.5, 0.2, 0.1] } ]\n";
  CHECK_THAT(events("[[probe_tool]]\nname = \"pin\"\nradius_mm = 5\n" + path),
             Contains("probe tool 'pin' has a radius of 5 mm") && Contains("'bar' a spacing of 50 mm") &&
                 Contains("sampling.spacing"));
  const std::string from = "path = [ { time = 0, at = [0.5, Y, 0.1] }, { time = 1, at = [0.5, 1, 0.1] } ]\n";
  const auto ballAt = [&](const std::string &y) {
    std::string text = from;
    text.replace(text.find('Y'), 1, y);
    return "[[probe_tool]]\nname = \"ball\"\nradius_mm = 80\n" + text;
  };
  CHECK(events(ballAt("0.28")).empty());
  CHECK_THAT(events(ballAt("0.26")), Contains("'ball' begins 20 mm deep in body 'bar'"));
  const auto within = runC3de({"run", scene(folder, kHeld + ballAt("0.1")).string(), "--steps", "1", "-q"});
  CHECK(within.exitCode == 5);
  CHECK_THAT(within.errorOutput,
             Contains("'ball' begins 100 mm deep in it") && Contains("to begin with 'ball' outside"));

  const auto turned = scene(folder, kHeld +
                                        "[[probe_tool]]\nname = \"rod\"\nradius_mm = 80\nlength_mm = 100\npath = [ { "
                                        "time = 0, at = [0, 1, 0], axis = [1, 0, 0] }, { time = 1, at = [0, 1, 0], "
                                        "axis = [-1, 0, 0] } ]\n");
  const auto refused = runC3de({"run", turned.string(), "--steps", "1", "-q"});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("scene.toml:11: ") && Contains("180 degrees"));
}

TEST_CASE("Contact that cannot be is refused with its line, by the simulator that serves it and by another",
          "[touch]") {
  const auto folder = freshFolder("touch-refused");
  const auto refusal = [&](const std::string &text, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"run", scene(folder, text).string(), "--steps", "1", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto ran = runC3de(arguments);
    CHECK(ran.exitCode != 0);
    return ran.errorOutput;
  };
  CHECK_THAT(refusal("[contact]\nfricton = 0.1\n" + kHeld),
             Contains("scene.toml:3: ") && Contains("did you mean 'contact.friction'?"));
  CHECK_THAT(refusal("[contact]\nfriction = -0.1\n" + kHeld), Contains("scene.toml:3: ") && Contains("-0.1"));
  CHECK_THAT(refusal(kHeld, {"--set", "contact.friction=11"}),
             Contains("--set contact.friction: ") && Contains("0 <= value <= 10"));
  const std::vector<std::string> recorder{"--no-plugins", "--plugin", C3DE_RECORDER};
  const std::string plain = "[[body]]\nname = \"bar\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n";
  CHECK_THAT(refusal(plain + finger(), recorder),
             Contains("scene.toml:6: '[[probe_tool]]' is not supported by this simulator"));
  CHECK_THAT(refusal(plain + "[[contact.pair]]\nbodies = [\"bar\", \"box\"]\nfriction = 0.1\n", recorder),
             Contains("scene.toml:6: '[[contact.pair]]' is not supported by this simulator"));
  CHECK_THAT(refusal("[contact]\nenabled = true\n" + plain, recorder),
             Contains("scene.toml:3: ") && Contains("contact.enabled"));
}

TEST_CASE("Info says which contacts are switched on or off, and what the probe tools are", "[touch]") {
  const auto folder = freshFolder("touch-info");
  const auto file = scene(folder, "[contact]\nenabled = true\nfriction = 0.2\n" + kHeld +
                                      body("other", "position = [0, 1, 0]\n") + finger() +
                                      "[[contact.pair]]\nbodies = [\"bar\", \"finger\"]\nenabled = false\n"
                                      "[[contact.pair]]\nbodies = [\"bar\", \"other\"]\nfriction = 0.05\n");
  const auto text = runC3de({"info", file.string()});
  INFO(text.errorOutput);
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("contact between bodies: on, friction 0.2, where no pair says otherwise") &&
                              Contains("contact of bodies with themselves: on") &&
                              Contains("contact of \"bar\" and \"finger\": off") &&
                              Contains("contact of \"bar\" and \"other\": on, friction 0.05") &&
                              Contains("probe tool \"finger\": radius 80 mm, 2 places from 0 to 0.2 s"));
  const auto json = Json::parse(runC3de({"info", file.string(), "--json", "--quick"}).output);
  CHECK(json.at("contact").at("friction") == 0.2);
  CHECK(json.at("contact").at("pairs").at(0).at("enabled") == false);
  CHECK(json.at("contact").at("pairs").at(1).at("friction") == 0.05);
  CHECK(json.at("probe_tools").at(0).at("radius_mm") == 80.0);
}
