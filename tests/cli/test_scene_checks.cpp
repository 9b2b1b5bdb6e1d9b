// SPDX-License-Identifier: Apache-2.0
// `info` reports the same about a scene as `run` would.
#include <chrono>
#include <sstream>

#include "program.h"

namespace {

const std::string kBox = R"(format = 1
[[body]]
name = "box"
mesh = "box.obj"
mesh_unit = "m"
)";

const std::string kImage =
    "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4 4\nspace: LPS\n"
    "space directions: (50,0,0) (0,50,0) (0,0,50)\nspace origin: (0,0,0)\nencoding: ascii\n\n";

/// Files that scenes name: box.obj, open.obj, garbage.obj, labels.nrrd (label 1), cut.nrrd, float.nrrd.
std::filesystem::path folderOfFiles(const std::string &name) {
  const auto folder = freshFolder(name);
  writeFile(folder / "box.obj", boxObj());
  writeFile(folder / "open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 1 2 3\nf 1 2 4\nf 2 3 5\nf 1 3 5\n");
  writeFile(folder / "garbage.obj", "v 0 0 zero\n");
  std::string voxels;
  for (int i = 0; i < 64; ++i) voxels += "1 ";
  writeFile(folder / "labels.nrrd", kImage + voxels + "\n");
  writeFile(folder / "cut.nrrd", kImage + "1 1 1\n");
  writeFile(folder / "negative.nrrd", kImage + "-1 -2 " + voxels.substr(4) + "\n");
  std::filesystem::create_directories(folder / "empty");
  return folder;
}

/// The errors, without progress lines, which a slow machine adds.
std::string errorsOf(const c3de::ProcessResult &result) {
  std::istringstream lines(result.errorOutput);
  std::string errors;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("c3de: error: ")) errors += line + "\n";
  return errors;
}

struct Checked {
  const char *what;
  std::string text;
  int exitCode;
  const char *contains;  ///< of the error
};

