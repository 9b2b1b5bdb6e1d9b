// SPDX-License-Identifier: Apache-2.0
// Header fields that a format does not define, and colours.
#include <cstring>

#include "images.h"

using namespace images;

namespace {

std::string nrrd(const std::string &fields) {
  return "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: ascii\n" + fields + "\n1 2";
}
const std::string kDirections = "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n";

std::string meta(const std::string &keys) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\nElementSpacing = 1 1 "
         "1\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n" +
         keys + "ElementDataFile = LOCAL\nab";
}

}  // namespace

TEST_CASE("A field that NRRD does not know is an error that names the nearest one", "[imaging]") {
  const auto file = testOutputFolder() / "field.nrrd";
  for (const auto &[wrong, right] : {std::pair{"space orgin: (0,0,100)", "space origin"},
                                     {"space_directions: (1,0,0) (0,1,0) (0,0,1)", "space directions"},
                                     {"spacing: 1 1 1", "spacings"},
                                     {"endiann: little", "endian"}}) {
    CAPTURE(wrong);
    const auto refused = readVolume(write(file, nrrd(kDirections + wrong + "\n")));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::input);
    CHECK_THAT(refused.error().message,
               Contains("did you mean '" + std::string(right) + "'?") && Contains("key:=value"));
  }
  const auto far = readVolume(write(file, nrrd(kDirections + "patient shoe size: 43\n")));
  REQUIRE_FALSE(far);
  CHECK_THAT(far.error().message, Contains("'patient shoe size'") && !Contains("did you mean"));
  const auto twice = readVolume(write(file, nrrd(kDirections + "space origin: (0,0,1)\nspace origin: (0,0,100)\n")));
  REQUIRE_FALSE(twice);
  CHECK_THAT(twice.error().message, Contains("'space origin' twice"));
  CHECK_FALSE(readVolume(write(file, nrrd(kDirections + "space origin: (5,6)\n"))));
}

TEST_CASE("All fields of NRRD and pairs of one's own are accepted, a field as a pair is said", "[imaging]") {
  const auto file = testOutputFolder() / "field.nrrd";
  const auto all = readVolume(write(
      file, nrrd(kDirections +
                 "Space Origin: (3,4,5)\ncontent: a\nnumber: 2\nblock size: 0\nthicknesses: nan nan 2\ncenterings: "
                 "cell cell cell\n"
                 "labels: \"x\" \"y\" \"z\"\nkinds: domain domain domain\nmin: 0\nmax: 9\nold min: 0\noldmax: "
                 "9\nendian: little\n"
                 "line skip: 0\nbyteskip: 0\nsample units: \"HU\"\nspace units: \"mm\" \"mm\" \"mm\"\nmeasurement "
                 "frame: (1,0,0) (0,1,0) (0,0,1)\n"
                 "axis mins: nan nan nan\naxismaxs: nan nan nan\nunits: \"mm\" \"mm\" \"mm\"\nmine:=what I like\n")));
  if (!all) FAIL(all.error().message);
  checkAt(all->volume.geometry.worldAt({0, 0, 0}), {3, 4, 5});
  CHECK(all->notices.empty());
  const auto pair = readVolume(write(file, nrrd(kDirections + "space origin:=(3,4,5)\n")));
  REQUIRE(pair);
  CHECK(says(pair->notices, "'space origin:='"));
  CHECK(says(pair->notices, "does not state the position of the first voxel"));
}

TEST_CASE("Keys that MetaImage does not know are said, with the nearest one", "[imaging]") {
  const auto file = testOutputFolder() / "key.mha";
  const auto slip = readVolume(write(file, meta("Ofset = 0 0 100\n")));
  REQUIRE(slip);
  CHECK(says(slip->notices, "'Ofset' (did you mean 'Offset'?)"));
  CHECK(says(slip->notices, "does not state the position of the first voxel (Offset)"));
  const auto own = readVolume(write(file, meta("Offset = 1 2 3\nScannerOfTheWard = seven\n")));
  REQUIRE(own);
  CHECK(says(own->notices, "ignored: ScannerOfTheWard"));
  checkAt(own->volume.geometry.worldAt({0, 0, 0}), {1, 2, 3});
  const auto known = readVolume(write(file, meta("Offset = 1 2 3\nAnatomicalOrientation = RAI\nCenterOfRotation = 0 0 "
                                                 "0\nCompressedData = False\nBinaryData = True\nComment = a\n")));
  REQUIRE(known);
  CHECK(known->notices.empty());
}

