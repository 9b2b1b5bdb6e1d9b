// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/export_image.h"

#include "c3de/imaging/masks.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/imaging/writing.h"
#include "c3de/session/body_sources.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

/// 40 voxels of 1 mm along each axis, centres from -9.5 mm; one is bone.
imaging::Volume scan() {
  imaging::Volume image;
  image.geometry = {{40, 40, 40}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -9.5, -9.5, -9.5, 1}};
  std::vector<std::int16_t> voxels(40 * 40 * 40, -1000);
  voxels[0] = 1200;
  image.voxels = voxels;
  return image;
}

scene::SceneFile sceneWith(const fs::path &image) {
  scene::SceneFile scene;
  scene.source = "lung.toml";
  scene.image.emplace();
  scene.image->file = image;
  scene.image->line = 7;
  return scene;
}

}  // namespace

TEST_CASE("The mask of vacated places is named after the displacement, with its whole ending") {
  CHECK(emptiedFile("out/u.nrrd") == fs::path("out/u-vacated.nrrd"));
  CHECK(emptiedFile("u.nii.gz") == fs::path("u-vacated.nii.gz"));
  CHECK(emptiedFile("a.b/u.v.mha") == fs::path("a.b/u.v-vacated.mha"));
  CHECK(emptiedFile("u") == fs::path("u-vacated"));
  CHECK(emptiedFile("").empty());
}

TEST_CASE("An image is written to names with an ending that can be written, in folders that are there") {
  const fs::path folder = testOutputFolder();
  for (const char *good : {"a.nrrd", "a.nii", "a.NII.GZ", "a.mha"}) {
    INFO(good);
    CHECK(checkImageFile(folder / good));
    CHECK_FALSE(fs::exists(folder / good));
  }
  for (const char *bad : {"a.png", "a.gz", "nrrd", ".nrrd"}) {
    INFO(bad);
    const auto refused = checkImageFile(folder / bad);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::usage);
    CHECK(refused.error().message == (folder / bad).string() + ": accepted: .nrrd, .nii, .nii.gz, .mha");
  }
  const auto nowhere = checkImageFile(folder / "nowhere" / "a.nrrd");
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::output);
  CHECK_THAT(nowhere.error().message, Contains("nowhere"));
}

TEST_CASE("An export of the image needs an image in the scene, and every file of it must be writable") {
  const fs::path folder = testOutputFolder();
  ImageExport wanted;
  CHECK_FALSE(wanted.isWanted());
  scene::SceneFile scene;
  scene.source = "lung.toml";
  CHECK(checkImageExport(wanted, scene));
  wanted.displacement = folder / "u.nrrd";
  CHECK(wanted.isWanted());
  auto checked = checkImageExport(wanted, scene);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ErrorCode::usage);
  CHECK_THAT(checked.error().message, Contains("need a scene with an [image]") && Contains("lung.toml:1 has none"));
  scene.image.emplace();
  CHECK(checkImageExport(wanted, scene));
  // A folder at the path of the mask next to the displacement.
  fs::create_directories(emptiedFile(wanted.displacement));
  checked = checkImageExport(wanted, scene);
  REQUIRE_FALSE(checked);
  CHECK_THAT(checked.error().message, Contains("u-vacated.nrrd"));
  fs::remove(emptiedFile(wanted.displacement));
  wanted.image = folder / "warped.png";
  checked = checkImageExport(wanted, scene);
  REQUIRE_FALSE(checked);
  CHECK_THAT(checked.error().message, Contains("warped.png"));
}

