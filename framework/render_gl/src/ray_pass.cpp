// SPDX-License-Identifier: Apache-2.0
#include "ray_pass.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "c3de/core/log.h"
#include "image_shaders.h"
#include "kept_target.h"
#include "shaders.h"

namespace c3de::render {
namespace {

constexpr unsigned kDisplaced = 1, kMaximum = 2, kShaded = 4, kLayered = 8, kEmptied = 16, kStill = 32;
constexpr std::size_t kTableSize = 1024;
constexpr double kBand_ms = 30.0;  // of refinement in one frame, so that the window stays responsive

/// Linear between the points of a transfer function; the end values continue.
Colour colourAt(const std::vector<TransferPoint> &points, double value) {
  if (points.empty()) return {};
  if (value <= points.front().value) return points.front().colour;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const TransferPoint &a = points[i - 1], &b = points[i];
    if (value > b.value) continue;
    const auto t = static_cast<float>((value - a.value) / std::max(b.value - a.value, 1e-12));
    Colour c{};
    for (std::size_t k = 0; k < 4; ++k) c[k] = a.colour[k] + t * (b.colour[k] - a.colour[k]);
    return c;
  }
  return points.back().colour;
}

/// Shortest distance between neighbouring voxels, mm.
double finestSpacing(const GridGeometry &place) {
  double finest = 1e30;
  for (std::size_t a = 0; a < 3; ++a) {
    const Mat4 &m = place.worldFromIndex;
    finest = std::min(finest, norm(Vec3{m[4 * a], m[4 * a + 1], m[4 * a + 2]}));
  }
  return finest;
}

void makeTexture(const Texture &texture, GLenum internal, GLenum format, GLenum type, int width, int height,
                 GLint filter) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

/// Uniforms: the positions of eye, image and cuts.
void setPlaces(const ImageParts &parts, const Frame &frame) {
  using namespace shaders;
  const Mat4 worldFromView = affineInverse(frame.view);
  const auto setMatrix = [](int location, const Mat4 &m) {
    const Mat4f f = toFloat(m);
    glUniformMatrix4fv(location, 1, GL_FALSE, f.data());
  };
  setMatrix(kImageFromView, multiply(parts.image->indexFromWorld, worldFromView));
  if (parts.displacement) {
    setMatrix(kNodeFromView, multiply(parts.displacement->indexFromWorld, worldFromView));
    Mat4 textureFromWorld = parts.image->indexFromWorld;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r)
        textureFromWorld[4 * c + r] /= static_cast<double>(parts.image->place.size[r]);
    const Mat3f linear = linearPart(textureFromWorld);
    glUniformMatrix3fv(kTextureFromShift, 1, GL_FALSE, linear.data());
  }
  const Mat4 &p = frame.projection;
  glUniform4f(kLens, static_cast<float>(1.0 / p[0]), static_cast<float>(1.0 / p[5]), static_cast<float>(p[10]),
              static_cast<float>(p[14]));
  glUniform1f(kNearest, frame.nearPlane);
  glUniform4fv(kRayCuts, static_cast<GLsizei>(frame.cuts.size()), frame.cuts[0].data());
}

}  // namespace

const Program *RayPass::programFor(unsigned variant, RenderStatistics &statistics) {
  std::optional<Program> &program = programs_[variant];
  if (!program) {
    using namespace shaders;
    std::vector<const char *> fragment{kHead};
    if (variant & kDisplaced) fragment.push_back("#define DISPLACED\n");
    if (variant & kMaximum) fragment.push_back("#define MAXIMUM\n");
    if (variant & kShaded) fragment.push_back("#define SHADED\n");
    if (variant & kLayered) fragment.push_back("#define LAYERED\n");
    if (variant & kEmptied) fragment.push_back("#define VACATED\n");
    if (variant & kStill) fragment.push_back("#define STILL\n");
    fragment.push_back(kGridFunction);
    if (variant & kDisplaced) fragment.push_back(kDisplacementFunction);
    fragment.push_back(kRayFragment);
    auto built = buildProgram("volume", std::vector<const char *>{kHead, kFullVertex}, fragment);
    if (!built) log(LogLevel::error, built.error().message);
    program = built ? std::move(*built) : Program();
    ++statistics.programsLinked;
  }
  return program->name() != 0 ? &*program : nullptr;
}

void RayPass::buildTable(const VolumeDisplay &look, double step_mm) {
  std::vector<Colour> table(kTableSize);
  const double low = look.points.front().value, high = look.points.back().value;
  for (std::size_t i = 0; i < kTableSize; ++i) {
    Colour c = colourAt(look.points, low + (high - low) * static_cast<double>(i) / (kTableSize - 1));
    c[3] = static_cast<float>(1.0 - std::pow(1.0 - std::clamp(static_cast<double>(c[3]), 0.0, 0.999), step_mm));
    table[i] = c;
  }
  uploadColourRow(table_, table);
}