std::vector<Checked> scenes() {
  const std::string second = "[[body]]\nname = \"second\"\nmesh_unit = \"m\"\n";
  const std::string organ = "format = 1\n[[body]]\nname = \"organ\"\nvolume = \"labels.nrrd\"\n";
  return {
      {"a good one", kBox, 0, ""},
      {"a good one with an image", kBox + "[image]\nfile = \"labels.nrrd\"\nlabels = \"labels.nrrd\"\n", 0, ""},
      {"a good one from an image", organ + "label = 1\n", 0, ""},
      {"an unknown key of the file", kBox + "colour = 3\n", 3, "unknown key 'colour'"},
      {"an unknown key of the simulator", kBox + "material = { yungs_modulus = 1e4 }\n", 3,
       "did you mean 'material.youngs_modulus'?"},
      {"an unknown key of the world", kBox + "[world]\nwind = 1\n", 3, "world.wind"},
      {"an unknown key of the view", kBox + "[view]\ncolor = \"error\"\n", 3, "did you mean 'view.colour'?"},
      {"a value out of range", kBox + "material = { poisson_ratio = 0.6 }\n", 3, "material.poisson_ratio = 0.6"},
      {"a value that is no number", kBox + "material = { density = nan }\n", 3, "material.density = nan"},
      {"a vector with text", kBox + "[world]\ngravity = [0, \"abc\", 0]\n", 3, "[0, \"abc\", 0]"},
      {"two values that do not go together",
       kBox + "material = { prony = [ { share = 0.6, time = 0.1 }, { share = 0.6, time = 1 } ] }\n", 3, "share"},
      {"a mesh that is not there", kBox + second + "mesh = \"gone.obj\"\n", 3, "does not exist"},
      {"a mesh that is a folder", kBox + second + "mesh = \"empty\"\n", 3, "is a folder"},
      {"a mesh that is damaged", kBox + second + "mesh = \"garbage.obj\"\n", 3, "'zero'"},
      {"a mesh that cannot be filled", kBox + second + "mesh = \"open.obj\"\n", 3, "cannot be filled"},
      {"an obstacle that is damaged", kBox + "[[obstacle]]\nmesh = \"garbage.obj\"\nmesh_unit = \"m\"\n", 3, "'zero'"},
      {"friction out of range",
       kBox + "[[obstacle]]\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nposition = [0, -3, 0]\nfriction = -1\n", 3,
       "friction = -1"},
      {"an image that is cut off", kBox + "[image]\nfile = \"cut.nrrd\"\n", 3, "truncated"},
      {"labels that are cut off", kBox + "[image]\nfile = \"labels.nrrd\"\nlabels = \"cut.nrrd\"\n", 3, "truncated"},
      {"labels that are none", kBox + "[image]\nfile = \"labels.nrrd\"\nlabels = \"negative.nrrd\"\n", 3,
       "negative.nrrd"},
      {"an image that is an empty folder", kBox + "[image]\nfile = \"empty\"\n", 3, "empty"},
      {"a label that is not there", organ + "label = 7\n", 3, "has no label 7"},
      {"a threshold that leaves nothing", organ + "threshold = [5, 6]\n", 3, "nothing is left"},
      {"a fix that misses", kBox + "[[fix]]\nregion = { sphere = { centre = [9, 9, 9], radius = 0.1 } }\n", 3, ":6: "},
      {"a load that misses",
       kBox + "[[load]]\nregion = { sphere = { centre = [9, 9, 9], radius = 0.1 } }\nforce = [0, 1, 0]\n", 3, ":6: "},
      {"a part that misses",
       kBox +
           "parts = [ { region = { sphere = { centre = [9, 9, 9], radius = 0.1 } }, material = { density = 900 } } ]\n",
       3, "region"},
      {"sampling that does not go together", kBox + "sampling = { evaluation = \"phyxels\", surface_spacing = 0.01 }\n",
       3, "stress_points"},
      {"a spacing that makes too many", kBox + "sampling = { spacing = 1e-4 }\n", 3, "phyxels; at most"},
      {"a surface spacing that makes too many", kBox + "sampling = { surface_spacing = 1e-4 }\n", 3, "phyxels"},
      {"a refinement that makes too many",
       kBox + "sampling = { refine = [ { region = { everywhere = true }, spacing = 0.0005 } ] }\n", 3, "phyxels"},
      {"a body of no name", kBox + "[[probe]]\nat = [0, 0, 0]\nbody = \"bix\"\n", 3, "did you mean 'box'?"},
  };
}

}  // namespace

TEST_CASE("info and run give the same verdict on a scene, in the same words") {
  const auto folder = folderOfFiles("same-verdict");
  for (const Checked &one : scenes()) {
    const std::string file = writeFile(folder / "scene.toml", one.text).string();
    const auto info = runC3de({"info", file}), run = runC3de({"run", file, "--steps", "1", "-q"});
    INFO(one.what << "\ninfo: " << info.errorOutput << "run:  " << run.errorOutput);
    CHECK(info.exitCode == one.exitCode);
    CHECK(run.exitCode == one.exitCode);
    CHECK(errorsOf(info) == errorsOf(run));
    if (one.exitCode != 0)
      CHECK_THAT(errorsOf(info), Contains("scene.toml:") && Contains(one.contains));
    else
      CHECK(errorsOf(info).empty());
  }
}

