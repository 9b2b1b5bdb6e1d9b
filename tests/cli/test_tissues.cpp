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

TEST_CASE("In the living brain the skull stays, the brain moves and nothing is turned inside out", "[tissues]") {
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

namespace {

// A bar of 200 x 40 x 40 mm along x in voxels of 4 mm, with a layer of unlabelled voxels around: labels in sequence
// along it, more than fifty in sequence by rows of voxels.
void writeBar(const std::filesystem::path &file, const std::vector<std::string> &names) {
  const std::size_t n = names.size();
  imaging::LabelMap map;
  map.geometry.size = {52, 12, 12};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  map.geometry.indexToWorld[12] = map.geometry.indexToWorld[13] = map.geometry.indexToWorld[14] = -2.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 11; ++k)
    for (std::size_t j = 1; j < 11; ++j)
      for (std::size_t i = 1; i < 51; ++i)
        map.voxels[i + 52 * (j + 12 * k)] = static_cast<std::uint16_t>(
            1 + (n <= 50 ? (i - 1) * n / 50 : ((i - 1) + 50 * ((j - 1) + 10 * (k - 1))) * n / 5000));
  for (std::size_t l = 0; l < n; ++l)
    map.labels.push_back({static_cast<std::uint16_t>(l + 1), names[l], {0.5F, 0.5F, 0.5F}});
  REQUIRE(imaging::writeLabelMap(file, map));
}

std::string barScene(const std::string &tissues, const std::string &more = "") {
  return "format = 1\n[[body]]\nname = \"bar\"\nvolume = \"bar.nrrd\"\nsampling = { spacing = 0.008 }\ntissues = " +
         tissues + "\n" + more;
}

const nlohmann::json &tissueOf(const nlohmann::json &report, const std::string &name) {
  for (const auto &tissue : report["bodies"][0]["tissues"])
    if (tissue["name"] == name) return tissue;
  FAIL("no tissue " + name);
  return report;
}

}  // namespace

TEST_CASE("Tissues are what their names are known as, and info says of what, how stiff and how much", "[tissues]") {
  const auto folder = freshFolder("tissues-known");
  // 50 slices of 100 voxels of 64 mm³, five to each label.
  writeBar(folder / "bar.nrrd", {"Left Kidney", "kidney_right", "LIVER", "vertebrae_L1", "rib_left_7", "trachea",
                                 "gizmo", "colon", "liver tumour", "portal_vein_and_splenic_vein"});
  const auto scene = writeFile(folder / "scene.toml", barScene("\"known\"")).string();
  const auto run = runC3de({"info", "--json", scene});
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  CHECK_THAT(run.errorOutput, Contains("1 label is of no known tissue and left out") && Contains("gizmo"));
  const auto tissues = nlohmann::json::parse(run.output)["bodies"][0]["volume"]["tissues"];
  REQUIRE(tissues.size() == 7);
  const auto &kidney = tissues[0], &bone = tissues[2], &air = tissues[3], &bowel = tissues[4];
  CHECK(kidney["label"] == "kidney");
  REQUIRE(kidney["labels"].size() == 2);
  CHECK(kidney["labels"][1]["name"] == "kidney_right");
  CHECK(kidney["youngs_modulus"] == 5000.0);
  CHECK(kidney["youngs_modulus_range"] == nlohmann::json{2000.0, 15000.0});
  CHECK(kidney["source"] == "PMID 21862792");
  CHECK(kidney["voxels"] == 1000);
  CHECK(kidney["volume_ml"] == 64.0);
  CHECK(bone["rigid"] == true);
  CHECK(bone["labels"].size() == 2);
  CHECK(bone["voxels"] == 1000);
  CHECK_FALSE(bone.contains("part"));
  CHECK(air["empty"] == true);
  CHECK(air["voxels"] == 0);
  CHECK(bowel["part"] == 2);
  CHECK_THAT(bowel["remark"].get<std::string>(), Contains("taken for the stomach"));
  CHECK(tissues[5]["material"] == "liver_hcc");
  CHECK(tissues[6]["label"] == "vein");
  const auto text = runC3de({"info", "--quick", scene}).output;
  CHECK_THAT(text, Contains("tissue kidney: 5 kPa (2 … 15), kidney_cortex (PMID 21862792)") &&
                       Contains("1000 voxels, 64 ml of Left Kidney, kidney_right") && Contains("tissue bone: rigid"));
}

