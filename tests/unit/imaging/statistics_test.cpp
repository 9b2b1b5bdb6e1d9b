// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "c3de/imaging/displacement.h"
#include "c3de/imaging/reading.h"
#include "c3de/imaging/region_statistics.h"
#include "c3de/imaging/statistics.h"
#include "support/catch.h"

using namespace c3de;
using imaging::Volume;

namespace {

template <class T>
Volume volumeOf(std::vector<T> voxels) {
  Volume volume;
  volume.geometry.size = {voxels.size(), 1, 1};
  volume.voxels = std::move(voxels);
  return volume;
}

}  // namespace

TEST_CASE("the robust range leaves out the share that was asked for, in values of the image", "[imaging]") {
  std::vector<std::int16_t> voxels;
  for (int i = 0; i < 10000; ++i) voxels.push_back(static_cast<std::int16_t>(i / 10));
  voxels[3] = -2000;
  voxels[7] = 30000;
  Volume volume = volumeOf(voxels);
  volume.slope = 2.0;
  volume.intercept = -1000.0;
  const auto range = imaging::robustRange(volume, 0.01);
  CHECK(range.min == -5000.0);
  CHECK(range.max == 59000.0);
  CHECK_THAT(range.low, WithinAbs(2.0 * 10 - 1000.0, 2.0));
  CHECK_THAT(range.high, WithinAbs(2.0 * 989 - 1000.0, 2.0));
  volume.slope = -2.0;
  const auto turned = imaging::robustRange(volume, 0.01);
  CHECK(turned.min == -61000.0);
  CHECK(turned.low < turned.high);
}

TEST_CASE("numbers that are not finite do not count, and a single value has a range as well", "[imaging]") {
  std::vector<float> voxels(1000, 0.25f);
  voxels[1] = std::numeric_limits<float>::quiet_NaN();
  voxels[2] = std::numeric_limits<float>::infinity();
  const auto flat = imaging::robustRange(volumeOf(voxels));
  CHECK(flat.min == 0.25);
  CHECK(flat.max == 0.25);
  CHECK(flat.low < flat.high);
  for (std::size_t i = 500; i < 1000; ++i) voxels[i] = 8.25f;
  const auto two = imaging::robustRange(volumeOf(voxels));
  CHECK_THAT(two.low, WithinAbs(0.25, 8.0 / 4096));
  CHECK_THAT(two.high, WithinAbs(8.25, 8.0 / 4096));
}

namespace {

/// Fractions of voxels around a value, with some noise, in HU.
struct Share {
  double value, share, spread;
};
Volume scanOf(const std::vector<Share> &shares) {
  std::vector<std::int16_t> voxels;
  for (const Share &s : shares)
    for (int n = 0; n < static_cast<int>(40000.0 * s.share); ++n)
      voxels.push_back(
          static_cast<std::int16_t>(s.value + s.spread * (static_cast<double>(n * 7919 % 2001) / 1000.0 - 1.0)));
  return volumeOf(voxels);
}

}  // namespace

TEST_CASE("What is seen of a tomography is soft tissue and bone, whatever of air, padding and metal is there",
          "[imaging]") {
  // Air, lung, fat, soft tissue, contrast, bone.
  const std::vector<Share> chest{{-1000, 0.4, 20}, {-800, 0.15, 80}, {-100, 0.1, 30},
                                 {45, 0.25, 40},   {250, 0.04, 60},  {600, 0.06, 300}};
  const auto plain = imaging::robustRange(scanOf(chest));
  CHECK(imaging::isLikelyHounsfield(scanOf(chest)));
  for (const auto &more : {std::vector<Share>{{-3024, 0.3, 0}},
                           {{3071, 0.02, 0}},
                           {{-3024, 0.3, 0}, {20000, 0.01, 5000}},
                           {{-1000, 5.0, 10}},
                           {{-850, 2.0, 10}}}) {
    std::vector<Share> all = chest;
    all.insert(all.end(), more.begin(), more.end());
    const auto range = imaging::robustRange(scanOf(all));
    CHECK_THAT(range.low, WithinAbs(plain.low, 30.0));
    CHECK_THAT(range.high, WithinAbs(plain.high, 60.0));
  }
  CHECK((plain.low >= -200.0 && plain.low <= -100.0));
  CHECK((plain.high >= 400.0 && plain.high <= 1000.0));
  // A file with the unit HU needs no air.
  Volume cut = scanOf({{45, 0.9, 40}, {600, 0.1, 300}});
  CHECK_FALSE(imaging::isLikelyHounsfield(cut));
  cut.unit = "HU";
  CHECK(imaging::robustRange(cut).high <= 1000.0);
  CHECK(imaging::isLikelyHounsfield(cut));
}

