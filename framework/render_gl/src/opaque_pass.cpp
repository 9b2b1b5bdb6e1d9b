// SPDX-License-Identifier: Apache-2.0
#include "opaque_pass.h"

#include <chrono>

#include "shaders.h"

namespace c3de::render {
namespace {

/// The buffers of a proxy. The vertex array is set up once; updates only replace the contents of the buffers.
struct ProxyBuffers final : BackEndData {
  VertexArray array = VertexArray::create();
  Buffer positions = Buffer::create(), normals = Buffer::create(), colours = Buffer::create(), radii = Buffer::create(),
         indices = Buffer::create();
};

constexpr GLuint kInstanced = 1;

void describeMesh(const Proxy &proxy, const ProxyBuffers &buffers) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers.positions.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(Vec3f), 0);
  glBindBuffer(GL_ARRAY_BUFFER, buffers.normals.name());
  setFloatAttribute(shaders::kNormal, 3, sizeof(Vec3f), 0);
  glBindBuffer(GL_ARRAY_BUFFER, buffers.colours.name());
  setColourAttribute(shaders::kColour, sizeof(Rgba8), 0);
  uploadBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers.indices, std::span<const Triangle>(proxy.triangles));
}

void describeSpheres(const ProxyBuffers &buffers) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers.positions.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(Vec3f), 0);
  glBindBuffer(GL_ARRAY_BUFFER, buffers.colours.name());
  setColourAttribute(shaders::kColour, sizeof(Rgba8), 0);
  glBindBuffer(GL_ARRAY_BUFFER, buffers.radii.name());
  setFloatAttribute(shaders::kRadius, 1, sizeof(float), 0);
  for (const GLuint location : {shaders::kPosition, shaders::kColour, shaders::kRadius})
    glVertexAttribDivisor(location, kInstanced);
}

void describeLines(const ProxyBuffers &buffers) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers.positions.name());
  setFloatAttribute(shaders::kPosition, 3, 2 * sizeof(Vec3f), 0);
  setFloatAttribute(shaders::kEnd, 3, 2 * sizeof(Vec3f), sizeof(Vec3f));
  glBindBuffer(GL_ARRAY_BUFFER, buffers.colours.name());
  setColourAttribute(shaders::kColour, 2 * sizeof(Rgba8), 0);
  setColourAttribute(shaders::kEndColour, 2 * sizeof(Rgba8), sizeof(Rgba8));
  for (const GLuint location : {shaders::kPosition, shaders::kEnd, shaders::kColour, shaders::kEndColour})
    glVertexAttribDivisor(location, kInstanced);
}

ProxyBuffers &buffersOf(Proxy &proxy, RenderStatistics &statistics) {
  if (!proxy.backEnd) {
    auto made = std::make_unique<ProxyBuffers>();
    glBindVertexArray(made->array.name());
    switch (proxy.kind) {
      case ProxyKind::mesh: describeMesh(proxy, *made); break;
      case ProxyKind::spheres: describeSpheres(*made); break;
      case ProxyKind::lines: describeLines(*made); break;
      case ProxyKind::label:
      case ProxyKind::legend: break;
    }
    proxy.backEnd = std::move(made);
    ++statistics.vertexArraysMade;
  }
  return static_cast<ProxyBuffers &>(*proxy.backEnd);
}

/// An existing array is read from its buffer, a missing one is replaced by a constant.
void useArray(GLuint location, bool present) {
  if (present)
    glEnableVertexAttribArray(location);
  else
    glDisableVertexAttribArray(location);
}

template <class T>
void replace(const Buffer &buffer, std::span<const T> values, RenderStatistics &statistics) {
  uploadBuffer(GL_ARRAY_BUFFER, buffer, values);
  statistics.uploadedBytes += values.size_bytes();
}

