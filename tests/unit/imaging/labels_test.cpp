// SPDX-License-Identifier: Apache-2.0
// Label maps: which voxels are labels, the sources of names and colours. Also text encodings and unusual headers.
#include <cmath>

#include "c3de/imaging/writing.h"
#include "images.h"

using namespace images;

namespace {

/// A NRRD whose voxels are stored as text.
std::filesystem::path textNrrd(const std::string &name, const std::string &type, const std::string &sizes,
                               const std::string &voxels, const std::string &more = "") {
  const auto dimension = std::count(sizes.begin(), sizes.end(), ' ') + 1;
  return write(testOutputFolder() / name, "NRRD0004\ntype: " + type + "\ndimension: " + std::to_string(dimension) +
                                              "\nsizes: " + sizes + "\nencoding: ascii\n" + more + "\n" + voxels);
}
const std::string kPlaced = "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n";

}  // namespace

TEST_CASE("Labels are whole numbers, and the first voxel that is none is named", "[imaging]") {
  const auto good = readLabelMap(textNrrd("good.nrrd", "float", "2 2 1", "0 3 3 17", kPlaced));
  REQUIRE(good);
  REQUIRE(good->labels.labels.size() == 2);
  CHECK(good->labels.labels[0].name == "label 3");
  CHECK(good->labels.labels[1].value == 17);
  CHECK(good->notices.empty());
  for (const auto &[voxels, wrong] : {std::pair{"0 1 2.5 3", "voxel (0, 1, 0) is 2.5"},
                                      {"0 1 2.02 3", "voxel (0, 1, 0) is 2.0"},
                                      {"0 -1 2 -1024", "holds -1 and, at voxel (1, 1, 0), -1024"}}) {
    const auto refused = readLabelMap(textNrrd("bad.nrrd", "float", "2 2 1", voxels, kPlaced));
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains(wrong) && Contains("accepted as labels: whole numbers from 0"));
  }
}

TEST_CASE("Labels that are nearly whole are rounded, and what is no number is background, with a notice", "[imaging]") {
  using Labels = std::vector<std::uint16_t>;
  struct Case {
    const char *type, *voxels;
    Labels expected;
    std::vector<const char *> notices;
  };
  const std::vector<Case> cases{
      {"float",
       "0 4.9999 4.9999 1",
       {0, 5, 5, 1},
       {"2 voxels are not a whole number, by up to 0.0001", "(1, 0, 0) is 4.99"}},
      {"double", "5.0001 0 0 5", {5, 0, 0, 5}, {"1 voxel is not a whole number"}},
      {"float", "-0.001 5 5.009 5", {0, 5, 5, 5}, {"2 voxels are not a whole number, by up to 0.009"}},
      {"float", "nan 5 nan 5", {0, 5, 0, 5}, {"2 voxels are not finite numbers and are treated as background"}},
      {"double", "nan 5 0 5", {0, 5, 0, 5}, {"1 voxel is not a finite number and is treated as background"}},
      {"short", "-1 5 0 5", {0, 5, 0, 5}, {"1 voxel of -1 is treated as background"}},
      {"float", "-1 5 -1 5", {0, 5, 0, 5}, {"2 voxels of -1 are treated as background"}},
      {"int", "-32768 5 -32768 7", {0, 5, 0, 7}, {"2 voxels of -32768"}},
      {"float", "-0.9999 5 nan 6.999", {0, 5, 0, 7}, {"of -1 is treated", "not a finite", "2 voxels are not a whole"}},
      {"float", "0 5 5 6", {0, 5, 5, 6}, {}}};
  for (const Case &one : cases) {
    CAPTURE(one.voxels);
    const auto read = readLabelMap(textNrrd("nearly.nrrd", one.type, "2 2 1", one.voxels, kPlaced));
    if (!read) FAIL(read.error().message);
    CHECK(read->labels.voxels == one.expected);
    CHECK(read->notices.empty() == one.notices.empty());
    for (const char *notice : one.notices) CHECK(says(read->notices, notice));
  }
}

