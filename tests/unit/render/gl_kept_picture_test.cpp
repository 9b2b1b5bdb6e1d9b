// SPDX-License-Identifier: Apache-2.0
// An offscreen picture that is retained from frame to frame.
#include "c3de/render_gl/kept_picture.h"
#include "gl_fixture.h"
#include "gl_target.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

std::vector<std::uint8_t> pixelsOf(int width, int height) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(4 * width * height));
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  return pixels;
}

}  // namespace

TEST_CASE("What was painted into a kept picture is shown as if it were drawn in each frame") {
  C3DE_GL_OR_SKIP(gl);
  const Shape ball = blob(20, 30, 25, 0.1f);
  gl.renderer->createMesh(ball.positions, ball.triangles, {{0.8f, 0.3f, 0.3f, 1}});
  gl.renderer->createMesh(ball.positions, ball.triangles, {{0.8f, 0.3f, 0.3f, 0.4f}, true});
  const Target target(200, 120);
  const Viewport part{30, 20, 100, 80};
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  gl.renderer->draw(frontCamera(), part);
  const auto drawn = pixelsOf(200, 120);

  CachedPicture picture;
  REQUIRE(picture.prepare(200, 120) == CachedPicture::State::empty);
  picture.paint([&] { gl.renderer->draw(frontCamera(), part); });
  for (int frame = 0; frame < 2; ++frame) {
    CHECK(picture.prepare(200, 120) == CachedPicture::State::kept);
    glClear(GL_COLOR_BUFFER_BIT);
    picture.show(part);
    CHECK(pixelsOf(200, 120) == drawn);
  }
  // The previously bound framebuffer is bound again.
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  CHECK(static_cast<GLuint>(bound) == target.framebuffer);
  CHECK(picture.prepare(100, 120) == CachedPicture::State::empty);
  CHECK(glGetError() == static_cast<GLenum>(GL_NO_ERROR));
}

TEST_CASE("No picture is kept for a framebuffer that smooths edges, or without pixels") {
  C3DE_GL_OR_SKIP(gl);
  CachedPicture picture;
  {
    const Target target(64, 64);
    REQUIRE(picture.prepare(64, 64) == CachedPicture::State::empty);
    CHECK(picture.prepare(0, 64) == CachedPicture::State::none);
    CHECK(picture.prepare(64, 64) == CachedPicture::State::empty);
  }
  GLuint framebuffer = 0, colour = 0;
  glGenFramebuffers(1, &framebuffer);
  glGenRenderbuffers(1, &colour);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glBindRenderbuffer(GL_RENDERBUFFER, colour);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, 4, GL_RGBA8, 64, 64);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLE_BUFFERS, &samples);
  if (samples > 0) CHECK(picture.prepare(64, 64) == CachedPicture::State::none);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteRenderbuffers(1, &colour);
}

TEST_CASE("A kept picture and a framebuffer that smooths edges are read, top row first") {
  C3DE_GL_OR_SKIP(gl);
  const auto paint = [] {
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0, 0, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 32, 64, 32);  // the upper half
    glClearColor(1, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
  };
  const auto check = [](const std::optional<Image> &image) {
    REQUIRE(image);
    CHECK(image->width == 40);
    REQUIRE(image->height == 50);
    const auto pixel = [&](int row) {
      const auto at = static_cast<std::size_t>(3 * 40 * row);
      return std::vector<int>{image->rgb[at], image->rgb[at + 1], image->rgb[at + 2]};
    };
    CHECK(pixel(0) == std::vector<int>{255, 0, 0});
    CHECK(pixel(21) == std::vector<int>{255, 0, 0});
    CHECK(pixel(22) == std::vector<int>{0, 0, 255});
    CHECK(pixel(49) == std::vector<int>{0, 0, 255});
  };
  const Viewport part{10, 4, 40, 50};
  {
    const Target target(64, 64);
    CachedPicture picture;
    CHECK_FALSE(picture.read(part));
    REQUIRE(picture.prepare(64, 64) == CachedPicture::State::empty);
    picture.paint(paint);
    check(picture.read(part));
    CHECK_FALSE(picture.read({30, 4, 40, 50}));
  }
  FramebufferCopy copy;
  CHECK_FALSE(copy.read());
  GLuint framebuffer = 0, colour = 0;
  glGenFramebuffers(1, &framebuffer);
  glGenRenderbuffers(1, &colour);
  glBindRenderbuffer(GL_RENDERBUFFER, colour);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, 4, GL_RGB8, 64, 64);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  REQUIRE(glCheckFramebufferStatus(GL_FRAMEBUFFER) == static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
  paint();
  copy.take(part);
  check(copy.read());
  copy.take({0, 0, 0, 0});
  CHECK_FALSE(copy.read());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteRenderbuffers(1, &colour);
  glDeleteFramebuffers(1, &framebuffer);
}
