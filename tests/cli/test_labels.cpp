// SPDX-License-Identifier: Apache-2.0
// Labels that deform with the tissue, labels that contradict their image, and the scene that a saved state belongs to.
#include <algorithm>
#include <map>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::Contains;
using Json = nlohmann::json;

namespace {

/// A block of two labels, 24 x 20 x 16 mm, in air: 40 voxels of 2 mm along each axis.
imaging::LabelMap twoHalves() {
  imaging::LabelMap map;
  map.geometry = {{40, 40, 40}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
  map.voxels.assign(64000, 0);
  for (std::size_t k = 16; k < 24; ++k)
    for (std::size_t j = 15; j < 25; ++j)
      for (std::size_t i = 10; i < 22; ++i) map.voxels[i + 40 * (j + 40 * k)] = i < 16 ? 1 : 200;
  map.labels = {{1, "spleen", {0.6F, 0.2F, 0.1F}}, {200, "liver", {0.3F, 0.1F, 0.4F}}};
  return map;
}

std::map<int, std::size_t> countsOf(const imaging::LabelMap &map) {
  std::map<int, std::size_t> counts;
  for (const std::uint16_t voxel : map.voxels) ++counts[voxel];
  return counts;
}

const std::string kFlying =
    "format = 1\n[world]\ngravity = [0, 0, 0]\n[image]\nfile = \"halves.nrrd\"\n[[body]]\n"
    "name = \"block\"\nvolume = \"halves.nrrd\"\ntissues = \"known\"\n"
    "sampling = { count = 200 }\nvelocity = [0.1, 0, 0]\n";

}  // namespace

TEST_CASE("Labels of a body that flies by whole voxels are exported with the same counts", "[labels]") {
  const auto folder = freshFolder("labels_fly");
  const imaging::LabelMap before = twoHalves();
  REQUIRE(imaging::writeLabelMap(folder / "halves.nrrd", before));
  const auto file = writeFile(folder / "scene.toml", kFlying);
  const auto labels = folder / "labels.nrrd", image = folder / "image.nrrd";
  // 4 mm, two voxels.
  const auto ran = runC3de(
      {"run", file.string(), "--until", "0.04", "--export-labels", labels.string(), "--export-image", image.string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  CHECK_THAT(ran.errorOutput, Contains("2 labels, each voxel with the label nearest to where its tissue was") &&
                                  Contains("image.nrrd: a label map"));
  const auto moved = imaging::readLabelMap(labels);
  REQUIRE(moved);
  CHECK(imaging::sameGrid(moved->labels.geometry, before.geometry));
  CHECK(countsOf(moved->labels) == countsOf(before));
  CHECK(moved->labels.voxels != before.voxels);
  CHECK(moved->labels.voxels[13 + 40 * (20 + 40 * 20)] == before.voxels[11 + 40 * (20 + 40 * 20)]);
  REQUIRE(moved->labels.labels.size() == 2);
  CHECK(moved->labels.labels[1].name == "liver");
  // An image that is a label map has no values between its labels.
  const auto warped = imaging::readLabelMap(image);
  REQUIRE(warped);
  CHECK(countsOf(warped->labels) == countsOf(before));

  const auto noLabels = writeFile(folder / "mesh.toml",
                                  "format = 1\n[image]\nfile = \"halves.nrrd\"\n[[body]]\nmesh = "
                                  "\"box.obj\"\nmesh_unit = \"m\"\n");
  (void)writeBoxScene(folder);
  const auto none = runC3de({"run", noLabels.string(), "--steps", "1", "--export-labels", labels.string()});
  CHECK(none.exitCode == 2);
  CHECK_THAT(none.errorOutput, Contains("--export-labels needs a label map"));
  const auto own =
      runC3de({"run", file.string(), "--steps", "1", "--export-labels", (folder / "halves.nrrd").string()});
  CHECK(own.exitCode == 2);
  CHECK_THAT(own.errorOutput, Contains("is read by this run"));
}

TEST_CASE("The deformed labels of an abdomen have the volumes that their tissue has", "[labels][slow]") {
  C3DE_DATA_OR_SKIP(scene, "found/labels/labels_warp.toml");
  const auto folder = freshFolder("labels_warp");
  const auto image = folder / "image.nii.gz", labels = folder / "labels.nii.gz", report = folder / "report.json";
  const auto ran = runC3de({"run", scene.string(), "--set", "body.abdomen.sampling.count=1500", "--export-image",
                            image.string(), "--export-labels", labels.string(), "--report", report.string(), "-q"});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto warped = imaging::readLabelMap(image), exported = imaging::readLabelMap(labels);
  REQUIRE((warped && exported));
  CHECK(warped->labels.voxels == exported->labels.voxels);
  const auto counts = countsOf(exported->labels);
  const double voxel_m3 = 1e-9 * exported->labels.geometry.voxelVolume();
  const Json json = readJson(report);
  std::size_t compared = 0;
  for (const Json &tissue : json.at("bodies").at(0).at("tissues")) {
    const std::string name = tissue.at("name");
    if (name != "spleen" && name != "liver" && name != "kidney" && name != "stomach") continue;
    double now_m3 = 0.0;
    for (const auto &label : exported->labels.labels)
      for (const auto &of : tissue.at("labels"))
        if (of == label.name) now_m3 += voxel_m3 * static_cast<double>(counts.at(label.value));
    INFO(name << " " << now_m3 << " " << tissue.at("volume_m3").dump());
    ++compared;
    // Voxels of 3 mm at a surface; the spleen has 9668.
    CHECK(now_m3 == Approx(tissue.at("volume_m3").at("end").get<double>()).epsilon(0.02));
  }
  CHECK(compared == 4);
}

TEST_CASE("Rigid labels that are no bone and notices of a map are in info, summary and report", "[labels]") {
  const auto folder = freshFolder("labels_soft");
  imaging::LabelMap map = twoHalves();
  map.labels[1].name = "vertebrae_L1";
  REQUIRE(imaging::writeLabelMap(folder / "labels.nrrd", map));
  imaging::Volume image;
  image.geometry = map.geometry;
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < map.voxels.size(); ++v) {
    const std::size_t i = v % 40, j = v / 40 % 40, k = v / 1600;
    const bool isBody = i > 5 && i < 27 && j > 9 && j < 31 && k > 9 && k < 31;
    values.push_back(static_cast<std::int16_t>(map.voxels[v] != 0 ? 45 : isBody ? -90 : -1000));
  }
  image.voxels = std::move(values);
  REQUIRE(imaging::writeVolume(folder / "ct.nrrd", image));
  const auto file = writeFile(folder / "scene.toml",
                              "format = 1\n[[body]]\nname = \"trunk\"\nvolume = \"labels.nrrd\"\ntissues = \"known\"\n"
                              "background = { material = \"fat\", image = \"ct.nrrd\", from = -150, to = 250 }\n"
                              "sampling = { count = 200 }\n");
  const std::string expected =
      "labels.nrrd: body 'trunk': 1 of 1 rigid labels has grey values below those of bone (median in brackets, of bone "
      "at least 100 HU): vertebrae_L1 (45 HU); accepted: check that numbers and names";
  const auto info = runC3de({"info", file.string(), "--quick", "--json"});
  INFO(info.errorOutput);
  REQUIRE(info.exitCode == 0);
  REQUIRE(Json::parse(info.output).at("notices").size() == 1);
  CHECK_THAT(Json::parse(info.output).at("notices").at(0).get<std::string>(), Contains(expected));
  const auto report = folder / "report.json";
  const auto ran = runC3de({"run", file.string(), "--steps", "1", "--report", report.string()});
  REQUIRE(ran.exitCode == 0);
  CHECK_THAT(ran.output, Contains("note: " + expected));
  const auto events = readJson(report).at("events");
  CHECK(std::count_if(events.begin(), events.end(), [&](const Json &event) {
          return event.at("kind") == "input" && event.at("text").get<std::string>().find(expected) == 0;
        }) == 1);
}

TEST_CASE("A label map that covers a part of its image is reported by info and run, before the body is made",
          "[labels]") {
  C3DE_DATA_OR_SKIP(map, "volume/totalseg/example_seg.nii.gz");
  const auto ct = map.parent_path() / "example_ct.nii.gz";
  const auto folder = freshFolder("labels_part");
  const auto file =
      writeFile(folder / "scene.toml", "format = 1\n[[body]]\nname = \"trunk\"\nvolume = '" + map.string() +
                                           "'\ntissues = \"known\"\nbackground = { material = \"fat\", image = '" +
                                           ct.string() + "', from = -150, to = 250 }\nsampling = { count = 200 }\n");
  const auto info = runC3de({"info", file.string(), "--quick"});
  INFO(info.errorOutput);
  CHECK(info.exitCode == 0);
  CHECK_THAT(info.output, Contains("The label map covers 2") && Contains("% of the image: along z"));
  const Json report = runToReport(file, {"--steps", "1"});
  const auto &events = report.at("events");
  CHECK(std::any_of(events.begin(), events.end(), [](const Json &event) {
    return event.at("kind") == "input" && event.at("text").get<std::string>().find("covers 2") != std::string::npos;
  }));
  const auto ran = runC3de({"run", file.string(), "--steps", "1"});
  CHECK_THAT(ran.output, Contains("note: ") && Contains("The label map covers 2"));
}

TEST_CASE("A state of another scene is refused with the fields that differ, and step budgets do not count",
          "[labels][saved_state]") {
  const auto folder = freshFolder("state_fields");
  const auto file = writeBoxScene(folder);
  const auto state = (folder / "state.bin").string();
  (void)runToReport(file, {"--steps", "3", "--save-state", state});
  const auto withSet = [&](const std::vector<std::string> &sets) {
    std::vector<std::string> arguments{"run", file.string(), "--steps", "5", "--from-state", state, "-q"};
    for (const std::string &one : sets) arguments.insert(arguments.end(), {"--set", one});
    return runC3de(arguments);
  };
  CHECK(withSet({}).exitCode == 0);
  // The time limit of a step is not physics, nor is a value set to its default.
  const auto budget = withSet({"solver.step_budget=5"});
  INFO(budget.errorOutput);
  CHECK(budget.exitCode == 0);
  CHECK(withSet({"solver.dt=\"auto\""}).exitCode == 0);
  for (const auto &[set, expected] : std::initializer_list<std::pair<const char *, std::vector<const char *>>>{
           {"world.gravity=[0,0,-3]", {"world.gravity is 0 0 -3, in the state 0 -9.81 0"}},
           {"body.box.material.youngs_modulus=7000", {"body 'box': material.youngs_modulus is 7000, in the state"}},
           {"body.box.sampling.spacing=0.05",
            {"body 'box': number of phyxels is", "sampling.spacing is 0.05, in the state 0.06"}},
           {"contact.self=false", {"contact.self is false, in the state true"}}}) {
    CAPTURE(set);
    const auto refused = withSet({set});
    CHECK(refused.exitCode == 3);
    CHECK_THAT(refused.errorOutput, Contains("belongs to another scene: "));
    for (const char *text : expected) CHECK_THAT(refused.errorOutput, Contains(text));
  }
  const auto two = writeBoxScene(folder,
                                 "[[obstacle]]\nname = \"table\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n"
                                 "position = [0, -3, 0]\n");
  const auto refused = runC3de({"run", two.string(), "--steps", "5", "--from-state", state, "-q"});
  CHECK_THAT(refused.errorOutput, Contains("obstacle 'table' is not in the state"));
}