std::optional<RayPass::Picture> RayPass::begin(const Frame &frame, int divisor, const DrawDepth &drawDepth,
                                               LayerPass &layers, RenderStatistics &statistics) {
  Picture picture;
  picture.divisor = divisor;
  picture.width = std::max(1, (frame.width + divisor - 1) / divisor);
  picture.height = std::max(1, (frame.height + divisor - 1) / divisor);
  glActiveTexture(GL_TEXTURE0);
  makeTexture(picture.colour, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, picture.width, picture.height, GL_LINEAR);
  makeTexture(picture.depth, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, picture.width, picture.height,
              GL_NEAREST);

  const FramebufferGuard kept;
  glBindFramebuffer(GL_FRAMEBUFFER, picture.depthBuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, picture.depth.name(), 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return std::nullopt;
  glViewport(0, 0, picture.width, picture.height);
  glScissor(0, 0, picture.width, picture.height);
  glClear(GL_DEPTH_BUFFER_BIT);
  Frame small = frame;
  small.width = picture.width;
  small.height = picture.height;
  small.multisampled = false;
  drawDepth(small);

  glBindFramebuffer(GL_FRAMEBUFFER, picture.colourBuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture.colour.name(), 0);
  if (!layers.isEmpty()) {
    if (!layers.find(picture.layers.emplace(), small, 0, 0, statistics)) picture.layers.reset();
    glActiveTexture(GL_TEXTURE0);
    std::array<GLenum, kLayers + 1> targets{GL_COLOR_ATTACHMENT0};
    for (std::size_t n = 0; n < kLayers && picture.layers; ++n) {
      targets[n + 1] = GL_COLOR_ATTACHMENT1 + static_cast<GLenum>(n);
      makeTexture(picture.behind[n].emplace(Texture::create()), GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, picture.width,
                  picture.height, GL_LINEAR);
      glFramebufferTexture2D(GL_FRAMEBUFFER, targets[n + 1], GL_TEXTURE_2D, picture.behind[n]->name(), 0);
    }
    if (picture.layers) glDrawBuffers(static_cast<GLsizei>(targets.size()), targets.data());
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return std::nullopt;
  return picture;
}

void RayPass::setTransfer(const Program &program, const ImageParts &parts, const ImageScene &scene, double step_mm) {
  const VolumeDisplay &look = scene.volume;
  if (look.isMaximum) {
    const std::array<float, 2> grey = greyRamp(*parts.image, scene.look.window, scene.look.level);
    glUniform2fv(shaders::kTransfer, 1, grey.data());
    return;
  }
  buildTable(look, step_mm);
  glUseProgram(program.name());
  // The table's ends are the centres of its first and last texel.
  const double low = look.points.front().value + look.shift;
  const double range = std::max(look.points.back().value + look.shift - low, 1e-12);
  const double texels = (kTableSize - 1.0) / kTableSize;
  glUniform2f(shaders::kTransfer, static_cast<float>(texels * parts.image->scale / range),
              static_cast<float>(texels * (parts.image->offset - low) / range + 0.5 / kTableSize));
}

void RayPass::castRows(Picture &picture, const ImageParts &parts, const ImageScene &scene, const Frame &frame, int rows,
                       RenderStatistics &statistics) {
  const VolumeDisplay &look = scene.volume;
  const unsigned variant = (parts.displacement ? kDisplaced : 0) |
                           (look.isMaximum  ? kMaximum
                            : look.isShaded ? kShaded
                                            : 0) |
                           (picture.layers ? kLayered : 0) |
                           (parts.hasEmptiedRegion() ? kEmptied | (scene.look.hasFixedRegions ? kStill : 0) : 0);
  const Program *program = programFor(variant, statistics);
  rows = std::min(rows, picture.height - picture.rows);
  const int first = picture.rows;
  picture.rows += rows;
  if (!program) return;

  // A coarse picture uses coarse steps; thin bone requires half a voxel.
  const double step_mm = finestSpacing(parts.image->place) * (picture.divisor > 1 ? 1.5 : 0.5);
  using namespace shaders;
  glUseProgram(program->name());
  setPlaces(parts, frame);
  setTransfer(*program, parts, scene, step_mm);
  if (variant & kEmptied) glUniform1f(kMinGap, static_cast<float>(scene.look.leastGap));
  glUniform1f(kStep, static_cast<float>(step_mm));
  glUniform2f(kPixel, 2.0f / static_cast<float>(picture.width), 2.0f / static_cast<float>(picture.height));
  bindImageTextures(parts, true);
  bindTexture(kTransferUnit, GL_TEXTURE_2D, table_.name());
  bindTexture(kDepthUnit, GL_TEXTURE_2D, picture.depth.name());
  for (GLuint n = 0; n < kLayers && picture.layers; ++n)
    bindTexture(kLayerUnit + n, GL_TEXTURE_2D, picture.layers->texture(n));

  const FramebufferGuard kept;
  glBindFramebuffer(GL_FRAMEBUFFER, picture.colourBuffer.name());
  glViewport(0, 0, picture.width, picture.height);
  glScissor(0, first, picture.width, rows);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glBindVertexArray(array_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  ++statistics.drawCalls;
  unbindImageTextures();
}

bool RayPass::composite(const Picture &picture, const Frame &frame, int x, int y, LayerPass &layers,
                        RenderStatistics &statistics) {
  const bool isLayered = picture.layers && layers.find(layers_, frame, x, y, statistics);
  // From the farthest: the last part of the volume, the surface before it, the part before that …
  if (isLayered) layers.draw(layers_, kLayers, frame, statistics);
  for (std::size_t n = kLayers; n-- > 0;) {
    if (picture.behind[n]) layOver(*picture.behind[n], frame, x, y, statistics);
    if (isLayered) layers.draw(layers_, n, frame, statistics);
  }
  layOver(picture.colour, frame, x, y, statistics);
  return isLayered;
}

void RayPass::layOver(const Texture &part, const Frame &frame, int x, int y, RenderStatistics &statistics) {
  if (!composite_) {
    auto built = buildProgram("volume picture", std::vector<const char *>{shaders::kHead, shaders::kFullVertex},
                              std::vector<const char *>{shaders::kHead, shaders::kCompositeFragment});
    if (!built) log(LogLevel::error, built.error().message);
    composite_ = built ? std::move(*built) : Program();
    ++statistics.programsLinked;
  }
  if (composite_->name() == 0) return;
  glUseProgram(composite_->name());
  glUniform4f(0, static_cast<float>(x), static_cast<float>(y), 1.0f / static_cast<float>(frame.width),
              1.0f / static_cast<float>(frame.height));
  bindTexture(0, GL_TEXTURE_2D, part.name());
  glBindSampler(0, 0);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(array_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glBindTexture(GL_TEXTURE_2D, 0);
  ++statistics.drawCalls;
}

bool RayPass::draw(const ImageParts &parts, const ImageScene &scene, const RayKey &key, const Frame &frame, int x,
                   int y, bool isFinal, const DrawDepth &drawDepth, LayerPass &layers, RenderStatistics &statistics) {
  if (!scene.volume.isMaximum && scene.volume.points.size() < 2) {
    forget();
    return false;
  }
  if (isFinal) {
    auto picture = begin(frame, 1, drawDepth, layers, statistics);
    if (!picture) return false;
    castRows(*picture, parts, scene, frame, picture->height, statistics);
    return composite(*picture, frame, x, y, layers, statistics);
  }
  if (!key_ || !(*key_ == key) || !shown_) {
    key_ = key;
    next_.reset();
    isResolutionLimited_ = false;
    shown_ = begin(frame, scene.movingDivisor, drawDepth, layers, statistics);
    if (shown_) castRows(*shown_, parts, scene, frame, shown_->height, statistics);
  } else if (!isRefined()) {
    if (!next_) {
      next_ = begin(frame, shown_->divisor > 2 ? 2 : 1, drawDepth, layers, statistics);
      bandRows_ = std::max(4, bandRows_ / 8);  // longer rows of shorter steps than those measured
    }
    isResolutionLimited_ = !next_;
    if (next_) {
      const auto start = std::chrono::steady_clock::now();
      const auto spent_ms = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      };
      while (next_->rows < next_->height) {
        const double before = spent_ms();
        castRows(*next_, parts, scene, frame, bandRows_, statistics);
        glFinish();
        const double band = spent_ms() - before;
        // Bands of about a third of the time available per frame.
        bandRows_ = std::clamp(static_cast<int>(bandRows_ * kBand_ms / (3.0 * std::max(band, 0.1))), 4, 4 * bandRows_);
        if (spent_ms() > 0.7 * kBand_ms) break;
      }
      if (next_->rows >= next_->height) {
        shown_ = std::move(next_);
        next_.reset();
      }
    }
  }
  return shown_ && composite(*shown_, frame, x, y, layers, statistics);
}

}  // namespace c3de::render
