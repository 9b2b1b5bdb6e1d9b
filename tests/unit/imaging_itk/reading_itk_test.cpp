// SPDX-License-Identifier: Apache-2.0
// Results of the readers against those of ITK: positions of voxels and their values.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "c3de/imaging/reading.h"
#include "itk_reading.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::imaging;
namespace fs = std::filesystem;

namespace {

struct Difference {
  double place_mm = 0.0, value = 0.0, range = 0.0;
  bool sameSize = false;
};

Difference differenceOf(const Volume &ours, const itk_truth::Image &theirs) {
  Difference d;
  d.sameSize = ours.geometry.size == theirs.geometry.size;
  if (!d.sameSize) return d;
  const auto &n = ours.geometry.size;
  for (const double part : {0.0, 0.5, 1.0}) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = part * static_cast<double>(n[a] - 1);
    d.place_mm = std::max(d.place_mm, norm(ours.geometry.worldAt(index) - theirs.geometry.worldAt(index)));
  }
  const auto [low, high] = std::minmax_element(theirs.values.begin(), theirs.values.end());
  d.range = *high - *low;
  std::size_t v = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++v) {
        const double mine = ours.value(i, j, k), other = theirs.values[v];
        if (std::isnan(mine) && std::isnan(other)) continue;
        d.value = std::max(d.value, std::abs(mine - other));
      }
  return d;
}

void checkSame(const Volume &ours, const itk_truth::Image &theirs) {
  const Difference d = differenceOf(ours, theirs);
  REQUIRE(d.sameSize);
  CHECK(d.place_mm < 1e-3);
  // ITK rescales in single precision where a slope is given.
  CHECK(d.value <= 1e-6 * (1.0 + d.range));
}

bool isVolumeFile(const fs::path &file) {
  const std::string name = file.filename().string();
  for (const char *end : {".nii", ".nii.gz", ".hdr", ".nrrd", ".nhdr", ".mha", ".mhd"})
    if (name.size() > std::string(end).size() && name.ends_with(end)) return true;
  return false;
}

}  // namespace

TEST_CASE("volumes are where ITK reads them, with its values", "[imaging][itk]") {
  C3DE_DATA_OR_SKIP(folder, "volume");
  std::set<fs::path> files;
  for (const fs::directory_entry &entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && isVolumeFile(entry.path())) files.insert(entry.path());
  std::size_t compared = 0;
  for (const fs::path &file : files) {
    CAPTURE(fs::relative(file, folder).generic_string());
    const auto ours = readVolume(file);
    const auto theirs = itk_truth::read(file);
    if (!ours || !theirs) {
      // ITK 5.2 reads no NIfTI-2.
      CHECK((ours && file.filename().string().find("nifti2") != std::string::npos));
      continue;
    }
    checkSame(ours->volume, *theirs);
    ++compared;
  }
  CHECK(compared >= 25);
}

TEST_CASE("Later time points have the values that ITK reads", "[imaging][itk]") {
  C3DE_DATA_OR_SKIP(file, "volume/nifti/example4d.nii.gz");
  for (const std::size_t time : {std::size_t{0}, std::size_t{1}}) {
    ReadOptions options;
    options.time = time;
    const auto ours = readVolume(file, options);
    const auto theirs = itk_truth::read(file, time);
    REQUIRE((ours && theirs));
    checkSame(ours->volume, *theirs);
  }
}

TEST_CASE("The brightness of colours is the luminance that ITK finds", "[imaging][itk]") {
  const fs::path folder = testOutputFolder();
  std::string rgb;
  for (int v = 0; v < 5 * 4 * 3; ++v)
    for (const int c : {37 * v, 91 * v + 13, 151 * v + 200}) rgb += static_cast<char>(c % 256);
  const auto write = [&](const char *name, const std::string &head) {
    std::ofstream(folder / name, std::ios::binary) << head << rgb;
    return folder / name;
  };
  for (const fs::path &file :
       {write("colour.nrrd",
              "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 5 4 3\nencoding: raw\nspace: left-posterior-superior\n"
              "space directions: none (2,0,0) (0,1.5,0) (0,0,3)\nspace origin: (4,5,6)\nkinds: RGB-color domain domain "
              "domain\n\n"),
        write("colour.mha",
              "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 "
              "0 0 1 0 0 0 1\nOffset = 4 5 6\n"
              "ElementSpacing = 2 1.5 3\nDimSize = 5 4 3\nElementNumberOfChannels = 3\nElementType = "
              "MET_UCHAR\nElementDataFile = LOCAL\n")}) {
    CAPTURE(file);
    const auto ours = readVolume(file);
    const auto theirs = itk_truth::read(file);
    REQUIRE((ours && theirs));
    const Difference d = differenceOf(ours->volume, *theirs);
    REQUIRE(d.sameSize);
    CHECK(d.place_mm < 1e-3);
    CHECK(d.value < 0.6);  // our value is rounded to 8 bits
    CHECK(d.range > 100.0);
  }
}

TEST_CASE("DICOM series are where ITK reads them, with its values", "[imaging][itk]") {
  C3DE_DATA_OR_SKIP(folder, "dicom");
  std::set<fs::path> folders;
  for (const fs::directory_entry &entry : fs::recursive_directory_iterator(folder))
    if (entry.is_directory() && entry.path().string().find("broken") == std::string::npos) folders.insert(entry.path());
  std::size_t compared = 0;
  for (const fs::path &path : folders) {
    CAPTURE(fs::relative(path, folder).generic_string());
    const auto ours = readVolume(path);
    const auto theirs = itk_truth::readSeries(path);
    if (!ours || !theirs) continue;  // folders of several series
    checkSame(ours->volume, *theirs);
    ++compared;
  }
  CHECK(compared >= 8);
}