TEST_CASE("Labels without a material are told apart in the map, and an override finds its part", "[tissues]") {
  const auto folder = freshFolder("tissues-named");
  writeBar(folder / "bar.nrrd", {"liver_1", "liver_2", "spleen", "rib_left_1", "rib_left_2"});
  const auto scene =
      writeFile(folder / "scene.toml", barScene("[ { label = \"liver*\" }, { label = \"rib*\" }, { label = 3 } ]"))
          .string();
  const nlohmann::json rib = tissueOf(runToReport(scene, {"--steps", "1"}), "rib*");
  CHECK(rib["rigid"] == true);
  CHECK(rib["labels"] == nlohmann::json{"rib_left_1", "rib_left_2"});
  CHECK(rib["material"] == "bone_cortical");
  CHECK(rib["displacement_m"]["max"] == 0.0);
  CHECK(rib["min_J"] == 1.0);
  const auto mass = [&](const std::string &set) {
    return runToReport(scene, {"--steps", "1", "--set", "body.bar.parts." + set})["bodies"][0]["mass_kg"].get<double>();
  };
  const double usual = mass("1.material.youngs_modulus=3e3");
  // A fifth of 320 ml is spleen, two fifths are liver; their borders run through cells.
  CHECK(mass("1.material.density=2089") - usual == Approx(0.064).epsilon(0.2));
  CHECK(mass("0.material.density=2060") - usual == Approx(0.128).epsilon(0.2));
  for (const auto &[set, said] :
       {std::pair{"2.material.density=5", "no such part"}, std::pair{"0.material.densty=5", "densty"},
        std::pair{"0.region={everywhere=true}", "this part is a tissue"}}) {
    const auto run = runC3de({"run", scene, "--steps", "1", "--set", std::string("body.bar.parts.") + set});
    CAPTURE(set, run.errorOutput);
    CHECK(run.exitCode == 2);
    CHECK_THAT(run.errorOutput, Contains(said));
  }
}

TEST_CASE("What names cannot settle is an error that says where and what is accepted", "[tissues]") {
  const auto folder = freshFolder("tissues-unsettled");
  const auto refusal = [&](const std::vector<std::string> &names, const std::string &tissues) {
    writeBar(folder / "bar.nrrd", names);
    const auto scene = writeFile(folder / "scene.toml", barScene(tissues)).string();
    const auto run = runC3de({"run", scene, "--steps", "1"});
    CHECK(run.exitCode == 3);
    CHECK_THAT(run.errorOutput, Contains("scene.toml:"));
    CHECK_THAT(runC3de({"info", scene}).errorOutput, Contains(run.errorOutput.substr(run.errorOutput.find("toml:"))));
    return run.errorOutput;
  };
  CHECK_THAT(refusal({"label 1", "label 2"}, "\"known\""),
             Contains("is known by its name; there are: label 1, label 2") && Contains("accepted"));
  CHECK_THAT(refusal({"rib_left_1", "trachea"}, "\"known\""), Contains("all tissues are rigid or empty"));
  CHECK_THAT(refusal({"liver", "gizmo"}, "[ { label = \"liver\" }, { label = 2 } ]"),
             Contains("no tissue is known by the name 'gizmo'"));
  CHECK_THAT(refusal({"liver", "spleen"}, "[ { label = \"livr\" } ]"), Contains("did you mean 'liver'?"));
  CHECK_THAT(refusal({"liver", "spleen"}, "[ { label = \"pancreas\" } ]"),
             Contains("no label 'pancreas'; there are: liver, spleen"));
  CHECK_THAT(refusal({"kidney_left", "kidney_cyst_left"}, "[ { label = \"kidney*\" } ]"),
             Contains("kidney_left as kidney, kidney_cyst_left as kidney cyst"));
  CHECK_THAT(refusal({"liver", "spleen"}, "[ { label = \"*\", material = \"fat\" }, { label = \"liver\" } ]"),
             Contains("belong to earlier tissues"));
  CHECK_THAT(refusal({"liver", "spleen"}, "[ { label = 1 }, { label = \"liver\" } ]"),
             Contains("tissue 'liver' belong to earlier tissues"));
}

