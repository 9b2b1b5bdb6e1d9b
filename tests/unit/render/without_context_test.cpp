// SPDX-License-Identifier: Apache-2.0
#include "c3de/render_gl/gl_renderer.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::render;

TEST_CASE("Without a context the OpenGL renderer is refused with the version it needs") {
  // No context is current on this thread: this program creates none.
  const auto renderer = createGlRenderer();
  REQUIRE(!renderer.has_value());
  CHECK(renderer.error().code == ErrorCode::graphics);
  CHECK_THAT(renderer.error().message, Contains("OpenGL 4.3 core is needed"));
}
