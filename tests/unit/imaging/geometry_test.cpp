// SPDX-License-Identifier: Apache-2.0
// Voxel positions of third-party images equal those from a second reading of their headers, or from gdcmdump.
#include <map>

#include "header_truth.h"
#include "images.h"

using namespace images;

namespace {

void compare(const std::filesystem::path &file, const header_truth::ReferenceSolution &truth) {
  INFO(file.string());
  const auto loaded = readVolume(file);
  if (!loaded) INFO(loaded.error().message);
  REQUIRE(loaded);
  const VolumeGeometry &g = loaded->volume.geometry;
  REQUIRE(g.size == truth.size);
  const Vec3 end = last(g), middle = 0.5 * end;
  checkAt(g.worldAt({0, 0, 0}), truth.at(0, 0, 0));
  checkAt(g.worldAt(end), truth.at(end[0], end[1], end[2]));
  checkAt(g.worldAt(middle), truth.at(middle[0], middle[1], middle[2]));
}

/// The output of gdcmdump: Image Position of the first and last slice along the normal, Image Orientation, Pixel
/// Spacing.
struct Dumped {
  const char *path;
  std::array<std::size_t, 3> size;
  Vec3 first, lastSlice, alongRow, alongColumn;
  double betweenColumns, betweenRows;
};

const std::vector<Dumped> &dumped() {
  // clang-format off
  static const std::vector<Dumped> all{
      {"ct_3slice_plus_seg", {512, 512, 3}, {-235.199997, -226.800003, -128.690002},
       {-235.199997, -226.800003, -126.690002}, {1, 0, 0}, {0, 1, 0}, 0.810547, 0.810547},
      {"ct_gantry_tilt_4", {512, 512, 4}, {-106.791015625, -256.61886606561, -61.951915066986},
       {-106.791015625, -256.61886606561, -46.951915066986}, {1, 0, 0}, {0, 0.970295726276, -0.2419218955997},
       0.41796875, 0.41796875},
      {"ct_head_phantom_philips_5mm", {512, 512, 28}, {-115.5, -1.85, 696.21}, {-115.5, -1.85, 831.21}, {1, 0, 0},
       {0, 1, 0}, 0.451171875, 0.451171875},
      {"ct_torso_j2k_20", {512, 512, 20}, {-249.51171875, -437.51171875, -804.5},
       {-249.51171875, -437.51171875, -766.5}, {1, 0, 0}, {0, 1, 0}, 0.9765625, 0.9765625},
      {"mr_double_oblique_hitachi", {64, 64, 4}, {-136.2682, -50.12272, 36.6436}, {-145.6324, -43.13273, 39.37342},
       {0.60883, 0.790737, 0.063724}, {-0.142762, 0.188227, -0.971694}, 2.34375, 2.34375},
      {"mr_enhanced_multiframe_philips", {256, 256, 8}, {100.293579101562, -150.60459327697, 116.949243545532},
       {91.8935394287109, -150.60459327697, 116.949243545532}, {0, 1, 0}, {0, 0, -1}, 1, 1},
      {"mr_mixed_orientation_4/IM-0001-0001-0001 2.dcm", {288, 288, 2},
       {21.2970258926457, -131.0381768455, 136.85565189706}, {17.9998981689518, -131.00080616373, 136.988106769192},
       {0.01587762124836, 0.99323856830596, 0.11500004678964}, {-0.0385642088949, 0.11553729325532, -0.9925542473793},
       0.31999999284744, 0.31999999284744},
      {"mr_mixed_orientation_4/IM-0001-0001-0001.dcm", {288, 288, 2},
       {-86.725048585449, -41.604496164053, -15.585296122403}, {-86.565964742218, -42.680278939932, -11.321801511616},
       {0.99912995100021, -0.0113245164975, -0.0401379205286}, {0.02078674733638, 0.96958416700363, 0.24387390911579},
       0.55555558204650, 0.55555558204650},
      {"seg_tiny_nonsquare/IMG0002.dcm", {24, 38, 3}, {46.4649, 5.01881, -177.75}, {46.4649, 5.01881, -172.75},
       {1, 0, 0}, {0, 1, 0}, 0.7, 0.7},
      {"seg_tiny_nonsquare/mf.dcm", {24, 38, 3}, {46.4649, 5.01881, -177.75}, {46.4649, 5.01881, -172.75}, {1, 0, 0},
       {0, 1, 0}, 0.7, 0.7},
      {"pydicom_single/CT_small.dcm", {128, 128, 1}, {-158.135803, -179.035797, -75.699997},
       {-158.135803, -179.035797, -75.699997}, {1, 0, 0}, {0, 1, 0}, 0.661468, 0.661468},
      {"pydicom_single/rtdose.dcm", {10, 10, 15}, {189.43125, 199.43125, -761.87}, {189.43125, 199.43125, -691.87},
       {1, 0, 0}, {0, 1, 0}, 10, 10},
      {"pydicom_single/rtdose_rle.dcm", {10, 10, 15}, {189.43125, 199.43125, -761.87}, {189.43125, 199.43125, -691.87},
       {1, 0, 0}, {0, 1, 0}, 10, 10}};
  // clang-format on
  return all;
}

unsigned long checkSum(const Volume &volume) {
  return std::visit(
      [](const auto &all) {
        return crc32(0, reinterpret_cast<const Bytef *>(all.data()), static_cast<uInt>(all.size() * sizeof(all[0])));
      },
      volume.voxels);
}

}  // namespace

