// SPDX-License-Identifier: Apache-2.0
// Bodies from label maps and images: from the file to the first step, without a mesh.
#include <algorithm>
#include <array>
#include <chrono>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
#include "program.h"

using namespace c3de;

namespace {

// Two balls with names, on an oblique left-handed grid of uneven voxels.
imaging::LabelMap twoBalls() {
  imaging::LabelMap map;
  map.geometry.size = {60, 50, 44};
  map.geometry.indexToWorld = {-1.2, 0.3, 0.0, 0, 0.35, 1.4, 0.0, 0, 0.0, 0.1, 1.6, 0, 40.0, -30.0, 500.0, 1};
  map.voxels.assign(map.geometry.voxelCount(), 0);
  const Vec3 centres[2] = {map.geometry.worldAt({16, 24, 20}), map.geometry.worldAt({44, 26, 22})};
  const double radii[2] = {16.0, 11.0};
  for (std::size_t k = 0; k < 44; ++k)
    for (std::size_t j = 0; j < 50; ++j)
      for (std::size_t i = 0; i < 60; ++i)
        for (std::uint16_t ball = 0; ball < 2; ++ball) {
          const Vec3 x = map.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          if (norm(x - centres[ball]) < radii[ball])
            map.voxels[i + 60 * (j + 50 * k)] = static_cast<std::uint16_t>(ball + 1);
        }
  map.labels = {{1, "liver", {0.6F, 0.2F, 0.1F}}, {2, "spleen", {0.3F, 0.1F, 0.4F}}};
  return map;
}

std::filesystem::path writeBalls(const std::filesystem::path &folder) {
  const auto file = folder / "organs.nrrd";
  REQUIRE(imaging::writeLabelMap(file, twoBalls()));
  return file;
}

double millilitres(const imaging::LabelMap &map, std::uint16_t label) {
  return static_cast<double>(std::count(map.voxels.begin(), map.voxels.end(), label)) * map.geometry.voxelVolume() /
         1000.0;
}

const char *const kBody = "format = 1\n[[body]]\nvolume = \"organs.nrrd\"\nsampling = { count = 300 }\n";

}  // namespace