TEST_CASE("Magnetic resonance, phases and other values keep the range of their voxels", "[imaging]") {
  const std::vector<Share> head{{5, 0.5, 5}, {300, 0.2, 60}, {600, 0.2, 80}, {900, 0.1, 90}};
  const std::vector<Share> phase{{0, 0.7, 4095}, {30, 0.3, 200}};
  const std::vector<Share> negative{{-1000, 0.3, 20}, {900, 0.7, 300}};
  for (const auto &shares : {head, phase, negative}) {
    const Volume volume = scanOf(shares);
    CHECK_FALSE(imaging::isLikelyHounsfield(volume));
    const auto range = imaging::robustRange(volume);
    CHECK(range.high - range.low > 0.9 * (range.max - range.min));
  }
}

TEST_CASE("Tomographies made by others show tissue, magnetic resonance all of it", "[imaging]") {
  for (const char *file : {"volume/totalseg/example_ct.nii.gz", "volume/totalseg/example_ct_sm.nii.gz",
                           "dicom/ct_head_phantom_philips_5mm", "dicom/pydicom_single/CT_small.dcm"}) {
    C3DE_DATA_OR_SKIP(path, file);
    CAPTURE(file);
    const auto loaded = imaging::readVolume(path);
    REQUIRE(loaded);
    CHECK(imaging::isLikelyHounsfield(loaded->volume));
    const auto range = imaging::robustRange(loaded->volume);
    CAPTURE(range.min, range.max, range.low, range.high);
    CHECK((range.low >= -200.0 && range.low < 60.0));
    CHECK((range.high >= 250.0 && range.high <= 1000.0));
  }
  for (const char *file :
       {"volume/totalseg/example_mr_sm.nii.gz", "volume/nifti/anatomical.nii", "volume/nifti/example4d.nii.gz",
        "volume/nifti/CT_pitch.nii.gz", "volume/nrrd/breast1_image.nrrd"}) {
    C3DE_DATA_OR_SKIP(path, file);
    CAPTURE(file);
    const auto loaded = imaging::readVolume(path);
    REQUIRE(loaded);
    CHECK_FALSE(imaging::isLikelyHounsfield(loaded->volume));
  }
}

TEST_CASE("a displacement grid is linear inside and zero outside", "[imaging]") {
  imaging::DisplacementGrid grid;
  grid.geometry.size = {3, 4, 2};
  grid.geometry.indexToWorld = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 5, 0, -1, -2, -3, 1};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 x = grid.geometry.worldAt({double(i), double(j), double(k)});
        for (const double u : {0.5 * x[0], x[1] - x[2], 7.0}) grid.xyz_mm.push_back(static_cast<float>(u));
      }
  const Vec3 u = grid.at({0.4, 1.5, -0.25});
  CHECK_THAT(u[0], WithinAbs(0.2, 1e-6));
  CHECK_THAT(u[1], WithinAbs(1.75, 1e-6));
  CHECK_THAT(u[2], WithinAbs(7.0, 1e-6));
  CHECK(grid.at({3.0, 7.0, 2.0})[2] == 7.0);  // the last point
  CHECK(grid.at({3.01, 7.0, 2.0}) == Vec3{});
  CHECK(grid.at({-1.01, 0.0, 0.0}) == Vec3{});
}