TEST_CASE("Colours are read as colours and their luma", "[imaging][colour]") {
  const auto folder = emptyFolder("colours");
  const std::string rgb{"\xff\x00\x00\x00\xff\x00\x00\x00\xff\x10\x80\xf0", 12};
  std::string nifti(352, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(nifti.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  std::memcpy(nifti.data() + 344, "n+1", 3);
  const std::int16_t dim[8] = {3, 2, 2, 1, 1, 1, 1, 1};
  for (std::size_t d = 0; d < 8; ++d) put(40 + 2 * d, dim[d]);
  put(70, std::int16_t{128});
  put(72, std::int16_t{24});
  put(108, 352.0f);
  put(112, 7.0f);  // by the format, colours have no scaling
  put(254, std::int16_t{1});
  for (std::size_t a = 0; a < 3; ++a) put(280 + 20 * a, 1.0f);
  const std::string nrrdFields =
      "sizes: 3 2 2 1\nencoding: raw\nspace: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: "
      "(0,0,0)\n";
  std::string wide;
  for (const char c : rgb) wide += std::string(2, c);  // c * 257
  for (const auto &[name, bytes] :
       {std::pair{std::string("a.nii"), nifti + rgb},
        {"a.nrrd",
         "NRRD0004\ntype: uchar\ndimension: 4\nkinds: RGB-color domain domain domain\n" + nrrdFields + "\n" + rgb},
        {"vector.nrrd",
         "NRRD0004\ntype: uchar\ndimension: 4\nkinds: vector domain domain domain\n" + nrrdFields + "\n" + rgb},
        {"wide.nrrd", "NRRD0004\ntype: ushort\nendian: little\ndimension: 4\nkinds: RGB-color domain domain domain\n" +
                          nrrdFields + "\n" + wide},
        {"a.mha",
         "ObjectType = Image\nNDims = 3\nDimSize = 2 2 1\nElementNumberOfChannels = 3\nElementType = "
         "MET_UCHAR\nElementSpacing = 1 1 1\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
         "Offset = 0 0 0\nElementDataFile = LOCAL\n" +
             rgb}}) {
    CAPTURE(name);
    const auto loaded = readVolume(write(folder / name, bytes));
    if (!loaded) FAIL(loaded.error().message);
    const Volume &volume = loaded->volume;
    CHECK(volume.colours ==
          std::vector<Rgba>{{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {16, 128, 240, 255}});
    CHECK(volume.voxels == Voxels(std::vector<std::uint8_t>{54, 182, 18, 112}));
    CHECK(volume.value(1, 0, 0) == 182.0);
    CHECK(says(loaded->notices, "colour image"));
    const auto labels = readLabelMap(folder / name);
    REQUIRE_FALSE(labels);
    CHECK_THAT(labels.error().message, Contains("colours"));
    for (std::size_t length = bytes.size() - 12; length < bytes.size(); ++length)
      CHECK_FALSE(readVolume(write(folder / name, bytes.substr(0, length))));
  }
  const auto four =
      readVolume(write(folder / "four.nrrd",
                       "NRRD0004\ntype: uchar\ndimension: 4\nkinds: RGBA-color domain domain domain\nsizes: 4 1 1 "
                       "1\nencoding: ascii\nspace: LPS\n"
                       "space directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n1 2 3 4"));
  REQUIRE(four);
  CHECK(four->volume.colours == std::vector<Rgba>{{1, 2, 3, 4}});
}

TEST_CASE("Vectors that are no colours are refused by name", "[imaging][colour]") {
  const auto file = testOutputFolder() / "vector.nrrd";
  const std::string rest =
      "dimension: 4\nsizes: 3 2 1 1\nencoding: ascii\nspace: LPS\nspace directions: none (1,0,0) (0,1,0) "
      "(0,0,1)\nspace origin: (0,0,0)\n";
  for (const char *fields :
       {"type: float\nkinds: vector domain domain domain\n", "type: float\nkinds: RGB-color domain domain domain\n",
        "type: uchar\nkinds: HSV-color domain domain domain\n", "type: short\n"}) {
    const auto refused = readVolume(write(file, "NRRD0004\n" + std::string(fields) + rest + "\n1 2 3 4 5 6"));
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("3 numbers per voxel") && Contains("RGB-color"));
  }
}
