// SPDX-License-Identifier: Apache-2.0
// Written data are read back: geometry, type, values, labels with their names, vectors.
#include <cstring>
#include <numeric>

#include "c3de/imaging/writing.h"
#include "header_truth.h"
#include "images.h"

using namespace images;

namespace {

constexpr const char *kEndings[] = {".nrrd", ".nii", ".nii.gz", ".mha"};

template <class T>
Volume counted(bool sheared) {
  Volume volume;
  volume.geometry = awkwardGeometry(sheared);
  std::vector<T> all(volume.geometry.voxelCount());
  for (std::size_t v = 0; v < all.size(); ++v)
    all[v] = static_cast<T>(std::is_signed_v<T> ? static_cast<double>(v) * 2.0 - 50.0 : static_cast<double>(v) * 3.0);
  volume.voxels = all;
  return volume;
}

}  // namespace

TEST_CASE("Volumes of every type and an awkward place come back as they were", "[imaging]") {
  const auto folder = emptyFolder("volumes");
  for (const bool sheared : {false, true})
    for (const char *ending : kEndings)
      for (const Volume &volume :
           {counted<std::int8_t>(sheared), counted<std::uint8_t>(sheared), counted<std::int16_t>(sheared),
            counted<std::uint16_t>(sheared), counted<std::int32_t>(sheared), counted<std::uint32_t>(sheared),
            counted<float>(sheared), counted<double>(sheared)}) {
        const auto file = folder / (std::string("volume") + ending);
        INFO(file.string() << " " << volume.scalarTypeName() << (sheared ? " sheared" : ""));
        const auto written = writeVolume(file, volume);
        REQUIRE(written);
        const auto loaded = readVolume(file);
        REQUIRE(loaded);
        CHECK(loaded->volume.voxels == volume.voxels);
        // Single precision of NIfTI-1: 1e-7 of the metre between origin and image.
        CHECK(sameGrid(loaded->volume.geometry, volume.geometry, 2e-4));
        CHECK(loaded->notices.empty());
      }
}

TEST_CASE("The two placements of a NIfTI file that is written agree", "[imaging]") {
  const auto file = emptyFolder("nifti") / "q.nii";
  Volume volume = counted<std::int16_t>(false);
  for (const double turn : {1.0, -1.0}) {
    for (int c = 0; c < 3; ++c) volume.geometry.indexToWorld[static_cast<std::size_t>(8 + c)] *= turn;
    REQUIRE(writeVolume(file, volume));
    std::string bytes = bytesOf(file);
    CHECK(bytes[254] == 1);
    bytes[254] = 0;  // without the sform, the qform decides
    const auto loaded = readVolume(write(file, bytes));
    REQUIRE(loaded);
    CHECK(sameGrid(loaded->volume.geometry, volume.geometry, 2e-4));
    const auto truth = header_truth::nifti(file);
    checkAt(volume.geometry.worldAt({4, 3, 2}), truth.at(4, 3, 2));
    bytes[252] = 0;  // without either, there is only the spacing
    const auto unplaced = readVolume(write(file, bytes));
    REQUIRE(unplaced);
    CHECK(says(unplaced->notices, "does not state the orientation of the image"));
    CHECK_THAT(unplaced->volume.geometry.spacing()[1], WithinAbs(1.3, 1e-6));
  }
  Volume sheared = counted<std::int16_t>(true);
  REQUIRE(writeVolume(file, sheared));
  CHECK(bytesOf(file)[252] == 0);  // a qform cannot represent it
}

TEST_CASE("Slope and intercept are kept by NIfTI and applied for the others", "[imaging]") {
  const auto folder = emptyFolder("scaled");
  for (const auto &[slope, intercept] : {std::pair{1.0, -1024.0}, {0.5, 3.0}, {0.1, 0.0}}) {
    Volume volume = counted<std::uint16_t>(false);
    volume.slope = slope;
    volume.intercept = intercept;
    for (const char *ending : kEndings) {
      const auto file = folder / (std::string("scaled") + ending);
      INFO(file.string() << " " << slope);
      REQUIRE(writeVolume(file, volume));
      const auto loaded = readVolume(file);
      REQUIRE(loaded);
      // 0.1 has no exact single-precision value
      const bool kept = std::string(ending).starts_with(".nii") && slope != 0.1;
      CHECK(loaded->volume.slope == (kept ? slope : 1.0));
      if (kept) CHECK(loaded->volume.voxels == volume.voxels);
      // single precision of 18
      for (const std::size_t k : {0u, 1u, 2u})
        CHECK_THAT(loaded->volume.value(3, 2, k), WithinAbs(volume.value(3, 2, k), 1e-5));
    }
  }
}