TEST_CASE("How an image is warped follows from its table in the scene, and errors have its line") {
  const fs::path folder = testOutputFolder();
  REQUIRE(imaging::writeVolume(folder / "ct.nrrd", scan()));
  imaging::LabelMap labels;
  labels.geometry = scan().geometry;
  labels.voxels.assign(40 * 40 * 40, 0);
  labels.voxels[1] = 4;
  labels.labels = {{4, "rib_left_1", {1, 1, 1}}};
  REQUIRE(imaging::writeLabelMap(folder / "labels.nrrd", labels));
  scene::SceneFile scene = sceneWith(folder / "ct.nrrd");
  scene.image->rim_mm = 3.0;
  scene.image->labels = {folder / "labels.nrrd"};
  scene.image->still.isAutomatic = false;
  scene.image->still.labels = {"rib_*"};
  BodySources sources;
  auto how = imageWarpOf(scene, sources, {});
  REQUIRE(how);
  CHECK(how->rim_mm == 3.0);
  REQUIRE(how->labels);
  CHECK(how->still.labels == std::vector<std::uint16_t>{4});

  scene.image->still.labels = {"rib_right_*"};
  how = imageWarpOf(scene, sources, {});
  REQUIRE_FALSE(how);
  CHECK(how.error().code == ErrorCode::input);
  CHECK_THAT(how.error().message, Contains("lung.toml:7: still: there is no label 'rib_right_*'"));
  scene.image->labels = {folder / "none.nrrd"};
  how = imageWarpOf(scene, sources, {});
  REQUIRE_FALSE(how);
  CHECK_THAT(how.error().message, Contains("lung.toml:7: ") && Contains("none.nrrd"));
  scene = sceneWith(folder / "no_scan.nrrd");
  how = imageWarpOf(scene, sources, {});
  REQUIRE_FALSE(how);
  CHECK_THAT(how.error().message, Contains("lung.toml:7: ") && Contains("no_scan.nrrd"));
  scene.image.reset();
  CHECK(imageWarpOf(scene, sources, {}));
}

TEST_CASE("The present displacement covers the bodies within the image, with what stays") {
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.02, {0, 0, 0}, {0.002, 0, 0})};
  simulator.displacement_m = {0.002, 0, 0};
  ImageWarp how;
  how.rim_mm = 4.0;
  how.still.above = 200.0;
  auto u = presentDisplacement(simulator.table(), simulator.object(), scan(), how);
  REQUIRE(u);
  imaging::WorldBox bodies;
  bodies.add({2, 0, 0});
  bodies.add({22, 20, 20});
  CHECK(imaging::boxOf(u->geometry).holds(bodies.grown(4.0)));
  CHECK_THAT(simulator.rims_m.at(0), WithinAbs(0.004, 1e-15));
  CHECK_THAT(u->xyz_mm[0], WithinAbs(2.0f, 1e-5));
  REQUIRE(u->bodies);
  CHECK(u->hasFixedRegions);
  CHECK(u->bodies->voxels[0] == imaging::kFixedVoxel);
  how.still = {};
  u = presentDisplacement(simulator.table(), simulator.object(), scan(), how);
  REQUIRE(u);
  CHECK_FALSE(u->hasFixedRegions);
  simulator.fail("displacement", C3DE_E_INTERNAL);
  u = presentDisplacement(simulator.table(), simulator.object(), scan(), how);
  REQUIRE_FALSE(u);
  CHECK(u.error().code == ErrorCode::state);
  CHECK_THAT(u.error().message, Contains("does not say how far its bodies have moved"));
}

