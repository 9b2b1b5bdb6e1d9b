// SPDX-License-Identifier: Apache-2.0
#include "c3de/render_gl/picture.h"

#include <algorithm>

#include "image_target.h"
#include "retained_renderer.h"

namespace c3de::render {

Expected<Image> paintPicture(int width, int height, const std::function<void()> &paint) {
  if (auto size = checkImageSize(width, height, largestPictureSide()); !size) return tl::unexpected(size.error());
  auto target = ImageTarget::create(width, height);
  if (!target) return tl::unexpected(target.error());
  glViewport(0, 0, width, height);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  paint();
  return target->read();
}

int largestPictureSide() {
  GLint renderbuffer = 0, viewport[2] = {0, 0};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  return std::min({renderbuffer, viewport[0], viewport[1]});
}

}  // namespace c3de::render