TEST_CASE("Two hundred labels are a handful of tissues", "[tissues]") {
  const auto folder = freshFolder("tissues-many");
  std::vector<std::string> names;
  for (int n = 0; n < 180; ++n)
    names.push_back((n % 3 == 0 ? "ctx-lh-" : n % 3 == 1 ? "wm-lh-" : "muscle_") + std::to_string(n));
  for (int n = 0; n < 20; ++n) names.push_back("gizmo_" + std::to_string(n));
  writeBar(folder / "bar.nrrd", names);
  const auto scene = writeFile(folder / "scene.toml", barScene("\"known\"", "mend = { largest = true }\n"));
  const auto run = runC3de({"run", scene.string(), "--steps", "1", "--report", (folder / "r.json").string()});
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  CHECK_THAT(run.errorOutput, Contains("20 labels are of no known tissue") && Contains("and 8 more"));
  const auto tissues = readJson(folder / "r.json")["bodies"][0]["tissues"];
  REQUIRE(tissues.size() == 3);
  CHECK(tissues[0]["name"] == "grey matter");
  CHECK(tissues[0]["labels"].size() == 60);
}

TEST_CASE("Report and table say how labels have moved and changed", "[tissues]") {
  const auto folder = freshFolder("tissues-moved");
  writeBar(folder / "bar.nrrd", {"liver", "spleen", "pancreas", "label 4"});
  // Stretched by a tenth without lateral contraction: u = 0.1 x, J = 1.1.
  const std::string held =
      "[solver]\nintegrator = \"quasistatic\"\nload_steps = 2\n"
      "[[fix]]\nregion = { box = { min = [-1, -1, -1], max = [0.002, 1, 1] } }\n"
      "[[fix]]\nregion = { box = { min = [0.198, -1, -1], max = [1, 1, 1] } }\ndisplacement = [0.02, 0, 0]\n";
  const auto scene = writeFile(
      folder / "scene.toml",
      barScene("[ { label = \"liver\", material = { youngs_modulus = 6e3, poisson_ratio = 0 } }, { label = \"spleen\", "
               "material = { youngs_modulus = 6e3, poisson_ratio = 0 } }, { label = \"pancreas\", material = { "
               "youngs_modulus = 6e3, poisson_ratio = 0 } }, { label = 4, material = { youngs_modulus = 6e3, "
               "poisson_ratio = 0 } } ]",
               held));
  const auto table = folder / "tissues.csv";
  const auto report = runToReport(scene, {"--tissues", table.string()});
  REQUIRE(report["bodies"][0]["tissues"].size() == 4);
  const auto &spleen = tissueOf(report, "spleen");
  CHECK(spleen["labels"] == nlohmann::json{"spleen"});
  CHECK(spleen["rigid"] == false);
  const double rest = spleen["volume_m3"]["reference"].get<double>();
  CHECK(rest == Approx(64e-9 * spleen["voxels"].get<double>()).epsilon(1e-9));
  CHECK(rest == Approx(8e-5).epsilon(0.05));
  CHECK(spleen["volume_m3"]["end"].get<double>() == Approx(1.1 * rest).epsilon(0.01));
  CHECK(spleen["min_J"].get<double>() == Approx(1.1).epsilon(0.02));
  CHECK(spleen["followed_part"] == 1.0);
  // Slices from 50 to 100 mm of 200; the centres of voxels are 2 mm inside.
  CHECK(spleen["displacement_m"]["mean"].get<double>() == Approx(0.0075).epsilon(0.03));
  CHECK(spleen["displacement_m"]["max"].get<double>() == Approx(0.0098).epsilon(0.03));
  CHECK(tissueOf(report, "4")["displacement_m"]["mean"].get<double>() == Approx(0.0175).epsilon(0.03));
  const std::string rows = readFile(table);
  CHECK_THAT(rows, Contains("body,label,name,tissue,material,rigid,voxels,volume [m3],") &&
                       Contains("\nbar,2,spleen,spleen,,false,") && Contains("\nbar,4,label 4,4,,false,"));
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 5);
  const auto refused = runC3de({"run", writeBoxScene(folder).string(), "--steps", "1", "--tissues", table.string()});
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput, Contains("--tissues needs a body with tissues"));
}

