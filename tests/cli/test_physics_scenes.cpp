// SPDX-License-Identifier: Apache-2.0
// Scenes with supports, loads and materials, run by the program with the point-based plugin and compared with
// mechanics.
#include <array>
#include <cmath>
#include <sstream>

#include "program.h"

namespace {

using Json = nlohmann::json;
using Point = std::array<double, 3>;

/// A closed box with outward faces.
std::string brickObj(const Point &min, const Point &max) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    const bool right = i % 4 == 1 || i % 4 == 2, upper = i % 4 >= 2, front = i >= 4;
    text << "v " << (right ? max : min)[0] << ' ' << (upper ? max : min)[1] << ' ' << (front ? max : min)[2] << '\n';
  }
  text << "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  return text.str();
}

constexpr double kLength = 0.2, kArea = 0.04 * 0.04;  // m, m²
const std::string kLeft = "region = { box = { min = [-0.001, -1, -1], max = [0.0, 1, 1] } }\n";
const std::string kRight = "region = { box = { min = [0.2, -1, -1], max = [0.201, 1, 1] } }\n";

/// A beam of 0.2 x 0.04 x 0.04 m along x with a probe in the middle of its end.
std::filesystem::path writeBeam(const std::filesystem::path &folder, const std::string &solver,
                                const std::string &material, const std::string &more,
                                const std::string &sampling = "spacing = 0.008") {
  writeFile(folder / "beam.obj", brickObj({0.0, -0.02, -0.02}, {kLength, 0.02, 0.02}));
  return writeFile(folder / "beam.toml", "format = 1\n[solver]\n" + solver +
                                             "\n[[probe]]\nname = \"tip\"\nbody = \"beam\"\nat = [0.2, 0, 0]\n"
                                             "[[body]]\nname = \"beam\"\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n"
                                             "material = { " +
                                             material + " }\nsampling = { " + sampling + " }\n" + more);
}

double component(const Json &vector, std::size_t axis) { return vector.at(axis).get<double>(); }

const char *const kQuasistatic = "integrator = \"quasistatic\"";
const char *const kSoft = "law = \"stvk\", youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1000.0";

}  // namespace

TEST_CASE("A cantilever bends as far as it must, and its support carries the load") {
  const auto folder = freshFolder("cantilever");
  const std::string supports = "[[fix]]\ncentre = [0, 0, 0]\n" + kLeft + "[[load]]\nforce = [0, 0, -1.6e-3]\n" + kRight;
  const auto json = runToReport(writeBeam(folder, kQuasistatic, kSoft, supports));
  CHECK(json.at("time_s") == 0.0);
  CHECK(json.at("integrator") == "quasistatic");
  CHECK(json.at("steps").get<int>() >= 1);
  // -2.0344 mm: extrapolated finite elements, tests/validation/truths; 2 % is the limit for five layers.
  const Json &tip = json.at("probes").at(0);
  CHECK_THAT(component(tip.at("position_m"), 2) - component(tip.at("reference_m"), 2), WithinRel(-2.0344e-3, 0.02));
  REQUIRE(json.at("reactions").size() == 1);
  const Json &reaction = json.at("reactions").at(0);
  CHECK(reaction.at("fix") == 0);
  // Equilibrium: the residual is the tolerance of the solution, far below 1 %.
  CHECK_THAT(component(reaction.at("force_N"), 2), WithinRel(1.6e-3, 0.01));
  CHECK_THAT(component(reaction.at("force_N"), 0), WithinAbs(0.0, 1.6e-5));
  CHECK_THAT(component(reaction.at("torque_Nm"), 1), WithinRel(-1.6e-3 * kLength, 0.01));
  const double estimate = json.at("bodies").at(0).at("error_estimate");
  CHECK(estimate >= 0.0);
  CHECK(estimate < 0.5);
}

TEST_CASE("Bars of two materials in series stretch by the sum of their parts") {
  const auto folder = freshFolder("two-materials");
  // Without lateral contraction the bar is one-dimensional, and F L / E A is exact for small strain.
  const double force_N = 0.16, stress = force_N / kArea;
  const auto json = runToReport(
      writeBeam(folder, kQuasistatic, "law = \"linear\", youngs_modulus = 1e4, poisson_ratio = 0.0, density = 1000.0",
                "[[body.parts]]\nregion = { half_space = { point = [0.104, 0, 0], normal = [-1, 0, 0] } }\n"
                "material = { youngs_modulus = 4e4 }\n"
                "[[fix]]\n" +
                    kLeft + "[[load]]\nforce = [0.16, 0, 0]\n" + kRight));
  // The border is between two cells of 8 mm: a cell that it crosses has one material, by its centre.
  const double expected_m = stress * (0.104 / 1e4 + (kLength - 0.104) / 4e4);
  CHECK_THAT(component(json.at("probes").at(0).at("position_m"), 0) - kLength, WithinRel(expected_m, 0.02));
}

