// SPDX-License-Identifier: Apache-2.0
#include "slice_pass.h"

#include <algorithm>

#include "c3de/core/log.h"
#include "image_shaders.h"
#include "shaders.h"

namespace c3de::render {
namespace {

constexpr unsigned kLabelled = 1, kDisplaced = 2, kShifted = 4, kEmptied = 8, kColoured = 16, kStill = 32,
                   kMissing = 64, kField = 128, kCompared = 256;

const GridTexture &texturesOf(const ImageSlot &slot) { return static_cast<const GridTexture &>(*slot.backEnd); }

Mat4 indexFromLocal(const ImageSlot &slot, const Mat4 &worldFromLocal) {
  return multiply(slot.indexFromWorld, worldFromLocal);
}

/// Any part of a direction that is in the plane, and what is orthogonal to it there.
std::array<Vec3, 2> directionsInPlane(const Vec3 &normal, const Vec3 &wanted) {
  constexpr double kParallel = 1e-6;
  const Vec3 n = (1.0 / std::max(norm(normal), 1e-30)) * normal;
  for (const Vec3 &direction : {wanted, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
    const Vec3 inPlane = direction - dot(direction, n) * n;
    if (const double length = norm(inPlane); length > kParallel) {
      const Vec3 along = (1.0 / length) * inPlane;
      return {along, cross(n, along)};
    }
  }
  return {};
}

/// Number of squares between a point and the middle of the first image, in one direction, as a linear function of local
/// coordinates.
std::array<float, 4> squaresAlong(const Vec3 &direction, const ImageSlot &image, double side_mm,
                                  const Mat4 &worldFromLocal) {
  Vec3 middle{};
  for (std::size_t a = 0; a < 3; ++a) middle[a] = 0.5 * (static_cast<double>(image.place.size[a]) - 1.0);
  middle = c3de::transformPoint(image.place.worldFromIndex, middle);
  const Vec3 origin{worldFromLocal[12], worldFromLocal[13], worldFromLocal[14]};
  std::array<float, 4> linear{};
  for (std::size_t c = 0; c < 3; ++c)
    linear[c] = static_cast<float>(
        dot(direction, {worldFromLocal[4 * c], worldFromLocal[4 * c + 1], worldFromLocal[4 * c + 2]}) / side_mm);
  linear[3] = static_cast<float>(dot(direction, origin - middle) / side_mm);
  return linear;
}

}  // namespace

std::array<float, 2> greyRamp(const ImageSlot &image, double window, double level) {
  const double width = std::max(window, 1e-12);
  return {static_cast<float>(image.scale / width), static_cast<float>((image.offset - level) / width + 0.5)};
}

void bindTexture(GLuint unit, GLenum target, GLuint name) {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(target, name);
}

void bindImageTextures(const ImageParts &parts, bool isSmooth) {
  using namespace shaders;
  if (parts.labels) {
    bindTexture(kLabelUnit, GL_TEXTURE_3D, texturesOf(*parts.labels).grid.name());
    bindTexture(kLabelColourUnit, GL_TEXTURE_2D, texturesOf(*parts.labels).table.name());
  }
  if (parts.displacement) bindTexture(kDisplacementUnit, GL_TEXTURE_3D, texturesOf(*parts.displacement).grid.name());
  if (parts.bodies) bindTexture(kBodiesUnit, GL_TEXTURE_3D, texturesOf(*parts.bodies).grid.name());
  if (parts.displacement && parts.displacement->hasField)
    bindTexture(kFieldUnit, GL_TEXTURE_3D, texturesOf(*parts.displacement).field.name());
  if (parts.missing) bindTexture(kMissingUnit, GL_TEXTURE_3D, texturesOf(*parts.missing).grid.name());
  const GLint filter = isSmooth ? GL_LINEAR : GL_NEAREST;
  const auto bindImage = [filter](GLuint unit, const Texture &texture) {
    bindTexture(unit, GL_TEXTURE_3D, texture.name());
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  };
  if (parts.second)
    bindImage(kSecondUnit,
              parts.second->hasColours ? texturesOf(*parts.second).colours : texturesOf(*parts.second).grid);
  if (parts.image->hasColours) bindImage(kColourUnit, texturesOf(*parts.image).colours);
  bindImage(kImageUnit, texturesOf(*parts.image).grid);
  for (GLuint unit = 0; unit < kImageUnits; ++unit) glBindSampler(unit, 0);
}

void unbindImageTextures() {
  for (GLuint unit = shaders::kImageUnits; unit-- > 0;) {
    bindTexture(unit, GL_TEXTURE_3D, 0);
    glBindTexture(GL_TEXTURE_2D, 0);
  }
}

SlicePass::SlicePass() {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  setFloatAttribute(shaders::kPosition, 3, sizeof(Vec3f), 0);
  glBindVertexArray(0);
}

const Program *SlicePass::programFor(unsigned variant, RenderStatistics &statistics) {
  std::optional<Program> &program = programs_[variant];
  if (!program) {
    using namespace shaders;
    std::vector<const char *> vertex{kHead}, fragment{kHead};
    for (std::vector<const char *> *texts : {&vertex, &fragment}) {
      if (variant & kLabelled) texts->push_back("#define LABELLED\n");
      if (variant & kDisplaced) texts->push_back("#define DISPLACED\n");
      if (variant & kShifted) texts->push_back("#define SHIFT\n");
      if (variant & kEmptied) texts->push_back("#define VACATED\n");
      if (variant & kColoured) texts->push_back("#define COLOURED\n");
      if (variant & kStill) texts->push_back("#define STILL\n");
      if (variant & kField) texts->push_back("#define FIELD\n");
      if (variant & kMissing) texts->push_back("#define MISSING\n");
      if (variant & kCompared) texts->push_back("#define COMPARED\n");
    }
    vertex.insert(vertex.end(), {"#define FLOW out\n", kSlicePlaces, kSliceVertex});
    fragment.insert(fragment.end(), {"#define FLOW in\n", kSlicePlaces, kGridFunction});
    if (variant & kDisplaced) fragment.push_back(kDisplacementFunction);
    fragment.push_back(kSliceFragment);
    auto built = buildProgram("slice", vertex, fragment);
    if (!built) {
      log(LogLevel::error, built.error().message);
      program.emplace();
    } else {
      program = std::move(*built);
      ++statistics.programsLinked;
    }
  }
  return program->name() != 0 ? &*program : nullptr;
}

void SlicePass::drawFlat(const ImageParts &parts, const ImageDisplay &look, const SlicePlane &plane, int width,
                         int height, RenderStatistics &statistics) {
  // Local coordinates are pixels from the upper left corner.
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  const std::array<Vec3f, 4> corners{{{0, h, 0}, {w, h, 0}, {w, 0, 0}, {0, 0, 0}}};
  Mat4 clipFromPixel{}, worldFromPixel = kIdentity4;
  clipFromPixel[0] = 2.0 / width;
  clipFromPixel[5] = -2.0 / height;
  clipFromPixel[12] = -1.0;
  clipFromPixel[13] = 1.0;
  clipFromPixel[15] = 1.0;
  const Vec3 normal = cross(plane.right, plane.down);
  for (std::size_t a = 0; a < 3; ++a) {
    worldFromPixel[a] = plane.right[a];
    worldFromPixel[4 + a] = plane.down[a];
    worldFromPixel[8 + a] = normal[a];
    worldFromPixel[12 + a] = plane.origin[a];
  }
  const auto [along, across] = directionsInPlane(normal, plane.right);
  draw(parts, look, corners, clipFromPixel, worldFromPixel, {along, across}, statistics);
}

void SlicePass::drawInSpace(const ImageParts &parts, const ImageDisplay &look, std::span<const Vec3> corners,
                            const SliceInSpace &slice, const Frame &frame, RenderStatistics &statistics) {
  if (corners.size() < 3) return;
  // Local coordinates are millimetres from the first corner, so that floats suffice far from the world's origin.
  Mat4 worldFromLocal = kIdentity4;
  std::vector<Vec3f> local;
  for (std::size_t a = 0; a < 3; ++a) worldFromLocal[12 + a] = corners[0][a];
  for (const Vec3 &corner : corners) {
    const Vec3 p = corner - corners[0];
    local.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  const Mat4 clipFromLocal = multiply(frame.projection, multiply(frame.view, worldFromLocal));
  const auto [along, across] = directionsInPlane(slice.normal, slice.along);
  draw(parts, look, local, clipFromLocal, worldFromLocal, {along, across}, statistics);

  if (!outline_) {
    using namespace shaders;
    auto built = buildProgram("border of a slice", std::vector<const char *>{kHead, kOutlineVertex},
                              std::vector<const char *>{kHead, kOutlineFragment});
    if (!built) log(LogLevel::error, built.error().message);
    outline_ = built ? std::move(*built) : Program();
    ++statistics.programsLinked;
  }
  if (outline_->name() == 0) return;
  glUseProgram(outline_->name());
  const Mat4f matrix = toFloat(clipFromLocal);
  glUniformMatrix4fv(shaders::kClipFromLocal, 1, GL_FALSE, matrix.data());
  glUniform4fv(1, 1, slice.frame.data());
  glBindVertexArray(array_.name());  // it still holds the corners
  glDrawArrays(GL_LINE_LOOP, 0, static_cast<GLsizei>(local.size()));
  ++statistics.drawCalls;
}

void SlicePass::draw(const ImageParts &parts, const ImageDisplay &look, std::span<const Vec3f> corners,
                     const Mat4 &clipFromLocal, const Mat4 &worldFromLocal, const InPlane &squares,
                     RenderStatistics &statistics) {
  unsigned variant = 0;
  if (parts.labels && look.labelOpacity > 0.0f) variant |= kLabelled;
  if (parts.displacement) variant |= kDisplaced;
  if (parts.displacement && look.overlayOpacity > 0.0f) {
    if (look.overlay == Overlay::shift) variant |= kShifted;
    if (look.overlay == Overlay::field && parts.displacement->hasField) variant |= kField;
  }
  if (parts.hasEmptiedRegion()) variant |= kEmptied | (look.hasFixedRegions ? kStill : 0);
  if (parts.image->hasColours) variant |= kColoured;
  if (parts.missing) variant |= kMissing;
  if (parts.second) variant |= kCompared;
  const Program *program = programFor(variant, statistics);
  if (!program) return;
  using namespace shaders;
  glUseProgram(program->name());
  const auto setMatrix = [](int location, const Mat4 &m) {
    const Mat4f f = toFloat(m);
    glUniformMatrix4fv(location, 1, GL_FALSE, f.data());
  };
  const auto setLinear = [](int location, const Mat4 &m) {
    const Mat3f f = linearPart(m);
    glUniformMatrix3fv(location, 1, GL_FALSE, f.data());
  };
  setMatrix(kClipFromLocal, clipFromLocal);
  setMatrix(kImageFromLocal, indexFromLocal(*parts.image, worldFromLocal));
  const std::array<float, 2> grey = greyRamp(*parts.image, look.window, look.level);
  glUniform2fv(kGrey, 1, grey.data());
  if (variant & kLabelled) {
    setMatrix(kLabelFromLocal, indexFromLocal(*parts.labels, worldFromLocal));
    glUniform1f(kLabelOpacity, std::clamp(look.labelOpacity, 0.0f, 1.0f));
  }
  if (variant & kDisplaced) {
    setMatrix(kNodeFromLocal, indexFromLocal(*parts.displacement, worldFromLocal));
    setLinear(kImageFromShift, parts.image->indexFromWorld);
    if (variant & kLabelled) setLinear(kLabelFromShift, parts.labels->indexFromWorld);
  }
  if (variant & kCompared) {
    const ComparisonDisplay &both = look.comparison;
    setMatrix(kSecondFromLocal,
              multiply(multiply(parts.second->indexFromWorld, affineInverse(both.worldFromSecond)), worldFromLocal));
    const std::array<float, 2> ramp = greyRamp(*parts.second, both.window, both.level);
    glUniform3f(kSecondGrey, ramp[0], ramp[1], parts.second->hasColours ? 1.0f : 0.0f);
    const float weight = std::clamp(both.weight, 0.0f, 1.0f);
    glUniform2f(kSecondWeights, both.isCheckerboard ? 0.0f : weight, both.isCheckerboard ? 1.0f : weight);
    const double side = both.square_mm > 0.0 ? both.square_mm : 1.0;
    glUniform4fv(kSquaresAlong, 1, squaresAlong(squares.along, *parts.image, side, worldFromLocal).data());
    glUniform4fv(kSquaresAcross, 1, squaresAlong(squares.across, *parts.image, side, worldFromLocal).data());
  }
  if (variant & kEmptied) glUniform1f(kMinGap, static_cast<float>(look.leastGap));
  if (variant & (kShifted | kField)) {
    const double range = std::max(look.overlayHigh - look.overlayLow, 1e-30);
    glUniform3f(kOverlay, static_cast<float>(look.overlayLow), static_cast<float>(1.0 / range),
                std::clamp(look.overlayOpacity, 0.0f, 1.0f));
    bindTexture(kOverlayColourUnit, GL_TEXTURE_2D, overlayColours_.name());
  }
  bindImageTextures(parts, look.isSmooth);
  glBindVertexArray(array_.name());
  uploadBuffer(GL_ARRAY_BUFFER, buffer_, corners);
  glDrawArrays(GL_TRIANGLE_FAN, 0, static_cast<GLsizei>(corners.size()));
  ++statistics.drawCalls;
  unbindImageTextures();
}

}  // namespace c3de::render
