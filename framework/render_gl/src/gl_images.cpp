// SPDX-License-Identifier: Apache-2.0
#include "gl_images.h"

#include <algorithm>

#include "image_target.h"

namespace c3de::render {

ImageParts GlImages::partsOf(const ImageDisplay &look) {
  return {find(look.image, ImageSlot::Kind::image),
          find(look.labels, ImageSlot::Kind::labels),
          find(look.displacement, ImageSlot::Kind::displacement),
          find(look.bodies, ImageSlot::Kind::image),
          find(look.missing, ImageSlot::Kind::image),
          find(look.comparison.image, ImageSlot::Kind::image)};
}

void GlImages::drawSlice(const ImageDisplay &look, const SlicePlane &plane, const Viewport &v) {
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

Expected<Image> GlImages::drawSliceToImage(const ImageDisplay &look, const SlicePlane &plane, int width, int height) {
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
    slices_.drawInSpace(parts, scene_.look,
                        cutPolygon(sliceOutline(parts.image->place, slice.point, slice.normal), scene_.cuts), slice,
                        frame, statistics_);
}

void GlImages::setCuts(Frame &frame) const {
  for (std::size_t i = 0; i < std::min(scene_.cuts.size(), frame.cuts.size()); ++i) {
    const CutPlane &cut = scene_.cuts[i];
    const Vec3 point = c3de::transformPoint(frame.view, cut.point);
    const Vec3 normal =
        (1.0 / std::max(norm(cut.normal), 1e-12)) * (c3de::transformPoint(frame.view, cut.point + cut.normal) - point);
    for (std::size_t a = 0; a < 3; ++a) frame.cuts[i][a] = static_cast<float>(-normal[a]);
    frame.cuts[i][3] = static_cast<float>(dot(normal, point));
  }
  frame.cutsProxies = scene_.cutsProxies && !scene_.cuts.empty();
}

bool GlImages::drawVolume(const Camera &camera, const Frame &frame, const Viewport &viewport,
                          std::uint64_t changesOfProxies, bool isFinal, const RayPass::DrawDepth &drawDepth,
                          LayerPass &layers) {
  const ImageParts parts = partsOf(scene_.look);
  if (!scene_.showsVolume || !parts.image) {
    rays_.forget();
    wantsRefinement_ = false;
    return false;
  }
  const RayKey key{camera, frame.width, frame.height, changesInSpace() + changesOfProxies};
  const bool hasBlended =
      rays_.draw(parts, scene_, key, frame, viewport.x, viewport.y, isFinal, drawDepth, layers, statistics_);
  if (!isFinal) wantsRefinement_ = !rays_.isRefined();
  return hasBlended;
}

}  // namespace c3de::render