TEST_CASE("A pressure on a face is carried by the support as pressure times area") {
  const auto folder = freshFolder("pressure");
  // Half of the column's buckling load.
  const std::string supports = "[[fix]]\n" + kLeft + "[[load]]\npressure = 50\nfollower = false\n" + kRight;
  const auto json = runToReport(writeBeam(folder, kQuasistatic, kSoft, supports));
  CHECK_THAT(component(json.at("reactions").at(0).at("force_N"), 0), WithinRel(50.0 * kArea, 0.01));
  CHECK(component(json.at("probes").at(0).at("position_m"), 0) < kLength);
}

TEST_CASE("A held end that is moved takes the body along, and the two supports pull against each other") {
  const auto folder = freshFolder("prescribed");
  const std::string supports = "[[fix]]\n" + kLeft + "[[fix]]\nname = \"grip\"\ndisplacement = [0.01, 0, 0]\n" + kRight;
  const auto scene = writeBeam(folder, kQuasistatic, kSoft, supports);
  const auto json = runToReport(scene);
  CHECK_THAT(component(json.at("probes").at(0).at("position_m"), 0), WithinAbs(0.21, 1e-4));
  REQUIRE(json.at("reactions").size() == 2);
  const double left = component(json.at("reactions").at(0).at("force_N"), 0);
  const double right = component(json.at("reactions").at(1).at("force_N"), 0);
  // E A strain (0.8 N) and the contribution of the held faces, which keep their width: below 10 % at five times as long
  // as thick; St. Venant-Kirchhoff in tension adds 1.5 strains, 7.5 %.
  CHECK(right > 0.8);
  CHECK(right < 0.8 * 1.2);
  CHECK_THAT(left, WithinRel(-right, 0.01));

  // The same with a tenth of the force, from the command line.
  const auto less = runToReport(scene, {"--set", "fix.grip.displacement=[0.001, 0, 0]"});
  CHECK_THAT(component(less.at("probes").at(0).at("position_m"), 0), WithinAbs(0.201, 1e-5));
  CHECK(component(less.at("reactions").at(1).at("force_N"), 0) < 0.11 * right);
}

TEST_CASE("A prescribed motion in time is reached at the end of its ramp and kept") {
  const auto folder = freshFolder("ramp");
  const auto scene = writeBeam(folder, "integrator = \"explicit\"\ndamping = 20.0", kSoft,
                               "[[fix]]\nregion = { everywhere = true }\ndisplacement = [0, 0.02, 0]\nramp = 0.05\n",
                               "spacing = 0.01");
  const auto half = runToReport(scene, {"--until", "0.025"});
  const double atHalf = component(half.at("probes").at(0).at("position_m"), 1);
  CHECK(atHalf > 0.002);
  CHECK(atHalf < 0.018);
  const auto end = runToReport(scene, {"--until", "0.08"});
  CHECK_THAT(component(end.at("probes").at(0).at("position_m"), 1), WithinAbs(0.02, 2e-4));
  CHECK_THAT(component(end.at("probes").at(0).at("velocity_m_s"), 1), WithinAbs(0.0, 1e-3));
}

TEST_CASE("A body begins with the velocity and the spin that the scene gives it") {
  const auto folder = freshFolder("velocity");
  const auto json = runToReport(writeBeam(folder, "integrator = \"explicit\"", kSoft,
                                          "velocity = [0.3, 0, 0]\nangular_velocity = [2, 0, 0]\n", "spacing = 0.01"),
                                {"--until", "0.02"});
  const Json &body = json.at("bodies").at(0);
  const double mass_kg = body.at("mass_kg"), time_s = json.at("time_s");
  CHECK_THAT(component(body.at("momentum"), 0), WithinRel(mass_kg * 0.3, 1e-9));
  CHECK_THAT(component(body.at("centre_of_mass_m"), 0), WithinAbs(0.5 * kLength + 0.3 * time_s, 1e-6));
  // I = m (a² + b²) / 12 of the box; at four cells across a hundredth of it remains uncorrected.
  const double box = (0.0016 + 0.0016) / 12.0;
  CHECK_THAT(component(body.at("angular_momentum"), 0), WithinRel(mass_kg * 2.0 * box, 0.012));
}

