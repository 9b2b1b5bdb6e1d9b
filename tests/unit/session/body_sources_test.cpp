// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_sources.h"

#include <algorithm>
#include <fstream>
#include <numeric>

#include "c3de/imaging/writing.h"
#include "c3de/session/build_scene.h"
#include "loading/body_geometry.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kSize = 24;

std::size_t at(std::size_t i, std::size_t j, std::size_t k) { return i + kSize * (j + kSize * k); }

/// Voxels of 2 mm: a ball of label 3, hollow by one voxel, with two separate voxels, and a single voxel of label 5.
imaging::LabelMap labelMap() {
  imaging::LabelMap map;
  map.geometry = {{kSize, kSize, kSize}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 100, 0, 0, 1}};
  map.voxels.assign(kSize * kSize * kSize, 0);
  for (std::size_t k = 0; k < kSize; ++k)
    for (std::size_t j = 0; j < kSize; ++j)
      for (std::size_t i = 0; i < kSize; ++i)
        if (norm(Vec3{double(i), double(j), double(k)} - Vec3{12, 12, 12}) < 8.0) map.voxels[at(i, j, k)] = 3;
  map.voxels[at(12, 12, 12)] = 0;
  map.voxels[at(1, 1, 1)] = map.voxels[at(2, 1, 1)] = 3;
  map.voxels[at(1, 22, 22)] = 5;
  map.labels = {{3, "kidney_left", {0.5f, 0.25f, 0.0f}}, {5, "spleen", {0, 1, 0}}};
  return map;
}

std::size_t ballVoxels() {
  const imaging::LabelMap map = labelMap();
  return static_cast<std::size_t>(std::count(map.voxels.begin(), map.voxels.end(), 3));
}

fs::path writtenLabels() {
  const fs::path file = testOutputFolder() / "labels.nrrd";
  if (const auto written = imaging::writeLabelMap(file, labelMap()); !written) FAIL(written.error().message);
  return file;
}

scene::SceneVolume numbered(const fs::path &file, std::uint16_t label) {
  scene::SceneVolume volume;
  volume.file = file;
  volume.label = label;
  return volume;
}

scene::SceneVolume called(const fs::path &file, const std::string &name) {
  scene::SceneVolume volume;
  volume.file = file;
  volume.labelName = name;
  return volume;
}

imaging::Mask ball() {
  imaging::LabelMap map = labelMap();
  map.voxels[at(1, 1, 1)] = map.voxels[at(2, 1, 1)] = 0;
  map.voxels[at(12, 12, 12)] = 3;
  return imaging::maskOf(map, std::uint16_t{3});
}

}  // namespace

TEST_CASE("A label is picked by number, by name and by the name a person reads, with its colour") {
  const fs::path file = writtenLabels();
  BodySources sources;
  Preparation took;
  for (const scene::SceneVolume &volume :
       {numbered(file, 3), called(file, "kidney_left"), called(file, "kidney left"), called(file, "label 3")}) {
    INFO(volume.labelName);
    const auto picked = sources.pick(volume, {}, took);
    REQUIRE(picked);
    CHECK(imaging::voxelCount(picked->mask) == ballVoxels());
    REQUIRE(picked->colour);
    CHECK_THAT((*picked->colour)[0], WithinAbs(0.5f, 0.01));
  }
  CHECK(took.reading_s > 0.0);
  CHECK(took.masks_s > 0.0);
}

TEST_CASE("A label that is not there is named with the file, the nearest one and those there are") {
  const fs::path file = writtenLabels();
  BodySources sources;
  Preparation took;
  auto picked = sources.pick(numbered(file, 9), {}, took);
  REQUIRE_FALSE(picked);
  CHECK(picked.error().code == ErrorCode::input);
  CHECK(picked.error().message == file.string() + " has no label 9; there are: 3 kidney_left, 5 spleen");
  picked = sources.pick(called(file, "spleem"), {}, took);
  REQUIRE_FALSE(picked);
  CHECK_THAT(picked.error().message, Contains("has no label 'spleem'; did you mean 'spleen'? there are: 3 kidney"));
  picked = sources.pick(numbered(file.parent_path() / "none.nrrd", 3), {}, took);
  REQUIRE_FALSE(picked);
  CHECK(picked.error().code == ErrorCode::input);
  CHECK_THAT(picked.error().message, Contains("none.nrrd"));
}

