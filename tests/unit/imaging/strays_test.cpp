// SPDX-License-Identifier: Apache-2.0
// Files next to images, images at unexpected locations or of unexpected kinds, paths written on other systems.
#include "dicom_made.h"
#include "support/pipes.h"

using namespace made;

namespace {

std::string slice(int k, const std::string &series = "2.25.3104.1.1") {
  return Picture(4, 3)
      .text(0x00080018, "UI", series + "." + std::to_string(k + 1))
      .text(0x00080060, "CS", "CT")
      .text(0x0020000e, "UI", series)
      .text(0x00200013, "IS", std::to_string(k + 1))
      .text(0x00200032, "DS", "0\\0\\" + std::to_string(2 * k))
      .pixels(std::vector<std::uint16_t>(12, static_cast<std::uint16_t>(100 + k)))
      .file();
}

std::string directory() {
  DicomElements all;
  all.add(0x0004, 0x1130, "CS", "X");
  all.add(0x0004, 0x1200, "UL", std::string(4, '\0'));
  all.add(0x0004, 0x1220, std::vector<std::string>{});
  return test::dicomFile(all.bytes());
}

/// The file that a Mac adds next to a file on a foreign disk: AppleDouble, with bytes of the file's kind in it.
std::string appleDouble(const std::string &of) {
  return std::string("\x00\x05\x16\x07\x00\x02\x00\x00Mac OS X        ", 24) + of.substr(0, 200);
}

std::filesystem::path series(const std::string &name) {
  const auto folder = emptyFolder(name);
  for (int k = 0; k < 4; ++k) write(folder / ("I" + std::to_string(k)), slice(k));
  return folder;
}

void checkWhole(const std::filesystem::path &path) {
  INFO(path);
  const auto loaded = readVolume(path);
  if (!loaded) {
    FAIL_CHECK(loaded.error().message);
    return;
  }
  CHECK(loaded->volume.geometry.size == std::array<std::size_t, 3>{4, 3, 4});
  checkAt(loaded->volume.geometry.spacing(), {1.5, 2, 2});
  for (std::size_t k = 0; k < 4; ++k) CHECK(loaded->volume.value(0, 0, k) == 100.0 + static_cast<double>(k));
}

std::string mask(const std::string &voxels) {
  return "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nspace: LPS\nspace directions: (1,0,0) "
         "(0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n" +
         voxels;
}

}  // namespace

TEST_CASE("What systems leave in a folder of DICOM files is not read", "[imaging][strays]") {
  const auto folder = series("strays");
  write(folder / "._I0", appleDouble(slice(0)));
  write(folder / "._I9", slice(9, "2.25.3104.7.7"));  // hidden, though it could be read
  write(folder / ".DS_Store", std::string("\0\0\0\1Bud1", 8) + std::string(90, '\0'));
  write(folder / "Thumbs.db", "\xd0\xcf\x11\xe0");
  write(folder / "desktop.ini", "[.ShellClassInfo]\n");
  write(folder / "__MACOSX" / "I0", slice(0, "2.25.3104.8.8"));
  write(folder / ".Trash" / "I0", slice(0, "2.25.3104.8.9"));
  write(folder / "DICOMDIR", directory());
  write(folder / "report.json", "{}");
  write(folder / "notes.txt", "CT of a test");
  write(folder / "picture.png", "\x89PNG\r\n\x1a\n");
  checkWhole(folder);
  checkWhole(folder / "I2");
  const auto list = listSeries(folder);
  REQUIRE(list);
  CHECK(list->size() == 1);
}

TEST_CASE("A DICOMDIR is read as the folder in which it lies", "[imaging][strays]") {
  const auto folder = emptyFolder("medium");
  std::filesystem::rename(series("files"), folder / "DATA");
  write(folder / "DICOMDIR", directory());
  checkWhole(folder / "DICOMDIR");
  checkWhole(folder);
  const auto loaded = readVolume(folder / "DICOMDIR");
  REQUIRE(loaded);
  CHECK(says(loaded->notices, "DICOMDIR"));
  const auto list = listSeries(folder / "DICOMDIR");
  REQUIRE(list);
  CHECK(list->size() == 1);
  CHECK(isLikelyImage(folder / "DICOMDIR"));
  const auto alone = emptyFolder("alone");
  const auto none = readVolume(write(alone / "DICOMDIR", directory()));
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("holds no DICOM image"));
}

TEST_CASE("Files of a series without a preamble belong to it", "[imaging][strays]") {
  for (const int bare : {0, 1, 3}) {
    const auto folder = series("bare");
    const auto file = folder / ("I" + std::to_string(bare));
    INFO(bare);
    const std::string whole = slice(bare);
    write(file, whole.substr(132));  // begins with the meta header
    checkWhole(folder);
    checkWhole(file);
    write(file, whole.substr(128));  // begins with DICM
    checkWhole(folder);
    checkWhole(file);
    Picture data(4, 3);
    std::string elements = whole.substr(whole.find(data.elements().substr(0, 8)));
    write(file, elements);  // begins with its data
    checkWhole(folder);
    checkWhole(file);
  }
  const auto all = series("all-bare");
  for (int k = 0; k < 4; ++k) write(all / ("I" + std::to_string(k)), slice(k).substr(132));
  checkWhole(all);
  CHECK(isLikelyImage(all));
}