TEST_CASE("NIfTI, NRRD and MetaImage files lie where their headers say", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "volume");
  std::size_t files = 0;
  for (const auto &file : filesOf(folder)) {
    const std::string extension = file.extension().string();
    if (extension == ".nii" || extension == ".gz")
      compare(file, header_truth::nifti(file));
    else if (extension == ".nrrd" || extension == ".nhdr")
      compare(file, header_truth::nrrd(file));
    else if (extension == ".mha" || extension == ".mhd")
      compare(file, header_truth::meta(file));
    else
      continue;
    ++files;
  }
  CHECK(files == 32);
}

TEST_CASE("NRRD files beside DICOM lie where their headers say", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "dicom");
  std::size_t files = 0;
  for (const auto &file : filesOf(folder))
    if (file.extension() == ".nrrd") compare(file, header_truth::nrrd(file)), ++files;
  CHECK(files == 4);
}

TEST_CASE("DICOM series lie where gdcmdump puts their slices", "[imaging]") {
  for (const Dumped &known : dumped()) {
    C3DE_DATA_OR_SKIP(path, std::string("dicom/") + known.path);
    INFO(known.path);
    const auto loaded = readVolume(path);
    if (!loaded) INFO(loaded.error().message);
    REQUIRE(loaded);
    const VolumeGeometry &g = loaded->volume.geometry;
    REQUIRE(g.size == known.size);
    // DICOM C.7.6.2.1.1: position + column index * spacing * row direction + row index * spacing * column direction.
    const auto onSlice = [&](const Vec3 &position, double i, double j) {
      return position + (i * known.betweenColumns) * known.alongRow + (j * known.betweenRows) * known.alongColumn;
    };
    const Vec3 end = last(g);
    checkAt(g.worldAt({0, 0, 0}), known.first);
    checkAt(g.worldAt(end), onSlice(known.lastSlice, end[0], end[1]));
    checkAt(g.worldAt(0.5 * end),
            0.5 * (onSlice(known.first, end[0] / 2, end[1] / 2) + onSlice(known.lastSlice, end[0] / 2, end[1] / 2)));
    CHECK(g.handedness() > 0.0);
  }
}

TEST_CASE("Slices of a tilted gantry stay a sheared grid, with a notice", "[imaging]") {
  C3DE_DATA_OR_SKIP(path, "dicom/ct_gantry_tilt_4");
  const auto loaded = readVolume(path);
  REQUIRE(loaded);
  // sine of 14 degrees, as in the header
  CHECK_THAT(loaded->volume.geometry.shear(), WithinAbs(0.2419218955997, 1e-6));
  CHECK(says(loaded->notices, "tilted by 14 degrees"));
}

TEST_CASE("One volume in five encodings has one place, and the voxels that gdcmconv unpacks", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "dicom/mr_same_volume_5_encodings");
  const auto plain = readVolume(folder / "anatomical");
  REQUIRE(plain);
  // CRC-32 of the output of `gdcmconv --raw` and `gdcmraw` for the four files, the last file first. The files that are
  // not compressed contain other voxels than the four others, which are equal.
  CHECK(checkSum(plain->volume) == 0xcb2edf96ul);
  for (const char *encoding : {"compressed_j2k", "compressed_jpeg", "compressed_jpegls", "compressed_rle"}) {
    INFO(encoding);
    const auto packed = readVolume(folder / encoding);
    REQUIRE(packed);
    CHECK(checkSum(packed->volume) == 0xefce513ful);
    CHECK(packed->volume.geometry.indexToWorld == plain->volume.geometry.indexToWorld);
  }
}

