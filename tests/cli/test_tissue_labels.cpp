// SPDX-License-Identifier: Apache-2.0
// Tissues by the names of their labels, and where labels are after a run.
#include <algorithm>
#include <utility>

#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::Contains;

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