TEST_CASE("An obstacle that moves pushes what is in its way") {
  const auto folder = freshFolder("moving-obstacle");
  writeFile(folder / "plate.obj", brickObj({-0.05, -0.06, -0.05}, {0.25, -0.021, 0.05}));
  const auto scene = writeBeam(folder, "integrator = \"explicit\"", kSoft,
                               "[[obstacle]]\nmesh = \"plate.obj\"\nmesh_unit = \"m\"\n"
                               "displacement = [0, 0.03, 0]\nramp = 0.1\n",
                               "spacing = 0.01");
  const auto json = runToReport(scene, {"--until", "0.12"});
  // The plate ends 29 mm above the initial position of the body's lower face; a pushed body is at least nearly there.
  CHECK(component(json.at("bodies").at(0).at("centre_of_mass_m"), 1) > 0.02);
  CHECK(json.at("bodies").at(0).at("deepest_penetration_m").get<double>() < 0.005);
}

TEST_CASE("The implicit integrators fall as far as the explicit one") {
  const auto folder = freshFolder("implicit");
  for (const char *integrator : {"implicit", "backward_euler"}) {
    INFO(integrator);
    const auto scene = writeBeam(folder, std::string("integrator = \"") + integrator + "\"\ndt = 0.01", kSoft,
                                 "[world]\ngravity = [0, -9.81, 0]\n", "spacing = 0.01");
    const auto json = runToReport(scene, {"--until", "0.1"});
    CHECK(json.at("steps") == 10);
    // Backward Euler is ahead by g t dt / 2, the midpoint rule is exact in free fall.
    const double time_s = json.at("time_s");
    CHECK_THAT(-component(json.at("bodies").at(0).at("centre_of_mass_m"), 1),
               WithinAbs(0.5 * 9.81 * time_s * time_s, 0.5 * 9.81 * time_s * 0.01 + 1e-6));
  }
}

TEST_CASE("What a scene asks of a body that cannot be is refused with its line") {
  const auto folder = freshFolder("refused-physics");
  const std::string nowhere = "region = { box = { min = [5, 5, 5], max = [6, 6, 6] } }\n";
  const std::string soft = kSoft;
  const struct {
    std::string solver, material, more;
    const char *line, *contains;
  } cases[] = {
      {kQuasistatic, soft, "[[fix]]\n" + kLeft + "[[fix]]\n" + nowhere, "beam.toml:16: ", "fix 1"},
      {kQuasistatic, soft, "[[fix]]\n" + kLeft + "[[load]]\nforce = [0, 0, 1]\n" + nowhere, "beam.toml:16: ", "load 0"},
      {kQuasistatic, "law = \"rubber\"", "", "beam.toml:12: ", "neo_hookean"},
      {"integrator = \"magic\"", soft, "", "beam.toml:3: ", "quasistatic"},
      {kQuasistatic, "plastic = { yield = -1 }", "", "beam.toml:12: ", "material.plastic.yield = -1"},
      {kQuasistatic, "plastic = { yeild = 1 }", "", "beam.toml:12: ", "did you mean 'material.plastic.yield'?"},
  };
  for (const auto &one : cases) {
    INFO(one.line << one.contains);
    const auto result =
        runC3de({"run", writeBeam(folder, one.solver, one.material, one.more).string(), "--steps", "1"});
    INFO(result.errorOutput);
    CHECK(result.exitCode == 3);
    CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains(one.line) && Contains(one.contains));
  }
}

TEST_CASE("A material that never yields may say so with infinity") {
  const auto folder = freshFolder("infinite");
  const std::string material = std::string(kSoft) + ", plastic = { yield = inf, creep = 0.0, max = inf }";
  const auto json =
      runToReport(writeBeam(folder, "integrator = \"explicit\"", material, "", "spacing = 0.02"), {"--steps", "3"});
  CHECK(json.at("steps") == 3);
}