TEST_CASE("One slice in eight encodings and byte orders gives the same voxels", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "dicom/pydicom_single");
  const auto plain = readVolume(folder / "MR_small.dcm");
  REQUIRE(plain);
  for (const char *name : {"MR_small_RLE.dcm", "MR_small_bigendian.dcm", "MR_small_expb.dcm", "MR_small_implicit.dcm",
                           "MR_small_jp2klossless.dcm", "MR_small_jpeg_ls_lossless.dcm", "MR_small_padded.dcm"}) {
    INFO(name);
    const auto other = readVolume(folder / name);
    REQUIRE(other);
    CHECK(other->volume.voxels == plain->volume.voxels);
  }
  const auto dose = readVolume(folder / "rtdose.dcm"), packed = readVolume(folder / "rtdose_rle.dcm");
  REQUIRE((dose && packed));
  CHECK(dose->volume.voxels == packed->volume.voxels);
}

TEST_CASE("Values of images have the ranges that are known of them", "[imaging]") {
  struct Known {
    const char *file, *type;
    double lo, hi, tolerance;  // the known range has four figures
  };
  for (const Known &known :
       {Known{"nifti/CT_pitch.nii.gz", "uint8", 0, 255, 0}, Known{"nifti/anatomical.nii", "int16", -610, 30390, 5},
        Known{"nifti/fmri_pitch.nii.gz", "uint8", 0, 2210, 1},
        Known{"nifti/reoriented_anat_moved.nii", "float32", 0, 21200, 50},
        Known{"nifti/someones_epi.nii.gz", "uint8", 7.743, 103.8, 0.05},
        Known{"totalseg/example_ct.nii.gz", "int32", -1207, 3382, 0},
        Known{"totalseg/example_ct_sm.nii.gz", "int16", -1100, 1207, 0},
        Known{"totalseg/example_mr_sm.nii.gz", "int16", -47, 833, 0}}) {
    C3DE_DATA_OR_SKIP(path, std::string("volume/") + known.file);
    INFO(known.file);
    const auto loaded = readVolume(path);
    REQUIRE(loaded);
    CHECK(std::string(loaded->volume.scalarTypeName()) == known.type);
    const auto [lo, hi] = rangeOf(loaded->volume);
    CHECK_THAT(lo, WithinAbs(known.lo, known.tolerance + 1e-9));
    CHECK_THAT(hi, WithinAbs(known.hi, known.tolerance + 1e-9));
  }
}

TEST_CASE("A detached header reads the same voxels raw and packed", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "volume/nrrd_mhd_detached");
  const std::string name = "BrainProtonDensitySliceShifted13x17yDirectionPlus30";
  const auto raw = readVolume(folder / (name + ".nhdr")), packed = readVolume(folder / (name + ".mhd"));
  REQUIRE((raw && packed));
  CHECK(raw->volume.voxels == packed->volume.voxels);
  CHECK(rangeOf(raw->volume).second > 100.0);
}

TEST_CASE("Labels stored left to right flipped lie over their organs", "[imaging]") {
  C3DE_DATA_OR_SKIP(scan, "dicom/ct_torso_j2k_20");
  C3DE_DATA_OR_SKIP(segmented, "volume/totalseg/example_seg_dicom.nii.gz");
  const auto image = readVolume(scan);
  const auto labels = readLabelMap(segmented);
  REQUIRE((image && labels));
  CHECK(image->volume.geometry.handedness() * labels->labels.geometry.handedness() < 0.0);  // it is indeed flipped
  CHECK(labels->labels.labels.size() == 31);
  const Mat4 toIndex = affineInverse(image->volume.geometry.indexToWorld);
  std::map<int, std::pair<double, double>> sums;
  const auto &g = labels->labels.geometry;
  for (std::size_t v = 0; v < labels->labels.voxels.size(); ++v) {
    if (labels->labels.voxels[v] == 0) continue;
    const Vec3 at = transformPoint(
        toIndex, g.worldAt({static_cast<double>(v % g.size[0]), static_cast<double>(v / g.size[0] % g.size[1]),
                            static_cast<double>(v / (g.size[0] * g.size[1]))}));
    auto &[count, sum] = sums[labels->labels.voxels[v]];
    count += 1.0;
    sum +=
        image->volume.value(static_cast<std::size_t>(std::lround(at[0])), static_cast<std::size_t>(std::lround(at[1])),
                            static_cast<std::size_t>(std::lround(at[2])));
  }
  const auto mean = [&](int label) { return sums.at(label).second / sums.at(label).first; };
  // Hounsfield units with contrast agent. Read index by index, or with both axes reversed, no vertebra is bone.
  CHECK_THAT(mean(5), WithinAbs(90.0, 20.0));  // liver
  CHECK_THAT(mean(1), WithinAbs(90.0, 20.0));  // spleen
  CHECK(mean(32) > 200.0);                     // vertebra
  CHECK(mean(33) > 200.0);
  CHECK(mean(97) > 200.0);   // rib, left
  CHECK(mean(109) > 200.0);  // rib, right
}
