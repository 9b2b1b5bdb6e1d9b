// SPDX-License-Identifier: Apache-2.0
#include "gl/gl_images.h"

#include "gl/image_target.h"

namespace c3de::render {

ImageParts GlImages::partsOf(const ImageLook &look) {
  return {find(look.image, ImageSlot::Kind::image), find(look.labels, ImageSlot::Kind::labels),
          find(look.displacement, ImageSlot::Kind::displacement)};
}

void GlImages::drawSlice(const ImageLook &look, const SlicePlane &plane, const Viewport &v) {
  if (v.width <= 0 || v.height <= 0) return;
  glViewport(v.x, v.y, v.width, v.height);
  glScissor(v.x, v.y, v.width, v.height);
  glEnable(GL_SCISSOR_TEST);
  for (const GLenum off : {GL_CULL_FACE, GL_BLEND, GL_STENCIL_TEST, GL_DEPTH_TEST, GL_FRAMEBUFFER_SRGB,
                           GL_SAMPLE_ALPHA_TO_COVERAGE, GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP})
    glDisable(off);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  const ImageParts parts = partsOf(look);
  if (parts.image) {
    slices_.drawFlat(parts, look, plane, v.width, v.height, statistics_);
  } else {
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  glDisable(GL_SCISSOR_TEST);
  glUseProgram(0);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

Expected<Image> GlImages::drawSliceToImage(const ImageLook &look, const SlicePlane &plane, int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (auto size = checkImageSize(width, height, largest); !size) return tl::unexpected(size.error());
  auto target = ImageTarget::create(width, height);
  if (!target) return tl::unexpected(target.error());
  drawSlice(look, plane, {0, 0, width, height});
  return target->read();
}

void GlImages::drawOpaque(const Frame &frame) {
  const ImageParts parts = partsOf(scene_.look);
  if (!parts.image) return;
  for (const SliceInSpace &slice : scene_.slices)
    slices_.drawInSpace(parts, scene_.look, sliceOutline(parts.image->place, slice.point, slice.normal), slice.frame,
                        frame, statistics_);
}

void GlImages::drawVolume(const Camera &camera, const Frame &frame, const Viewport &viewport, std::uint64_t changesOfProxies,
                          bool isFinal, const RayPass::DrawDepth &drawDepth) {
  const ImageParts parts = partsOf(scene_.look);
  if (!scene_.showsVolume || !parts.image) {
    rays_.forget();
    wantsRefinement_ = false;
    return;
  }
  const RayKey key{camera, frame.width, frame.height, changes_ + changesOfProxies};
  rays_.draw(parts, scene_, key, frame, viewport.x, viewport.y, isFinal, drawDepth, statistics_);
  if (!isFinal) wantsRefinement_ = !rays_.isRefined();
}

}  // namespace c3de::render