TEST_CASE("Labels are found again where a body has flown and turned", "[tissues]") {
  const auto folder = freshFolder("tissues-flown");
  writeBar(folder / "bar.nrrd", {"liver", "spleen"});
  const auto scene =
      writeFile(folder / "scene.toml",
                barScene("\"known\"",
                         "velocity = [0, 1, 0]\nangular_velocity = [0, 0, 3.14159265]\nposition = [0.1, 0, 0]\n"
                         "rotation_deg = [0, 90, 0]\nscale = 0.5\n"));
  const auto report = runToReport(scene, {"--until", "1"});
  const auto &liver = tissueOf(report, "liver"), &spleen = tissueOf(report, "spleen");
  for (const auto *tissue : {&liver, &spleen}) {
    CHECK((*tissue)["followed_part"].get<double>() > 0.99);
    // An eighth of 160 ml.
    CHECK((*tissue)["volume_m3"]["reference"].get<double>() == Approx(2e-5).epsilon(0.05));
    CHECK((*tissue)["volume_m3"]["end"].get<double>() == Approx(2e-5).epsilon(0.06));
  }
  // The axis moves with it: a metre along y, and half a turn about it.
  CHECK(liver["displacement_m"]["mean"].get<double>() == Approx(1.0).epsilon(0.02));
  CHECK(spleen["displacement_m"]["max"].get<double>() < 1.05);
}

namespace {

/// Two blocks of 128 x 64 x 32 mm on each other, in voxels of 4 mm, the border between them at z = 32 mm.
void writeBlocks(const std::filesystem::path &file) {
  imaging::LabelMap map;
  map.geometry.size = {34, 18, 18};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  for (const std::size_t axis : {12, 13, 14}) map.geometry.indexToWorld[axis] = -2.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 17; ++k)
    for (std::size_t j = 1; j < 17; ++j)
      for (std::size_t i = 1; i < 33; ++i) map.voxels[i + 34 * (j + 18 * k)] = k < 9 ? 1 : 2;
  map.labels = {{1, "below", {0.6F, 0.2F, 0.1F}}, {2, "above", {0.2F, 0.6F, 0.1F}}};
  REQUIRE(imaging::writeLabelMap(file, map));
}

/// Held at the bottom; the block above is pushed along x by half of its weight.
std::string blocksScene(const std::string &slides, const std::string &world = "gravity = [0, 0, -9.81]\n") {
  return "format = 1\n[world]\n" + world +
         "[[body]]\nname = \"scan\"\nvolume = \"blocks.nrrd\"\nsampling = { spacing = 0.008 }\n" + slides +
         "tissues = [ { label = \"below\", material = { youngs_modulus = 1e5, density = 1000, viscosity = 50 } }, "
         "{ label = \"above\", material = { youngs_modulus = 1e5, density = 1000, viscosity = 50 } } ]\n"
         "[[fix]]\nbody = \"scan\"\nregion = { box = { min = [-1, -1, -1], max = [1, 1, 0.004] } }\n"
         "[[load]]\nname = \"push\"\nbody = \"scan\"\nregion = { box = { min = [-1, -1, 0.0325], max = [1, 1, 1] } }\n"
         "force = [1.286, 0, 0]\n";
}

}  // namespace

