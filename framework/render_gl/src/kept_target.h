// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

namespace c3de::render {

/// The framebuffer, viewport and scissor of the caller come back.
class KeptTarget {
 public:
  KeptTarget() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
    glGetIntegerv(GL_VIEWPORT, viewport_);
    glGetIntegerv(GL_SCISSOR_BOX, scissor_);
  }
  ~KeptTarget() {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
    glScissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  }
  KeptTarget(const KeptTarget &) = delete;
  KeptTarget &operator=(const KeptTarget &) = delete;

 private:
  GLint draw_ = 0, read_ = 0, viewport_[4] = {}, scissor_[4] = {};
};

}  // namespace c3de::render