TEST_CASE("info says what it could not check") {
  const auto folder = folderOfFiles("not-checked");
  const auto misses =
      writeFile(folder / "misses.toml", kBox + "[[fix]]\nregion = { sphere = { centre = [9, 9, 9], radius = 0.1 } }\n")
          .string();
  const auto without = runC3de({"info", misses, "--no-plugins"});
  CHECK(without.exitCode == 0);
  CHECK_THAT(without.output,
             Contains("not checked: keys and values of materials") && Contains("no plugin that simulates is loaded"));
  const auto quick = runC3de({"info", misses, "--quick"});
  CHECK(quick.exitCode == 0);
  CHECK_THAT(quick.output, Contains("every key is known") && Contains("not checked: sampling") && Contains("--quick"));
  CHECK(runC3de({"info", misses}).exitCode == 3);
  const auto typo = writeFile(folder / "typo.toml", kBox + "material = { yungs_modulus = 1e4 }\n").string();
  CHECK(runC3de({"info", typo, "--quick"}).exitCode == 3);
  const auto cut = writeFile(folder / "cut.toml", kBox + "[image]\nfile = \"cut.nrrd\"\n").string();
  CHECK(runC3de({"info", cut, "--no-plugins"}).exitCode == 3);
}

TEST_CASE("info tells what was built of a body") {
  const auto folder = folderOfFiles("built");
  const auto json =
      runC3de({"info", writeFile(folder / "scene.toml", kBox + "sampling = { count = 500 }\n").string(), "--json"});
  REQUIRE(json.exitCode == 0);
  const auto parsed = nlohmann::json::parse(json.output);
  CHECK(parsed.at("built") == true);
  CHECK(parsed.at("bodies").at(0).at("points") > 400);
  CHECK(parsed.at("bodies").at(0).at("points") < 600);
}

TEST_CASE("Without a count a thin body has more phyxels than a thick one") {
  const auto folder = folderOfFiles("automatic");
  writeFile(folder / "thin.obj",
            "v 0 0 0\nv 1 0 0\nv 1 0.2 0\nv 0 0.2 0\nv 0 0 0.05\nv 1 0 0.05\nv 1 0.2 0.05\nv 0 0.2 0.05\n"
            "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const auto phyxelsOf = [&](const std::string &mesh, const std::string &sampling) {
    std::string text = kBox + sampling;
    text.replace(text.find("box.obj"), 7, mesh);
    const auto told = runC3de({"info", writeFile(folder / "scene.toml", text).string(), "--json"});
    INFO(told.errorOutput);
    REQUIRE(told.exitCode == 0);
    return nlohmann::json::parse(told.output).at("bodies").at(0).at("points").get<double>();
  };
  // At least these; more where an error of 5 % requires them.
  CHECK(phyxelsOf("box.obj", "") > 0.92 * 1000);
  // V = 0.01 m³, A = 0.52 m²: 2A³/V² = 2812.
  const double thin = phyxelsOf("thin.obj", "");
  CHECK(thin > 0.95 * 2812);
  CHECK(phyxelsOf("thin.obj", "sampling = { count = \"auto\" }\n") == thin);
  CHECK(phyxelsOf("thin.obj", "sampling = { count = 1000 }\n") == Approx(1000).epsilon(0.05));
}

TEST_CASE("Too many phyxels are refused before they are made") {
  const auto folder = folderOfFiles("too-many");
  for (const std::string sampling :
       {"surface_spacing = 1e-6", "surface_spacing = 1e-4", "spacing = 2.6e-3", "spacing = 1e-6",
        "refine = [ { region = { everywhere = true }, spacing = 5e-4 } ]",
        "refine = [ { region = { sphere = { centre = [0.5, 0.1, 0.1], radius = 0.09 } }, spacing = 1e-4 } ]"}) {
    const auto scene = writeFile(folder / "scene.toml", kBox + "sampling = { " + sampling + " }\n").string();
    const auto begin = std::chrono::steady_clock::now();
    const auto refused = runC3de({"run", scene, "--steps", "1", "-q"});
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    INFO(sampling << ": " << refused.errorOutput);
    CHECK(refused.exitCode == 3);
    CHECK_THAT(refused.errorOutput, Contains("phyxels") && Contains("use a larger spacing"));
    CHECK(took_s < 5.0);  // a second on a quiet machine; 20 to 35 s where it was built first
  }
}