TEST_CASE("A layer that slides without friction is pushed aside as a free body and a glued one shears", "[tissues]") {
  const auto folder = freshFolder("tissues-slide");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene = writeFile(folder / "scene.toml", blocksScene("slides = [\"above\"]\nslide_friction = 0\n"));
  const auto table = folder / "tissues.csv";
  const double t = 0.06, mass = 1000.0 * 128e-3 * 64e-3 * 32e-3, weight = 9.81 * mass, push = 1.286;
  const auto moved = [&](const nlohmann::json &report, const char *piece) {
    for (const auto &body : report["bodies"])
      if (body["name"] == piece) return body["centre_of_mass_m"][0].get<double>();
    FAIL("no body " + std::string(piece));
    return 0.0;
  };
  const auto report = runToReport(scene, {"--until", std::to_string(t), "--tissues", table.string()});
  REQUIRE(report["bodies"].size() == 2);
  CHECK(report["bodies"][1]["name"] == "scan.above");
  CHECK(report["bodies"][1]["mass_kg"].get<double>() == Approx(mass).epsilon(1e-3));
  // Half a F/m t². Skins are not flat: bulges of 0.3 mm over edges of 6 mm that climb each other resist by some 0.05 of
  // the pressing force, here of the weight; half as much again is allowed.
  const double s = report["time_s"].get<double>(), free = 0.5 * push / mass * s * s;
  const double slid = moved(report, "scan.above") - 0.064;
  CHECK(slid < 1.01 * free);
  CHECK(slid > free * (1.0 - 0.075 * weight / push));
  REQUIRE(report["contacts"].size() == 1);
  CHECK(report["contacts"][0]["bodies"] == nlohmann::json{"scan", "scan.above"});
  CHECK(std::abs(report["contacts"][0]["force_N"][0].get<double>()) < 0.075 * weight);
  CHECK(-report["contacts"][0]["force_N"][2].get<double>() == Approx(weight).epsilon(0.1));
  const std::string rows = readFile(table);
  CHECK_THAT(rows, Contains("\nscan,1,below,") && Contains("\nscan.above,2,above,"));
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 3);

  // Without weight there is no shear: the loss is from initial overlap with the other's bulges.
  const auto light = runToReport(scene, {"--until", "0.06", "--set", "world.gravity=[0, 0, 0]"});
  CHECK(moved(light, "scan.above") - 0.064 == Approx(free).epsilon(0.05));

  // Coulomb friction on the border, in addition.
  const auto rough = runToReport(scene, {"--until", "0.06", "--set", "body.scan.slide_friction=0.3"});
  const double slowed = free * (1.0 - 0.3 * weight / push);
  CHECK(moved(rough, "scan.above") - 0.064 < slowed);
  CHECK(moved(rough, "scan.above") - 0.064 > slowed - free * 0.075 * weight / push);

  const auto glued = runToReport(writeFile(folder / "glued.toml", blocksScene("")), {"--until", "0.06"});
  REQUIRE(glued["bodies"].size() == 1);
  CHECK(glued["contacts"].empty());
  // The mean of all points, half of which are near the support: less than a twentieth of the sliding distance.
  CHECK(std::abs(moved(glued, "scan") - 0.064) < 0.05 * free);
}

