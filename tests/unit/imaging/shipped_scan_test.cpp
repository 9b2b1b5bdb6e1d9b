// SPDX-License-Identifier: Apache-2.0
// The scan of resources/scans, which tools/make_scan.cpp makes.
#include <set>

#include "c3de/core/platform.h"
#include "c3de/imaging/label_names.h"
#include "unit/imaging/images.h"

using namespace images;

namespace {

const std::filesystem::path kScans = std::filesystem::path(testResourcesFolder()) / "scans";

}  // namespace

TEST_CASE("The shipped scan and its labels are what tools/make_scan makes") {
  const auto folder = emptyFolder("made");
  const auto image = folder / "abdomen.nii.gz", labels = folder / "abdomen_labels.nrrd";
  const auto run = runProcess({C3DE_MAKE_SCAN, image.string(), labels.string()}, 300.0);
  REQUIRE(run);
  INFO(run->errorOutput);
  REQUIRE(run->exitCode == 0);
  const auto made = readVolume(image), shipped = readVolume(kScans / "abdomen.nii.gz");
  REQUIRE(made);
  REQUIRE(shipped);
  CHECK(made->volume.geometry.size == shipped->volume.geometry.size);
  CHECK(made->volume.geometry.indexToWorld == shipped->volume.geometry.indexToWorld);
  CHECK((made->volume.voxels == shipped->volume.voxels));
  const auto madeLabels = readLabelMap(labels), shippedLabels = readLabelMap(kScans / "abdomen_labels.nrrd");
  REQUIRE(madeLabels);
  REQUIRE(shippedLabels);
  CHECK((madeLabels->labels.voxels == shippedLabels->labels.voxels));
  REQUIRE(madeLabels->labels.labels.size() == shippedLabels->labels.labels.size());
  for (std::size_t i = 0; i < madeLabels->labels.labels.size(); ++i) {
    CHECK(madeLabels->labels.labels[i].name == shippedLabels->labels.labels[i].name);
    CHECK(madeLabels->labels.labels[i].colour == shippedLabels->labels.labels[i].colour);
  }
}

TEST_CASE("The shipped scan is a small oblique CT whose labels are on its grid") {
  const auto image = readVolume(kScans / "abdomen.nii.gz");
  const auto read = readLabelMap(kScans / "abdomen_labels.nrrd");
  REQUIRE(image);
  REQUIRE(read);
  CHECK(read->notices.empty());
  CHECK(std::filesystem::file_size(kScans / "abdomen.nii.gz") +
            std::filesystem::file_size(kScans / "abdomen_labels.nrrd") <
        1'500'000);
  const LabelMap &map = read->labels;
  CHECK(sameGrid(image->volume.geometry, map.geometry));
  CHECK(image->volume.geometry.shear() < 1e-4);
  CHECK(image->volume.geometry.spacing()[2] > 1.3 * image->volume.geometry.spacing()[0]);
  CHECK(image->volume.geometry.indexToWorld[1] != 0.0);  // oblique

  std::set<std::string> names;
  for (const LabelMap::Label &label : map.labels) {
    INFO(label.name);
    names.insert(label.name);
    CHECK(label.colour != distinctColour(label.value));
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < map.voxels.size(); ++i)
      if (map.voxels[i] == label.value) {
        sum += std::get<std::vector<std::int16_t>>(image->volume.voxels)[i];
        count += 1.0;
      }
    const double mean = sum / count, ml = 1e-3 * count * map.geometry.voxelVolume();
    CHECK(ml > 5.0);
    if (label.name == "liver") {
      CHECK_THAT(mean, WithinAbs(110.0, 15.0));
      CHECK_THAT(ml, WithinAbs(1100.0, 300.0));
    } else if (label.name.starts_with("vertebrae") || label.name.starts_with("ribs")) {
      CHECK(mean > 200.0);
    } else if (label.name.starts_with("lung")) {
      CHECK(mean < -600.0);
    } else {
      CHECK(mean > -20.0);
      CHECK(mean < 200.0);
    }
  }
  for (const char *name : {"liver", "liver_tumor", "kidney_left", "kidney_right", "spleen", "aorta", "vertebrae_L1"})
    CHECK(names.count(name) == 1);
}