TEST_CASE("Labels become bodies with the volume of their voxels, by number and by name") {
  const auto folder = freshFolder("labels");
  (void)writeBalls(folder);
  const auto report = folder / "report.json";
  const auto scene =
      writeFile(folder / "scene.toml", std::string(kBody) +
                                           "name = \"big\"\nlabel = 1\n[[body]]\nvolume = "
                                           "\"organs.nrrd\"\nsampling = { count = 300 }\nlabel = \"spleen\"\n");
  const auto ran = runC3de({"run", scene.string(), "--steps", "2", "--report", report.string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto json = nlohmann::json::parse(readFile(report));
  const imaging::LabelMap map = twoBalls();
  REQUIRE(json["bodies"].size() == 2);
  for (std::size_t b = 0; b < 2; ++b) {
    const auto &body = json["bodies"][b];
    CHECK(body["name"] == (b == 0 ? "big" : "spleen"));
    // The fill is scaled to its voxels; 1e-6 is the rounding of the fill's floats.
    CHECK(body["volume_m3"].get<double>() ==
          Approx(1e-6 * millilitres(map, static_cast<std::uint16_t>(b + 1))).epsilon(1e-6));
    CHECK(body["mesh_volume_m3"].get<double>() == Approx(body["volume_m3"].get<double>()).epsilon(0.01));
    // Position of its voxels: LPS, in metres.
    const Vec3 centre = map.geometry.worldAt(b == 0 ? Vec3{16, 24, 20} : Vec3{44, 26, 22});
    for (std::size_t a = 0; a < 3; ++a)
      CHECK(body["centre_of_mass_m"][a].get<double>() == Approx(1e-3 * centre[a]).margin(2e-4));
  }
}

TEST_CASE("A simulator is handed the voxels of the label in metres and its colour, and none for a mesh") {
  const auto folder = freshFolder("fill");
  (void)writeBalls(folder);
  const auto report = folder / "report.json";
  const auto scene = writeFile(folder / "scene.toml",
                               "format = 1\n[[body]]\nvolume = \"organs.nrrd\"\nname = \"ball\"\nlabel = 2\n[[body]]\n"
                               "name = \"box\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n");
  (void)writeBoxScene(folder);
  const auto ran = runC3de(
      {"run", "--no-plugins", "--plugin", C3DE_RECORDER, scene.string(), "--steps", "1", "--report", report.string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto json = nlohmann::json::parse(readFile(report));
  REQUIRE(json["bodies"].size() == 2);
  CHECK(json["bodies"][1]["fill"].is_null());
  // The label is (0.3, 0.1, 0.4) of light; as screens encode it (IEC 61966-2-1):
  const auto &colour = json["bodies"][0]["colour"];
  REQUIRE(colour.is_array());
  const std::array<double, 3> encoded{0.584, 0.349, 0.665};
  for (std::size_t c = 0; c < 3; ++c) CHECK_THAT(colour[c].get<double>(), WithinAbs(encoded[c], 2e-3));
  CHECK(json["bodies"][1]["colour"].is_null());
  const auto &fill = json["bodies"][0]["fill"];
  REQUIRE(fill.is_object());
  const auto vector = [&](const char *key) {
    return Vec3{fill[key][0].get<double>(), fill[key][1].get<double>(), fill[key][2].get<double>()};
  };
  const Vec3 i = vector("step_i_m"), j = vector("step_j_m"), k = vector("step_k_m");
  // Sums of floats of 0 … 1.
  CHECK(fill["sum"].get<double>() * std::abs(dot(i, cross(j, k))) ==
        Approx(1e-6 * millilitres(twoBalls(), 2)).epsilon(1e-6));
  const imaging::LabelMap map = twoBalls();
  Vec3 middle{};
  double count = 0.0;
  for (std::size_t v = 0; v < map.voxels.size(); ++v)
    if (map.voxels[v] == 2) {
      middle = middle + map.geometry.worldAt({static_cast<double>(v % 60), static_cast<double>(v / 60 % 50),
                                              static_cast<double>(v / 3000)});
      count += 1.0;
    }
  for (std::size_t a = 0; a < 3; ++a)
    CHECK(fill["middle_m"][a].get<double>() == Approx(1e-3 * middle[a] / count).margin(1e-8));
}

TEST_CASE("A label that does not occur is refused with those that do") {
  const auto folder = freshFolder("no_label");
  (void)writeBalls(folder);
  for (const auto &[line, expected] :
       {std::pair{"label = 7\n", "no label 7"}, {"label = \"splen\"\n", "did you mean 'spleen'?"}}) {
    const auto refused =
        runC3de({"run", writeFile(folder / "scene.toml", std::string(kBody) + line).string(), "--steps", "1"});
    CHECK(refused.exitCode == 3);
    CHECK_THAT(refused.errorOutput, Contains("scene.toml:2: ") && Contains(expected) && Contains("1 liver, 2 spleen"));
  }
}

TEST_CASE("A threshold that leaves nothing and a simulator that cannot fill are refused") {
  const auto folder = freshFolder("nothing");
  (void)writeBalls(folder);
  const auto empty = writeFile(folder / "empty.toml", std::string(kBody) + "threshold = [5, 9]\n");
  const auto refused = runC3de({"run", empty.string(), "--steps", "1"});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("empty.toml:2: ") && Contains("nothing is left"));
  const auto good = writeFile(folder / "good.toml", std::string(kBody) + "label = 1\n");
  const auto old =
      runC3de({"run", "--no-plugins", "--plugin", C3DE_RECORDER_WITHOUT_FILLS, good.string(), "--steps", "1"});
  CHECK(old.exitCode != 0);
  CHECK_THAT(old.errorOutput, Contains("'volume' is not supported by this simulator"));
}

TEST_CASE("What of a label is in no body is told in ml, in the report, as an event and in the summary") {
  const auto folder = freshFolder("not_represented");
  imaging::LabelMap map = twoBalls();
  // A vessel of two voxels from the first ball on, and an island of one voxel.
  for (std::size_t i = 30; i < 42; ++i)
    for (std::size_t v : {i + 60 * (24 + 50 * 20), i + 60 * (25 + 50 * 20)})
      if (map.voxels[v] == 0) map.voxels[v] = 1;
  map.voxels[2 + 60 * (2 + 50 * 2)] = 1;
  REQUIRE(imaging::writeLabelMap(folder / "organs.nrrd", map));
  const auto report = folder / "report.json";
  const auto run = [&](const std::string &more) {
    const auto scene = writeFile(folder / "scene.toml", std::string(kBody) + "name = \"liver\"\nlabel = 1\n" + more);
    const auto ran = runC3de({"run", scene.string(), "--steps", "1", "--report", report.string()});
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    return std::pair(nlohmann::json::parse(readFile(report)), ran.output);
  };
  const auto [fine, fineSummary] = run("");
  CHECK(fine["bodies"][0]["represented_part"].get<double>() > 0.98);
  CHECK(fine["bodies"][0]["represented_part"].get<double>() <= 1.0);
  const auto [coarse, summary] = run("edge_length = 9\n");
  const auto &body = coarse["bodies"][0];
  const double missing = body["not_represented_ml"].get<double>();
  INFO(body.dump());
  CHECK(missing > 0.02);
  CHECK(body["represented_part"].get<double>() < 1.0 - 0.5 * missing / millilitres(map, 1));
  REQUIRE_FALSE(coarse["events"].empty());
  CHECK(coarse["events"][0]["kind"] == "not_represented");
  CHECK_THAT(coarse["events"][0]["text"].get<std::string>(),
             Contains("'liver'") && Contains("ml") && Contains("1 loose island"));
  CHECK_THAT(summary, Contains("belongs to no body"));
}

TEST_CASE("A scene with an image is drawn as four views, or as the one that was asked for", "[gpu]") {
  const auto folder = freshFolder("views");
  (void)writeBalls(folder);
  const auto scene =
      writeFile(folder / "scene.toml", std::string(kBody) + "label = 1\n[image]\nfile = \"organs.nrrd\"\n");
  bool isDrawn = true;
  const auto draw = [&](const std::string &name, std::vector<std::string> more) -> std::string {
    std::vector<std::string> arguments{"run",          scene.string(),           "--steps", "2",
                                       "--screenshot", (folder / name).string(), "--size",  "640x480"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto ran = runWithoutDisplay(arguments);
    INFO(ran.errorOutput);
    isDrawn = ran.exitCode != 6;
    if (!isDrawn) return {};
    REQUIRE(ran.exitCode == 0);
    return readFile(folder / name);
  };
  const std::string four = draw("four.png", {});
  if (!isDrawn) C3DE_SKIP("no OpenGL here");
  CHECK(four.size() > 5000);
  CHECK(draw("four_again.png", {"--view", "four-up"}) == four);
  std::vector<std::string> all{four};
  for (const std::string view : {"3d", "axial", "sagittal", "coronal"})
    all.push_back(draw(view + ".png", {"--view", view}));
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) CHECK(all[a] != all[b]);
}

TEST_CASE("The picture of slices shows the overlay that is asked for, and a name that is none costs no step", "[gpu]") {
  const auto folder = freshFolder("overlays");
  (void)writeBalls(folder);
  const auto scene = writeFile(folder / "scene.toml",
                               std::string(kBody) +
                                   "label = 1\n[image]\nfile = \"organs.nrrd\"\n\n[world]\ngravity = [0, 0, "
                                   "-9.81]\n[[fix]]\nregion = { box = { min = [-1, -1, 0.54], max = [1, 1, 1] } }\n")
                         .string();
  const auto draw = [&](const std::string &overlay, const std::string &view) {
    return runWithoutDisplay({"run", scene, "--until", "0.05", "--screenshot", (folder / (overlay + ".png")).string(),
                              "--size", "320x320", "--view", view, "--overlay", overlay});
  };
  const auto plain = draw("none", "coronal");
  if (plain.exitCode == 6) C3DE_SKIP("no OpenGL here: " + plain.errorOutput);
  REQUIRE(plain.exitCode == 0);
  std::vector<std::string> all{readFile(folder / "none.png")};
  for (const std::string overlay : {"displacement", "volume_change", "stress_vm"}) {
    const auto ran = draw(overlay, "coronal");
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    all.push_back(readFile(folder / (overlay + ".png")));
  }
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) CHECK(all[a] != all[b]);
  const auto misspelt = draw("stress", "coronal");
  CHECK(misspelt.exitCode == 2);
  CHECK_THAT(misspelt.errorOutput,
             Contains("--overlay stress: accepted: none, displacement, volume_change, stress_vm"));
  CHECK_FALSE(std::filesystem::exists(folder / "stress.png"));
  CHECK(draw("displacement", "3d").exitCode == 2);
  CHECK(runC3de({"run", scene, "--steps", "1", "--overlay", "none"}).exitCode == 2);
}

TEST_CASE("A view of slices is refused where there is no image, and a name that is none") {
  const auto folder = freshFolder("no_views");
  const auto scene = writeBoxScene(folder).string();
  const std::string picture = (folder / "a.png").string();
  const auto refused = runWithoutDisplay({"run", scene, "--steps", "1", "--screenshot", picture, "--view", "axial"});
  if (refused.exitCode == 6) C3DE_SKIP("no OpenGL here: " + refused.errorOutput);
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput,
             Contains("--view axial") && Contains("no [image]") && Contains("accepted: --view 3d"));
  CHECK_FALSE(std::filesystem::exists(picture));
  const auto misspelt = runWithoutDisplay({"run", scene, "--steps", "1", "--screenshot", picture, "--view", "top"});
  CHECK(misspelt.exitCode == 2);
  CHECK_THAT(misspelt.errorOutput, Contains("accepted: 3d, axial, sagittal, coronal, four-up"));
  CHECK(runC3de({"run", scene, "--steps", "1", "--view", "3d"}).exitCode == 2);
}

TEST_CASE("Liver, spleen and kidneys of a CT take their first step within ten seconds of its file", "[data]") {
  const std::filesystem::path labels =
      std::filesystem::path(testDataFolder()) / "volume/totalseg/example_seg_fast_force_split.nii.gz";
  if (!std::filesystem::exists(labels)) {
    WARN("skipped: " << labels << " is not there");
    return;
  }
  const auto folder = freshFolder("totalseg");
  std::string text = "format = 1\n";
  for (const int label : {5, 1, 2, 3})
    text += "[[body]]\nname = \"label " + std::to_string(label) + "\"\nvolume = \"" + labels.generic_string() +
            "\"\nlabel = " + std::to_string(label) + "\nsampling = { count = 1000 }\n";
  const auto report = folder / "report.json";
  const auto begin = std::chrono::steady_clock::now();
  const auto ran =
      runC3de({"run", writeFile(folder / "scene.toml", text).string(), "--steps", "1", "--report", report.string()});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  // Voxels of 3 mm, counted by hand: 41692, 9668, 7134, 5090.
  const double expected_ml[] = {1125.684, 261.036, 192.618, 137.430};
  const auto json = nlohmann::json::parse(readFile(report));
  for (std::size_t b = 0; b < 4; ++b)
    CHECK(1e6 * json["bodies"][b]["volume_m3"].get<double>() == Approx(expected_ml[b]).epsilon(1e-4));
  const auto &stages = json["preparation"];
  WARN("four organs of about 1 000 phyxels, from file to first step: " << stages.dump());
  CHECK(took.count() < 10.0);
  double sum = 0.0;
  for (const char *stage : {"reading_s", "masks_s", "surfaces_s", "fills_s", "bodies_s", "first_step_s"}) {
    CHECK(stages[stage] > 0.0);
    sum += stages[stage].get<double>();
  }
  // The remaining time is used by plugins, the scene file and the program itself.
  CHECK(stages["to_first_step_s"] > sum);
  CHECK(stages["to_first_step_s"] < took.count());
}

TEST_CASE("An image is exported as the tissue lies at the end, with the way it has come") {
  const auto folder = freshFolder("exported_image");
  (void)writeBalls(folder);
  // A free ball flies two voxels, 3.2 mm, towards -z; the other one stays in place, as an image only.
  const auto scene = writeFile(folder / "scene.toml",
                               "format = 1\n[image]\nfile = \"organs.nrrd\"\nrim = 4\n[world]\ngravity = [0, 0, 0]\n" +
                                   std::string(kBody).substr(11) + "label = 2\nvelocity = [0, 0, -0.1]\n");
  const auto image = folder / "warped.nii.gz", field = folder / "u.nrrd";
  const auto ran = runC3de({"run", scene.string(), "--until", "0.032", "--export-image", image.string(),
                            "--export-displacement", field.string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto warped = imaging::readVolume(image);
  REQUIRE(warped);
  const imaging::LabelMap before = twoBalls();
  CHECK(imaging::sameGrid(warped->volume.geometry, before.geometry, 1e-3));
  const auto centreOf = [&](const auto &valueAt, double label) {
    Vec3 sum{};
    double count = 0.0;
    for (std::size_t k = 0; k < 44; ++k)
      for (std::size_t j = 0; j < 50; ++j)
        for (std::size_t i = 0; i < 60; ++i)
          if (valueAt(i, j, k) == label) {
            sum =
                sum + before.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
            count += 1.0;
          }
    return (1.0 / count) * sum;
  };
  const auto was = [&](std::size_t i, std::size_t j, std::size_t k) {
    return static_cast<double>(before.voxels[i + 60 * (j + 50 * k)]);
  };
  const auto is = [&](std::size_t i, std::size_t j, std::size_t k) { return warped->volume.value(i, j, k); };
  const Vec3 flown = centreOf(is, 2.0) - centreOf(was, 2.0), stayed = centreOf(is, 1.0) - centreOf(was, 1.0);
  // Labels move by whole voxels, of 1.6 mm; a rim of 4 mm is compressed and stretched: a quarter of a voxel.
  CHECK_THAT(flown[2], WithinAbs(-3.2, 0.4));
  CHECK_THAT(flown[0], WithinAbs(0.0, 0.4));
  CHECK_THAT(stayed[2], WithinAbs(0.0, 0.4));
  CHECK(std::filesystem::file_size(field) > 1000);

  const auto none = runC3de({"run", writeBoxScene(folder).string(), "--steps", "1", "--export-image", image.string()});
  CHECK(none.exitCode == 2);
  CHECK_THAT(none.errorOutput, Contains("[image]"));
  const auto unknown = runC3de({"run", scene.string(), "--steps", "1", "--export-image", (folder / "w.jpg").string()});
  CHECK(unknown.exitCode == 2);
  CHECK_THAT(unknown.errorOutput, Contains("accepted: .nrrd"));
}

TEST_CASE("No output takes the place of a file that is read, nor of another output") {
  const auto folder = freshFolder("outputs_apart");
  const auto organs = writeBalls(folder);
  const auto before = readFile(organs);
  const auto scene = writeFile(folder / "scene.toml", "format = 1\n[image]\nfile = \"organs.nrrd\"\n" +
                                                          std::string(kBody).substr(11) + "label = 2\n");
  std::filesystem::create_directories(folder / "sub");
  const auto roundabout = folder / "sub" / ".." / "organs.nrrd";
  for (const auto &file : {organs, roundabout}) {
    const auto refused = runC3de({"run", scene.string(), "--steps", "1", "--export-image", file.string()});
    CHECK(refused.exitCode == 2);
    CHECK_THAT(refused.errorOutput, Contains("is read by this run"));
    CHECK(readFile(organs) == before);
  }
  const auto own = runC3de({"run", scene.string(), "--steps", "1", "--report", scene.string()});
  CHECK(own.exitCode == 2);
  const auto both = folder / "both.nrrd";
  const auto twice = runC3de(
      {"run", scene.string(), "--steps", "1", "--export-image", both.string(), "--export-displacement", both.string()});
  CHECK(twice.exitCode == 2);
  CHECK_THAT(twice.errorOutput, Contains("two outputs"));
  CHECK_FALSE(std::filesystem::exists(both));
}

TEST_CASE("An image that cannot be read is refused before anything is simulated, and by info") {
  const auto folder = freshFolder("unread_image");
  const auto organs = readFile(writeBalls(folder));
  (void)writeFile(folder / "cut.nrrd", organs.substr(0, organs.size() / 2));
  const auto scene = writeFile(folder / "scene.toml", "format = 1\n[image]\nfile = \"cut.nrrd\"\n" +
                                                          std::string(kBody).substr(11) + "label = 2\n");
  const auto report = folder / "report.json";
  const auto ran = runC3de({"run", scene.string(), "--steps", "1", "--report", report.string(), "--export-image",
                            (folder / "w.nrrd").string()});
  CHECK(ran.exitCode == 3);
  CHECK_THAT(ran.errorOutput, Contains("scene.toml:2") && Contains("cut.nrrd"));
  CHECK_FALSE(std::filesystem::exists(report));
  const auto info = runC3de({"info", scene.string()});
  CHECK(info.exitCode == 3);
  CHECK_THAT(info.errorOutput, Contains("cut.nrrd"));
  const auto good =
      writeFile(folder / "good.toml", "format = 1\n[image]\nfile = \"organs.nrrd\"\nlabels = \"organs.nrrd\"\n" +
                                          std::string(kBody).substr(11) + "label = 2.0\n");
  const auto told = runC3de({"info", good.string()});
  CHECK(told.exitCode == 0);
  CHECK_THAT(told.output, Contains("60 x 50 x 44 voxels") && Contains("labels "));
}

TEST_CASE("A value of a scene that the voxels do not allow is input, not usage") {
  const auto folder = freshFolder("edge_too_short");
  (void)writeBalls(folder);
  const auto scene = writeFile(folder / "scene.toml", std::string(kBody) + "label = 2\nedge_length = 0.001\n");
  const auto ran = runC3de({"run", scene.string(), "--steps", "1"});
  CHECK(ran.exitCode == 3);
  CHECK_THAT(ran.errorOutput, Contains("edge length of 0.001 mm"));
  const auto image = runC3de({"run", (folder / "organs.nrrd").string(), "--steps", "1"});
  CHECK(image.exitCode == 3);
  CHECK_THAT(image.errorOutput, Contains("is an image") && Contains("volume"));
}

TEST_CASE("An exported image follows a body far away, also while another one has left the image altogether") {
  const auto folder = freshFolder("exported_far");
  (void)writeBalls(folder);
  // 20 mm towards -z, twice the ball's radius; the other ball is 10 m away by then.
  const auto scene =
      writeFile(folder / "scene.toml",
                "format = 1\n[image]\nfile = \"organs.nrrd\"\nrim = 4\n[world]\ngravity = [0, 0, 0]\n"
                "[contact]\nenabled = false\n" +
                    std::string(kBody).substr(11) + "name = \"near\"\nlabel = 2\nvelocity = [0, 0, -0.1]\n" +
                    std::string(kBody).substr(11) + "name = \"far\"\nlabel = 1\nvelocity = [-50, 0, 0]\n");
  const auto image = folder / "warped.nrrd", field = folder / "u.nrrd";
  const auto ran = runC3de({"run", scene.string(), "--until", "0.2", "--export-image", image.string(),
                            "--export-displacement", field.string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto warped = imaging::readVolume(image);
  REQUIRE(warped);
  const imaging::LabelMap before = twoBalls();
  const Vec3 there = before.geometry.worldAt({44, 26, 22}) + Vec3{0, 0, -20};
  std::size_t inside = 0, right = 0, beside = 0, empty = 0;
  for (std::size_t k = 0; k < 44; ++k)
    for (std::size_t j = 0; j < 50; ++j)
      for (std::size_t i = 0; i < 60; ++i) {
        const Vec3 x =
            before.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const double r = norm(x - there), value = warped->volume.value(i, j, k);
        // The border of a ball is as coarse as its voxels, of 1.6 mm.
        if (r < 9.0) ++inside, right += value == 2.0 ? 1 : 0;
        if (r > 13.0 && x[2] < there[2])
          ++beside, empty += value == static_cast<double>(before.voxels[i + 60 * (j + 50 * k)]) ? 1 : 0;
      }
  CHECK(inside > 900);
  CHECK(right == inside);
  // Within the rim the image is stretched: it contains no information.
  CHECK(empty == beside);

  // The region that the balls have left is marked in addition to the displacement, which stays finite.
  const auto marks = imaging::readVolume(folder / "u-vacated.nrrd");
  REQUIRE(marks);
  CHECK(imaging::sameGrid(marks->volume.geometry, before.geometry, 1e-3));
  std::size_t marked = 0, left = 0, leftAndMarked = 0, balls = 0;
  for (std::size_t v = 0; v < before.voxels.size(); ++v) {
    const std::size_t i = v % 60, j = v / 60 % 50, k = v / 3000;
    const Vec3 x = before.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
    const bool isMarked = marks->volume.value(i, j, k) == 1.0;
    marked += isMarked ? 1 : 0;
    balls += before.voxels[v] != 0 ? 1 : 0;
    // Inside the former position of a ball, and not where the other one is now.
    if (before.voxels[v] == 0 || norm(x - there) < 14.0 || warped->volume.value(i, j, k) != 0.0) continue;
    ++left;
    leftAndMarked += isMarked ? 1 : 0;
  }
  CHECK(left > 900);
  // Single voxels are empty because their source is outside of the image.
  CHECK(leftAndMarked <= left);
  CHECK(static_cast<double>(leftAndMarked) > 0.999 * static_cast<double>(left));
  // Bodies are as large as their skins, which are up to half a voxel off the border.
  CHECK(static_cast<double>(marked) < 1.05 * static_cast<double>(balls));
  CHECK_THAT(ran.errorOutput + ran.output, Contains("u-vacated.nrrd: " + std::to_string(marked) + " voxels") &&
                                               Contains("ml) are vacated by a body"));
  const auto u = readFile(field);
  CHECK(u.find("nan") == std::string::npos);
}

namespace {

// Two cubes in a volume of 20 mm, of 8 mm and of 12 mm: one behind the other in time, or side by side in each voxel.
std::string cubesNrrd(bool areLayers, const std::string &keys) {
  std::string voxels;
  const auto isIn = [](int v, int half) {
    for (const int index : {v % 20, v / 20 % 20, v / 400})
      if (index < 10 - half || index >= 10 + half) return false;
    return true;
  };
  const auto voxel = [&](int v, int n) { return isIn(v, n == 0 ? 4 : 6) ? '\1' : '\0'; };
  for (int outer = 0; outer < (areLayers ? 8000 : 2); ++outer)
    for (int inner = 0; inner < (areLayers ? 2 : 8000); ++inner)
      voxels += areLayers ? voxel(outer, inner) : voxel(inner, outer);
  return std::string("NRRD0004\ntype: uchar\ndimension: 4\nspace: LPS\nencoding: raw\nspace origin: (0,0,0)\n") +
         (areLayers
              ? "sizes: 2 20 20 20\nkinds: list domain domain domain\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
              : "sizes: 20 20 20 2\nkinds: domain domain domain time\nspace directions: (1,0,0) (0,1,0) (0,0,1) "
                "none\n") +
         keys + "\n" + voxels;
}

}  // namespace

TEST_CASE("A time point is chosen by a scene and by info, and one that is not there is refused") {
  const auto folder = freshFolder("time_points");
  const auto file = writeFile(folder / "moving.nrrd", cubesNrrd(false, ""));
  const auto info = [&](const std::string &time) { return runC3de({"info", file.string(), "--json", "--time", time}); };
  const auto later = info("1");
  REQUIRE(later.exitCode == 0);
  const auto json = nlohmann::json::parse(later.output);
  CHECK(json["time"] == 1);
  CHECK(json["times"] == 2);
  const auto beyond = info("2");
  CHECK(beyond.exitCode == 3);
  CHECK_THAT(beyond.errorOutput, Contains("time 2 is asked for") && Contains("2 time points (0 … 1)"));
  CHECK_THAT(runC3de({"info", file.string()}).output, Contains("time point 0 of 2 (0 to 1)"));

  const auto report = folder / "report.json";
  for (const auto &[time, millilitre] : {std::pair{"0", 0.512}, {"1", 1.728}}) {
    const auto scene =
        writeFile(folder / "scene.toml", std::string("format = 1\n[image]\nfile = \"moving.nrrd\"\ntime = ") + time +
                                             "\n[[body]]\nvolume = \"moving.nrrd\"\ntime = " + time +
                                             "\nlabel = 1\nsampling = { count = 200 }\n");
    const auto ran = runC3de({"run", scene.string(), "--steps", "1", "--report", report.string(), "--export-image",
                              (folder / "w.nrrd").string()});
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    CHECK(1e6 * nlohmann::json::parse(readFile(report))["bodies"][0]["volume_m3"].get<double>() ==
          Approx(millilitre).epsilon(1e-6));
    const auto written = imaging::readVolume(folder / "w.nrrd");
    REQUIRE(written);
    CHECK(written->volume.value(5, 10, 10) == (std::string(time) == "1" ? 1.0 : 0.0));
    CHECK_THAT(runC3de({"info", scene.string()}).output, Contains(std::string("time point ") + time + " of 2"));
  }
  const auto scene =
      writeFile(folder / "scene.toml", "format = 1\n[[body]]\nvolume = \"moving.nrrd\"\ntime = 5\nlabel = 1\n");
  const auto refused = runC3de({"run", scene.string(), "--steps", "1"});
  CHECK(refused.exitCode == 3);
  CHECK_THAT(refused.errorOutput, Contains("scene.toml:2: ") && Contains("2 time points (0 … 1)"));
}

TEST_CASE("Segments in layers become bodies by name, and a number that is in two layers is asked about") {
  const auto folder = freshFolder("layers");
  const auto file = writeFile(folder / "organs.seg.nrrd",
                              cubesNrrd(true,
                                        "Segment0_Layer:=0\nSegment0_LabelValue:=1\nSegment0_Name:=tumour\nSegment1_"
                                        "Layer:=1\nSegment1_LabelValue:=1\nSegment1_Name:=liver\n"));
  const auto info = runC3de({"info", file.string(), "--json"});
  REQUIRE(info.exitCode == 0);
  const auto labels = nlohmann::json::parse(info.output)["labels"];
  REQUIRE(labels.size() == 2);
  CHECK((labels[0]["name"] == "tumour" && labels[0]["layer"] == 0));
  CHECK((labels[1]["name"] == "liver" && labels[1]["layer"] == 1));
  const auto scene = [&](const std::string &label) {
    return writeFile(folder / "scene.toml",
                     "format = 1\n[[body]]\nvolume = \"organs.seg.nrrd\"\nsampling = { count = 200 }\nlabel = " +
                         label + "\n")
        .string();
  };
  const auto report = folder / "report.json";
  for (const auto &[name, millilitre] : {std::pair{"tumour", 0.512}, {"liver", 1.728}}) {
    const auto ran =
        runC3de({"run", scene("\"" + std::string(name) + "\""), "--steps", "1", "--report", report.string()});
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    CHECK(1e6 * nlohmann::json::parse(readFile(report))["bodies"][0]["volume_m3"].get<double>() ==
          Approx(millilitre).epsilon(1e-6));
  }
  const auto asked = runC3de({"run", scene("1"), "--steps", "1"});
  CHECK(asked.exitCode == 3);
  CHECK_THAT(asked.errorOutput, Contains("label 1 in 2 of its layers") && Contains("1 tumour, 1 liver"));
}
