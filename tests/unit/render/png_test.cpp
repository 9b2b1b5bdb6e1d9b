// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "c3de/render/picture_file.h"
#include "c3de/render/png_file.h"
#include "c3de/render/renderer.h"
#include "support/catch.h"
#include "support/png_resolution.h"

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // functions of the library that are not used here
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_WINDOWS_UTF8
#include <stb_image.h>

using namespace c3de;
using namespace c3de::render;

namespace {

std::string outputFile(const char *name) {
  std::filesystem::create_directories(testOutputRoot());
  return (std::filesystem::path(testOutputRoot()) / name).string();
}

Image testImage() {
  Image image{37, 23, {}};
  for (int i = 0; i < 3 * 37 * 23; ++i) image.rgb.push_back(static_cast<std::uint8_t>((i * 31 + i / 7) & 255));
  return image;
}

}  // namespace

TEST_CASE("A written PNG reads back to the same pixels, top row first") {
  const Image image = testImage();
  const std::string path = outputFile("round_trip_µ.png");
  const auto written = writePng(path, image);
  REQUIRE(written.has_value());

  int width = 0, height = 0, channels = 0;
  unsigned char *pixels = stbi_load(path.c_str(), &width, &height, &channels, 3);
  REQUIRE(pixels != nullptr);
  CHECK(width == image.width);
  CHECK(height == image.height);
  CHECK(channels == 3);
  CHECK(std::equal(image.rgb.begin(), image.rgb.end(), pixels));
  stbi_image_free(pixels);
}

TEST_CASE("A PNG states its resolution in a pHYs chunk, and has the same pixels") {
  const Image image = testImage();
  const auto bytes = encodePng(image, 300.0);
  REQUIRE(bytes.has_value());
  const auto size = c3de::test::pngSize({bytes->begin(), bytes->end()});
  REQUIRE(size.has_value());
  CHECK(size->width == 37);
  CHECK(size->height == 23);
  CHECK(size->perMetreX == 11811);  // 300 / 0.0254 m = 11811.02
  CHECK(size->perMetreY == 11811);
  CHECK(size->unit == 1);
  CHECK(size->crc == 0x78a53f76u);  // of the chunk, computed by zlib
  CHECK(size->isBeforeData);

  int width = 0, height = 0, channels = 0;
  unsigned char *pixels = stbi_load_from_memory(reinterpret_cast<const unsigned char *>(bytes->data()),
                                                static_cast<int>(bytes->size()), &width, &height, &channels, 3);
  REQUIRE(pixels != nullptr);
  CHECK(std::equal(image.rgb.begin(), image.rgb.end(), pixels));
  stbi_image_free(pixels);
}

TEST_CASE("A resolution that a PNG cannot state is refused with what is accepted, and 0 states none") {
  for (const double dpi : {-1.0, 0.01, 2e6, std::nan("")}) {
    const auto bytes = encodePng(testImage(), dpi);
    REQUIRE(!bytes.has_value());
    CHECK_THAT(bytes.error().message, Contains("accepted: 0.1 to 1000000"));
  }
  const auto bytes = encodePng(testImage(), 0.0);
  REQUIRE(bytes.has_value());
  const auto size = c3de::test::pngSize({bytes->begin(), bytes->end()});
  REQUIRE(size.has_value());
  CHECK(size->perMetreX == 0);
}

TEST_CASE("A PNG into a folder that does not exist is an output error that names the file") {
  const std::string path = outputFile("no-such-folder/picture.png");
  const auto written = writePng(path, testImage());
  REQUIRE(!written.has_value());
  CHECK(written.error().code == ErrorCode::output);
  CHECK_THAT(written.error().message, Contains(path));
}

TEST_CASE("An image whose bytes do not fit its size is not written") {
  Image image = testImage();
  image.rgb.pop_back();
  CHECK(!writePng(outputFile("short.png"), image).has_value());
}

TEST_CASE("A PNG is read again, and a damaged one is refused by name") {
  const Image image = testImage();
  const std::filesystem::path file = outputFile("read_again.png");
  REQUIRE(writePng(file.string(), image).has_value());
  const auto read = readPng(file);
  REQUIRE(read);
  CHECK(read->width == image.width);
  CHECK(read->height == image.height);
  CHECK(read->rgb == image.rgb);

  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const auto truncated = readPng(file);
  REQUIRE_FALSE(truncated);
  CHECK(truncated.error().code == ErrorCode::input);
  CHECK_THAT(truncated.error().message, Contains("read_again.png") && Contains("not a readable PNG"));
  std::ofstream(file, std::ios::trunc) << "";
  CHECK_FALSE(readPng(file));
  CHECK_FALSE(readPng(file.parent_path() / "absent.png"));
  CHECK_FALSE(readPng(file.parent_path()));
}

TEST_CASE("A written JPEG has the colours of the picture, and an unknown extension is refused") {
  // Smooth, with a different slope for each colour; an edge is not what the format keeps.
  Image image{64, 48, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const int value : {3 * x, 5 * y, 255 - 2 * x - y}) image.rgb.push_back(static_cast<std::uint8_t>(value));
  const std::string path = outputFile("colours.jpeg");
  REQUIRE(writePicture(path, image));
  int width = 0, height = 0, channels = 0;
  stbi_uc *read = stbi_load(path.c_str(), &width, &height, &channels, 3);
  REQUIRE(read != nullptr);
  CHECK(width == image.width);
  CHECK(height == image.height);
  int largest = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<int>(read[i]) - static_cast<int>(image.rgb[i])));
  stbi_image_free(read);
  // Of 255; quality 92 quantises smooth colours to about 2.
  CHECK(largest <= 8);

  REQUIRE(writePicture(outputFile("picture.PNG"), image));
  CHECK(readPng(outputFile("picture.PNG"))->rgb == image.rgb);
  CHECK(isPictureFile("a.JPG"));
  CHECK_FALSE(isPictureFile("a.gif"));
  const auto refused = writePicture(outputFile("a.gif"), image);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::usage);
  CHECK_THAT(refused.error().message, Contains("accepted: .png, .jpg, .jpeg, .ppm"));
  CHECK_FALSE(encodeJpeg(image, 0));
  CHECK_FALSE(encodeJpeg({2, 2, {1, 2, 3}}, 90));
}
