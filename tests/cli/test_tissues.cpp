// SPDX-License-Identifier: Apache-2.0
// One body of many tissues, as a person writes it.
#include <cmath>

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
  // Materials are told apart by the samples of cells, 2.5 mm apart, and planes between them.
  const double mass = voxel * (2000.0 * static_cast<double>(ball) + 1000.0 * static_cast<double>(block + plate));
  CHECK(body["mass_kg"].get<double>() == Approx(mass).epsilon(2e-3));
  REQUIRE(report["reactions"].size() == 1);
  // What hangs on the plate: all but its own weight; the plate rests in itself.
  const double hanging = 9.81 * voxel * (2000.0 * static_cast<double>(ball) + 1000.0 * static_cast<double>(block));
  const double held = -report["reactions"][0]["force_N"][0].get<double>();
  CHECK(held > 0.97 * hanging);
  CHECK(held < 1.01 * 9.81 * mass);
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
  CHECK_THAT(refusal(sceneOf("{ label = \"core\" }")), Contains("neither a material nor rigid = true"));
  CHECK_THAT(refusal(sceneOf("{ material = \"liver\" }")), Contains("a tissue has no 'label'"));
  CHECK_THAT(refusal(sceneOf("{ label = \"core\", materiel = \"liver\" }")), Contains("unknown key 'materiel'"));
  CHECK_THAT(refusal(sceneOf("{ label = \"*\", rigid = true }", "")), Contains("all tissues are rigid"));
  CHECK_THAT(refusal(sceneOf(kCore, "background = { material = \"fat\", image = \"ct.nrrd\", from = 3, to = 1 }\n")),
             Contains("from 3 to 1 leaves nothing"));
  CHECK_THAT(refusal(sceneOf(kCore, "label = 1\n")), Contains("'tissues' and 'label'"));
  CHECK_THAT(refusal(sceneOf(kCore, "background = { material = \"fat\", image = \"ct.nrrd\", from = 3 }\n")),
             Contains("background has no 'to'"));
  // Where tissues are set, nothing can take them out of step with their parts.
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
