// SPDX-License-Identifier: Apache-2.0
// Pixels other than grey integers: parametric maps in floating point, colours, films.
#include "dicom_made.h"

using namespace made;

namespace {

Expected<LoadedVolume> readBack(const Picture &picture, const std::string &syntax = "1.2.840.10008.1.2.1",
                                std::size_t time = 0) {
  ReadOptions options;
  options.time = time;
  return readVolume(write(emptyFolder("kinds") / "one.dcm", picture.file(syntax)), options);
}

/// 4 x 2 pixels in colours.
Picture coloured(const std::string &photometric, std::uint16_t samples) {
  Picture out(4, 2);
  out.bits(8).number(0x00280002, samples).text(0x00280004, "CS", photometric).text(0x00080060, "CS", "US");
  return out;
}

const std::vector<Rgba> kColours{{255, 0, 0, 255}, {0, 255, 0, 255},   {0, 0, 255, 255},  {255, 255, 255, 255},
                                 {0, 0, 0, 255},   {128, 64, 32, 255}, {10, 20, 30, 255}, {200, 100, 50, 255}};

void checkColours(const Expected<LoadedVolume> &loaded, int tolerance) {
  REQUIRE(loaded);
  REQUIRE(loaded->volume.colours.size() == kColours.size());
  int most = 0;
  for (std::size_t v = 0; v < kColours.size(); ++v) {
    for (std::size_t c = 0; c < 4; ++c) most = std::max(most, std::abs(loaded->volume.colours[v][c] - kColours[v][c]));
    const Rgba &rgb = loaded->volume.colours[v];
    CHECK(std::abs(loaded->volume.value(v % 4, v / 4, 0) - (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2])) <=
          0.5 + 1e-9);
  }
  CHECK(most <= tolerance);
  CHECK(says(loaded->notices, "colour image"));
}

/// Y, Cb, Cr of full range, PS3.3 C.7.6.3.1.2.
std::array<std::uint8_t, 3> differenceOf(const Rgba &c) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::clamp(std::lround(x), 0L, 255L)); };
  return {byte(0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]), byte(-0.168736 * c[0] - 0.331264 * c[1] + 0.5 * c[2] + 128),
          byte(0.5 * c[0] - 0.418688 * c[1] - 0.081312 * c[2] + 128)};
}

}  // namespace

TEST_CASE("Floating-point pixels of a parametric map are read with their meaning", "[imaging]") {
  const std::string mapping = item([](DicomElements &e) {
    const std::string unit = item([](DicomElements &u) { u.add(0x0008, 0x0100, "SH", "um2/s"); });
    e.add(0x0040, 0x08ea, std::vector<std::string>{unit});
    e.add(0x0040, 0x9224, "FD", packed(std::vector<double>{-3.0}));
    e.add(0x0040, 0x9225, "FD", packed(std::vector<double>{2.0}));
  });
  const std::vector<float> floats{0.5f, -1.25f, 1e-9f, 3.0f, 1e6f, 0.0f};
  Picture map(3, 2);
  map.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.30").sequence(0x52009229, {item([&](DicomElements &e) {
                                                                      e.add(0x0040, 0x9096,
                                                                            std::vector<std::string>{mapping});
                                                                    })});
  for (const std::uint32_t tag : {0x00280101u, 0x00280102u, 0x00280103u}) map.without(tag);
  Picture wide = map;
  map.number(0x00280100, 32).text(0x7fe00008, "OF", packed(floats));
  const auto loaded = readBack(map);
  REQUIRE(loaded);
  CHECK(std::get<std::vector<float>>(loaded->volume.voxels) == floats);
  CHECK(loaded->volume.unit == "um2/s");
  CHECK(loaded->volume.value(1, 0, 0) == 2.0 * -1.25 - 3.0);

  const std::vector<double> doubles{0.1, 1e-300, -7.0, 1.0 / 3.0, 1e300, 0.0};
  wide.number(0x00280100, 64).text(0x7fe00009, "OD", packed(doubles));
  const auto exact = readBack(wide);
  REQUIRE(exact);
  CHECK(std::get<std::vector<double>>(exact->volume.voxels) == doubles);

  const auto cut = readBack(map.text(0x7fe00008, "OF", packed(std::vector<float>{1.0f})));
  REQUIRE_FALSE(cut);
  CHECK_THAT(cut.error().message, Contains("truncated: 4 of 24 bytes"));
}