TEST_CASE("Labels above 65535 are renumbered and keep their names", "[imaging]") {
  // Of the mouse brain atlas of the Allen Institute, whose numbers reach 614454277.
  const auto file = textNrrd("atlas.nrrd", "uint32", "2 2 2", "0 1 70000 614454277 3 70000 0 1", kPlaced);
  const auto plain = readLabelMap(file);
  if (!plain) FAIL(plain.error().message);
  CHECK(plain->labels.voxels == std::vector<std::uint16_t>{0, 1, 2, 4, 3, 2, 0, 1});
  REQUIRE(plain->labels.labels.size() == 4);
  CHECK(plain->labels.labels[1].name == "label 70000");
  CHECK(plain->labels.labels[3].name == "label 614454277");
  CHECK(says(plain->notices, "2 labels above 65535 are renumbered: 70000 is 2, 614454277 is 4"));

  // A number in the table remains reserved for its label.
  const auto beside = write(testOutputFolder() / "atlas.txt", "2 cortex\n614454277 supraoculomotor\n");
  const auto named = readLabelMap(file);
  std::filesystem::remove(beside);
  REQUIRE(named);
  CHECK(named->labels.voxels == std::vector<std::uint16_t>{0, 1, 4, 5, 3, 4, 0, 1});
  CHECK(named->labels.labels.back().name == "supraoculomotor");
  CHECK(named->labels.labels[2].name == "label 70000");

  std::string many;
  for (int n = 1; n <= 65536; ++n) many += std::to_string(n + (n > 65535 ? 10 : 0)) + " ";
  const auto refused = readLabelMap(textNrrd("toomany.nrrd", "uint32", "256 256 1", many, kPlaced));
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("more than 65535 different"));
}

TEST_CASE("Label maps that other programs have spoilt are read", "[imaging]") {
  {
    C3DE_DATA_OR_SKIP(file, "found/labels/almost.nii.gz");
    const auto read = readLabelMap(file);
    if (!read) FAIL(read.error().message);
    REQUIRE(read->labels.labels.size() == 2);
    CHECK(read->labels.labels[0].value == 5);
    CHECK(read->labels.labels[1].value == 7015);
    CHECK(says(read->notices, "8257 voxels are not a whole number, by up to 0.00049, and rounded to the label"));
  }
  C3DE_DATA_OR_SKIP(file, "found/labels/nanbg.nii.gz");
  const auto read = readLabelMap(file);
  if (!read) FAIL(read.error().message);
  REQUIRE(read->labels.labels.size() == 2);
  CHECK(read->labels.labels[0].value == 5);
  CHECK(read->labels.labels[1].value == 7);
  CHECK(says(read->notices, "55743 voxels are not finite numbers and are treated as background"));
}

TEST_CASE("Names come from a table beside the file, in each of its forms", "[imaging]") {
  const auto image = textNrrd("organs.nrrd", "uint8", "4 1 1", "0 1 2 5", kPlaced);
  struct Table {
    const char *file, *text;
  };
  for (const Table &table :
       {Table{"organs.nrrd.txt", "1 spleen 2001\r\n2 kidney_right 2002\r\n5 liver 9\r\n"},
        Table{"organs.txt", "0\tnothing\r\n1\tspleen\r\n5\tliver\n"},
        Table{"organs.label",
              "# ITK-SNAP\n 0 0 0 0 0 0 0 \"Clear Label\"\n 1 255 0 0 1 1 1 \"spleen\"\n 5 0 255 0 1 1 1 \"liver\"\n"},
        Table{"organs.ctbl", "# Color table\n1 spleen 255 0 0 255\n5 liver 0 255 0 255\n"}}) {
    INFO(table.file);
    const auto beside = write(testOutputFolder() / table.file, table.text);
    const auto loaded = readLabelMap(image);
    std::filesystem::remove(beside);
    REQUIRE(loaded);
    REQUIRE(loaded->labels.labels.size() == 3);
    CHECK(loaded->labels.labels[0].name == "spleen");
    CHECK(loaded->labels.labels[2].name == "liver");
    CHECK(says(loaded->notices, table.file));
    const bool coloured = std::string(table.file) == "organs.label" || std::string(table.file) == "organs.ctbl";
    if (coloured) CHECK(loaded->labels.labels[2].colour == std::array<float, 3>{0.0f, 1.0f, 0.0f});
  }
}

