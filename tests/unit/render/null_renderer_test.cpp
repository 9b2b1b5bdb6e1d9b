// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/renderer.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::render;

TEST_CASE("The null renderer's image has the asked size and the background's colour") {
  const auto renderer = createNullRenderer();
  renderer->setBackground({{1.0f, 0.5f, 0.0f, 1.0f}, {1.0f, 0.5f, 0.0f, 1.0f}});
  const auto image = renderer->drawToImage(Camera{}, 8, 5);
  REQUIRE(image.has_value());
  CHECK(image->width == 8);
  CHECK(image->height == 5);
  REQUIRE(image->rgb.size() == 8u * 5u * 3u);
  CHECK(image->rgb[0] == 255);
  CHECK(image->rgb[1] == 128);
  CHECK(image->rgb[2] == 0);
}

TEST_CASE("An image without size is a usage error that names the size") {
  const auto renderer = createNullRenderer();
  const auto image = renderer->drawToImage(Camera{}, 0, 5);
  REQUIRE(!image.has_value());
  CHECK(image.error().code == ErrorCode::usage);
  CHECK_THAT(image.error().message, Contains("0 x 5"));
}

TEST_CASE("Without a context the OpenGL renderer is refused with the version it needs") {
  // No context is current on this thread: this program makes none.
  const auto renderer = createGlRenderer();
  REQUIRE(!renderer.has_value());
  CHECK(renderer.error().code == ErrorCode::graphics);
  CHECK_THAT(renderer.error().message, Contains("OpenGL 4.3 core is needed"));
}