TEST_CASE("Colours come as colours, their brightness as values", "[imaging]") {
  std::vector<std::uint8_t> together, apart(24), luma, pairs;
  for (std::size_t p = 0; p < 8; ++p)
    for (std::size_t c = 0; c < 3; ++c) together.push_back(kColours[p][c]), apart[8 * c + p] = kColours[p][c];
  checkColours(readBack(coloured("RGB", 3).number(0x00280006, 0).pixels(together)), 0);
  checkColours(readBack(coloured("RGB", 3).number(0x00280006, 1).pixels(apart)), 0);
  for (const Rgba &colour : kColours)
    for (const std::uint8_t part : differenceOf(colour)) luma.push_back(part);
  checkColours(readBack(coloured("YBR_FULL", 3).number(0x00280006, 0).pixels(luma)), 2);  // of 8 bits each way

  std::vector<std::uint16_t> deep;
  for (const std::uint8_t part : together) deep.push_back(static_cast<std::uint16_t>(part * 257));
  checkColours(readBack(coloured("RGB", 3).bits(16).number(0x00280006, 0).pixels(deep)), 0);

  Picture palette = coloured("PALETTE COLOR", 1);
  palette.pixels(std::vector<std::uint8_t>{3, 4, 5, 6, 7, 8, 9, 10});
  for (std::uint32_t c = 0; c < 3; ++c) {
    std::vector<std::uint16_t> table;
    for (const Rgba &colour : kColours) table.push_back(static_cast<std::uint16_t>(colour[c] << 8));
    palette.text(0x00281101 + c, "US", packed(std::vector<std::uint16_t>{8, 3, 16}))
        .text(0x00281201 + c, "OW", packed(table));
  }
  checkColours(readBack(palette), 0);
  const auto lost = readBack(palette.without(0x00281202));
  REQUIRE_FALSE(lost);
  CHECK_THAT(lost.error().message, Contains("tables of its palette"));
}

TEST_CASE("Pairs of pixels that share their colour differences are read", "[imaging]") {
  std::vector<std::uint8_t> stored;
  for (std::size_t p = 0; p < 8; p += 2) {
    const auto a = differenceOf(kColours[p]);
    stored.insert(stored.end(), {a[0], static_cast<std::uint8_t>(a[0] / 2), a[1], a[2]});
  }
  const auto loaded = readBack(coloured("YBR_FULL_422", 3).number(0x00280006, 0).pixels(stored));
  REQUIRE(loaded);
  for (std::size_t p = 0; p < 8; p += 2)
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(loaded->volume.colours[p][c] - kColours[p][c]) <= 2);
}

TEST_CASE("Colours that are not read are refused by name, and colours are no labels", "[imaging]") {
  const auto refused = readBack(coloured("HSV", 3).pixels(std::vector<std::uint8_t>(24)));
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message,
             Contains("holds colours (HSV, 3 numbers of 8 bits per pixel)") && Contains("PALETTE COLOR are read"));
  write(emptyFolder("labels") / "one.dcm", coloured("RGB", 3).pixels(std::vector<std::uint8_t>(24)).file());
  const auto labels = readLabelMap(testOutputFolder() / "labels/one.dcm");
  REQUIRE_FALSE(labels);
  CHECK_THAT(labels.error().message, Contains("no label map: it holds colours"));
}

TEST_CASE("Compressed colours of scanners are read", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/pydicom_single");
  const auto ultrasound = readVolume(data / "examples_jpeg2k.dcm");
  REQUIRE(ultrasound);
  REQUIRE(ultrasound->volume.colours.size() == 640u * 480u);
  const auto grey = std::count_if(ultrasound->volume.colours.begin(), ultrasound->volume.colours.end(),
                                  [](const Rgba &c) { return c[0] == c[1] && c[1] == c[2]; });
  CHECK(grey > 250000);     // an ultrasound picture is mostly grey …
  CHECK(grey < 640 * 480);  // … with some coloured writing
  ReadOptions second;
  second.time = 1;
  const auto first = readVolume(data / "SC_rgb_rle_2frame.dcm"),
             other = readVolume(data / "SC_rgb_rle_2frame.dcm", second);
  REQUIRE((first && other));
  CHECK(says(first->notices, "(a cine loop)"));
  CHECK(first->times == 2);
  CHECK(first->volume.colours.front() == Rgba{255, 0, 0, 255});
  for (std::size_t p = 0; p < first->volume.colours.size(); p += 501)  // the second frame is the negative of the first
    for (std::size_t c = 0; c < 3; ++c) CHECK(first->volume.colours[p][c] + other->volume.colours[p][c] == 255);
}

TEST_CASE("JPEG pictures in luma and colour differences are read", "[imaging]") {
  C3DE_DATA_OR_SKIP(file, "dicom/seg_tiny_nonsquare/brainlab.jpg");
  std::string jpeg = bytesOf(file);
  if (jpeg.size() % 2 != 0) jpeg += '\0';
  Picture picture(1915, 1196);
  picture.bits(8)
      .number(0x00280002, 3)
      .text(0x00280004, "CS", "YBR_FULL_422")
      .number(0x00280006, 0)
      .text(0x00080060, "CS", "XC");
  std::string elements =
      picture.elements() +
      std::string("\xe0\x7f\x10\0OB\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\x00\xe0", 24);
  for (unsigned b = 0; b < 4; ++b) elements += static_cast<char>(jpeg.size() >> 8 * b & 255);
  elements += jpeg + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
  const auto loaded =
      readVolume(write(emptyFolder("jpeg") / "one.dcm", test::dicomFile(elements, "1.2.840.10008.1.2.4.50")));
  REQUIRE(loaded);
  // The result of another decoder; colour differences are stored coarsely and may be smoothed.
  for (const auto &[x, y, colour] : {std::tuple{957u, 598u, Rgba{253, 248, 245, 255}},
                                     {1700u, 200u, Rgba{16, 16, 16, 255}},
                                     {100u, 100u, Rgba{0, 0, 0, 255}}})
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(loaded->volume.colours[x + 1915u * y][c] - colour[c]) <= 4);
}
