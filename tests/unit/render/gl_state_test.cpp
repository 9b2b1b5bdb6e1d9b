// SPDX-License-Identifier: Apache-2.0
// The renderer's handling of the context that it shares with the user interface.
#include "gl_fixture.h"
#include "gl_target.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

void fillScene(Renderer &r) {
  const Shape ball = blob(20, 30, 25, 0.1f);
  r.createMesh(ball.positions, ball.triangles, {{0.8f, 0.3f, 0.3f, 1}});
  r.createMesh(ball.positions, ball.triangles, {{0.8f, 0.3f, 0.3f, 0.4f}, true});
  r.createSpheres(std::vector<Vec3f>{{0, 0, 30}, {10, 0, 30}}, 4.0f, {{0.2f, 0.9f, 0.3f, 1}});
  r.createLines(std::vector<Vec3f>{{-40, 0, 0}, {40, 0, 0}}, 3.0f, {{1, 1, 1, 1}});
  r.createLabel({0, 10, 0}, "label", {{1, 1, 1, 1}});
}

}  // namespace

TEST_CASE("Drawing touches only its viewport") {
  C3DE_GL_OR_SKIP(gl);
  fillScene(*gl.renderer);
  const Target target(200, 100);
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  gl.renderer->draw(frontCamera(), {100, 20, 80, 60});
  for (const auto &[x, y] : {std::pair{99, 50}, {180, 50}, {140, 19}, {140, 80}, {0, 0}})
    CHECK(target.at(x, y) == Rgb{255, 0, 255});
  for (const auto &[x, y] : {std::pair{100, 20}, {179, 79}, {140, 50}}) CHECK(target.at(x, y) != Rgb{255, 0, 255});
  gl.renderer->draw(frontCamera(), {0, 0, 0, 0});
  CHECK(glGetError() == static_cast<GLenum>(GL_NO_ERROR));
}

TEST_CASE("The picture does not depend on the state that was left by others") {
  C3DE_GL_OR_SKIP(gl);
  fillScene(*gl.renderer);
  const Target target(160, 120);
  const auto drawAndRead = [&] {
    gl.renderer->draw(frontCamera(), {0, 0, 160, 120});
    std::vector<std::uint8_t> pixels(4 * 160 * 120);
    glReadPixels(0, 0, 160, 120, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
  };
  const auto clean = drawAndRead();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glBlendEquation(GL_FUNC_REVERSE_SUBTRACT);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, 3, 3);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  glFrontFace(GL_CW);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_NEVER);
  glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glViewport(0, 0, 5, 5);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glClearDepth(0.0);
  const bool samePicture = drawAndRead() == clean;
  CHECK(samePicture);
}

TEST_CASE("Afterwards nothing is bound or left on, and no error is pending") {
  C3DE_GL_OR_SKIP(gl);
  fillScene(*gl.renderer);
  const Target target(160, 120);
  gl.renderer->draw(frontCamera(), {0, 0, 160, 120});
  CHECK(glGetError() == static_cast<GLenum>(GL_NO_ERROR));
  for (const GLenum off :
       {GL_DEPTH_TEST, GL_SCISSOR_TEST, GL_CULL_FACE, GL_BLEND, GL_FRAMEBUFFER_SRGB, GL_SAMPLE_ALPHA_TO_COVERAGE})
    CHECK(glIsEnabled(off) == GL_FALSE);
  for (const GLenum binding :
       {GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING, GL_TEXTURE_BINDING_2D}) {
    GLint name = -1;
    glGetIntegerv(binding, &name);
    CHECK(name == 0);
  }
  GLboolean depthMask = GL_FALSE;
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depthMask);
  CHECK(depthMask == GL_TRUE);
}

TEST_CASE("The colours are the same in an sRGB framebuffer") {
  C3DE_GL_OR_SKIP(gl);
  fillScene(*gl.renderer);
  const auto read = [&](GLenum format) {
    const Target target(160, 120, format);
    gl.renderer->draw(frontCamera(), {0, 0, 160, 120});
    return std::array{target.at(80, 60), target.at(5, 5), target.at(70, 70)};
  };
  CHECK(read(GL_RGBA8) == read(GL_SRGB8_ALPHA8));
}

TEST_CASE("Drawing into an image gives the framebuffer back that was bound") {
  C3DE_GL_OR_SKIP(gl);
  const Target target(50, 40);
  drawn(*gl.renderer, frontCamera());
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  CHECK(bound == static_cast<GLint>(target.framebuffer));
}

TEST_CASE("Updating arrays links no program and makes no vertex array") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  Shape ball = blob(20, 30, 25, 0.1f);
  const Handle mesh = r.createMesh(ball.positions, ball.triangles, {});
  const Handle spheres = r.createSpheres(ball.positions, 1.0f, {});
  const Handle lines = r.createLines(ball.positions, 1.0f, {});
  drawn(r, frontCamera());
  const RenderStatistics before = r.statistics();
  CHECK(before.vertexArraysMade == 3);
  for (int i = 0; i < 5; ++i) {
    for (Vec3f &p : ball.positions) p[0] *= 1.05f;
    const std::vector<Colour> colours(ball.positions.size(), Colour{0.1f * float(i), 0.5f, 0.5f, 1});
    for (const Handle h : {mesh, spheres, lines}) {
      REQUIRE(r.setPositions(h, ball.positions));
      REQUIRE(r.setColours(h, colours));
    }
    REQUIRE(r.setPositions(spheres, std::span(ball.positions).first(static_cast<std::size_t>(10 + i))));
    drawn(r, frontCamera());
  }
  CHECK(r.statistics().vertexArraysMade == before.vertexArraysMade);
  CHECK(r.statistics().programsLinked == before.programsLinked);
  CHECK(r.statistics().drawCalls == before.drawCalls);
}
