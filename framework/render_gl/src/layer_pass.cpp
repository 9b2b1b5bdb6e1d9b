// SPDX-License-Identifier: Apache-2.0
#include "layer_pass.h"

#include "c3de/core/log.h"
#include "kept_target.h"

namespace c3de::render {
namespace {

// As in shaders.h.
constexpr GLuint kNearerUnit = 0, kFartherUnit = 1;

void makeDepths(const Texture &texture, GLenum internal, GLenum format, int width, int height, const float *values) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, format, GL_FLOAT, values);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

void bind(GLuint unit, GLuint texture) {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, texture);
  glBindSampler(unit, 0);
}

}  // namespace

LayerPass::LayerPass(BlendedPass &blended) : blended_(blended) {
  const float before = -1.0f, behind = 2.0f;
  glActiveTexture(GL_TEXTURE0);
  makeDepths(beforeAll_, GL_R32F, GL_RED, 1, 1, &before);
  makeDepths(behindAll_, GL_R32F, GL_RED, 1, 1, &behind);
}

void LayerPass::bindLimits(GLuint nearer, GLuint farther) const {
  bind(kFartherUnit, farther);
  bind(kNearerUnit, nearer);
}

bool LayerPass::find(LayerDepths &depths, const Frame &frame, int x, int y, RenderStatistics &statistics) {
  if (!programs_ && !hasFailed_) {
    auto built = buildPrograms(true);
    hasFailed_ = !built;
    if (built)
      programs_ = std::move(*built);
    else
      log(LogLevel::error, built.error().message);
    ++statistics.programsLinked;
  }
  if (hasFailed_) return false;
  // The viewport has the same position as in the picture, so that depths are identical to the bit.
  const int width = x + frame.width, height = y + frame.height;
  const FramebufferGuard kept;
  glActiveTexture(GL_TEXTURE0);
  for (std::size_t n = 0; n < kLayers; ++n) {
    if (depths.width_ != width || depths.height_ != height)
      makeDepths(depths.depths_[n], GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, width, height, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, depths.buffers_[n].name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths.depths_[n].name(), 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return false;
    glViewport(x, y, frame.width, frame.height);
    glScissor(x, y, frame.width, frame.height);
    glClear(GL_DEPTH_BUFFER_BIT);
    bindLimits(n == 0 ? beforeAll_.name() : depths.depths_[n - 1].name(), behindAll_.name());
    blended_.drawDepth(frame, *programs_, statistics);
    bindLimits(0, 0);
  }
  depths.width_ = width;
  depths.height_ = height;
  return true;
}

void LayerPass::draw(const LayerDepths &depths, std::size_t layer, const Frame &frame, RenderStatistics &statistics) {
  if (!programs_) return;
  bindLimits(layer == 0 ? beforeAll_.name() : depths.texture(layer - 1),
             layer == kLayers ? behindAll_.name() : depths.texture(layer));
  blended_.draw(frame, *programs_, statistics);
  bindLimits(0, 0);
}

}  // namespace c3de::render
