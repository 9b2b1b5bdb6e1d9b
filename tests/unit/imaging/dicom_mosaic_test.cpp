// SPDX-License-Identifier: Apache-2.0
// Mosaics of Siemens: many slices as tiles of one picture.
#include "dicom_made.h"

using namespace made;

namespace {

void put(std::string &bytes, std::uint32_t value) { bytes += packed(std::vector<std::uint32_t>{value}); }

/// A CSA header of version 1 or 2 with these fields.
std::string csa(int version, const std::vector<std::pair<std::string, std::vector<std::string>>> &fields) {
  std::string out = version == 2 ? std::string("SV10\4\3\2\1", 8) : "";
  put(out, static_cast<std::uint32_t>(fields.size()));
  put(out, 77);
  for (const auto &[name, values] : fields) {
    out += name + std::string(64 - name.size(), '\0');
    put(out, static_cast<std::uint32_t>(values.size()));
    out += std::string("FD\0\0", 4);
    put(out, 3);
    put(out, 6);  // items, of which the last are empty
    put(out, 77);
    for (std::size_t n = 0; n < 6; ++n) {
      const std::string value = n < values.size() ? values[n] + '\0' : "";
      const auto length = static_cast<std::uint32_t>(value.size());
      put(out, version == 2 ? length : length + 6);
      put(out, length);
      put(out, 77);
      put(out, length);
      out += value + std::string((4 - value.size() % 4) % 4, '\0');
    }
  }
  return out;
}

/// 7 slices of 4 x 5 as 3 x 3 tiles; the value of a voxel is 1000 + 100 k + 10 j + i, plus `more`.
Picture mosaic(const std::string &header, std::uint16_t more = 0) {
  std::vector<std::uint16_t> pixels(12 * 15, 0);
  for (std::size_t k = 0; k < 7; ++k)
    for (std::size_t j = 0; j < 5; ++j)
      for (std::size_t i = 0; i < 4; ++i)
        pixels[(k / 3 * 5 + j) * 12 + k % 3 * 4 + i] = static_cast<std::uint16_t>(1000 + 100 * k + 10 * j + i + more);
  Picture out(12, 15);
  out.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC")
      .text(0x00180088, "DS", "3")
      .text(0x00200032, "DS", "10\\20\\30");
  out.text(0x00290011, "LO", "SIEMENS CSA HEADER").text(0x00291110, "OB", header).pixels(pixels);
  return out;
}

std::string goodHeader(int version, const std::string &z) {
  return csa(version, {{"EchoLinePosition", {"1"}},
                       {"NumberOfImagesInMosaic", {"7       "}},
                       {"SliceNormalVector", {"0.0", "0.0", z}}});
}

}  // namespace

TEST_CASE("A mosaic becomes the volume that its tiles are", "[imaging]") {
  const auto folder = emptyFolder("mosaic");
  for (const int version : {1, 2})
    for (const char *z : {"1.0", "-1.0"}) {
      CAPTURE(version, z);
      const auto loaded = readVolume(write(folder / "mosaic.dcm", mosaic(goodHeader(version, z)).file()));
      REQUIRE(loaded);
      const VolumeGeometry &g = loaded->volume.geometry;
      REQUIRE(g.size == std::array<std::size_t, 3>{4, 5, 7});
      CHECK(says(loaded->notices, "mosaic of 7 slices"));
      // The position is that of a picture of 12 x 15 around the first tile: 4 columns of 1.5 and 5 rows of 2 mm off.
      const double step = std::string(z) == "1.0" ? 3.0 : -3.0;
      const bool up = step > 0.0;
      checkAt(g.worldAt({0, 0, up ? 0.0 : 6.0}), {10 + 4 * 1.5, 20 + 5 * 2.0, 30});
      checkAt(g.worldAt({3, 4, up ? 6.0 : 0.0}), {10 + 7 * 1.5, 20 + 9 * 2.0, 30 + 6 * step});
      for (std::size_t k = 0; k < 7; ++k)
        CHECK(loaded->volume.value(3, 2, up ? k : 6 - k) == 1000.0 + 100.0 * static_cast<double>(k) + 23.0);
    }
}

