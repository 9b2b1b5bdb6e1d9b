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
