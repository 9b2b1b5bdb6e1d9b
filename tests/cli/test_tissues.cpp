// SPDX-License-Identifier: Apache-2.0
// One body of many tissues, as a user writes it.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::Contains;

namespace {

// A ball in a block on a plate, 96 mm wide: labels of 4 mm, and an image of 6 mm that shows the block in air.
std::filesystem::path writePhantom(const std::filesystem::path &folder) {
  imaging::LabelMap map;
  map.geometry.size = {24, 24, 24};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 0; k < 24; ++k)
    for (std::size_t j = 0; j < 24; ++j)
      for (std::size_t i = 0; i < 24; ++i) {
        const Vec3 x = map.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        std::uint16_t &label = map.voxels[i + 24 * (j + 24 * k)];
        if (norm(x - Vec3{46.0, 46.0, 50.0}) < 14.0) label = 1;
        if (k < 4 && i >= 4 && i < 20 && j >= 4 && j < 20) label = 2;
        if (i == 12 && j == 12 && k == 18) label = 3;
      }
  map.labels = {
      {1, "core", {0.6F, 0.2F, 0.1F}}, {2, "bone_plate", {0.9F, 0.9F, 0.8F}}, {3, "speck", {0.1F, 0.2F, 0.9F}}};
  REQUIRE(imaging::writeLabelMap(folder / "labels.nrrd", map));
  imaging::Volume image;
  image.geometry.size = {16, 16, 16};
  for (const std::size_t axis : {0, 5, 10}) image.geometry.indexToWorld[axis] = 6.0;
  std::vector<float> values(image.geometry.voxelCount(), -1000.0F);
  for (std::size_t k = 3; k < 13; ++k)
    for (std::size_t j = 3; j < 13; ++j)
      for (std::size_t i = 3; i < 13; ++i) values[i + 16 * (j + 16 * k)] = 50.0F;
  image.voxels = std::move(values);
  REQUIRE(imaging::writeVolume(folder / "ct.nrrd", image));
  return folder / "labels.nrrd";
}

const std::string kCore = "{ label = \"core\", material = { youngs_modulus = 1e5, density = 2000 } }";
const std::string kPlate = "{ label = \"bone*\", rigid = true }";
const std::string kBackground =
    "background = { material = { youngs_modulus = 1e4, density = 1000 }, image = \"ct.nrrd\", from = -100, to = 100 "
    "}\n";

std::string sceneOf(const std::string &tissues, const std::string &background = kBackground) {
  return "format = 1\n[world]\ngravity = [9.81, 0, 0]\n[solver]\ndamping = 20\n[[body]]\nname = \"scan\"\nvolume = "
         "\"labels.nrrd\"\nsampling = { spacing = 0.01 }\ntissues = [ " +
         tissues + " ]\n" + background;
}

}  // namespace

TEST_CASE("A body of many tissues has their volumes and densities, and what is rigid holds it", "[tissues]") {
  const auto folder = freshFolder("tissues");
  (void)writePhantom(folder);
  const auto scene = writeFile(folder / "scene.toml", sceneOf(kCore + ", " + kPlate));
  const auto report = runToReport(scene, {"--until", "2"});
  const auto &body = report["bodies"][0];
  // Voxels of 64 mm³: 16² x 4 of the plate, the ball, and the block between 15 and 75 mm, that the image shows.
  std::size_t ball = 0, block = 0, plate = 16 * 16 * 4;
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        if (k < 4 && i >= 4 && i < 20 && j >= 4 && j < 20) continue;
        const bool inBall = std::hypot(4 * i - 46, 4 * j - 46, 4 * k - 50) < 14.0;
        const auto isIn = [](int a) { return 4 * a >= 15 && 4 * a < 75; };
        ball += inBall ? 1 : 0;
        block += !inBall && isIn(i) && isIn(j) && isIn(k) ? 1 : 0;
      }
  const double voxel = 64e-9;
  CHECK(body["volume_m3"].get<double>() == Approx(voxel * static_cast<double>(ball + block + plate)).epsilon(1e-6));
  // Materials are resolved by the samples of cells, 2.5 mm apart, and planes between them.
  const double mass = voxel * (2000.0 * static_cast<double>(ball) + 1000.0 * static_cast<double>(block + plate));
  CHECK(body["mass_kg"].get<double>() == Approx(mass).epsilon(2e-3));
  REQUIRE(report["reactions"].size() == 1);
  // The weight hanging on the plate: all but its own; the plate supports itself.
  const double hanging = 9.81 * voxel * (2000.0 * static_cast<double>(ball) + 1000.0 * static_cast<double>(block));
  const double held = -report["reactions"][0]["force_N"][0].get<double>();
  CHECK(held > 0.97 * hanging);
  CHECK(held < 1.01 * 9.81 * mass);
}

