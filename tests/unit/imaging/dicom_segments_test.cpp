// SPDX-License-Identifier: Apache-2.0
// DICOM segmentations as label maps.
#include "dicom_made.h"

using namespace made;

namespace {

constexpr std::uint16_t kColumns = 5, kRows = 3;
constexpr std::size_t kEach = kColumns * kRows;

std::string segment(std::uint16_t number, const std::string &name, const std::vector<std::uint16_t> &lab = {}) {
  return item([&](DicomElements &e) {
    e.add(0x0062, 0x0004, number);
    e.add(0x0062, 0x0005, "LO", name);
    if (!lab.empty()) e.add(0x0062, 0x000d, "US", packed(lab));
  });
}

/// One frame of a segment, at a height.
std::string frame(double z, std::uint16_t number) {
  return item([&](DicomElements &e) {
    e.add(0x0020, 0x9113, std::vector<std::string>{item([&](DicomElements &p) {
            p.add(0x0020, 0x0032, {10.0, 20.0, z});
          })});
    e.add(0x0062, 0x000a, std::vector<std::string>{item([&](DicomElements &p) { p.add(0x0062, 0x000b, number); })});
  });
}

Picture segmentation(const std::string &type, const std::vector<std::string> &segments,
                     const std::vector<std::string> &frames) {
  Picture out(kColumns, kRows);
  out.without(0x00200032).text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4").text(0x00080060, "CS", "SEG");
  out.text(0x00280008, "IS", std::to_string(frames.size())).text(0x00620001, "CS", type).sequence(0x00620002, segments);
  out.text(0x00180088, "DS", "2.5").sequence(0x52009230, frames);
  return type == "BINARY" ? out.bits(1) : out.bits(8);
}

/// Frames without a gap between their bits, the lowest bit first.
std::string bitsOf(const std::vector<std::vector<int>> &frames) {
  std::string bytes;
  std::size_t n = 0;
  for (const std::vector<int> &frame : frames)
    for (std::size_t p = 0; p < kEach; ++p, ++n) {
      if (n % 8 == 0) bytes += '\0';
      if (std::find(frame.begin(), frame.end(), static_cast<int>(p)) != frame.end())
        bytes.back() = static_cast<char>(bytes.back() | 1 << n % 8);
    }
  return bytes;
}

Expected<LoadedLabels> labelsOf(const Picture &picture) {
  return readLabelMap(write(emptyFolder("seg") / "seg.dcm", picture.file()));
}

std::size_t countOf(const LabelMap &map, std::uint16_t label) {
  return static_cast<std::size_t>(std::count(map.voxels.begin(), map.voxels.end(), label));
}

}  // namespace

TEST_CASE("Binary segments lie where their frames are, with names and colours, empty places are empty slices",
          "[imaging]") {
  Picture picture = segmentation("BINARY", {segment(2, "Leber l\xe4ngs", {41661, 41167, 40792}), segment(7, "Niere")},
                                 {frame(5.0, 7), frame(12.5, 2), frame(5.0, 2)});
  picture.text(0x00080005, "CS", "ISO_IR 100").text(0x7fe00010, "OB", bitsOf({{0, 14}, {4, 5, 6}, {1, 2}}));
  const auto loaded = labelsOf(picture);
  REQUIRE(loaded);
  const LabelMap &map = loaded->labels;
  REQUIRE(map.geometry.size == std::array<std::size_t, 3>{kColumns, kRows, 4});
  checkAt(map.geometry.worldAt({0, 0, 0}), {10, 20, 5});
  checkAt(map.geometry.worldAt({1, 1, 3}), {11.5, 22, 12.5});
  CHECK(loaded->layers.empty());
  std::vector<std::uint16_t> expected(4 * kEach, 0);
  for (const std::size_t p : {0u, 14u}) expected[p] = 7;
  for (const std::size_t p : {1u, 2u}) expected[p] = 2;
  for (const std::size_t p : {4u, 5u, 6u}) expected[3 * kEach + p] = 2;
  CHECK(map.voxels == expected);
  REQUIRE(map.labels.size() == 2);
  CHECK(map.labels[0].name == "Leber längs");
  CHECK(map.labels[1].name == "Niere");
  // 3D Slicer's colour of livers, 221 130 101 in sRGB, as its writer stores it (with another white: 0.02).
  CHECK_THAT(map.labels[0].colour[0], WithinAbs(0.723, 0.04));
  CHECK_THAT(map.labels[0].colour[1], WithinAbs(0.223, 0.02));
  CHECK_THAT(map.labels[0].colour[2], WithinAbs(0.130, 0.02));
}

TEST_CASE("Overlapping segments keep all of their voxels, in layers", "[imaging]") {
  Picture picture = segmentation("BINARY", {segment(1, "organ"), segment(2, "tumour"), segment(3, "beside")},
                                 {frame(0, 1), frame(0, 2), frame(0, 3)});
  picture.text(0x7fe00010, "OB", bitsOf({{0, 1, 2, 3}, {2, 3, 4}, {8, 9}}));
  const auto loaded = labelsOf(picture);
  REQUIRE(loaded);
  REQUIRE(loaded->layers.size() == 1);
  CHECK(countOf(loaded->labels, 1) == 4);
  CHECK(countOf(loaded->labels, 3) == 2);
  CHECK(countOf(loaded->layers[0], 2) == 3);
  CHECK(loaded->layers[0].labels.front().name == "tumour");
  CHECK(sameGrid(loaded->labels.geometry, loaded->layers[0].geometry));
  CHECK(says(
      loaded->notices,
      "Segments overlap (in 2 voxels): they lie in 2 layers, each a label map of its own: organ, beside; tumour."));
}

