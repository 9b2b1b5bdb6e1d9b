// SPDX-License-Identifier: Apache-2.0
// Unusual lengths in files: decimal commas, units, non-spatial axes, sizes that do not fit.
#include <zlib.h>

#include <cmath>
#include <cstring>

#include "dicom_made.h"

using namespace made;

namespace {

/// Three slices 2.5 mm apart with this Pixel Spacing, thickness and scaling.
std::filesystem::path series(const std::string &folderName, const std::string &spacing, const std::string &z = ".",
                             const std::string &slope = "1") {
  const auto folder = emptyFolder(folderName);
  for (int k = 0; k < 3; ++k) {
    const std::string position = k == 0 ? "0" : k == 1 ? "2" + z + "5" : "5";
    Picture one(4, 3);
    one.text(0x00080018, "UI", "2.25.3104.1.1." + std::to_string(k + 1))
        .text(0x00080060, "CS", "CT")
        .text(0x00200013, "IS", std::to_string(k + 1))
        .text(0x00200032, "DS", "-1" + z + "5\\0\\" + position)
        .text(0x00280030, "DS", spacing)
        .text(0x00281052, "DS", "-1024")
        .text(0x00281053, "DS", slope)
        .pixels(std::vector<std::uint16_t>(12, 1100));
    if (spacing.empty()) one.without(0x00280030);
    write(folder / (std::to_string(k) + ".dcm"), one.file());
  }
  return folder;
}

void checkSpacing(const Expected<LoadedVolume> &loaded, const Vec3 &expected) {
  if (!loaded) {
    FAIL_CHECK(loaded.error().message);
    return;
  }
  for (const std::string &notice : loaded->notices) UNSCOPED_INFO(notice);
  checkAt(loaded->volume.geometry.spacing(), expected);
}

std::string nrrd(const std::string &sizes, const std::string &fields, const std::string &type = "uchar") {
  std::size_t dimension = 1, count = 1;
  for (const char c : sizes) dimension += c == ' ' ? 1 : 0;
  for (std::size_t at = 0; at < sizes.size();) {
    std::size_t used = 0;
    count *= std::stoul(sizes.substr(at), &used);
    at += used + 1;
  }
  return "NRRD0005\ntype: " + type + "\ndimension: " + std::to_string(dimension) + "\nsizes: " + sizes +
         "\nencoding: raw\nendian: little\n" + fields + "\n" + std::string(count * (type == "float" ? 4 : 1), '\1');
}
const std::string kDirections = "space: LPS\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,2)\nspace origin: (1,2,3)\n";

std::string meta(const std::string &spacing, const std::string &more = "", const std::string &offset = "1 2 3") {
  return "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = " + spacing +
         "\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = " + offset + "\n" + more +
         "ElementDataFile = LOCAL\nabcdefgh";
}

/// 4 x 3 x 2 bytes with spacings 1, 2, 3 of a unit.
std::string nifti(int unit, float size = 1) {
  std::string out(352 + 24, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(out.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  const std::int16_t dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
  std::memcpy(out.data() + 40, dims, sizeof dims);
  put(70, std::int16_t{2});
  put(72, std::int16_t{8});
  const float pixdim[8] = {1, size, 2 * size, 3 * size, 1, 1, 1, 1};
  std::memcpy(out.data() + 76, pixdim, sizeof pixdim);
  put(108, 352.0F);
  out[123] = static_cast<char>(unit);
  put(254, std::int16_t{1});
  const float rows[12] = {size, 0, 0, 0, 0, 2 * size, 0, 0, 0, 0, 3 * size, 0};
  std::memcpy(out.data() + 280, rows, sizeof rows);
  std::memcpy(out.data() + 344, "n+1", 4);
  return out;
}

std::string gzipped(const std::string &bytes, const std::filesystem::path &file) {
  gzFile out = gzopen(file.string().c_str(), "wb");
  gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(out);
  return bytesOf(file);
}

}  // namespace

TEST_CASE("Decimal commas of DICOM are read as decimal points, and said", "[imaging][lengths]") {
  for (const char *spacing :
       {"0,5\\0,75", "0,50\\0,75", "0,5 \\0,75 ", " 0,5\\ 0,75", "+0,5\\0,75", "5,0E-1\\7,5e-1"}) {
    INFO(spacing);
    const auto loaded = readVolume(series("comma", spacing, ","));
    checkSpacing(loaded, {0.75, 0.5, 2.5});
    REQUIRE(loaded);
    checkAt(loaded->volume.geometry.worldAt({0, 0, 0}), {-1.5, 0, 0});
    CHECK(says(loaded->notices, "decimal comma"));
  }
  for (const char *spacing : {"0.5\\0.75", "5.0E-1\\7.5e-1", ".5\\.75", "0.500000000000000\\0.75", "0.5\\0.75\\"}) {
    INFO(spacing);
    const auto loaded = readVolume(series("point", spacing));
    checkSpacing(loaded, {0.75, 0.5, 2.5});
    REQUIRE(loaded);
    CHECK_FALSE(says(loaded->notices, "decimal comma"));
    CHECK_FALSE(says(loaded->notices, "left out"));
  }
  // The scaling of values has commas too.
  const auto scaled = readVolume(series("scaled", "1\\1", ".", "0,5"));
  REQUIRE(scaled);
  CHECK(scaled->volume.slope == 0.5);
  CHECK(says(scaled->notices, "decimal comma"));
}

TEST_CASE("A spacing of DICOM that is no length is said with what was written", "[imaging][lengths]") {
  for (const char *spacing : {"0\\0", "-1\\-1", "0.5", "a\\b", "1.234,5\\1", "1,2,3\\1", "nan\\nan", "0.5 mm\\0.5 mm",
                              "0.5,0.5", "1e9\\1e9"}) {
    INFO(spacing);
    const auto loaded = readVolume(series("bad", spacing));
    checkSpacing(loaded, {1.0, 1.0, 2.5});
    REQUIRE(loaded);
    CHECK(says(loaded->notices, "Pixel Spacing '" + std::string(spacing) + "' is not two numbers above 0"));
    CHECK(says(loaded->notices, "1 mm is taken"));
  }
  const auto absent = readVolume(series("absent", ""));
  checkSpacing(absent, {1.0, 1.0, 2.5});
  CHECK(says(absent->notices, "give no pixel spacing: 1 mm is taken"));
  const auto slope = readVolume(series("slope", "1\\1", ".", "x"));
  REQUIRE(slope);
  CHECK(says(slope->notices, "Rescale Slope 'x' is not a number"));
}

TEST_CASE("Units of NRRD are heeded, of axes as well as of space", "[imaging][lengths]") {
  const auto file = testOutputFolder() / "unit.nrrd";
  const struct {
    std::string fields;
    Vec3 spacing;
    const char *notice;
  } cases[] = {
      {"spacings: 0.5 0.5 2\nunits: \"cm\" \"cm\" \"cm\"\n", {5, 5, 20}, nullptr},
      {"spacings: 0.5 0.5 2\nunits: \"m\" \"mm\" \"um\"\n", {500, 0.5, 0.002}, nullptr},
      {"spacings: 0.5 0.5 2\nunits: mm mm mm\n", {0.5, 0.5, 2}, nullptr},
      {"spacings: 0.5 0.5 2\nunits: \"micrometers\" \"\xc2\xb5m\" \"\xce\xbcm\"\n", {5e-4, 5e-4, 2e-3}, nullptr},
      {"spacings: 0.5 0.5 2\nunits: \"furlong\" \"mm\" \"mm\"\n", {0.5, 0.5, 2}, "'furlong'"},
      {"spacings: 0.5 0.5 2\nunits: \"\" \"\" \"cm\"\n", {0.5, 0.5, 20}, nullptr},
      {"spacings: 0,5 0,5 2\n", {0.5, 0.5, 2}, "decimal comma"},
      {kDirections, {0.5, 0.5, 2}, nullptr},
      {kDirections + "space units: \"cm\" \"cm\" \"cm\"\n", {5, 5, 20}, nullptr},
      {kDirections + "space units: \"m\" \"m\" \"m\"\n", {500, 500, 2000}, nullptr},
      {kDirections + "units: \"cm\" \"cm\" \"cm\"\n", {5, 5, 20}, "none for space"},
      {kDirections + "space units: \"voxels\" \"mm\" \"mm\"\n", {0.5, 0.5, 2}, "'voxels'"},
  };
  for (const auto &one : cases) {
    INFO(one.fields);
    const auto loaded = readVolume(write(file, nrrd("4 5 6", one.fields)));
    checkSpacing(loaded, one.spacing);
    if (loaded && one.notice != nullptr) CHECK(says(loaded->notices, one.notice));
    if (loaded) CHECK(says(loaded->notices, "mm is taken") == (one.notice != nullptr && one.notice[0] == '\''));
  }
  const auto origin = readVolume(write(file, nrrd("4 5 6", kDirections + "space units: \"cm\" \"cm\" \"cm\"\n")));
  REQUIRE(origin);
  checkAt(origin->volume.geometry.worldAt({0, 0, 0}), {10, 20, 30});
  for (const char *fields : {"spacings: 1 1\n", "spacings: 1.000,5 1 1\n", "kinds: domain domain\n",
                             "space: LPS\nspace directions: (0,5,0,0) (0,0,5,0) (0,0,2,0)\nspace origin: (0,0,0,0)\n",
                             "space: LPS\nspace directions: (1,0,0) (0,1,0)\n",
                             "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nunits: \"cm\" \"mm\" \"mm\"\n"}) {
    INFO(fields);
    CHECK_FALSE(readVolume(write(file, nrrd("4 5 6", fields))));
  }
}

TEST_CASE("Axes of NRRD that are lists or vectors are not taken for space", "[imaging][lengths]") {
  const auto file = testOutputFolder() / "axes.nrrd";
  const struct {
    const char *sizes;
    std::string fields;
    std::array<std::size_t, 3> size;
    Vec3 spacing;
    std::size_t times;
    bool isColour;
  } cases[] = {
      {"2 4 5 6", "kinds: list domain domain domain\nspacings: nan 1 2 3\n", {4, 5, 6}, {1, 2, 3}, 2, false},
      {"4 5 6 2", "kinds: domain domain domain list\nspacings: 1 2 3 nan\n", {4, 5, 6}, {1, 2, 3}, 2, false},
      {"4 5 6 2", "kinds: domain domain domain time\nspacings: 1 2 3 0.1\n", {4, 5, 6}, {1, 2, 3}, 2, false},
      {"2 4 5 6",
       "kinds: list domain domain domain\nunits: \"\" \"cm\" \"cm\" \"cm\"\nspacings: nan 1 2 3\n",
       {4, 5, 6},
       {10, 20, 30},
       2,
       false},
      {"3 4 5 6", "kinds: RGB-color domain domain domain\nspacings: nan 1 2 3\n", {4, 5, 6}, {1, 2, 3}, 1, true},
      {"3 4 5 6", "kinds: 3-color domain domain domain\nspacings: nan 1 2 3\n", {4, 5, 6}, {1, 2, 3}, 1, true},
      {"3 4 5 6", "spacings: nan 1 2 3\n", {4, 5, 6}, {1, 2, 3}, 1, true},
      {"4 5 6 2", "spacings: 1 2 3 nan\n", {4, 5, 6}, {1, 2, 3}, 2, false},
      {"2 4 5", "kinds: list domain domain\nspacings: nan 1 2\n", {4, 5, 1}, {1, 2, 1}, 2, false},
      {"4 5 2", "kinds: domain domain list\nspacings: 1 2 nan\n", {4, 5, 1}, {1, 2, 1}, 2, false},
      {"2 4 5 6",
       "kinds: list domain domain domain\nspace: LPS\nspace directions: none (1,0,0) (0,2,0) (0,0,3)\n",
       {4, 5, 6},
       {1, 2, 3},
       2,
       false},
      {"4 5 2",
       "kinds: domain domain list\nspace: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\n",
       {4, 5, 1},
       {1, 2, 1},
       2,
       false},
  };
  for (const auto &one : cases) {
    INFO(one.sizes << " " << one.fields);
    const auto loaded = readVolume(write(file, nrrd(one.sizes, one.fields)));
    checkSpacing(loaded, one.spacing);
    if (!loaded) continue;
    CHECK(loaded->volume.geometry.size == one.size);
    CHECK(loaded->times == one.times);
    CHECK(loaded->volume.colours.empty() != one.isColour);
  }
  const auto contrary = readVolume(write(file, nrrd(cases[11].sizes, cases[11].fields)));
  REQUIRE(contrary);
  CHECK(says(contrary->notices, "Axis 3 has a direction in space and is of kind 'list'"));
  const auto unsaid = readVolume(write(file, nrrd("4 5 6 2", "spacings: 1 2 3 4\n")));
  REQUIRE(unsaid);
  CHECK(says(unsaid->notices, "which of its 4 axes lie in space"));
  for (const auto &[sizes, fields] : {std::pair{"3 4 5 6", "kinds: vector domain domain domain\n"},
                                      {"4 5 6 3", "kinds: domain domain domain vector\n"}})
    CHECK_FALSE(readVolume(write(file, nrrd(sizes, fields, "float"))));
}

TEST_CASE("Lengths of MetaImage are read in their unit, with points or commas", "[imaging][lengths]") {
  const auto file = testOutputFolder() / "lengths.mha";
  const struct {
    std::string bytes;
    Vec3 spacing;
    const char *notice;
  } cases[] = {
      {meta("0.5 0.75 2"), {0.5, 0.75, 2}, nullptr},
      {meta("0,5 0,75 2"), {0.5, 0.75, 2}, "decimal comma"},
      {meta("0,5 0,75 2,0", "", "1,5 2 3"), {0.5, 0.75, 2}, "decimal comma"},
      {meta("0.5, 0.75, 2"), {0.5, 0.75, 2}, nullptr},
      {meta("0.5 0.75 2", "DistanceUnits = cm\n"), {5, 7.5, 20}, nullptr},
      {meta("0.5 0.75 2", "DistanceUnits = um\n"), {5e-4, 7.5e-4, 2e-3}, nullptr},
      {meta("0.5 0.75 2", "DistanceUnits = mm\n"), {0.5, 0.75, 2}, nullptr},
      {meta("0.5 0.75 2", "DistanceUnits = ?\n"), {0.5, 0.75, 2}, nullptr},
      {meta("0.5 0.75 2", "DistanceUnits = parsec\n"), {0.5, 0.75, 2}, "'parsec'"},
      {meta("0.5 0.75 2", "ElementSize = 9 9 9\n"), {0.5, 0.75, 2}, nullptr},
      {meta("0.5 0.75 2 9"), {0.5, 0.75, 2}, nullptr},
  };
  for (const auto &one : cases) {
    INFO(one.bytes);
    const auto loaded = readVolume(write(file, one.bytes));
    checkSpacing(loaded, one.spacing);
    if (loaded) CHECK(loaded->notices.empty() == (one.notice == nullptr));
    if (loaded && one.notice != nullptr) CHECK(says(loaded->notices, one.notice));
  }
  const auto far = readVolume(write(file, meta("1 1 1", "DistanceUnits = cm\n")));
  REQUIRE(far);
  checkAt(far->volume.geometry.worldAt({0, 0, 0}), {10, 20, 30});
  for (const char *spacing : {"1 1", "1.000,5 1 1", "nan 1 1", "0 1 1", "1 1 a"}) {
    INFO(spacing);
    const auto refused = readVolume(write(file, meta(spacing)));
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("lengths.mha"));
  }
}

TEST_CASE("The unit of a NIfTI is heeded, and without one lengths that are unusual in mm are reported",
          "[imaging][lengths]") {
  const auto file = testOutputFolder() / "unit.nii";
  for (const auto &[unit, factor] : {std::pair{1, 1000.0},
                                     {2, 1.0},
                                     {3, 1e-3},
                                     {0, 1.0},
                                     {4, 1.0},
                                     {7, 1.0},
                                     {8, 1.0},
                                     {10, 1.0},
                                     {9, 1000.0},
                                     {11, 1e-3}}) {
    INFO(unit);
    const auto loaded = readVolume(write(file, nifti(unit)));
    REQUIRE(loaded);
    CHECK_THAT(loaded->volume.geometry.spacing()[2], WithinRel(3.0 * factor, 1e-6));
    CHECK_FALSE(says(loaded->notices, "unusual in mm"));
    CHECK(says(loaded->notices, "is not known") == ((unit & 7) > 3));
  }
  for (const auto &[size, isUnusual] : {std::pair{1e-3F, true}, {0.1F, false}, {5.0F, false}, {1000.0F, true}}) {
    INFO(size);
    const auto loaded = readVolume(write(file, nifti(0, size)));
    REQUIRE(loaded);
    CHECK(says(loaded->notices, "unusual in mm: mm is taken") == isUnusual);
  }
}

TEST_CASE("Voxels left over behind those of the header are said", "[imaging][lengths]") {
  const auto folder = emptyFolder("left");
  const std::string directions = "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n";
  const std::string raw = nrrd("4 5 6", directions);
  std::string text = raw;
  text.replace(text.find("encoding: raw"), 13, "encoding: ascii");
  text.resize(text.size() - 120);
  std::string numbers;
  for (int n = 0; n < 120; ++n) numbers += "1 ";
  std::string zipped = raw;
  zipped.replace(zipped.find("encoding: raw"), 13, "encoding: gzip");
  zipped.resize(zipped.size() - 120);
  const auto packed = [&](std::size_t bytes) { return gzipped(std::string(bytes, '\1'), folder / "packed"); };
  const std::string detached =
      "ObjectType = Image\nNDims = 3\nDimSize = 4 5 6\nElementType = MET_UCHAR\nElementSpacing "
      "= 1 1 1\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\n";
  write(folder / "v.raw", std::string(150, '\1'));
  write(folder / "exact.raw", std::string(120, '\1'));
  std::string image(nifti(2));
  const auto dicom = [](std::size_t pixels) {
    return Picture(4, 3).pixels(std::vector<std::uint16_t>(pixels, 7)).file();
  };
  const struct {
    const char *name;
    std::string bytes;
    const char *notice;  ///< nullptr: no rest
  } cases[] = {
      {"raw.nrrd", raw, nullptr},
      {"more.nrrd", raw + std::string(40, 'x'), "holds 40 bytes behind the 120"},
      {"text.nrrd", text + numbers, nullptr},
      {"more-text.nrrd", text + numbers + "5 6", "more numbers than the 120 voxels"},
      {"zip.nrrd", zipped + packed(120), nullptr},
      {"more-zip.nrrd", zipped + packed(500), "holds 380 bytes behind the 120"},
      {"more.mhd", detached + "ElementDataFile = v.raw\n", "holds 30 bytes behind the 120"},
      {"exact.mhd", detached + "ElementDataFile = exact.raw\n", nullptr},
      {"end.mhd", detached + "HeaderSize = -1\nElementDataFile = v.raw\n", nullptr},
      {"head.mhd", detached + "HeaderSize = 30\nElementDataFile = v.raw\n", nullptr},
      {"some.mhd", detached + "HeaderSize = 10\nElementDataFile = v.raw\n", "holds 20 bytes behind the 120"},
      {"local.mha", detached + "ElementDataFile = LOCAL\n" + std::string(121, 'x'), "holds 1 bytes behind the 120"},
      {"more.nii", image + "abc", "holds 3 bytes behind the 24"},
      {"exact.nii", image, nullptr},
      {"more.nii.gz", gzipped(image + std::string(24, 'x'), folder / "z"), "holds 24 bytes behind the 24"},
      {"exact.nii.gz", gzipped(image, folder / "z"), nullptr},
      {"exact.dcm", dicom(12), nullptr},
      {"more.dcm", dicom(24), "holds 24 bytes behind the 24"},
  };
  for (const auto &one : cases) {
    INFO(one.name);
    const auto at = emptyFolder("left/" + std::string(one.name).substr(0, std::string(one.name).find('.')) + "-" +
                                std::string(one.name).substr(std::string(one.name).find('.') + 1)) /
                    one.name;
    std::filesystem::copy_file(folder / "v.raw", at.parent_path() / "v.raw");
    std::filesystem::copy_file(folder / "exact.raw", at.parent_path() / "exact.raw");
    const auto loaded = readVolume(write(at, one.bytes));
    if (!loaded) {
      FAIL_CHECK(loaded.error().message);
      continue;
    }
    for (const std::string &notice : loaded->notices) UNSCOPED_INFO(notice);
    CHECK(says(loaded->notices, "left out") == (one.notice != nullptr));
    if (one.notice != nullptr) CHECK(says(loaded->notices, one.notice));
  }
}