TEST_CASE("a histogram counts every value once, in values of the image", "[imaging][histogram]") {
  Volume volume = volumeOf(std::vector<std::int16_t>{0, 1, 1, 2, 3, 4, 4, 4, -7, 50});
  volume.slope = 10.0;
  volume.intercept = 5.0;
  // 5, 15, 15 | 25, 35, 45, 45, 45: the upper limit belongs to the last interval
  CHECK(imaging::histogramOf(volume, 5.0, 45.0, 2) == std::vector<std::uint64_t>{3, 5});
  CHECK(imaging::histogramOf(volume, 5.0, 45.0, 4) == std::vector<std::uint64_t>{1, 2, 1, 4});
  volume.slope = -10.0;
  volume.intercept = 50.0;
  CHECK(imaging::histogramOf(volume, 10.0, 50.0, 4) == std::vector<std::uint64_t>{3, 1, 1, 3});
  CHECK(imaging::histogramOf(volume, 10.0, 10.0, 4).empty());
  CHECK(imaging::histogramOf(volume, 10.0, 50.0, 0).empty());
  const Volume broken = volumeOf(
      std::vector<float>{0.5f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1.0f});
  CHECK(imaging::histogramOf(broken, 0.0, 1.0, 2) == std::vector<std::uint64_t>{0, 2});
}

TEST_CASE("values in labels have the mean and the deviation of their formulas, on any grid", "[imaging][regions]") {
  // Values x + 100 y on the grid of the image; the labels are finer, turned by axes, and reach beyond it.
  imaging::Volume image;
  image.geometry = {{6, 5, 4}, {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 10, 20, 30, 1}};
  std::vector<std::int16_t> values;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 6; ++i) values.push_back(static_cast<std::int16_t>(i + 100 * j));
  image.voxels = values;
  image.slope = 2.0;
  image.intercept = -7.0;
  imaging::LabelMap same;
  same.geometry = image.geometry;
  same.voxels.assign(120, 9);
  for (std::size_t v = 0; v < 60; ++v) same.voxels[v] = 4;
  same.labels = {{4, "lower", {}}, {9, "upper, with comma", {}}};
  const auto measured = imaging::statisticsOfLabels(same, &image);
  REQUIRE(measured);
  REQUIRE(measured->size() == 2);
  // i of 0 … 5: mean 2.5, mean square deviation 35/12; j of 0 … 4: 2 and 2.
  const double variance = 4.0 * (35.0 / 12.0 + 1e4 * 2.0) * 60.0 / 59.0;
  for (const imaging::RegionStatistics &one : *measured) {
    CHECK(one.voxels == 60);
    CHECK(one.measured == 60);
    CHECK_THAT(one.mean, WithinRel(2.0 * (2.5 + 200.0) - 7.0, 1e-12));
    CHECK_THAT(one.sd, WithinRel(std::sqrt(variance), 1e-12));
    CHECK(one.min == -7.0);
    CHECK(one.max == 2.0 * 405.0 - 7.0);
  }

  // The same points as a mask of another grid: axes exchanged, and a layer outside of the image.
  imaging::Mask mask;
  mask.geometry = {{5, 6, 5}, {0, 3, 0, 0, 2, 0, 0, 0, 0, 0, 4, 0, 10, 20, 30, 1}};
  mask.voxels.assign(150, 1);
  const auto turned = imaging::statisticsOf(mask, &image);
  REQUIRE(turned);
  CHECK(turned->voxels == 150);
  CHECK(turned->measured == 120);
  CHECK_THAT(turned->mean, WithinRel(2.0 * 202.5 - 7.0, 1e-12));
  CHECK_THAT(turned->sd, WithinRel(std::sqrt(variance * (59.0 / 60.0) * (120.0 / 119.0)), 1e-12));

  const auto counted = imaging::statisticsOf(mask, nullptr);
  REQUIRE(counted);
  CHECK((counted->voxels == 150 && counted->measured == 0));
  const auto cancelled = imaging::statisticsOf(mask, &image, [](double, const std::string &) { return false; });
  REQUIRE_FALSE(cancelled);
  CHECK(cancelled.error().code == ErrorCode::cancelled);
  const std::string text =
      imaging::statisticsCsv({{"9", "upper, with comma", measured->back(), 24.0}, {"", "organ", *counted, 24.0}}, "HU");
  CHECK_THAT(text, Contains("\n9,\"upper, with comma\",60,1.44,60,398,") && Contains(",-7,803,HU\n") &&
                       Contains("\n,organ,150,3.6,0,,,,,\n"));
}
