// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissues.h"

#include <algorithm>
#include <numeric>

#include "c3de/imaging/writing.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/tissue_motion.h"
#include "stand_in_simulator.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using Catch::Matchers::Contains;
using session::test::cubeBody;
using session::test::StandInSimulator;
namespace fs = std::filesystem;

namespace {

const scene::MaterialLibrary &presets() {
  static const auto library = scene::MaterialLibrary::load(fs::path(testResourcesFolder()) / "materials.toml");
  return library.value();
}

/// 20 x 4 x 4 voxels of 2 mm, four labels of five slices each.
fs::path writtenMap() {
  imaging::LabelMap map;
  map.geometry = {{20, 4, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1}};
  map.voxels.resize(320);
  for (std::size_t v = 0; v < 320; ++v) map.voxels[v] = static_cast<std::uint16_t>(1 + v % 20 / 5);
  map.labels = {{1, "liver", {}}, {2, "TRACHEA", {}}, {3, "rib left 3", {}}, {4, "gizmo", {}}};
  const fs::path file = testOutputFolder() / "tissues.nrrd";
  REQUIRE(imaging::writeLabelMap(file, map));
  return file;
}

/// Air in the slices from 7 on, tissue before.
fs::path writtenImage() {
  imaging::Volume image;
  image.geometry = {{20, 4, 4}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1}};
  std::vector<float> values(320);
  for (std::size_t v = 0; v < 320; ++v) values[v] = v % 20 < 7 ? 0.0F : -1000.0F;
  image.voxels = std::move(values);
  const fs::path file = testOutputFolder() / "tissues-ct.nrrd";
  REQUIRE(imaging::writeVolume(file, image));
  return file;
}

scene::SceneFile sceneOf(const std::string &more) {
  (void)writtenMap();
  auto parsed = scene::parseScene("format = 1\n[[body]]\nname = \"scan\"\nvolume = \"tissues.nrrd\"\n" + more,
                                  testOutputFolder() / "tissues.toml", &presets());
  if (!parsed) FAIL(parsed.error().message);
  return std::move(*parsed);
}

std::size_t countOf(const imaging::LabelMap &map, std::uint16_t value) {
  return static_cast<std::size_t>(std::count(map.voxels.begin(), map.voxels.end(), value));
}

}  // namespace

TEST_CASE("Known tissues are settled once, with their labels and parts", "[tissues]") {
  scene::SceneFile scene = sceneOf("tissues = \"known\"\n");
  BodySources sources;
  Preparation took;
  REQUIRE(scene::applyOverride(scene, "body.scan.parts.0.material.youngs_modulus=1e4", &presets()));
  REQUIRE(settleTissues(scene, presets(), sources, {}, took));
  const scene::SceneBody &body = scene.bodies.front();
  REQUIRE(body.volume.tissues.size() == 3);
  CHECK(body.volume.tissues[1].isEmpty);
  CHECK(body.volume.tissues[2].isRigid);
  CHECK(body.volume.tissues[2].labels.front().value == 3);
  REQUIRE(body.parts.size() == 1);
  const auto stiffness = std::find_if(body.parts[0].params.begin(), body.parts[0].params.end(),
                                      [](const auto &value) { return value.value.id == "material.youngs_modulus"; });
  CHECK(stiffness->value.num == 1e4);
  CHECK(took.reading_s > 0.0);
  REQUIRE(settleTissues(scene, presets(), sources, {}, took));
  CHECK(body.parts.size() == 1);
  CHECK(body.volume.tissues.size() == 3);
}

TEST_CASE("Airways are of the background where the image shows tissue, and labels of no tissue everywhere",
          "[tissues]") {
  (void)writtenImage();
  scene::SceneFile scene = sceneOf(
      "tissues = \"known\"\nbackground = { material = \"fat\", image = \"tissues-ct.nrrd\", from = -150, to = "
      "250 }\n");
  BodySources sources;
  Preparation took;
  CHECK_FALSE(sources.pick(scene.bodies[0].volume, {}, took));  // not settled
  REQUIRE(settleTissues(scene, presets(), sources, {}, took));
  const auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  // Slices of 16 voxels: 5 of liver, 2 of 5 of the trachea, 5 of bone, 5 of what nobody knows.
  CHECK(countOf(*picked->tissues, 1) == 80);
  CHECK(countOf(*picked->tissues, 2) == 0);
  CHECK(countOf(*picked->tissues, 3) == 80);
  CHECK(countOf(*picked->tissues, 4) == 2 * 16 + 80);
  CHECK(countOf(*picked->tissues, 0) == 3 * 16);
  const auto places = sources.placesOf(scene.bodies[0], *picked);
  REQUIRE(places);
  REQUIRE(places->labels.size() == 4);
  CHECK(places->labels[0].voxels == 80);
  CHECK(places->labels[0].sample.size() == 80);
  CHECK(norm(places->labels[0].sample[0] - Vec3{1, 1, 1}) < 1e-9);
  CHECK(places->labels[2].name == "gizmo");
  CHECK(places->labels[2].tissue == 3);
  CHECK(places->labels[3].value == 0);
  CHECK(places->labels[3].voxels == 2 * 16);
  CHECK(places->tissueAt(3).label == "background");
}