TEST_CASE("Names of a table may have several words, which end where numbers begin", "[imaging]") {
  const auto image = textNrrd("words.nrrd", "uint8", "4 1 1", "0 1 2 5", kPlaced);
  const auto beside =
      write(testOutputFolder() / "words.txt", "1 liver, left lobe\n2  spinal  cord 2001\n5 vena cava 0 255 0 255\n");
  const auto loaded = readLabelMap(image);
  std::filesystem::remove(beside);
  REQUIRE(loaded);
  REQUIRE(loaded->labels.labels.size() == 3);
  CHECK(loaded->labels.labels[0].name == "liver, left lobe");
  CHECK(loaded->labels.labels[1].name == "spinal cord");
  CHECK(loaded->labels.labels[2].name == "vena cava");
  CHECK(loaded->labels.labels[2].colour == std::array<float, 3>{0.0f, 1.0f, 0.0f});
}

TEST_CASE("Names and colours of Slicer's segments are read", "[imaging]") {
  const std::string segments =
      "Segment0_LabelValue:=5\nSegment0_Name:=liver\nSegment0_Color:=1 0 "
      "0\nSegment1_LabelValue:=1\nSegment1_Name:=spleen\nSegment1_Layer:=0\n";
  const auto file = textNrrd("a.seg.nrrd", "uint8", "4 1 1", "0 1 2 5", kPlaced + segments);
  const auto loaded = readLabelMap(file);
  REQUIRE(loaded);
  const auto list = listSeries(file), plain = listSeries(textNrrd("plain.nrrd", "uint8", "4 1 1", "0 1 2 5", kPlaced));
  REQUIRE((list && plain));
  CHECK(list->front().isSegmentation);
  CHECK_FALSE(plain->front().isSegmentation);
  CHECK(loaded->labels.labels[0].name == "spleen");
  CHECK(loaded->labels.labels[1].name == "label 2");
  CHECK(loaded->labels.labels[2].name == "liver");
  CHECK(loaded->labels.labels[2].colour == std::array<float, 3>{1.0f, 0.0f, 0.0f});
}

TEST_CASE("Segments that overlap are read as layers, each with its names and colours", "[imaging]") {
  // Voxel 1 is liver and tumour; each layer has its own label 1.
  const std::string head =
      "space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,7)\nkinds: list domain domain "
      "domain\n";
  const std::string segments =
      "Segment0_Layer:=0\nSegment0_LabelValue:=1\nSegment0_Name:=liver\nSegment0_Color:=1 0 0\nSegment0_Extent:=0 1 0 "
      "0 0 0\n"
      "Segment1_Layer:=0\nSegment1_LabelValue:=2\nSegment1_Name:=spleen\nSegment1_Color:=0 1 0\n"
      "Segment2_Layer:=1\nSegment2_LabelValue:=1\nSegment2_Name:=tumour\nSegment2_Color:=0 0 1\n";
  const auto file = textNrrd("layers.seg.nrrd", "uint8", "2 4 1 1", "1 0  1 1  2 0  0 0", head + segments);
  const auto loaded = readLabelMap(file);
  if (!loaded) FAIL(loaded.error().message);
  CHECK(loaded->labels.voxels == std::vector<std::uint16_t>{1, 1, 2, 0});
  REQUIRE(loaded->labels.labels.size() == 2);
  CHECK(loaded->labels.labels[0].name == "liver");
  CHECK(loaded->labels.labels[1].name == "spleen");
  REQUIRE(loaded->layers.size() == 1);
  CHECK(loaded->layers[0].voxels == std::vector<std::uint16_t>{0, 1, 0, 0});
  CHECK(sameGrid(loaded->layers[0].geometry, loaded->labels.geometry));
  REQUIRE(loaded->layers[0].labels.size() == 1);
  CHECK(loaded->layers[0].labels[0].name == "tumour");
  CHECK(loaded->layers[0].labels[0].colour == std::array<float, 3>{0.0f, 0.0f, 1.0f});
  CHECK(says(loaded->notices, "2 layers"));
  const auto image = readVolume(file);
  REQUIRE(image);
  CHECK(image->times == 1);
  CHECK(says(image->notices, "2 layers of a segmentation"));
  ReadOptions later;
  later.time = 1;
  CHECK_FALSE(readVolume(file, later));
  CHECK_FALSE(readLabelMap(file, later));

  // Slicer 4.10: a component for each segment.
  const auto old = readLabelMap(textNrrd("old.seg.nrrd", "uint8", "2 4 1 1", "1 0  1 1  0 1  0 0",
                                         head + "Segment0_Name:=liver\nSegment1_Name:=tumour\n"));
  REQUIRE(old);
  CHECK(old->labels.labels[0].name == "liver");
  REQUIRE(old->layers.size() == 1);
  CHECK(old->layers[0].labels[0].name == "tumour");
  CHECK(old->layers[0].voxels == std::vector<std::uint16_t>{0, 1, 1, 0});
  for (const char *wrong : {"Segment0_Layer:=-5\n", "Segment0_Layer:=1e300\n", "Segment0_Layer:=nan\n",
                            "Segment99999999999999999999_Name:=a\n"})
    CHECK(readLabelMap(textNrrd("odd.seg.nrrd", "uint8", "2 4 1 1", "1 0  1 1  0 1  0 0",
                                head + wrong + "Segment0_LabelValue:=1\nSegment0_Name:=liver\n")));
}