TEST_CASE("Mosaics at several times are time points of one volume", "[imaging]") {
  const auto folder = emptyFolder("mosaic");
  for (std::uint16_t t = 0; t < 3; ++t) {
    Picture one = mosaic(goodHeader(2, "1.0"), static_cast<std::uint16_t>(2000 * t));
    one.text(0x00200013, "IS", std::to_string(t + 1)).text(0x00080018, "UI", "2.25.3104.1.1." + std::to_string(t));
    write(folder / (std::to_string(9 - t) + ".dcm"), one.file());
  }
  for (std::size_t t = 0; t < 3; ++t) {
    ReadOptions options;
    options.time = t;
    const auto loaded = readVolume(folder, options);
    REQUIRE(loaded);
    CHECK(loaded->times == 3);
    CHECK(loaded->volume.value(0, 0, 6) == 1600.0 + 2000.0 * static_cast<double>(t));
  }
  ReadOptions options;
  options.time = 3;
  const auto refused = readVolume(folder, options);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("time 3 is asked for") && Contains("3 time points (0 … 2)"));
  const auto list = listSeries(folder);
  REQUIRE(list);
  REQUIRE(list->size() == 1);
  CHECK(list->front().times == 3);
  CHECK(list->front().size == std::array<std::size_t, 3>{4, 5, 7});
}

TEST_CASE("A mosaic whose header does not suffice is refused by name", "[imaging]") {
  const auto folder = emptyFolder("mosaic");
  const auto reason = [&](const Picture &picture) {
    const auto loaded = readVolume(write(folder / "mosaic.dcm", picture.file()));
    return loaded ? std::string("read") : loaded.error().message;
  };
  Picture bare = mosaic(goodHeader(2, "1.0"));
  CHECK_THAT(reason(bare.without(0x00291110)),
             Contains("mosaic of Siemens") && Contains("NumberOfImagesInMosaic is missing"));
  Picture stepless = mosaic(goodHeader(2, "1.0"));
  CHECK_THAT(reason(stepless.without(0x00180088)), Contains("Spacing Between Slices is missing"));
  CHECK_THAT(reason(mosaic(csa(2, {{"NumberOfImagesInMosaic", {"7"}}}))), Contains("SliceNormalVector is missing"));
  CHECK_THAT(reason(mosaic(csa(2, {{"NumberOfImagesInMosaic", {"7"}}, {"SliceNormalVector", {"1", "0", "0"}}}))),
             Contains("not perpendicular to its slices"));
  CHECK_THAT(reason(mosaic(csa(2, {{"NumberOfImagesInMosaic", {"20"}}, {"SliceNormalVector", {"0", "0", "1"}}}))),
             Contains("not 5 x 5 equal tiles"));
  CHECK_THAT(reason(mosaic(csa(2, {{"NumberOfImagesInMosaic", {"-7"}}, {"SliceNormalVector", {"0", "0", "1"}}}))),
             Contains("says -7 tiles"));
  // The count alone is also in a plain private element.
  Picture plain = mosaic(csa(2, {{"SliceNormalVector", {"0", "0", "1"}}}));
  plain.text(0x00190010, "LO", "SIEMENS MR HEADER").number(0x0019100a, 7);
  CHECK(reason(plain) == "read");
}

TEST_CASE("A mosaic of a scanner is its 35 slices", "[imaging]") {
  C3DE_DATA_OR_SKIP(file, "found/siemens_mosaic.dcm");
  const auto folder = emptyFolder("mosaic");
  copyFile(file, folder / "mosaic.dcm");
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  const VolumeGeometry &g = loaded->volume.geometry;
  REQUIRE(g.size == std::array<std::size_t, 3>{64, 64, 35});
  CHECK(says(loaded->notices, "mosaic of 35 slices"));
  checkAt({g.spacing()[0], g.spacing()[1], g.spacing()[2]}, {3.25, 3.25, 3.6});
  // Image Position plus 160 pixels of 3.25 mm along row (1, 0, 0) and column (0, 0.99415, -0.108): half of the
  // difference in width between a picture of 384 pixels and one of 64.
  checkAt(g.worldAt({0, 0, 0}), {-624.0 + 520.0, -661.82658862 + 520.0 * 0.99415096, -6.52550177 - 520.0 * 0.10799935});
  // Upwards along the stated normal (0, 0.108, 0.99415).
  checkAt(g.worldAt({0, 0, 34}) - g.worldAt({0, 0, 0}), {0.0, 34 * 3.6 * 0.10799944, 34 * 3.6 * 0.99415095});
}