TEST_CASE("A piece of what slides is set by the name that the report says", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-set");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene = writeFile(folder / "scene.toml", blocksScene("slides = [\"above\"]\n"));
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"--steps", "1"});
    return runToReport(scene, more)["bodies"];
  };
  const auto as = run({});
  const auto set =
      run({"--set", "body.scan.above.material.density=500", "--set", "body.scan.above.sampling.spacing=0.016"});
  REQUIRE(set.size() == 2);
  CHECK(set[0]["mass_kg"] == as[0]["mass_kg"]);
  CHECK(set[0]["phyxels"] == as[0]["phyxels"]);
  CHECK(set[1]["mass_kg"].get<double>() == Approx(0.5 * as[1]["mass_kg"].get<double>()));
  CHECK(set[1]["phyxels"].get<int>() < as[1]["phyxels"].get<int>() / 4);
  // In a body with a given point count, a piece without a setting has the spacing of the rest, a piece with one has its
  // own.
  const auto counted = run({"--set", "body.scan.sampling.count=2000", "--set", "body.scan.above.sampling.count=100"});
  CHECK(counted[1]["phyxels"].get<int>() < counted[0]["phyxels"].get<int>() / 4);

  const auto refusal = [&](const std::string &assignment) {
    const auto refused = runC3de({"run", scene.string(), "--steps", "1", "--set", assignment});
    CHECK(refused.exitCode == 2);
    return refused.errorOutput;
  };
  CHECK_THAT(refusal("body.scan.abov.material.density=500"),
             Contains("there is no piece 'scan.abov'; did you mean 'scan.above'? accepted: scan.above"));
  CHECK_THAT(refusal("body.scan.above.material.densty=500"),
             Contains("--set body.scan.above.material.densty") && Contains("did you mean 'material.density'?"));
  CHECK_THAT(refusal("body.scan.above.position=[0,0,0]"), Contains("cannot be set for a piece; accepted: material"));
}