TEST_CASE("A file is read once for all bodies, and what its reader noticed is told once") {
  const fs::path file = writtenLabels();
  BodySources sources;
  Preparation took;
  REQUIRE(sources.pick(numbered(file, 3), {}, took));
  fs::remove(file);
  const auto second = sources.pick(numbered(file, 5), {}, took);
  REQUIRE(second);
  CHECK(imaging::voxelCount(second->mask) == 1);
  const auto layers = sources.labels(file, {});
  REQUIRE(layers);
  CHECK((*layers)->size() == 1);
  (void)sources.popNotices();
  CHECK(sources.popNotices().empty());
  CHECK_FALSE(sources.volume(file, {}));  // it was not read as an image
}

TEST_CASE("A mask is mended in the order of the scene") {
  const fs::path file = writtenLabels();
  BodySources sources;
  Preparation took;
  const auto voxels = [&](const scene::SceneVolume &volume) {
    const auto picked = sources.pick(volume, {}, took);
    if (!picked) FAIL(picked.error().message);
    return imaging::voxelCount(picked->mask);
  };
  scene::SceneVolume volume = numbered(file, 3);
  volume.mend.largest = true;
  CHECK(voxels(volume) == ballVoxels() - 2);
  volume.mend.fillHoles = true;
  CHECK(voxels(volume) == ballVoxels() - 1);
  volume = numbered(file, 3);
  volume.mend.fillHoles = true;
  CHECK(voxels(volume) == ballVoxels() + 1);
  volume = numbered(file, 5);
  volume.mend.opening_mm = 3.0;
  const auto nothing = sources.pick(volume, {}, took);
  REQUIRE_FALSE(nothing);
  CHECK(nothing.error().code == ErrorCode::input);
  CHECK_THAT(nothing.error().message, Contains("labels.nrrd: nothing is left of what was asked for"));
  volume = numbered(file, 3);
  volume.mend.closing_mm = 2.5;
  CHECK(voxels(volume) >= ballVoxels() + 1);
}

TEST_CASE("Values of an image are picked between two limits, and a mask is taken as it is") {
  const fs::path file = testOutputFolder() / "image.nrrd";
  imaging::Volume image;
  image.geometry.size = {4, 1, 1};
  image.voxels = std::vector<std::int16_t>{-5, 10, 20, 30};
  REQUIRE(imaging::writeVolume(file, image));
  BodySources sources;
  Preparation took;
  scene::SceneVolume volume;
  volume.file = file;
  volume.threshold = {{10.0, 20.0}};
  auto picked = sources.pick(volume, {}, took);
  REQUIRE(picked);
  CHECK(picked->mask.voxels == std::vector<std::uint8_t>{0, 1, 1, 0});
  CHECK_FALSE(picked->colour);
  volume.threshold = {{50.0, 60.0}};
  CHECK_THAT(sources.pick(volume, {}, took).error().message, Contains("image.nrrd: nothing is left"));
  volume = {};
  volume.mask = std::make_shared<const imaging::Mask>(ball());
  volume.colour = {{0.0f, 1.0f, 0.5f}};
  picked = sources.pick(volume, {}, took);
  REQUIRE(picked);
  CHECK(picked->mask.voxels == ball().voxels);
  CHECK(picked->colour == volume.colour);
}

