// SPDX-License-Identifier: Apache-2.0
// Which slices form a volume, when they are resampled, when they are refused.
#include "images.h"

using namespace images;

namespace {

constexpr const char *kSeries = "dicom/ct_head_phantom_philips_5mm";  // I10, I20, … at z = 696.21, 701.21, … mm

/// Copies of some slices, in their own folder.
std::filesystem::path copies(const std::filesystem::path &data, std::initializer_list<const char *> names) {
  const auto folder = emptyFolder("series");
  for (const char *name : names) copyFile(data / name, folder / name);
  return folder;
}

std::vector<double> slice(const Volume &volume, std::size_t k) {
  std::vector<double> all;
  for (std::size_t j = 0; j < volume.geometry.size[1]; j += 7)
    for (std::size_t i = 0; i < volume.geometry.size[0]; i += 7) all.push_back(volume.value(i, j, k));
  return all;
}

}  // namespace

TEST_CASE("A missing slice is interpolated between its neighbours, with a notice", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto loaded = readVolume(copies(data, {"I10", "I20", "I40", "I50"}));
  REQUIRE(loaded);
  const Volume &volume = loaded->volume;
  CHECK(volume.geometry.size[2] == 5);
  CHECK(says(loaded->notices, "1 slices are missing (10 mm between two of them, elsewhere 5)"));
  checkAt(volume.geometry.worldAt({0, 0, 4}), {-115.5, -1.85, 716.21});
  CHECK(std::string(volume.scalarTypeName()) == "uint16");
  const auto before = slice(volume, 1), between = slice(volume, 2), after = slice(volume, 3);
  double most = 0.0;
  for (std::size_t p = 0; p < between.size(); ++p)
    most = std::max(most, std::abs(between[p] - 0.5 * (before[p] + after[p])));
  CHECK(most <= 0.5);  // rounded to whole numbers
}

TEST_CASE("Slices at uneven distances are resampled where they really lie", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto folder = copies(data, {"I10", "I20", "I30", "I40"});
  write(folder / "I20", patched(bytesOf(data / "I20"), "\\701.21", "\\699.71"));  // 1.5 mm lower than before
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  CHECK(says(loaded->notices, "The slices lie unevenly, 3.5 to 6.5 mm apart"));
  const auto original = readVolume(data);
  REQUIRE(original);
  const Volume &volume = loaded->volume;
  CHECK_THAT(volume.geometry.spacing()[2], WithinAbs(5.0, 1e-9));
  // The slice at 701.21 is now 10/13 of I20 (at 699.71) and 3/13 of I30 (at 706.21).
  const auto a = slice(original->volume, 1), b = slice(original->volume, 2), found = slice(volume, 1);
  double most = 0.0;
  for (std::size_t p = 0; p < found.size(); ++p)
    most = std::max(most, std::abs(found[p] - (10.0 * a[p] + 3.0 * b[p]) / 13.0));
  CHECK(most <= 0.5 + 1e-9);
}

TEST_CASE("A hole of many slices is refused", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto loaded = readVolume(copies(data, {"I10", "I20", "I30", "I100"}));
  REQUIRE_FALSE(loaded);
  CHECK_THAT(loaded.error().message, Contains("35 mm") && Contains("missing in a row"));
}

TEST_CASE("Copies of a slice are left out, another slice at its place is refused", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto folder = copies(data, {"I10", "I20", "I30"});
  copyFile(data / "I20", folder / "again");
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  CHECK(loaded->volume.geometry.size[2] == 3);
  CHECK(says(loaded->notices, "1 pictures are copies"));
  write(folder / "again", patched(bytesOf(data / "I40"), "\\711.21", "\\701.21"));
  const auto refused = readVolume(folder);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("belong together"));
}

TEST_CASE("Two slices at every place are two volumes, of which the first is read", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto folder = copies(data, {"I10", "I20"});
  write(folder / "I30", patched(bytesOf(data / "I30"), "\\706.21", "\\696.21"));
  write(folder / "I40", patched(bytesOf(data / "I40"), "\\711.21", "\\701.21"));
  const auto loaded = readVolume(folder), first = readVolume(data);
  REQUIRE((loaded && first));
  CHECK(says(loaded->notices, "2 pictures at every position"));
  CHECK(slice(loaded->volume, 0) == slice(first->volume, 0));
  CHECK(slice(loaded->volume, 1) == slice(first->volume, 1));
}

TEST_CASE("Slices that are shifted sideways make no volume", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, kSeries);
  const auto folder = copies(data, {"I10", "I20", "I30"});
  write(folder / "I20", patched(bytesOf(data / "I20"), "-115.5\\", "-117.5\\"));
  const auto loaded = readVolume(folder);
  REQUIRE_FALSE(loaded);
  CHECK_THAT(loaded.error().message, Contains("shifted sideways by up to 2 mm"));
}