TEST_CASE("Pieces and the rest are rigid, free or thrown each by itself, and the rest has a name", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-pieces");
  writeBlocks(folder / "blocks.nrrd");
  const std::string slides = "slides = [\"above\"]\nslide_friction = 0\n", text = blocksScene(slides);
  const auto scene = writeFile(folder / "scene.toml", text);
  const auto run = [&](const std::filesystem::path &what, const std::vector<std::string> &set, double until_s = 0.02) {
    std::vector<std::string> more{"--until", std::to_string(until_s)};
    for (const std::string &one : set) more.insert(more.end(), {"--set", one});
    return runToReport(what, more);
  };
  const auto centre = [](const nlohmann::json &report, std::size_t body, std::size_t axis) {
    return report["bodies"][body]["centre_of_mass_m"][axis].get<double>();
  };
  const auto as = run(scene, {});
  REQUIRE(as["bodies"].size() == 2);

  // It is static, and the body pushed against it does not pass through.
  const auto standing = run(scene, {"body.scan.above.rigid=true", "body.scan.velocity=[0, 0, 0.1]"});
  for (std::size_t axis = 0; axis < 3; ++axis)
    CHECK(centre(standing, 1, axis) == Approx(axis == 0 ? 0.064 : axis == 1 ? 0.032 : 0.048).margin(1e-12));
  // It moves like the soft one, half a F/m t² less the resistance of the bulges, and keeps its shape.
  const double pushed = centre(as, 1, 0) - 0.064;
  const auto free = run(scene, {"body.scan.above.free=true", "body.scan.above.rigid=true"});
  CHECK(pushed > 5e-4);
  CHECK(centre(free, 1, 0) - 0.064 == Approx(pushed).epsilon(0.15));
  CHECK(free["bodies"][1]["energy_J"]["elastic"] == 0.0);
  CHECK(free["bodies"][0]["energy_J"]["elastic"] > 0.0);
  // Each separately.
  const std::vector<std::string> light{"world.gravity=[0, 0, 0]", "load.push.force=[0, 0, 0]"};
  const auto thrown = [&](std::string set, double until_s) {
    std::vector<std::string> all = light;
    all.push_back(std::move(set));
    return run(scene, all, until_s);
  };
  const auto above = thrown("body.scan.above.velocity=[0, 0.1, 0]", 0.01),
             rest = thrown("body.scan.rest.velocity=[0, 0.1, 0]", 1e-4);
  CHECK(centre(above, 1, 1) - 0.032 == Approx(1e-3).epsilon(0.05));
  CHECK(std::abs(centre(above, 0, 1) - 0.032) < 5e-5);
  const double mass = rest["bodies"][0]["mass_kg"].get<double>();
  CHECK(rest["bodies"][0]["momentum"][1].get<double>() > 0.7 * 0.1 * mass);  // it is held at the bottom
  CHECK(std::abs(rest["bodies"][1]["momentum"][1].get<double>()) < 0.05 * 0.1 * mass);

  // A setting of the rest applies to nothing else.
  const auto set = run(scene, {"body.scan.rest.material.density=500", "body.scan.rest.sampling.spacing=0.016"}, 1e-4);
  CHECK(set["bodies"][0]["mass_kg"].get<double>() == Approx(0.5 * as["bodies"][0]["mass_kg"].get<double>()));
  CHECK(set["bodies"][0]["phyxels"].get<int>() < as["bodies"][0]["phyxels"].get<int>() / 4);
  CHECK(set["bodies"][1]["mass_kg"] == as["bodies"][1]["mass_kg"]);
  CHECK(set["bodies"][1]["phyxels"] == as["bodies"][1]["phyxels"]);
  const std::string fix = "[[fix]]\nbody = \"scan\"\n", pair = "[[contact.pair]]\nfriction = 0.3\nbodies = [\"scan";
  REQUIRE(text.find(fix) != std::string::npos);
  std::string all = text, alone = text;
  all += pair + "\", \"scan.above\"]\n";
  alone.replace(alone.find(fix), fix.size(), "[[fix]]\nbody = \"scan.rest\"\n");
  alone += pair + ".rest\", \"scan.above\"]\n";
  const auto whole = run(writeFile(folder / "all.toml", all), {}),
             other = run(writeFile(folder / "rest.toml", alone), {});
  CHECK(whole["state_hash"] == other["state_hash"]);
  CHECK(whole["state_hash"] != as["state_hash"]);
  REQUIRE(other["contacts"].size() == 1);
  CHECK(other["contacts"][0]["bodies"] == nlohmann::json{"scan", "scan.above"});
  // A fix of both acts on the part that is not static already.
  std::string both = text;
  both.replace(both.find("0.004] } }"), 10, "0.004] } }\n[[fix]]\nbody = \"scan\"\nregion = { everywhere = true }");
  const auto held = run(writeFile(folder / "both.toml", both), {"body.scan.above.rigid=true"}, 1e-3);
  REQUIRE(held["reactions"].size() == 2);
  CHECK(held["reactions"][1]["body"] == "scan");

  const auto refusal = [&](const std::vector<std::string> &assignments) {
    std::vector<std::string> arguments{"run", scene.string(), "--steps", "1"};
    for (const std::string &one : assignments) arguments.insert(arguments.end(), {"--set", one});
    const auto refused = runC3de(arguments);
    CHECK(refused.exitCode == 2);
    return refused.errorOutput;
  };
  CHECK_THAT(refusal({"body.scan.above.free=true"}),
             Contains("--set body.scan.above.free: 'scan.above' deforms, and moves freely where nothing holds it; "
                      "accepted: free = true of what is rigid, --set body.scan.above.rigid=true"));
  CHECK_THAT(refusal({"body.scan.rest.velocity=[0, 0, 1]", "body.scan.rest.rigid=true"}),
             Contains("'scan.rest' has a velocity and is rigid, which stands in its place; accepted: one of them, or "
                      "--set body.scan.rest.free=true"));
  CHECK_THAT(refusal({"body.scan.rigid=true"}), Contains("of pieces: PIECE.rigid, pieces: scan.above, scan.rest"));
  CHECK_THAT(refusal({"body.scan.rst.rigid=true"}),
             Contains("there is no piece 'scan.rst'; did you mean 'scan.rest'? accepted: scan.above, scan.rest"));
}