TEST_CASE("A body of many tissues that is led has finer cells there by itself", "[tissues]") {
  const auto folder = freshFolder("tissues-adaptive");
  (void)writePhantom(folder);
  const auto scene =
      writeFile(folder / "scene.toml",
                sceneOf(kCore + ", " + kPlate) +
                    "[[fix]]\nbody = \"scan\"\nregion = { sphere = { centre = [0.046, 0.046, 0.05], radius = "
                    "0.006 } }\ndisplacement = [0.004, 0, 0]\n");
  const std::vector<std::string> count{"--set", "body.scan.sampling.count=1200", "--set",
                                       "solver.integrator=quasistatic"};
  const auto led = runToReport(scene, count);
  REQUIRE(led["bodies"][0].contains("adaptive"));
  CHECK(led["bodies"][0]["adaptive"]["halved_cells"] > 0);
  CHECK(led["bodies"][0]["phyxels"].get<double>() == Approx(1200.0).epsilon(0.12));
  CHECK(led["bodies"][0]["added_mass_kg"] == 0.0);
  // An explicit spacing is used as specified.
  CHECK_FALSE(runToReport(scene, {"--set", "solver.integrator=quasistatic"})["bodies"][0].contains("adaptive"));

  // In explicit steps as well.
  const auto stepped = runToReport(scene, {"--set", "body.scan.sampling.count=1200", "--steps", "1"});
  const auto even = runToReport(
      scene, {"--set", "body.scan.sampling.count=1200", "--set", "body.scan.sampling.adaptive=off", "--steps", "1"});
  CHECK_FALSE(even["bodies"][0].contains("adaptive"));
  CHECK(stepped["bodies"][0]["adaptive"]["halved_cells"] == led["bodies"][0]["adaptive"]["halved_cells"]);
  CHECK(stepped["bodies"][0]["stable_dt_s"].get<double>() > 0.4 * even["bodies"][0]["stable_dt_s"].get<double>());
}

TEST_CASE("What is not right about tissues is an error, and labels that nobody names are told", "[tissues]") {
  const auto folder = freshFolder("tissues-refused");
  (void)writePhantom(folder);
  const auto refusal = [&](const std::string &text) {
    const auto run = runC3de({"run", writeFile(folder / "scene.toml", text).string(), "--steps", "1"});
    CHECK(run.exitCode == 3);
    return run.errorOutput;
  };
  CHECK_THAT(refusal(sceneOf("{ label = \"cor\", material = \"liver\" }")),
             Contains("no label 'cor'") && Contains("did you mean 'core'?"));
  CHECK_THAT(refusal(sceneOf("{ label = \"core\" }")), Contains("no tissue is known by the name 'core'"));
  CHECK_THAT(refusal(sceneOf("{ material = \"liver\" }")), Contains("a tissue has no 'label'"));
  CHECK_THAT(refusal(sceneOf("{ label = \"core\", materiel = \"liver\" }")), Contains("unknown key 'materiel'"));
  CHECK_THAT(refusal(sceneOf("{ label = \"*\", rigid = true }", "")), Contains("all tissues are rigid"));
  CHECK_THAT(refusal(sceneOf(kCore, "background = { material = \"fat\", image = \"ct.nrrd\", from = 3, to = 1 }\n")),
             Contains("from 3 to 1 leaves nothing"));
  CHECK_THAT(refusal(sceneOf(kCore, "label = 1\n")), Contains("'tissues' and 'label'"));
  CHECK_THAT(refusal(sceneOf(kCore, "background = { material = \"fat\", image = \"ct.nrrd\", from = 3 }\n")),
             Contains("background has no 'to'"));
  // Where tissues are set, they cannot become inconsistent with their parts.
  const auto scene = writeFile(folder / "set.toml", sceneOf(kCore + ", " + kPlate)).string();
  for (const char *set : {"parts=[]", "label=1", "tissues=[]", "rigid=true", "parts.0.region={everywhere=true}"}) {
    CAPTURE(set);
    const auto run = runC3de({"run", scene, "--steps", "1", "--set", std::string("body.scan.") + set});
    CHECK(run.exitCode == 2);
    CHECK_THAT(run.errorOutput, Contains("accepted") && Contains("material"));
  }
  const auto softer = runC3de({"run", scene, "--steps", "1", "--set", "body.scan.parts.0.material.youngs_modulus=5e4"});
  CHECK(softer.exitCode == 0);
  const auto left =
      runC3de({"run", writeFile(folder / "left.toml", sceneOf(kCore + ", " + kPlate, "")).string(), "--steps", "1"});
  INFO(left.errorOutput);
  CHECK(left.exitCode == 0);
  CHECK_THAT(left.errorOutput, Contains("1 label is of no tissue and left out") && Contains("speck"));
}