TEST_CASE("What systems leave in a folder of masks is no mask", "[imaging][strays]") {
  const auto folder = emptyFolder("masks");
  write(folder / "liver.nrrd", mask(std::string("\1\0\0\0\0\0\0\0", 8)));
  write(folder / "spleen.nrrd", mask(std::string("\0\1\0\0\0\0\0\0", 8)));
  write(folder / "._liver.nrrd", appleDouble("NRRD"));
  write(folder / "._spleen.nii.gz", appleDouble(""));
  write(folder / ".hidden.mha", "x");
  write(folder / ".DS_Store", "Bud1");
  write(folder / "Thumbs.db", "x");
  write(folder / "desktop.ini", "x");
  write(folder / "statistics.json", "{}");
  write(folder / "__MACOSX" / "._liver.nrrd", appleDouble(""));
  const auto loaded = readLabelMap(folder);
  if (!loaded) FAIL(loaded.error().message);
  REQUIRE(loaded->labels.labels.size() == 2);
  CHECK(loaded->labels.labels[0].name == "liver");
  CHECK(loaded->labels.labels[1].name == "spleen");
}

TEST_CASE("Files with voxels are found by paths with backslashes", "[imaging][strays]") {
  const auto folder = emptyFolder("paths");
  write(folder / "data" / "v.raw", "abcdefgh");
  write(folder / "data" / "v1.raw", "abcd");
  write(folder / "data" / "v2.raw", "efgh");
  write(folder / "v 1.raw", "abcdefgh");
  const std::string meta =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 "
      "1\nElementDataFile = ";
  const std::string nrrd =
      "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nspacings: 1 1 1\ndata file: ";
  const std::string deep = "..\\paths\\data\\v.raw";
  for (const auto &[name, bytes] : {std::pair<const char *, std::string>{"a.mhd", meta + "data\\v.raw\n"},
                                    {"b.mhd", meta + ".\\data\\v.raw\n"},
                                    {"c.mhd", meta + deep + "\n"},
                                    {"d.mhd", meta + "data/v.raw\n"},
                                    {"e.mhd", meta + "LIST\ndata\\v1.raw\ndata\\v2.raw\n"},
                                    {"f.mhd", meta + "data\\v%d.raw 1 2 1\n"},
                                    {"g.mhd", meta + "v 1.raw\n"},
                                    {"a.nhdr", nrrd + "data\\v.raw\n"},
                                    {"b.nhdr", nrrd + ".\\data\\v.raw\n"},
                                    {"c.nhdr", nrrd + "LIST\ndata\\v1.raw\ndata\\v2.raw\n"},
                                    {"d.nhdr", nrrd + "data\\v%d.raw 1 2 1\n"},
                                    {"e.nhdr", nrrd + "v 1.raw\n"}}) {
    INFO(name);
    const auto loaded = readVolume(write(folder / name, bytes));
    if (!loaded) {
      FAIL_CHECK(loaded.error().message);
      continue;
    }
    CHECK(loaded->volume.value(1, 1, 1) == 'h');
  }
  const auto absent = readVolume(write(folder / "x.mhd", meta + "C:\\data\\v.raw\n"));
  REQUIRE_FALSE(absent);
  CHECK_THAT(absent.error().message, Contains("C:\\data\\v.raw") && Contains("no such file") && Contains("x.mhd"));
}

#if !defined(_WIN32)
TEST_CASE("A pipe or a device in place of an image is refused at once, by name", "[imaging][strays]") {
  for (const char *name : {"a.nii", "a.nii.gz", "a.hdr", "a.nrrd", "a.nhdr", "a.mha", "a.mhd", "a.dcm", "noname"}) {
    INFO(name);
    const auto pipe = test::pipeAt(testOutputFolder() / name);
    const auto loaded = readVolume(pipe);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error().message, Contains(name) && Contains("is a pipe (FIFO), not a file"));
    CHECK_FALSE(readLabelMap(pipe));
    CHECK_FALSE(isLikelyImage(pipe));
  }
  const auto folder = emptyFolder("parts");
  test::pipeAt(folder / "v.raw");
  const auto named = readVolume(write(folder / "a.mhd",
                                      "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\n"
                                      "ElementDataFile = v.raw\n"));
  REQUIRE_FALSE(named);
  CHECK_THAT(named.error().message, Contains("v.raw: is a pipe") && Contains("named by a.mhd"));
  write(folder / "b.nrrd", mask(std::string("\1\0\0\0\0\0\0\0", 8)));
  test::pipeAt(folder / "b.txt");  // where names of labels are searched
  CHECK(readLabelMap(folder / "b.nrrd"));
  // Next to slices and masks it is ignored.
  const auto slices = series("slices");
  test::pipeAt(slices / "I9");
  checkWhole(slices);
}
#endif
