// SPDX-License-Identifier: Apache-2.0
// The simulator of masses and springs (plugins/mass_spring), run by the program.
#include <cmath>
#include <sstream>

#include "program.h"
#include "support/folders.h"

namespace {

using Json = nlohmann::json;

constexpr double kYoungsModulus = 6000.0, kPressure = 60.0;

std::string plugin() {
  return (std::filesystem::path(testExampleFolder()) / ("mass_spring" + std::string(c3de::pluginExtension()))).string();
}

/// A bar of 0.2 x 0.04 x 0.04 m along x, of 320 g.
std::filesystem::path writeBar(const std::filesystem::path &folder, const std::string &more) {
  std::ostringstream mesh;
  for (int i = 0; i < 8; ++i)
    mesh << "v " << (i % 4 == 1 || i % 4 == 2 ? 0.2 : 0.0) << ' ' << (i % 4 >= 2 ? 0.02 : -0.02) << ' '
         << (i >= 4 ? 0.02 : -0.02) << '\n';
  mesh << "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  writeFile(folder / "bar.obj", mesh.str());
  return writeFile(folder / "bar.toml",
                   "format = 1\n[simulator]\nclass = \"org.c3de.mass_spring.Simulator/0\"\n"
                   "[world]\ngravity = [0, 0, 0]\n[[body]]\nname = \"bar\"\nmesh = \"bar.obj\"\nmesh_unit = \"m\"\n"
                   "material = { youngs_modulus = 6e3, density = 1000.0 }\nsampling = { spacing = 0.01 }\n" +
                       more);
}

Json run(const std::filesystem::path &scene, std::vector<std::string> more) {
  const auto report = scene.parent_path() / "report.json";
  std::vector<std::string> arguments{"run", scene.string(), "--report", report.string(), "-q", "--plugin", plugin()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto result = runC3de(arguments);
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  return readJson(report);
}

std::string refusal(const std::filesystem::path &scene, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"run", scene.string(), "--steps", "1", "-q", "--plugin", plugin()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto result = runC3de(arguments);
  CHECK(result.exitCode == 3);
  return result.errorOutput;
}

const std::string kMoving = "velocity = [0.1, 0.2, 0.3]\nangular_velocity = [3.0, 2.0, 1.0]\n[solver]\ndamping = 0\n";

}  // namespace

TEST_CASE("a bar of springs stretches by Young's modulus and thins by a quarter", "[mass_spring]") {
  const auto scene = writeBar(
      freshFolder("springs_bar"),
      "[solver]\ndamping = 30\n"
      "[[fix]]\nregion = { box = { min = [-0.001, -1, -1], max = [0, 1, 1] } }\n"
      "[[load]]\npressure = -60\nfollower = false\nregion = { box = { min = [0.2, -1, -1], max = [0.201, 1, 1] } }\n"
      "[[probe]]\nname = \"left\"\nbody = \"bar\"\nat = [0.08, 0, 0]\n"
      "[[probe]]\nname = \"right\"\nbody = \"bar\"\nat = [0.12, 0, 0]\n"
      "[[probe]]\nname = \"side\"\nbody = \"bar\"\nat = [0.1, 0.02, 0]\n");
  const Json report = run(scene, {"--until", "3"});
  const auto at = [&](std::size_t probe, std::size_t axis) {
    return report.at("probes").at(probe).at("position_m").at(axis).get<double>();
  };
  const double strain = (at(1, 0) - at(0, 0)) / 0.04 - 1.0, across = at(2, 1) / 0.02 - 1.0;
  // Springs are linear in their length and not in the strain: at 1 % that is half a per cent of it.
  CHECK_THAT(strain, WithinRel(kPressure / kYoungsModulus, 0.01));
  CHECK_THAT(-across / strain, WithinRel(0.25, 0.01));
  // The support balances the pull, exactly.
  CHECK_THAT(report.at("reactions").at(0).at("force_N").at(0).get<double>(), WithinRel(-0.0016 * kPressure, 1e-6));
}

TEST_CASE("a free bar of springs keeps its momentum, and the same run gives the same bits", "[mass_spring]") {
  const auto scene = writeBar(freshFolder("springs_free"), kMoving);
  const Json first = run(scene, {"--steps", "0"}), later = run(scene, {"--steps", "500"});
  for (const char *key : {"momentum", "angular_momentum"})
    for (std::size_t a = 0; a < 3; ++a) {
      INFO(key << ' ' << a);
      CHECK_THAT(later.at("bodies").at(0).at(key).at(a).get<double>(),
                 WithinAbs(first.at("bodies").at(0).at(key).at(a).get<double>(), 1e-12));
    }
  CHECK(later.at("state_hash") != first.at("state_hash"));
  CHECK(run(scene, {"--steps", "500"}).at("state_hash") == later.at("state_hash"));
}

TEST_CASE("what springs do not serve is refused with its line", "[mass_spring]") {
  const auto folder = freshFolder("springs_refused");
  const auto refined = writeBar(folder, "");
  const std::string text = readFile(refined), coarse = "spacing = 0.01";
  CHECK_THAT(
      refusal(writeFile(refined, std::string(text).replace(text.find(coarse), coarse.size(),
                                                           coarse + ", refine = [ { region = { sphere = { centre "
                                                                    "= [0, 0, 0], radius = 1.0 } }, "
                                                                    "spacing = 0.005 } ]"))),
      Contains("the lattice has one spacing"));
  CHECK_THAT(refusal(writeBar(folder, "[[obstacle]]\nname = \"block\"\nmesh = \"bar.obj\"\nmesh_unit = \"m\"\n")),
             Contains("accepted: no obstacle"));
  CHECK_THAT(refusal(writeBar(folder, "[solver]\ndt = 0.1\n")), Contains("above the stable step of body 'bar'"));
}

TEST_CASE("a state goes on bit for bit, and another file changes nothing", "[mass_spring][saved_state]") {
  const auto folder = freshFolder("springs_state");
  const auto scene = writeBar(folder, kMoving);
  const std::string state = (folder / "bar.state").string();
  const Json whole = run(scene, {"--steps", "300"}), half = run(scene, {"--steps", "100", "--save-state", state});
  CHECK(run(scene, {"--from-state", state, "--steps", "100"}).at("state_hash") == half.at("state_hash"));
  CHECK(run(scene, {"--from-state", state, "--steps", "300"}).at("state_hash") == whole.at("state_hash"));

  const std::string bytes = readFile(state);
  const auto cut = [&](std::size_t n) {
    return refusal(scene, {"--from-state", writeFile(folder / "cut.state", bytes.substr(0, n)).string()});
  };
  CHECK_THAT(cut(0), Contains("is not a state file"));
  for (const std::size_t n : {std::size_t{22}, std::size_t{40}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1})
    CHECK_THAT(cut(n), Contains("the state ends too early"));
  std::string turned = bytes;
  turned[turned.size() / 2] = static_cast<char>(turned[turned.size() / 2] ^ 1);
  CHECK_THAT(refusal(scene, {"--from-state", writeFile(folder / "turned.state", turned).string()}),
             Contains("the state is damaged"));
  const auto heavier = writeBar(folder, "[solver]\ndamping = 1\n");
  CHECK_THAT(refusal(heavier, {"--from-state", state}), Contains("belongs to another scene"));
}

TEST_CASE("a state of the point-based simulator goes on bit for bit, through contact", "[saved_state]") {
  const auto folder = freshFolder("organ_state");
  const std::filesystem::path resources = testResourcesFolder();
  const std::string scene = (resources / "scenes" / "first_light.toml").string();
  const std::string held =
      writeFile(folder / "held.toml",
                "format = 1\n[simulator]\nclass = \"c3de.pointbased.WorldSimulator/1\"\n"
                "[solver]\nintegrator = \"explicit\"\n[[body]]\nname = \"organ\"\nmesh_unit = \"mm\"\nmesh = \"" +
                    (resources / "meshes" / "organ.obj").generic_string() +
                    "\"\nmaterial = { viscosity = 5.0, prony = [ { share = 0.3, time = 0.1 } ] }\n"
                    "[[fix]]\nregion = { half_space = { point = [-0.031, 0, 0], normal = [1, 0, 0] } }\n"
                    "displacement = [0, 0.01, 0]\nramp = 0.2\n"
                    "[[load]]\nforce = [0, 0, 0.1]\nramp = 0.1\n"
                    "region = { half_space = { point = [0.05, 0, 0], normal = [-1, 0, 0] } }\n")
          .string();
  const std::string state = (folder / "organ.state").string();
  const auto hashAfter = [&](const std::string &what, const std::string &steps, std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", what, "--steps", steps, "-q", "--report", (folder / "r.json").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = runC3de(arguments);
    INFO(result.errorOutput);
    REQUIRE(result.exitCode == 0);
    return readJson(folder / "r.json").at("state_hash").get<std::string>();
  };
  struct Case {
    std::string scene, half, whole;
  };
  // In the air, on the block, and by moving supports.
  for (const Case &one : {Case{scene, "100", "400"}, Case{scene, "400", "700"}, Case{held, "60", "300"}}) {
    INFO(one.scene << ' ' << one.half);
    const std::string saved = hashAfter(one.scene, one.half, {"--save-state", state});
    CHECK(hashAfter(one.scene, one.half, {"--from-state", state}) == saved);
    CHECK(hashAfter(one.scene, one.whole, {"--from-state", state}) == hashAfter(one.scene, one.whole, {}));
  }
  // A different scene setting is detected, even where it changes no body.
  std::string elsewhere = readFile(held);
  elsewhere.replace(elsewhere.find("[0.05, 0, 0]"), 12, "[0.04, 0, 0]");
  for (const auto &[other, more] :
       {std::pair{scene, std::string("obstacle.block.friction=0.9")},
        std::pair{scene, std::string("body.organ.material.viscosity=4")},
        std::pair{writeFile(folder / "elsewhere.toml", elsewhere).string(), std::string("title=load")}}) {
    INFO(more);
    const std::string &of = other == scene ? scene : held;
    (void)hashAfter(of, "5", {"--save-state", state});
    const auto refused = runC3de({"run", other, "--from-state", state, "--set", more, "--steps", "1"});
    CHECK(refused.exitCode == 3);
    CHECK_THAT(refused.errorOutput, Contains("belongs to another scene"));
  }
  const auto springs =
      runC3de({"run", writeBar(folder, kMoving).string(), "--plugin", plugin(), "--from-state", state, "--steps", "1"});
  CHECK(springs.exitCode == 3);
  CHECK_THAT(springs.errorOutput, Contains("a state of simulator c3de.pointbased.WorldSimulator/1"));
}
