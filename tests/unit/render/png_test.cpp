// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>

#include "c3de/render/png_file.h"
#include "c3de/render/renderer.h"
#include "support/catch.h"

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // functions of the library that are not used here
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
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