TEST_CASE("A single label without a name is called after its file", "[imaging]") {
  for (const auto &[file, name] : {std::pair{"heart.nrrd", "heart"},
                                   {"vertebrae_T12.nrrd", "vertebra T12"},
                                   {"Liver-mask.seg.nrrd", "Liver"},
                                   {"kidney_left.nrrd", "kidney left"},
                                   {"label.nrrd", "label 3"},
                                   {"segmentation_1.nrrd", "label 3"}}) {
    CAPTURE(file);
    const auto loaded = readLabelMap(textNrrd(file, "uint8", "2 1 1", "0 3", kPlaced));
    REQUIRE(loaded);
    REQUIRE(loaded->labels.labels.size() == 1);
    CHECK(loaded->labels.labels[0].name == name);
  }
  CHECK(readLabelMap(textNrrd("heart.nrrd", "uint8", "2 1 1", "1 3", kPlaced))->labels.labels[0].name == "label 1");
  CHECK(readLabelMap(
            textNrrd("a.nrrd", "uint8", "2 1 1", "0 3", kPlaced + "Segment0_LabelValue:=3\nSegment0_Name:=spleen\n"))
            ->labels.labels[0]
            .name == "spleen");
  C3DE_DATA_OR_SKIP(file, "volume/totalseg/single_organs/kidney_left.nii.gz");
  CHECK(readLabelMap(file)->labels.labels[0].name == "kidney left");
}

TEST_CASE("Colours of labels that have none are told apart", "[imaging]") {
  std::string voxels;
  for (int v = 0; v < 41; ++v) voxels += std::to_string(v) + " ";
  const auto loaded = readLabelMap(textNrrd("many.nrrd", "uint8", "41 1 1", voxels, kPlaced));
  REQUIRE(loaded);
  REQUIRE(loaded->labels.labels.size() == 40);
  double nearest = 10.0;
  for (std::size_t a = 0; a < 40; ++a)
    for (std::size_t b = a + 1; b < 40; ++b) {
      double square = 0.0;
      for (std::size_t c = 0; c < 3; ++c)
        square += std::pow(loaded->labels.labels[a].colour[c] - loaded->labels.labels[b].colour[c], 2);
      nearest = std::min(nearest, std::sqrt(square));
    }
  CHECK(nearest > 0.02);  // five steps of 256 in the middle of the range
}