TEST_CASE("What mending takes away is of no tissue, and a known tissue without a voxel has no part", "[tissues]") {
  scene::SceneFile scene =
      sceneOf("tissues = [ { label = 1 }, { label = 4, material = \"fat\" } ]\nmend = { largest = true }\n");
  BodySources sources;
  Preparation took;
  REQUIRE(settleTissues(scene, presets(), sources, {}, took));
  auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  CHECK(countOf(*picked->tissues, 1) == 80);
  CHECK(countOf(*picked->tissues, 2) == 0);
  BodyGeometry geometry;
  geometry.volume_mm3 = 640.0;
  auto added = addTissues(scene.bodies[0].volume, *picked->tissues, 100.0, geometry);
  REQUIRE_FALSE(added);
  CHECK_THAT(added.error().message, Contains("tissue '4' has no voxel of its own"));
  geometry.tissues.clear();
  scene.bodies[0].volume.takesKnownTissues = true;
  REQUIRE(addTissues(scene.bodies[0].volume, *picked->tissues, 100.0, geometry));
  REQUIRE(geometry.tissues.size() == 2);
  CHECK(geometry.tissues[0]);
  CHECK_FALSE(geometry.tissues[1]);
}

TEST_CASE("Labels are followed by what the simulator says, and it may not say", "[tissues]") {
  scene::SceneFile scene = sceneOf("tissues = \"known\"\n");
  BodySources sources;
  Preparation took;
  REQUIRE(settleTissues(scene, presets(), sources, {}, took));
  const auto picked = sources.pick(scene.bodies[0].volume, {}, took);
  REQUIRE(picked);
  const auto places = sources.placesOf(scene.bodies[0], *picked);
  REQUIRE(places);
  StandInSimulator simulator;
  simulator.bodies = {cubeBody(0.04, {0, 0, 0}, {0.003, 0, 0.004})};
  simulator.displacement_m = {0.003, 0, 0.004};
  auto motions = tissueMotions(simulator.table(), simulator.object(), {*places});
  REQUIRE(motions);
  REQUIRE(motions->size() == 1);
  const LabelMotion liver = motions->front().ofTissue(0), bone = motions->front().ofTissue(2);
  CHECK(liver.followed == 80);
  CHECK(liver.reference_m3 == Approx(80 * 8e-9));
  CHECK(liver.end_m3 == Approx(80 * 8e-9));
  CHECK(liver.meanDisplacement_m() == Approx(0.005));
  CHECK(liver.largestDisplacement_m == Approx(0.005));
  CHECK(liver.minJ == Approx(1.0));
  CHECK(bone.largestDisplacement_m == 0.0);
  simulator.failing["displacement"] = -1;
  motions = tissueMotions(simulator.table(), simulator.object(), {*places});
  REQUIRE_FALSE(motions);
  CHECK_THAT(motions.error().message, Contains("does not say how far"));
  CHECK(tissueMotions(simulator.table(), simulator.object(), {})->empty());
}

TEST_CASE("Labels of one tissue add up by their volumes") {
  TissueMotion motion;
  motion.places.labels.resize(2);
  motion.labels = {{3.0, 6.0, 10.0, 2.0, 0.9, 10, 10}, {1.0, 1.0, 20.0, 7.0, 0.8, 4, 10}};
  const LabelMotion all = motion.ofTissue(0);
  CHECK(all.reference_m3 == 4.0);
  CHECK(all.end_m3 == 7.0);
  CHECK(all.meanDisplacement_m() == Approx((3.0 * 1.0 + 1.0 * 5.0) / 4.0));
  CHECK(all.largestDisplacement_m == 7.0);
  CHECK(all.minJ == 0.8);
  CHECK_FALSE(motion.ofTissue(1).isKnown());
}
