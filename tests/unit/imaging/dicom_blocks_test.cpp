// SPDX-License-Identifier: Apache-2.0
// Series of several blocks of slices, and the names that select a series or a part of it.
#include "dicom_made.h"

using namespace made;

namespace {

/// A series whose stored values are 100 z, so that interpolation between slices has an exact result.
void writeRamp(const std::filesystem::path &folder, const std::vector<double> &z,
               const std::string &uid = "2.25.3104.1.1", int number = 4,
               const std::string &description = "head, two blocks") {
  for (std::size_t n = 0; n < z.size(); ++n) {
    Picture slice(3, 2);
    slice.text(0x00080018, "UI", uid + "." + std::to_string(n))
        .text(0x00080060, "CS", "CT")
        .text(0x0008103e, "LO", description);
    slice.text(0x0020000e, "UI", uid)
        .text(0x00200011, "IS", std::to_string(number))
        .text(0x00200013, "IS", std::to_string(n + 1));
    slice.text(0x00200032, "DS", "0\\0\\" + std::to_string(z[n])).number(0x00280103, 1);
    slice.pixels(std::vector<std::int16_t>(6, static_cast<std::int16_t>(std::lround(100.0 * z[n]))));
    write(folder / (uid.substr(uid.size() - 1) + "-" + std::to_string(n) + ".dcm"), slice.file());
  }
}

std::vector<double> twoBlocks(double gap) {
  std::vector<double> z;
  for (int n = 0; n < 6; ++n) z.push_back(2.4 * n);
  for (int n = 0; n < 5; ++n) z.push_back(12.0 + gap + 4.8 * n);
  return z;
}

Expected<LoadedVolume> readSeries(const std::filesystem::path &folder, const std::string &series) {
  ReadOptions options;
  options.series = series;
  return readVolume(folder, options);
}

}  // namespace

TEST_CASE("Two blocks of slices with a gap are one volume on the finer spacing, and two parts", "[imaging]") {
  const auto folder = emptyFolder("blocks");
  writeRamp(folder, twoBlocks(1.14));
  const auto whole = readVolume(folder);
  REQUIRE(whole);
  const VolumeGeometry &g = whole->volume.geometry;
  CHECK_THAT(g.spacing()[2], WithinAbs(2.4, 1e-9));
  REQUIRE(g.size[2] == 14);  // from 0 to 32.34 mm
  checkAt(g.worldAt({0, 0, 0}), {0, 0, 0});
  CHECK(says(whole->notices, "2 blocks: 6 slices 2.4 mm apart, then 1.14 mm, 5 slices 4.8 mm apart"));
  CHECK(says(whole->notices, "resampled to 2.4 mm"));
  for (std::size_t k = 0; k < 14; ++k)
    CHECK(std::abs(whole->volume.value(1, 1, k) - 240.0 * static_cast<double>(k)) <= 0.5);

  const auto list = listSeries(folder);
  REQUIRE(list);
  REQUIRE(list->size() == 3);
  CHECK_FALSE((*list)[0].isPart);
  CHECK((*list)[1].isPart);
  CHECK((*list)[1].id == (*list)[0].id + "#1");
  CHECK((*list)[2].size[2] == 5);
  for (const auto &[part, slices, step, from] : {std::tuple{"#1", 6u, 2.4, 0.0}, {"#2", 5u, 4.8, 13.14}}) {
    const auto block = readSeries(folder, part);
    REQUIRE(block);
    CHECK(block->volume.geometry.size[2] == slices);
    CHECK_THAT(block->volume.geometry.spacing()[2], WithinAbs(step, 1e-9));
    checkAt(block->volume.geometry.worldAt({0, 0, 0}), {0, 0, from});
    CHECK_FALSE(says(block->notices, "interpolation"));
  }
}

TEST_CASE("The grid of several blocks keeps the slices of the finest one", "[imaging]") {
  const auto folder = emptyFolder("blocks");
  std::vector<double> z;  // coarse below, fine above
  for (int n = 0; n < 4; ++n) z.push_back(5.0 * n);
  for (int n = 0; n < 7; ++n) z.push_back(16.1 + 1.5 * n);
  writeRamp(folder, z);
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  const VolumeGeometry &g = loaded->volume.geometry;
  CHECK_THAT(g.spacing()[2], WithinAbs(1.5, 1e-9));
  for (std::size_t n = 0; n < 7; ++n) {
    const std::size_t k = g.size[2] - 7 + n;
    checkAt(g.worldAt({0, 0, static_cast<double>(k)}), {0, 0, z[4 + n]});
    CHECK(loaded->volume.value(0, 0, k) == std::round(100.0 * z[4 + n]));
  }
}

TEST_CASE("Blocks too far from each other are refused together and read one by one", "[imaging]") {
  const auto folder = emptyFolder("blocks");
  writeRamp(folder, twoBlocks(40.0));
  const auto refused = readVolume(folder);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("2 blocks with 40 mm between two of them") && Contains("#1, #2"));
  CHECK(readSeries(folder, "#1"));
  CHECK(readSeries(folder, "#2"));
}

TEST_CASE("A missing slice between equal halves is a missing slice, not two blocks", "[imaging]") {
  const auto folder = emptyFolder("blocks");
  writeRamp(folder, {0, 2, 4, 6, 10, 12, 14});
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  CHECK(says(loaded->notices, "1 slices are missing"));
  CHECK(loaded->volume.geometry.size[2] == 8);
}

TEST_CASE("A series is asked for by identifier, number or description, a part behind a #", "[imaging]") {
  const auto folder = emptyFolder("names");
  writeRamp(folder, twoBlocks(1.14), "2.25.3104.1.1", 4, "head, two blocks");
  writeRamp(folder, {0, 1, 2}, "2.25.3104.1.2", 5, "neck");
  writeRamp(folder, {0, 3, 6, 9}, "2.25.3104.1.3", 6, "neck");
  const auto slices = [&](const std::string &series) {
    const auto loaded = readSeries(folder, series);
    return loaded ? std::to_string(loaded->volume.geometry.size[2]) : loaded.error().message;
  };
  CHECK(slices("2.25.3104.1.3") == "4");
  CHECK(slices("5") == "3");
  CHECK(slices("head, two blocks") == "14");
  CHECK(slices("head, two blocks#2") == "5");
  CHECK(slices("4#1") == "6");
  CHECK(slices("2.25.3104.1.1#2") == "5");
  CHECK_THAT(slices("neck"), Contains("has 2 series 'neck'") && Contains("2.25.3104.1.2") && Contains("2.25.3104.1.3"));
  CHECK_THAT(slices("7"), Contains("no series '7'; there are:") && Contains("number 6") && Contains("\"neck\""));
  CHECK_THAT(slices("5#1"), Contains("no series '5#1'"));
}