TEST_CASE("The atlas of MRIcron is read with its names", "[imaging]") {
  const std::filesystem::path atlas = "/usr/share/mricron/templates/aal.nii.gz";
  if (!std::filesystem::exists(atlas)) C3DE_SKIP("package mricron-data is not installed");
  const auto loaded = readLabelMap(atlas);
  REQUIRE(loaded);
  CHECK(loaded->labels.labels.size() == 116);
  CHECK(loaded->labels.labels.front().name == "Precentral_L");
  CHECK(loaded->labels.labels.back().name == "Vermis_10");
  // Left is where LPS x is positive.
  double sum = 0.0, count = 0.0;
  const auto &g = loaded->labels.geometry;
  for (std::size_t v = 0; v < loaded->labels.voxels.size(); ++v)
    if (loaded->labels.voxels[v] == 1) {
      sum += g.worldAt({static_cast<double>(v % g.size[0]), static_cast<double>(v / g.size[0] % g.size[1]),
                        static_cast<double>(v / (g.size[0] * g.size[1]))})[0];
      count += 1.0;
    }
  CHECK(sum / count > 20.0);
}

TEST_CASE("Spaces of NRRD are turned to LPS, units to millimetres", "[imaging]") {
  for (const auto &[space, turned] : {std::pair{"left-posterior-superior", Vec3{1, 2, 3}},
                                      {"right-anterior-superior", Vec3{-1, -2, 3}},
                                      {"LAS", Vec3{1, -2, 3}}}) {
    const auto loaded = readVolume(textNrrd(
        "space.nrrd", "short", "1 1 2", "4 5",
        std::string("space: ") + space + "\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (1,2,3)\n"));
    REQUIRE(loaded);
    checkAt(loaded->volume.geometry.worldAt({0, 0, 0}), turned);
    CHECK(loaded->notices.empty());
  }
  const auto metres = readVolume(textNrrd("m.nrrd", "short", "1 1 2", "4 5",
                                          "space: LPS\nspace units: \"m\" \"m\" \"m\"\nspace directions: (.002,0,0) "
                                          "(0,.002,0) (0,0,.002)\nspace origin: (.001,0,0)\n"));
  REQUIRE(metres);
  checkAt(metres->volume.geometry.worldAt({0, 0, 1}), {1, 0, 2});
  const auto unplaced = readVolume(textNrrd("u.nrrd", "short", "1 1 2", "4 5", "spacings: 2 3 nan\n"));
  REQUIRE(unplaced);
  CHECK(says(unplaced->notices, "only its spacing"));
  CHECK(says(unplaced->notices, "no spacing along axis 3"));
}

TEST_CASE("64-bit integers become 32-bit where they fit", "[imaging]") {
  const auto small = readVolume(textNrrd("small.nrrd", "int64", "3 1 1", "-2 0 2147483647", kPlaced));
  REQUIRE(small);
  CHECK(std::string(small->volume.scalarTypeName()) == "int32");
  const auto large = readVolume(textNrrd("large.nrrd", "int64", "3 1 1", "-2 0 2147483648", kPlaced));
  REQUIRE(large);
  CHECK(std::string(large->volume.scalarTypeName()) == "float64");
  CHECK(large->volume.value(2, 0, 0) == 2147483648.0);
  CHECK_FALSE(large->notices.empty());
}