TEST_CASE("Tissues may be told by values and by distance, beside labels and without", "[tissues]") {
  const auto folder = freshFolder("tissues-rules");
  (void)writePhantom(folder);
  const std::string soft = "material = { youngs_modulus = 1e4, density = 1000 }";
  const auto voxelsOf = [&](const std::string &tissues, const std::string &volume) {
    std::string text = sceneOf(tissues, "");
    text.replace(text.find("labels.nrrd"), 11, volume);
    const auto run = runC3de({"info", "--json", "--quick", writeFile(folder / "scene.toml", text).string()});
    INFO(run.errorOutput);
    REQUIRE(run.exitCode == 0);
    std::map<std::string, std::size_t> voxels;
    const auto json = nlohmann::json::parse(run.output);
    for (const auto &tissue : json["bodies"][0]["volume"]["tissues"])
      voxels[tissue["label"]] = tissue["voxels"].get<std::size_t>();
    return voxels;
  };
  // The expected result, on both grids; voxels of the map use the image voxel that contains their centre.
  std::size_t core = 0, block = 0, shell = 0, front = 0;
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        if (k < 4 && i >= 4 && i < 20 && j >= 4 && j < 20) continue;
        const double r = std::hypot(4 * i - 46, 4 * j - 46, 4 * k - 50);
        const auto isIn = [](int a) { return 4 * a >= 15 && 4 * a < 75; };
        core += r < 14.0 ? 1 : 0;
        block += r >= 14.0 && isIn(i) && isIn(j) && isIn(k) ? 1 : 0;
        bool isNear = false;
        for (int dk = -1; dk <= 1; ++dk)
          for (int dj = -1; dj <= 1; ++dj)
            for (int di = -1; di <= 1; ++di)
              isNear = isNear || (di * di + dj * dj + dk * dk <= 1 &&
                                  std::hypot(4 * (i + di) - 46, 4 * (j + dj) - 46, 4 * (k + dk) - 50) < 14.0);
        shell += r >= 14.0 && isNear ? 1 : 0;
        front += r >= 14.0 && isNear && 4 * i <= 46 ? 1 : 0;
      }
  auto voxels = voxelsOf(
      kCore + ", " + kPlate + ", { name = \"block\", image = \"ct.nrrd\", threshold = [-100, 100], " + soft + " }",
      "labels.nrrd");
  CHECK(voxels["core"] == core);
  CHECK(voxels["bone*"] == 16 * 16 * 4);
  CHECK(voxels["block"] == block);
  // Around earlier tissues: in the order of the list, and within a region.
  const std::string within = "region = { half_space = { point = [0.046, 0, 0], normal = [1, 0, 0] } }";
  voxels = voxelsOf("{ label = \"core\", " + soft + " }, { name = \"front\", margin = 4.0, " + within +
                        ", empty = true }, { name = \"block\", image = \"ct.nrrd\", threshold = [-100, 100], rigid = "
                        "true }",
                    "labels.nrrd");
  CHECK(voxels["front"] == 0);  // none of it belongs to the body
  CHECK(voxels["block"] > 0);
  CHECK(voxels["block"] + front >= block);
  CHECK(voxels["block"] < block);
  voxels = voxelsOf(kCore + ", { name = \"shell\", margin = 4.0, " + soft + " }", "labels.nrrd");
  CHECK(voxels["shell"] == shell);
  // Of an image without labels, whose negative values no label map could hold.
  voxels = voxelsOf("{ name = \"block\", threshold = [-100, 100], " + soft +
                        " }, { name = \"air\", threshold = "
                        "[-2000, -900], rigid = true }",
                    "ct.nrrd");
  CHECK(voxels["block"] == 1000);
  CHECK(voxels["air"] == 16 * 16 * 16 - 1000);

  const auto refusal = [&](const std::string &tissue) {
    const auto run = runC3de(
        {"run", writeFile(folder / "bad.toml", sceneOf(kCore + ", { " + tissue + " }")).string(), "--steps", "1"});
    CHECK(run.exitCode == 3);
    return run.errorOutput;
  };
  CHECK_THAT(refusal("name = \"x\", threshold = [500, 900], image = \"ct.nrrd\", " + soft),
             Contains("bad.toml:10: tissue 'x' holds no voxel (values 500 to 900 of ct.nrrd)"));
  CHECK_THAT(refusal("name = \"x\", threshold = [9, 5], " + soft), Contains("bad.toml:10: threshold: 9 and 5"));
  CHECK_THAT(refusal("name = \"x\", margin = 0, " + soft), Contains("margin is 0; accepted: a length in mm above 0"));
  CHECK_THAT(refusal("threshold = [0, 9], " + soft), Contains("a tissue without a label has no 'name'"));
  CHECK_THAT(refusal("name = \"x\", " + soft), Contains("neither 'label' nor 'threshold' nor 'margin'"));
  CHECK_THAT(refusal("label = 2, margin = 3, " + soft), Contains("has a label and a threshold, margin"));
  CHECK_THAT(refusal("name = \"x\", margin = 3, image = \"ct.nrrd\", " + soft),
             Contains("'image' requires a 'threshold'"));
  CHECK_THAT(refusal("name = \"x\", margin = 3, empty = true, " + soft), Contains("is empty and has a material"));
  CHECK_THAT(refusal("name = \"gizmo\", margin = 3"), Contains("no tissue is known by the name 'gizmo'"));
}