TEST_CASE("The warped scan, its displacement and the vacated places are written and told") {
  const fs::path folder = testOutputFolder();
  imaging::DisplacementGrid u;
  u.geometry = {{2, 2, 2}, {100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, -50, -50, -50, 1}};
  for (int point = 0; point < 8; ++point) u.xyz_mm.insert(u.xyz_mm.end(), {1.0f, 0.0f, 0.0f});
  u.gap_mm.assign(8, 0.0f);
  auto bodies = std::make_shared<imaging::Mask>();
  bodies->geometry = scan().geometry;
  bodies->voxels.assign(40 * 40 * 40, 0);
  u.bodies = bodies;
  const ImageExport wanted{folder / "warped.nrrd", folder / "u.nrrd", {}};
  auto told = writeImages(wanted, scan(), false, u, {}, nullptr);
  REQUIRE(told);
  CHECK_THAT(*told, Contains("warped.nrrd\n") && Contains("u.nrrd\n") &&
                        Contains("u-vacated.nrrd: no voxel is vacated by a body"));
  const auto warped = imaging::readVolume(folder / "warped.nrrd");
  REQUIRE(warped);
  CHECK(warped->volume.value(1, 0, 0) == 1200.0);
  CHECK(warped->volume.value(2, 0, 0) == -1000.0);
  CHECK(fs::exists(folder / "u.nrrd"));
  const auto marks = imaging::readVolume(folder / "u-vacated.nrrd");
  REQUIRE(marks);
  CHECK(marks->volume.value(1, 0, 0) == 0.0);

  // A body of two voxels has moved far away.
  auto gone = std::make_shared<imaging::Mask>(*bodies);
  gone->voxels[10 + 40 * (10 + 40 * 10)] = gone->voxels[11 + 40 * (10 + 40 * 10)] = imaging::kBodyVoxel;
  u.bodies = gone;
  u.gap_mm.assign(8, 80.0f);
  told = writeImages({{}, folder / "u.nrrd", {}}, scan(), false, u, {}, nullptr);
  REQUIRE(told);
  CHECK_THAT(*told, !Contains("warped.nrrd") && Contains("2 voxels (0.00 ml) are vacated by a body"));
  const auto marked = imaging::readVolume(folder / "u-vacated.nrrd");
  REQUIRE(marked);
  CHECK(marked->volume.value(11, 10, 10) == 1.0);
  CHECK(marked->volume.value(10, 10, 10) == 0.0);
  const auto failed = writeImages({folder / "nowhere" / "a.nrrd", {}, {}}, scan(), false, u, {}, nullptr);
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::output);
}

TEST_CASE("A scene says where its labels are exported from, and whether its image is a label map") {
  const fs::path folder = testOutputFolder();
  imaging::LabelMap labels;
  labels.geometry = scan().geometry;
  labels.voxels.assign(40 * 40 * 40, 0);
  labels.voxels[1] = 4;
  labels.labels = {{4, "rib_left_1", {1, 1, 1}}};
  REQUIRE(imaging::writeLabelMap(folder / "from.nrrd", labels));
  REQUIRE(imaging::writeVolume(folder / "from_ct.nrrd", scan()));
  BodySources sources;
  scene::SceneFile scene = sceneWith(folder / "from_ct.nrrd");
  ImageExport wanted{{}, {}, folder / "moved.nrrd"};
  auto checked = checkImageExport(wanted, scene);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ErrorCode::usage);
  CHECK_THAT(checked.error().message, Contains("--export-labels needs a label map") && Contains("lung.toml"));
  CHECK_FALSE(isImageOfLabels(scene));
  // Of a body.
  scene.bodies.emplace_back().volume.file = folder / "from.nrrd";
  scene.bodies[0].volume.label = 4;
  CHECK(checkImageExport(wanted, scene));
  CHECK_FALSE(isImageOfLabels(scene));
  auto layers = labelsToExport(scene, sources);
  REQUIRE(layers);
  CHECK((*layers)->front().labels[0].name == "rib_left_1");
  scene.image->file = folder / "." / "from.nrrd";
  CHECK(isImageOfLabels(scene));
  scene.bodies[0].volume.label.reset();
  scene.bodies[0].volume.threshold = {0.5, 4.5};
  CHECK_FALSE(isImageOfLabels(scene));
  CHECK_FALSE(checkImageExport(wanted, scene));
  scene.image->labels = {folder / "from.nrrd"};
  CHECK(isImageOfLabels(scene));
  CHECK(checkImageExport(wanted, scene));
  CHECK(labelFiles("a/b.nii.gz", 3) == std::vector<fs::path>{"a/b.nii.gz", "a/b-2.nii.gz", "a/b-3.nii.gz"});
}