TEST_CASE("Label maps come back with names and colours", "[imaging]") {
  LabelMap labels;
  labels.geometry = awkwardGeometry(true);
  labels.voxels.assign(labels.geometry.voxelCount(), 0);
  const auto folder = emptyFolder("labels");
  for (const std::uint16_t large : {std::uint16_t{7}, std::uint16_t{2001}}) {
    labels.voxels[3] = 2;
    labels.voxels[59] = large;
    labels.labels = {{2, "Left kidney", {1.0f, 0.25f, 0.0f}}, {large, "liver: right lobe", {0.1f, 0.5f, 0.9f}}};
    for (const char *ending : kEndings) {
      const auto file = folder / (std::string("labels") + ending);
      INFO(file.string() << " " << large);
      REQUIRE(writeLabelMap(file, labels));
      const auto loaded = readLabelMap(file);
      REQUIRE(loaded);
      CHECK(loaded->labels.voxels == labels.voxels);
      CHECK(sameGrid(loaded->labels.geometry, labels.geometry, 2e-4));
      REQUIRE(loaded->labels.labels.size() == 2);
      for (std::size_t n = 0; n < 2; ++n) {
        CHECK(loaded->labels.labels[n].value == labels.labels[n].value);
        CHECK(loaded->labels.labels[n].name == labels.labels[n].name);
        for (std::size_t c = 0; c < 3; ++c)  // tables have 256 steps, of which the largest is 0.01 in linear light
          CHECK_THAT(loaded->labels.labels[n].colour[c], WithinAbs(labels.labels[n].colour[c], 5e-3));
      }
    }
  }
}

TEST_CASE("Vector fields are written with three numbers per voxel, and refused as images", "[imaging]") {
  const VolumeGeometry geometry = awkwardGeometry(true);
  std::vector<float> field(3 * geometry.voxelCount());
  std::iota(field.begin(), field.end(), 0.5f);
  const auto folder = emptyFolder("vectors");
  for (const char *ending : kEndings) {
    const auto file = folder / (std::string("field") + ending);
    INFO(file.string());
    REQUIRE(writeVectorField(file, geometry, field));
    const auto refused = readVolume(file);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("3 numbers per voxel"));
  }
  const std::string nifti = bytesOf(folder / "field.nii");
  REQUIRE(nifti.size() == 352 + 4 * field.size());
  const auto value = [&](std::size_t at) {
    float x;
    std::memcpy(&x, nifti.data() + 352 + 4 * at, sizeof x);
    return x;
  };
  CHECK(value(1) == field[3]);                              // x of voxel 1
  CHECK(value(geometry.voxelCount() + 1) == field[4]);      // y of voxel 1
  CHECK(value(2 * geometry.voxelCount() + 1) == field[5]);  // z of voxel 1
}

TEST_CASE("Writing says what it cannot do and leaves no half files", "[imaging]") {
  const auto folder = emptyFolder("refused");
  const Volume volume = counted<std::int16_t>(false);
  const auto unknown = writeVolume(folder / "volume.png", volume);
  REQUIRE_FALSE(unknown);
  CHECK_THAT(unknown.error().message, Contains("volume.png") && Contains(".nrrd, .nii, .nii.gz or .mha"));
  const auto nowhere = writeVolume(folder / "absent" / "volume.nii", volume);
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::output);
  Volume flat = volume;
  for (std::size_t c = 8; c < 11; ++c) flat.geometry.indexToWorld[c] = flat.geometry.indexToWorld[c - 4];
  CHECK_FALSE(writeVolume(folder / "flat.nii", flat));
  Volume less = volume;
  less.voxels = std::vector<std::uint8_t>(3);
  CHECK_FALSE(writeVolume(folder / "less.nii", less));
  CHECK(filesOf(folder).empty());
}

TEST_CASE("Long axes are written as NIfTI-2", "[imaging]") {
  const auto file = emptyFolder("long") / "long.nii.gz";
  Volume volume;
  volume.geometry.size = {40000, 1, 2};
  volume.geometry.indexToWorld = awkwardGeometry(true).indexToWorld;
  std::vector<std::int16_t> all(80000);
  std::iota(all.begin(), all.end(), std::int16_t{-32768});
  volume.voxels = all;
  REQUIRE(writeVolume(file, volume));
  const auto loaded = readVolume(file);
  REQUIRE(loaded);
  CHECK(loaded->volume.voxels == volume.voxels);
  CHECK(sameGrid(loaded->volume.geometry, volume.geometry, 1e-9));  // double precision
}