TEST_CASE("In the living brain the skull stays, the brain moves and nothing is turned inside out", "[tissues][slow]") {
  if (!std::filesystem::exists("/usr/share/mricron/templates/ch2bet.nii.gz"))
    C3DE_SKIP("mricron-data is not installed");
  const auto folder = freshFolder("living-brain");
  const auto points = writeFile(folder / "points.csv",
                                "body,x [m],y [m],z [m]\n"
                                "head,0.0,-0.0785,0.009\nhead,0.0745,0.015,0.019\nhead,0.0,0.106,0.019\n"  // skull
                                "head,0.0,-0.05,0.03\n");  // frontal pole
  const auto run = runC3de({"run", (std::filesystem::path(testResourcesFolder()) / "scenes/brain_living.toml").string(),
                            "--until", "0.5", "--tissues", (folder / "tissues.csv").string(), "--sample-points",
                            points.string(), "--sampled", (folder / "sampled.csv").string()});
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  const auto rowsOf = [](const std::filesystem::path &file) {
    std::ifstream in(file);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(in, line);) {
      rows.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
  };
  const auto sampled = rowsOf(folder / "sampled.csv");
  REQUIRE(sampled.size() == 5);
  const auto columnOf = [](const std::vector<std::string> &heading, const std::string &name) {
    const auto found = std::find(heading.begin(), heading.end(), name);
    REQUIRE(found != heading.end());
    return static_cast<std::size_t>(found - heading.begin());
  };
  for (std::size_t row = 1; row < sampled.size(); ++row) {
    CAPTURE(row);
    double square = 0.0;
    for (const char *axis : {"x", "y", "z"}) {
      const double from = std::stod(sampled[row][columnOf(sampled[0], axis + std::string(" [m]"))]);
      const double to = std::stod(sampled[row][columnOf(sampled[0], axis + std::string(" at the end [m]"))]);
      square += (to - from) * (to - from);
    }
    if (row < 4)
      CHECK(std::sqrt(square) < 1e-5);
    else
      CHECK(std::sqrt(square) > 1e-3);
  }
  const auto tissues = rowsOf(folder / "tissues.csv");
  REQUIRE(tissues.size() == 6);  // the drained fluid is absent
  for (std::size_t row = 1; row < tissues.size(); ++row) {
    CAPTURE(tissues[row]);
    CHECK(std::stod(tissues[row][columnOf(tissues[0], "min J")]) > 0.0);
    const std::string &name = tissues[row][columnOf(tissues[0], "name")];
    const double mean_m = std::stod(tissues[row][columnOf(tissues[0], "mean displacement [m]")]);
    if (name == "skull")
      CHECK(mean_m == 0.0);
    else if (name != "fluid")
      CHECK(mean_m > 1e-3);
  }
}