TEST_CASE("Fractions belong to a segment from one half on, numbers of segments are labels", "[imaging]") {
  std::vector<std::uint8_t> fractions(kEach, 0);
  fractions[3] = 99;
  fractions[4] = 100;
  fractions[5] = 200;
  Picture fractional = segmentation("FRACTIONAL", {segment(1, "lesion")}, {frame(0, 1)});
  const auto loaded = labelsOf(fractional.number(0x0062000e, 200).pixels(fractions));
  REQUIRE(loaded);
  CHECK(countOf(loaded->labels, 1) == 2);
  CHECK(says(loaded->notices, "from one half on"));

  std::vector<std::uint8_t> numbers(kEach, 0);
  numbers[1] = 9;
  const auto map = labelsOf(segmentation("LABELMAP", {segment(9, "spleen")}, {frame(0, 0)}).pixels(numbers));
  REQUIRE(map);
  REQUIRE(map->labels.labels.size() == 1);
  CHECK(map->labels.labels[0].name == "spleen");
  CHECK(map->labels.voxels[1] == 9);
}

TEST_CASE("Segmentations that cannot be placed or decoded are refused by name", "[imaging]") {
  const auto reason = [](const Picture &picture) {
    const auto loaded = labelsOf(picture);
    return loaded ? std::string("read") : loaded.error().message;
  };
  Picture uneven = segmentation("BINARY", {segment(1, "a")}, {frame(0, 1), frame(2, 1), frame(3.3, 1), frame(7, 1)});
  CHECK_THAT(reason(uneven.text(0x7fe00010, "OB", bitsOf({{0}, {0}, {0}, {0}}))),
             Contains("lie unevenly, at least 1.3 mm apart"));
  Picture lost = segmentation("BINARY", {segment(1, "a")}, {frame(0, 0)});
  CHECK_THAT(reason(lost.text(0x7fe00010, "OB", bitsOf({{0}}))), Contains("belong to no segment"));
  Picture cut = segmentation("BINARY", {segment(1, "a")}, {frame(0, 1), frame(2.5, 1)});
  CHECK_THAT(reason(cut.text(0x7fe00010, "OB", std::string(2, '\1'))), Contains("truncated: 2 of 4 bytes"));
  CHECK_THAT(reason(segmentation("SURFACE", {segment(1, "a")}, {frame(0, 1)}).pixels(std::vector<std::uint8_t>(kEach))),
             Contains("type 'SURFACE'"));
}

TEST_CASE("A list of series tells segmentations, and which series the named file is of", "[imaging]") {
  C3DE_DATA_OR_SKIP(scan, "dicom/ct_3slice_plus_seg/01.dcm");
  C3DE_DATA_OR_SKIP(segments, "dicom/ct_3slice_plus_seg/liver.dcm");
  for (const auto &[file, isSegmentation] : {std::pair{scan, false}, {segments, true}}) {
    const auto list = listSeries(file);
    REQUIRE(list);
    std::size_t named = 0;
    for (const SeriesInfo &series : *list) {
      if (!series.holdsNamedFile) continue;
      ++named;
      CHECK(series.isSegmentation == isSegmentation);
    }
    CHECK(named == 1);
  }
  C3DE_DATA_OR_SKIP(slicer, "dicom/ct_3slice_plus_seg/liver_seg.nrrd");
  const auto list = listSeries(slicer);
  REQUIRE((list && list->size() == 1));
  CHECK(list->front().holdsNamedFile);
}

TEST_CASE("Segmentations of 3D Slicer are the label maps they were written from", "[imaging]") {
  for (const auto &[segments, labels, scale] :
       {std::tuple{"dicom/seg_tiny_nonsquare/label.seg", "dicom/seg_tiny_nonsquare/label.nrrd", 1},
        {"dicom/ct_3slice_plus_seg/liver.dcm", "dicom/ct_3slice_plus_seg/liver_seg.nrrd", 1}}) {
    C3DE_DATA_OR_SKIP(file, segments);
    C3DE_DATA_OR_SKIP(truth, labels);
    const auto ours = readLabelMap(file), theirs = readLabelMap(truth);
    REQUIRE((ours && theirs));
    REQUIRE(sameGrid(ours->labels.geometry, theirs->labels.geometry));
    std::size_t different = 0, inside = 0;
    for (std::size_t v = 0; v < ours->labels.voxels.size(); ++v) {
      different += (ours->labels.voxels[v] != 0) != (theirs->labels.voxels[v] != 0);
      inside += theirs->labels.voxels[v] != 0;
    }
    CHECK(different == 0);
    CHECK(inside > 300);
    REQUIRE(ours->labels.labels.size() == 1);
    CHECK(ours->labels.labels[0].name == "Liver");
  }
  C3DE_DATA_OR_SKIP(overlapping, "dicom/ct_3slice_plus_seg/partial_overlaps.dcm");
  const auto layers = readLabelMap(overlapping);
  REQUIRE(layers);
  REQUIRE(layers->layers.size() == 2);
  CHECK(says(layers->notices, "Segments overlap"));
  std::vector<std::string> names;
  for (const auto &label : layers->labels.labels) names.push_back(label.name);
  CHECK(names == std::vector<std::string>{"GREEN", "LIGHT_BLUE", "DARK_BLUE"});
  C3DE_DATA_OR_SKIP(one, "dicom/pydicom_single/liver_1frame.dcm");
  const auto slice = readLabelMap(one);
  REQUIRE(slice);
  CHECK(slice->labels.geometry.size[2] == 1);
  const auto asImage = readVolume(one);
  REQUIRE(asImage);
  CHECK(says(asImage->notices, "A segmentation: its values are the numbers of its segments"));
}