TEST_CASE("A series of mixed orientations is two stacks to choose from", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/mr_mixed_orientation_4");
  const auto refused = readVolume(data);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("holds 2 series and none was chosen") && Contains("oblique sagittal") &&
                                          Contains("oblique axial"));
  const auto list = listSeries(data);
  REQUIRE(list);
  REQUIRE(list->size() == 2);
  for (const SeriesInfo &info : *list) {
    CHECK(info.size == std::array<std::size_t, 3>{288, 288, 2});
    CHECK(info.modality == "MR");
    CHECK(info.files == 2);
    ReadOptions options;
    options.series = info.id;
    CHECK(readVolume(data, options));
    CHECK_THAT(refused.error().message, Contains(info.id));
  }
  ReadOptions options;
  options.series = "1.2.3";
  const auto unknown = readVolume(data, options);
  REQUIRE_FALSE(unknown);
  CHECK_THAT(unknown.error().message, Contains("no series '1.2.3'") && Contains(list->front().id));
}

TEST_CASE("Segmentations beside a series do not hide it", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/ct_3slice_plus_seg");
  const auto loaded = readVolume(data);
  REQUIRE(loaded);
  CHECK(loaded->volume.unit == "HU");
  CHECK(loaded->volume.intercept == -1024.0);
  CHECK(says(loaded->notices, "2 segmentations, to be opened as a label map"));
  C3DE_DATA_OR_SKIP(report, "dicom/pydicom_single/rtstruct.dcm");
  const auto refused = readVolume(report);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("rtstruct.dcm") && Contains("no image"));
}

TEST_CASE("More memory than allowed is refused before it is taken, with both figures", "[imaging]") {
  ReadOptions options;
  options.memoryLimit = 10'000'000;
  C3DE_DATA_OR_SKIP(series, kSeries);
  const auto dicom = readVolume(series, options);
  REQUIRE_FALSE(dicom);
  // 28 slices of 0.5 MB, and the last file twice
  CHECK_THAT(dicom.error().message, Contains("needs 17 MB") && Contains("allowed are 10 MB"));
  options.memoryLimit = 1'000'000;
  C3DE_DATA_OR_SKIP(file, "volume/totalseg/example_ct.nii.gz");
  const auto nifti = readVolume(file, options);
  REQUIRE_FALSE(nifti);
  // 122 * 101 * 112 voxels of four bytes
  CHECK_THAT(nifti.error().message, Contains("needs 6 MB") && Contains("allowed are 1 MB"));
}

TEST_CASE("Reading ends when it is cancelled, and tells how far it is", "[imaging]") {
  C3DE_DATA_OR_SKIP(series, "dicom/mr_same_volume_5_encodings/anatomical");
  C3DE_DATA_OR_SKIP(file, "volume/totalseg/example_ct.nii.gz");
  for (const auto &path : {series, file}) {
    double furthest = -1.0;
    bool forward = true;
    ReadOptions options;
    options.progress = [&](double fraction, const std::string &) {
      forward = forward && fraction >= furthest && fraction <= 1.0;
      furthest = fraction;
      return true;
    };
    CHECK(readVolume(path, options));
    CHECK(forward);
    CHECK(furthest >= 0.0);
    int calls = 0;
    options.progress = [&](double, const std::string &) { return ++calls < 2; };
    const auto cancelled = readVolume(path, options);
    REQUIRE_FALSE(cancelled);
    CHECK(cancelled.error().code == ErrorCode::cancelled);
  }
}

TEST_CASE("The patient's name is in its own field and nowhere else", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/pydicom_single");
  const auto list = listSeries(data);
  REQUIRE(list);
  std::vector<std::string> names;
  for (const SeriesInfo &info : *list) {
    if (info.patientName.size() > 3) names.push_back(info.patientName);
    CHECK((info.patientName.empty() ||
           (info.description + info.id + info.refusal).find(info.patientName) == std::string::npos));
  }
  CHECK(names.size() >= 3);
  const auto message = readVolume(data);
  REQUIRE_FALSE(message);
  for (const std::string &name : names) CHECK(message.error().message.find(name) == std::string::npos);
}

TEST_CASE("What looks like an image is known without reading it", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/ct_head_phantom_philips_5mm");
  CHECK(isLikelyImage(data));
  CHECK(isLikelyImage(data / "I10"));
  C3DE_DATA_OR_SKIP(mesh, "mesh");
  CHECK_FALSE(isLikelyImage(mesh));
  CHECK_FALSE(isLikelyImage(mesh / "absent.nii"));
  CHECK_FALSE(isLikelyImage(mesh / "sofa/liver.obj"));
}
