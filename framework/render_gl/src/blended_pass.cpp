// SPDX-License-Identifier: Apache-2.0
#include "blended_pass.h"

#include <algorithm>
#include <chrono>

#include "shaders.h"

namespace c3de::render {
namespace {

// An item identifies its primitive by kind (upper two bits) and index.
constexpr std::uint32_t kIndexBits = 30, kIndexMask = (1u << kIndexBits) - 1;

Rgba8 colourOf(const Proxy &proxy, std::size_t point) {
  return proxy.colours.empty() ? toRgba8(proxy.material.colour)
                               : toRgba8(proxy.colours[point], proxy.material.colour[3]);
}

bool facesAway(const Vec3f &a, const Vec3f &b, const Vec3f &c) {
  const Vec3f u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const Vec3f n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return n[0] * a[0] + n[1] * a[1] + n[2] * a[2] >= 0.0f;  // the eye is the origin
}

}  // namespace

BlendedPass::BlendedPass()
    : meshArray_(VertexArray::create()), sphereArray_(VertexArray::create()), lineArray_(VertexArray::create()),
      vertexBuffer_(Buffer::create()), indexBuffer_(Buffer::create()), sphereBuffer_(Buffer::create()),
      segmentBuffer_(Buffer::create()) {
  glBindVertexArray(meshArray_.name());
  glBindBuffer(GL_ARRAY_BUFFER, vertexBuffer_.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(MeshVertex), offsetof(MeshVertex, position));
  setFloatAttribute(shaders::kNormal, 3, sizeof(MeshVertex), offsetof(MeshVertex, normal));
  setColourAttribute(shaders::kColour, sizeof(MeshVertex), offsetof(MeshVertex, colour));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_.name());

  glBindVertexArray(sphereArray_.name());
  glBindBuffer(GL_ARRAY_BUFFER, sphereBuffer_.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(Sphere), offsetof(Sphere, centre));
  setFloatAttribute(shaders::kRadius, 1, sizeof(Sphere), offsetof(Sphere, radius));
  setColourAttribute(shaders::kColour, sizeof(Sphere), offsetof(Sphere, colour));
  for (const GLuint location : {shaders::kPosition, shaders::kRadius, shaders::kColour})
    glVertexAttribDivisor(location, 1);

  glBindVertexArray(lineArray_.name());
  glBindBuffer(GL_ARRAY_BUFFER, segmentBuffer_.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(Segment), offsetof(Segment, start));
  setFloatAttribute(shaders::kEnd, 3, sizeof(Segment), offsetof(Segment, end));
  setColourAttribute(shaders::kColour, sizeof(Segment), offsetof(Segment, startColour));
  setColourAttribute(shaders::kEndColour, sizeof(Segment), offsetof(Segment, endColour));
  setFloatAttribute(shaders::kWidth, 1, sizeof(Segment), offsetof(Segment, width_px));
  for (const GLuint location :
       {shaders::kPosition, shaders::kEnd, shaders::kColour, shaders::kEndColour, shaders::kWidth})
    glVertexAttribDivisor(location, 1);
  glBindVertexArray(0);
}

void BlendedPass::begin() {
  vertices_.clear();
  triangles_.clear();
  spheres_.clear();
  segments_.clear();
  items_.clear();
}

void BlendedPass::add(Proxy &proxy, const Frame &frame) {
  switch (proxy.kind) {
    case ProxyKind::mesh: addMesh(proxy, frame); break;
    case ProxyKind::spheres: addSpheres(proxy, frame); break;
    case ProxyKind::lines: addLines(proxy, frame); break;
    case ProxyKind::label:
    case ProxyKind::legend: break;
  }
}

void BlendedPass::push(ProxyKind kind, std::size_t index, float depth) {
  const std::uint32_t upper = static_cast<std::uint32_t>(kind) << kIndexBits;
  items_.push_back({farFirstKey(depth), upper | static_cast<std::uint32_t>(index)});
}

void BlendedPass::addMesh(Proxy &proxy, const Frame &frame) {
  proxy.updateNormals();
  const Mat4 viewFromProxy = multiply(frame.view, proxy.transform);
  const Mat4f points = toFloat(viewFromProxy);
  const Mat3f normals = normalMatrix(viewFromProxy);
  const auto base = static_cast<unsigned>(vertices_.size());
  vertices_.reserve(vertices_.size() + proxy.positions.size());
  for (std::size_t i = 0; i < proxy.positions.size(); ++i)
    vertices_.push_back(
        {transformPoint(points, proxy.positions[i]), transformNormal(normals, proxy.normals[i]), colourOf(proxy, i)});

  // A mirrored mesh is flipped back, so that all triangles of the frame have the same orientation.
  const bool mirrored = linearDeterminant(proxy.transform) < 0.0;
  for (const Triangle &t : proxy.triangles) {
    const Triangle shared{base + t[0], base + t[mirrored ? 2 : 1], base + t[mirrored ? 1 : 2]};
    const Vec3f &a = vertices_[shared[0]].position;
    const Vec3f &b = vertices_[shared[1]].position;
    const Vec3f &c = vertices_[shared[2]].position;
    if (-std::min({a[2], b[2], c[2]}) < frame.nearPlane) continue;
    if (!proxy.material.twoSided && facesAway(a, b, c)) continue;
    push(ProxyKind::mesh, triangles_.size(), -(a[2] + b[2] + c[2]) / 3.0f);
    triangles_.push_back(shared);
  }
}