TEST_CASE("The geometry of a body has the volume of its mask, as skin and as fill, without specks") {
  imaging::Mask mask = ball();
  const double volume_mm3 = imaging::volumeOf(mask);
  mask.voxels[at(1, 1, 1)] = 1;
  const auto body = bodyGeometryOf(mask, 0.0, 500.0, false, {});
  REQUIRE(body);
  CHECK(body->volume_mm3 == volume_mm3);
  const double filled =
      std::accumulate(body->fill.values.begin(), body->fill.values.end(), 0.0) * body->fill.geometry.voxelVolume();
  CHECK_THAT(filled / volume_mm3, WithinAbs(1.0, 1e-5));
  // The surface preserves the volume of its part to about a thousandth.
  CHECK_THAT(geometry::signedVolume(body->skin.mesh) / volume_mm3, WithinAbs(1.0, 0.01));
  CHECK(body->coverage.specks == 1);
  CHECK_THAT(body->coverage.requested_mm3, WithinAbs(volume_mm3 + 8.0, 1e-9));
  CHECK_THAT(body->coverage.missing_mm3, WithinAbs(8.0, 1e-9));
  CHECK(body->took.surfaces_s > 0.0);
  CHECK(body->took.fills_s > 0.0);
  std::fill(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{0});
  CHECK_FALSE(bodyGeometryOf(mask, 0.0, 500.0, false, {}));
  CHECK(bodyGeometryOf(ball(), 0.0, 500.0, false, [](double, const std::string &) { return false; }).error().code ==
        ErrorCode::cancelled);
}

TEST_CASE("Voxels are averaged to a sixteenth of the distance of points, never finer than they are") {
  imaging::Mask cube;
  cube.geometry = {{44, 44, 44}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
  cube.voxels.assign(44 * 44 * 44, 0);
  for (std::size_t k = 2; k < 42; ++k)
    for (std::size_t j = 2; j < 42; ++j)
      for (std::size_t i = 2; i < 42; ++i) cube.voxels[i + 44 * (j + 44 * k)] = 1;
  // An edge of 80 mm: 5 mm for a single phyxel, which is two voxels of 2 mm.
  const auto coarse = bodyGeometryOf(cube, 0.0, 1.0, false, {}), fine = bodyGeometryOf(cube, 0.0, 1000.0, false, {});
  REQUIRE(coarse);
  REQUIRE(fine);
  CHECK(coarse->fill.geometry.spacing() == Vec3{4, 4, 4});
  CHECK(fine->fill.geometry.spacing() == Vec3{2, 2, 2});
}

TEST_CASE("What is wrong with a file that a scene names is told with the line, and is input") {
  scene::SceneFile scene;
  scene.source = "lung.toml";
  Error error = failInScene({ErrorCode::usage, "no label 9"}, scene, 12).value();
  CHECK(error.code == ErrorCode::input);
  CHECK(error.message == "lung.toml:12: no label 9");
  error = failInScene({ErrorCode::cancelled, "cancelled"}, scene, 12).value();
  CHECK(error.code == ErrorCode::cancelled);
}

TEST_CASE("The image beside a simulation is read with its labels, and what fails has the line of its table") {
  const fs::path labels = writtenLabels(), image = testOutputFolder() / "image.nrrd";
  imaging::Volume volume;
  volume.geometry.size = {2, 2, 2};
  volume.voxels = std::vector<std::uint8_t>(8, 1);
  REQUIRE(imaging::writeVolume(image, volume));
  BodySources sources;
  scene::SceneFile scene;
  scene.source = "lung.toml";
  CHECK(readSceneImage(scene, sources, {}));
  scene.image.emplace();
  scene.image->file = image;
  scene.image->labels = {labels};
  scene.image->line = 4;
  CHECK(readSceneImage(scene, sources, {}));
  scene.image->still.labels = {"spleem"};
  auto read = readSceneImage(scene, sources, {});
  REQUIRE_FALSE(read);
  CHECK_THAT(read.error().message, Contains("lung.toml:4: still: there is no label 'spleem'"));
  scene.image->labels = {labels.parent_path() / "none.nrrd"};
  read = readSceneImage(scene, sources, {});
  REQUIRE_FALSE(read);
  CHECK_THAT(read.error().message, Contains("lung.toml:4: ") && Contains("none.nrrd"));
  scene.image->file = image.parent_path() / "no_image.nrrd";
  read = readSceneImage(scene, sources, {});
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::input);
  CHECK_THAT(read.error().message, Contains("lung.toml:4: ") && Contains("no_image.nrrd"));
}