TEST_CASE("Voxels in numbered files, behind lines and bytes, and as hexadecimal digits are read", "[imaging]") {
  const auto folder = emptyFolder("parts");
  for (int n = 3; n <= 5; ++n) {
    std::string bytes = "title\nx";
    bytes += {static_cast<char>(n), 0, static_cast<char>(10 * n), 0};
    write(folder / ("s00" + std::to_string(n) + ".raw"), bytes);
  }
  const std::string head =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 3\nendian: little\nencoding: raw\n" + kPlaced;
  for (const char *where : {"line skip: 1\nbyte skip: 1\ndata file: s%03d.raw 3 5 1\n",
                            "byte skip: -1\ndata file: LIST\ns003.raw\ns004.raw\ns005.raw\n"}) {
    const auto loaded = readVolume(write(folder / "parts.nhdr", head + where));
    if (!loaded) INFO(loaded.error().message);
    REQUIRE(loaded);
    CHECK(loaded->volume.voxels == Voxels(std::vector<std::int16_t>{3, 30, 4, 40, 5, 50}));
  }
  const auto absent = readVolume(write(folder / "absent.nhdr", head + "data file: s%03d.raw 3 6 1\n"));
  REQUIRE_FALSE(absent);
  const auto list =
      readVolume(write(folder / "list.mhd",
                       "ObjectType = Image\nNDims = 3\nDimSize = 2 1 3\nElementType = MET_SHORT\nElementSpacing = 1 1 "
                       "1\nHeaderSize = -1\n"
                       "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementDataFile = s%03d.raw 3 5 1\n"));
  REQUIRE(list);
  CHECK(list->volume.value(1, 0, 2) == 50.0);
  const auto hex = readVolume(write(
      folder / "hex.nrrd",
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 1\nendian: big\nencoding: hex\n" + kPlaced + "\n01 02ff\nFE"));
  REQUIRE(hex);
  CHECK(hex->volume.voxels == Voxels(std::vector<std::int16_t>{0x0102, -2}));
}

TEST_CASE("Labels have the names and colours of the table inside of a NIfTI", "[imaging]") {
  const auto folder = emptyFolder("inside");
  LabelMap labels;
  labels.geometry.size = {4, 2, 2};
  labels.voxels = {0, 1, 5, 7, 0, 1, 5, 7, 0, 1, 5, 7, 0, 1, 5, 7};
  REQUIRE(writeLabelMap(folder / "plain.nii", labels));
  const std::string xml =
      "<?xml version=\"1.0\"?> <CaretExtension><VolumeInformation Index=\"0\"><LabelTable>\n"
      "<Label Key=\"5\" Red=\"0\" Green=\"1\" Blue=\"0.5\" Alpha=\"1\"><![CDATA[liver]]></Label>\n"
      "<Label Key=\"1\"> left kidney </Label><Label Key=\"-1\"><![CDATA[no label]]></Label><Label Key=\"7\"></Label>\n"
      "</LabelTable></VolumeInformation></CaretExtension>";
  const auto withExtensions = [&](std::int32_t excess) {
    std::string bytes = bytesOf(folder / "plain.nii"), extensions;
    const auto add = [&](std::int32_t code, std::string text, std::int32_t more) {
      text.resize((text.size() + 8 + 15) / 16 * 16 - 8);
      const std::int32_t numbers[2] = {static_cast<std::int32_t>(text.size()) + 8 + more, code};
      extensions.append(reinterpret_cast<const char *>(numbers), sizeof numbers) += text;
    };
    add(6, "a comment", 0);
    add(30, xml, excess);
    const float offset = 352.0f + static_cast<float>(extensions.size());
    bytes.replace(108, 4, reinterpret_cast<const char *>(&offset), 4);
    bytes[348] = 1;
    return readLabelMap(write(folder / "named.nii", bytes.insert(352, extensions)));
  };
  const auto named = withExtensions(0);
  REQUIRE(named);
  CHECK(named->labels.voxels == labels.voxels);
  REQUIRE(named->labels.labels.size() == 3);
  CHECK(named->labels.labels[0].name == "left kidney");
  CHECK(named->labels.labels[1].name == "liver");
  CHECK(named->labels.labels[2].name == "label 7");
  CHECK(named->labels.labels[1].colour[0] == 0.0f);
  CHECK(named->labels.labels[1].colour[1] == 1.0f);
  CHECK_THAT(named->labels.labels[1].colour[2], WithinAbs(0.2140, 1e-3));  // half of sRGB, linear
  const auto damaged = withExtensions(16);                                 // extends into the voxels
  REQUIRE(damaged);
  CHECK(damaged->labels.voxels == labels.voxels);
  CHECK(damaged->labels.labels[1].name == "label 5");
}

TEST_CASE("Organs of TotalSegmentator have their names", "[imaging]") {
  C3DE_DATA_OR_SKIP(file, "volume/totalseg/example_seg.nii.gz");
  const auto loaded = readLabelMap(file);
  REQUIRE(loaded);
  REQUIRE(loaded->labels.labels.size() == 41);
  for (const auto &[number, name] : {std::pair{1, "spleen"}, {2, "kidney_right"}, {3, "kidney_left"}, {5, "liver"}}) {
    const auto &all = loaded->labels.labels;
    const auto found =
        std::find_if(all.begin(), all.end(), [wanted = number](const LabelMap::Label &l) { return l.value == wanted; });
    REQUIRE(found != all.end());
    CHECK(found->name == name);
  }
}