TEST_CASE("A body that cannot go on stops in its last good state, the other goes on, and the run says so") {
  const auto folder = freshFolder("one-stops");
  // 3000 rad/s tear a body apart whose waves travel at 3 m/s.
  writeFile(folder / "beam.obj", brickObj({0.0, -0.02, -0.02}, {kLength, 0.02, 0.02}));
  const auto block = [](const std::string &name, const std::string &spin, const std::string &height) {
    return "[[body]]\nname = \"" + name + "\"\nposition = [0, " + height +
           ", 0]\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n" +
           "material = { youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1000.0 }\n" +
           "sampling = { spacing = 0.02 }\nangular_velocity = [0, 0, " + spin + "]\n";
  };
  const auto scene = writeFile(folder / "two.toml",
                               "format = 1\n[world]\ngravity = [0, -9.81, 0]\n[solver]\n"
                               "integrator = \"explicit\"\ndt = 0.02\n" +
                                   block("torn", "3000", "0") + block("whole", "0", "1"));
  const auto report = folder / "report.json";
  const auto result = runC3de({"run", scene.string(), "--until", "0.1", "--report", report.string(), "-q"});
  CHECK(result.exitCode == 5);
  CHECK_THAT(result.errorOutput, Contains("1 body stopped"));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "diverged");
  const std::string why = json.at("bodies").at(0).at("stopped");
  CHECK_THAT(why, Contains("torn") && Contains("phyxel") && Contains("solver.integrator"));
  CHECK_THAT(component(json.at("bodies").at(0).at("centre_of_mass_m"), 1), WithinAbs(0.0, 1e-12));
  CHECK_THAT(component(json.at("bodies").at(1).at("centre_of_mass_m"), 1), WithinAbs(1.0 - 0.5 * 9.81 * 0.01, 1e-6));
}

TEST_CASE("What is shown of a scene does not change its result, and wrong wishes are refused") {
  const auto folder = freshFolder("view");
  const std::string more = "velocity = [0, 0, 0]\n[[fix]]\n" + kLeft + "[[load]]\nforce = [0, 0, -1.6e-3]\n" + kRight;
  const auto scene = writeBeam(folder, kQuasistatic, kSoft, more, "spacing = 0.02");
  const auto plain = runToReport(scene);
  const auto coloured =
      runToReport(scene, {"--set", "view.colour=error", "--set", "view.surface=transparent", "--set", "view.range=20"});
  CHECK(plain["state_hash"] == coloured["state_hash"]);
  const auto refused = runC3de({"run", scene.string(), "--set", "view.colour=rainbow"});
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput, Contains("view.colour") && Contains("rainbow") && Contains("von_mises"));
}

TEST_CASE("A picture shows the colours that the scene asks for, and the result stays", "[gpu]") {
  const auto folder = freshFolder("coloured");
  const std::string more = "[[fix]]\n" + kLeft + "[[load]]\nforce = [0, 0, -1.6e-3]\n" + kRight;
  const auto scene = writeBeam(folder, kQuasistatic, kSoft, more, "spacing = 0.02").string();
  std::vector<std::string> pictures, hashes;
  for (const std::string colour : {"material", "error", "von_mises"}) {
    const auto picture = folder / (colour + ".png"), report = folder / (colour + ".json");
    const auto result = runWithoutDisplay({"run", scene, "-q", "--report", report.string(), "--screenshot",
                                           picture.string(), "--size", "640x480", "--set", "view.colour=" + colour});
    INFO(result.errorOutput);
    if (result.exitCode == 6) C3DE_SKIP("no OpenGL here: " + result.errorOutput);
    REQUIRE(result.exitCode == 0);
    pictures.push_back(readFile(picture));
    hashes.push_back(readJson(report)["state_hash"].dump());
  }
  CHECK(hashes[1] == hashes[0]);
  CHECK(hashes[2] == hashes[0]);
  CHECK(pictures[1] != pictures[0]);
  CHECK(pictures[2] != pictures[1]);
}

TEST_CASE("A step beyond its budget ends the run in the state before it, with what would help") {
  const auto folder = freshFolder("step-budget");
  const auto scene = writeBeam(folder, "integrator = \"backward_euler\"\nstep_budget = 0.02",
                               "youngs_modulus = 1e6, poisson_ratio = 0.499, density = 1000.0", "",
                               "count = 10000 }\nangular_velocity = [0, 0, 20] # {");
  const auto report = folder / "report.json";
  const auto result = runC3de({"run", scene.string(), "--until", "0.1", "--report", report.string(), "-q"});
  CHECK(result.exitCode != 0);
  CHECK_THAT(result.errorOutput, Contains("step 1 at 0 s failed: the step was abandoned after 0.02 s") &&
                                     Contains("solver.step_budget") && Contains("sampling.count = "));
  const auto json = readJson(report);
  CHECK(json.at("outcome") == "failed");
  CHECK(json.at("steps") == 0);
}