void BlendedPass::addSpheres(const Proxy &proxy, const Frame &frame) {
  const Mat4f points = toFloat(multiply(frame.view, proxy.transform));
  const float scale = lengthScale(proxy.transform);
  for (std::size_t i = 0; i < proxy.positions.size(); ++i) {
    const Vec3f centre = transformPoint(points, proxy.positions[i]);
    const float radius = scale * (proxy.radii.empty() ? proxy.radius : proxy.radii[i]);
    if (radius - centre[2] < frame.nearPlane) continue;
    push(ProxyKind::spheres, spheres_.size(), -centre[2]);
    spheres_.push_back({centre, radius, colourOf(proxy, i)});
  }
}

void BlendedPass::addLines(const Proxy &proxy, const Frame &frame) {
  const Mat4f points = toFloat(multiply(frame.view, proxy.transform));
  for (std::size_t i = 0; i + 1 < proxy.positions.size(); i += 2) {
    const Vec3f a = transformPoint(points, proxy.positions[i]), b = transformPoint(points, proxy.positions[i + 1]);
    if (-std::min(a[2], b[2]) < frame.nearPlane) continue;
    push(ProxyKind::lines, segments_.size(), -0.5f * (a[2] + b[2]));
    segments_.push_back({a, b, colourOf(proxy, i), colourOf(proxy, i + 1), proxy.width_px});
  }
}

void BlendedPass::order() {
  sortByKey(items_, scratch_);
  orderedTriangles_.clear();
  orderedSpheres_.clear();
  orderedSegments_.clear();
  runs_.clear();
  for (const DepthItem &item : items_) {
    const auto kind = static_cast<ProxyKind>(item.primitive >> kIndexBits);
    const std::uint32_t index = item.primitive & kIndexMask;
    std::size_t place = 0;
    switch (kind) {
      case ProxyKind::mesh:
        place = orderedTriangles_.size();
        orderedTriangles_.push_back(triangles_[index]);
        break;
      case ProxyKind::spheres:
        place = orderedSpheres_.size();
        orderedSpheres_.push_back(spheres_[index]);
        break;
      default:
        place = orderedSegments_.size();
        orderedSegments_.push_back(segments_[index]);
        break;
    }
    if (runs_.empty() || runs_.back().kind != kind) runs_.push_back({kind, static_cast<std::uint32_t>(place), 0});
    ++runs_.back().count;
  }
}

void BlendedPass::upload() {
  glBindVertexArray(meshArray_.name());
  uploadBuffer(GL_ARRAY_BUFFER, vertexBuffer_, std::span<const MeshVertex>(vertices_));
  uploadBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_, std::span<const Triangle>(orderedTriangles_));
  uploadBuffer(GL_ARRAY_BUFFER, sphereBuffer_, std::span<const Sphere>(orderedSpheres_));
  uploadBuffer(GL_ARRAY_BUFFER, segmentBuffer_, std::span<const Segment>(orderedSegments_));
}

void BlendedPass::prepare(RenderStatistics &statistics) {
  statistics.sortedPrimitives = items_.size();
  if (items_.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  order();
  statistics.sort_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  upload();
}

void BlendedPass::draw(const Frame &frame, const Programs &programs, RenderStatistics &statistics) {
  if (items_.empty()) return;
  glEnable(GL_BLEND);
  glDepthMask(GL_FALSE);
  drawRuns(frame, programs, statistics);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void BlendedPass::drawDepth(const Frame &frame, const Programs &programs, RenderStatistics &statistics) {
  if (items_.empty()) return;
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  drawRuns(frame, programs, statistics);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void BlendedPass::drawRuns(const Frame &frame, const Programs &programs, RenderStatistics &statistics) {
  const CutProxies cut(frame);
  // Everything is in view space already.
  const Mat4f identity = toFloat(kIdentity4);
  const Mat3f identity3 = normalMatrix(kIdentity4);
  for (const Program *program : {&programs.mesh, &programs.sphere, &programs.line}) {
    glUseProgram(program->name());
    glUniformMatrix4fv(shaders::kProjection, 1, GL_FALSE, frame.projectionF.data());
    glUniformMatrix4fv(shaders::kViewFromProxy, 1, GL_FALSE, identity.data());
    setCuts(frame);
  }
  glUseProgram(programs.mesh.name());
  glUniformMatrix3fv(shaders::kNormalMatrix, 1, GL_FALSE, identity3.data());
  glUniform1f(shaders::kCover, 0.0f);
  glUniform1i(shaders::kTwoSided, 1);  // back faces that must be hidden were omitted
  glUniform1i(shaders::kBlended, 1);
  glUseProgram(programs.sphere.name());
  glUniform1f(shaders::kRadiusScale, 1.0f);
  glUniform1i(shaders::kSmoothEdge, 1);
  glUniform1i(shaders::kBlended, 1);
  glUseProgram(programs.line.name());
  glUniform2fv(shaders::kViewportSize, 1, frame.scaledSize().data());
  glUniform1f(shaders::kNear, frame.nearPlane);

  for (const Run &run : runs_) {
    const auto count = static_cast<GLsizei>(run.count);
    switch (run.kind) {
      case ProxyKind::mesh:
        glUseProgram(programs.mesh.name());
        glBindVertexArray(meshArray_.name());
        glDrawElements(GL_TRIANGLES, 3 * count, GL_UNSIGNED_INT,
                       reinterpret_cast<const void *>(static_cast<std::uintptr_t>(run.first * sizeof(Triangle))));
        break;
      case ProxyKind::spheres:
        glUseProgram(programs.sphere.name());
        glBindVertexArray(sphereArray_.name());
        glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, count, run.first);
        break;
      default:
        glUseProgram(programs.line.name());
        glBindVertexArray(lineArray_.name());
        glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, count, run.first);
        break;
    }
    ++statistics.drawCalls;
  }
}

}  // namespace c3de::render