TEST_CASE("Rigid tissue of a piece that is rigid does what all of it does", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-bone");
  imaging::LabelMap map;
  map.geometry.size = {18, 18, 26};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 25; ++k)
    for (std::size_t j = 1; j < 17; ++j)
      for (std::size_t i = 1; i < 17; ++i) map.voxels[i + 18 * (j + 18 * k)] = k < 9 ? 3 : k < 17 ? 1 : 2;
  map.labels = {{1, "below", {0.6F, 0.2F, 0.1F}}, {2, "above", {0.2F, 0.6F, 0.1F}}, {3, "bone", {0.9F, 0.9F, 0.6F}}};
  REQUIRE(imaging::writeLabelMap(folder / "blocks.nrrd", map));
  const auto scene =
      writeFile(folder / "scene.toml",
                "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"scan\"\nvolume = \"blocks.nrrd\"\n"
                "slides = [\"above\"]\nsampling = { spacing = 0.008 }\n"
                "tissues = [ { label = \"below\", material = \"liver\" }, { label = \"above\", material = \"liver\" }, "
                "{ label = \"bone\", rigid = true } ]\n");
  const auto as = runToReport(scene, {"--until", "0.01"});
  REQUIRE(as["reactions"].size() == 1);
  // Cells of 8 mm are of bone or not: 9 x 9 corners in 5 layers over 32 mm, of which the uppermost is of both.
  CHECK(as["bodies"][0]["phyxels"] == 9 * 9 * 9);
  CHECK(as["bodies"][0]["held_phyxels"] == 9 * 9 * 4);
  CHECK(as["bodies"][1]["held_phyxels"] == 0);
  CHECK_THAT(as["notices"].dump(), Contains("body 'scan': 324 of its 729 phyxels are held, in rigid tissue") &&
                                       !Contains("body 'scan.above': 0 of"));
  const auto standing = runToReport(scene, {"--until", "0.01", "--set", "body.scan.rest.rigid=true"});
  CHECK(standing["reactions"].empty());
  const double dropped =
      as["bodies"][0]["centre_of_mass_m"][2].get<double>() - standing["bodies"][0]["centre_of_mass_m"][2].get<double>();
  CHECK(dropped < 0.0);
  const auto falling = runToReport(
      scene, {"--until", "0.01", "--set", "body.scan.rest.rigid=true", "--set", "body.scan.rest.free=true"});
  const double t = falling["time_s"].get<double>();
  CHECK(standing["bodies"][0]["centre_of_mass_m"][2].get<double>() -
            falling["bodies"][0]["centre_of_mass_m"][2].get<double>() ==
        Approx(0.5 * 9.81 * t * t).epsilon(0.1));
}

TEST_CASE("Pieces in balance with the gravity of the scan stay where they are", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-rest");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene =
      writeFile(folder / "scene.toml",
                blocksScene("slides = [\"above\"]\n", "gravity = [0, 0, -9.81]\nscan_gravity = [0, 0, -9.81]\n"));
  const auto report = runToReport(scene, {"--until", "0.5", "--set", "load.push.force=[0, 0, 0]"});
  REQUIRE(report["bodies"].size() == 2);
  // Nothing presses, so nothing moves.
  for (const auto &body : report["bodies"]) {
    REQUIRE(body["tissues"].size() == 1);
    CHECK(body["tissues"][0]["displacement_m"]["max"].get<double>() < 1e-6);
  }
  for (const auto &event : report["events"]) CHECK(event["kind"] != "warning");
}