void upload(Proxy &proxy, ProxyBuffers &buffers, RenderStatistics &statistics) {
  const auto begin = std::chrono::steady_clock::now();
  if (proxy.kind == ProxyKind::mesh) proxy.updateNormals();
  if (proxy.stale.positions) replace(buffers.positions, std::span<const Vec3f>(proxy.positions), statistics);
  if (proxy.stale.normals && proxy.kind == ProxyKind::mesh)
    replace(buffers.normals, std::span<const Vec3f>(proxy.normals), statistics);
  if (proxy.stale.radii && proxy.kind == ProxyKind::spheres)
    replace(buffers.radii, std::span<const float>(proxy.radii), statistics);
  if (proxy.stale.colours) {
    std::vector<Rgba8> bytes;
    bytes.reserve(proxy.colours.size());
    for (const Colour &c : proxy.colours) bytes.push_back(toRgba8(c));
    replace(buffers.colours, std::span<const Rgba8>(bytes), statistics);
  }
  proxy.stale = {false, false, false, false};
  statistics.upload_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

void drawOpaque(Proxy &proxy, const Frame &frame, const Programs &programs, RenderStatistics &statistics,
                bool isDepthOnly) {
  ProxyBuffers &buffers = buffersOf(proxy, statistics);
  glBindVertexArray(buffers.array.name());
  upload(proxy, buffers, statistics);

  const Mat4 viewFromProxy = multiply(frame.view, proxy.transform);
  const Mat4f viewFromProxyF = toFloat(viewFromProxy);
  const Program &program = proxy.kind == ProxyKind::mesh      ? programs.mesh
                           : proxy.kind == ProxyKind::spheres ? programs.sphere
                                                              : programs.line;
  glUseProgram(program.name());
  glUniformMatrix4fv(shaders::kProjection, 1, GL_FALSE, frame.projectionF.data());
  glUniformMatrix4fv(shaders::kViewFromProxy, 1, GL_FALSE, viewFromProxyF.data());
  setCuts(frame);

  const bool hasColours = !proxy.colours.empty();
  useArray(shaders::kColour, hasColours);
  if (!hasColours) glVertexAttrib4fv(shaders::kColour, proxy.material.colour.data());

  switch (proxy.kind) {
    case ProxyKind::mesh: {
      const Mat3f normals = normalMatrix(viewFromProxy);
      glUniformMatrix3fv(shaders::kNormalMatrix, 1, GL_FALSE, normals.data());
      glUniform1i(shaders::kTwoSided, proxy.material.twoSided ? 1 : 0);
      glUniform1f(shaders::kCover, isDepthOnly ? proxy.material.cover * lengthScale(proxy.transform) : 0.0f);
      glUniform1i(shaders::kBlended, 0);
      glFrontFace(linearDeterminant(proxy.transform) < 0.0 ? GL_CW : GL_CCW);
      if (!proxy.material.twoSided) glEnable(GL_CULL_FACE);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * proxy.triangles.size()), GL_UNSIGNED_INT, nullptr);
      glDisable(GL_CULL_FACE);
      glFrontFace(GL_CCW);
      break;
    }
    case ProxyKind::spheres: {
      const bool hasRadii = !proxy.radii.empty();
      useArray(shaders::kRadius, hasRadii);
      if (!hasRadii) glVertexAttrib1f(shaders::kRadius, proxy.radius);
      glUniform1f(shaders::kRadiusScale, lengthScale(proxy.transform));
      glUniform1i(shaders::kSmoothEdge, frame.multisampled ? 1 : 0);
      glUniform1i(shaders::kBlended, 0);
      // The edge of an impostor is inside its square, where multisampling has no effect: coverage is passed through
      // alpha.
      if (frame.multisampled) glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(proxy.positions.size()));
      glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
      break;
    }
    case ProxyKind::lines:
      useArray(shaders::kEndColour, hasColours);
      if (!hasColours) glVertexAttrib4fv(shaders::kEndColour, proxy.material.colour.data());
      glVertexAttrib1f(shaders::kWidth, proxy.width_px);
      glUniform2fv(shaders::kViewportSize, 1, frame.scaledSize().data());
      glUniform1f(shaders::kNear, frame.nearPlane);
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(proxy.positions.size() / 2));
      break;
    case ProxyKind::label:
    case ProxyKind::legend: break;
  }
  ++statistics.drawCalls;
}

}  // namespace c3de::render
