// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

namespace c3de::render {

/// Restores the framebuffer, viewport and scissor of the caller.
class FramebufferGuard {
 public:
  FramebufferGuard() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
    glGetIntegerv(GL_VIEWPORT, viewport_);
    glGetIntegerv(GL_SCISSOR_BOX, scissor_);
  }
  ~FramebufferGuard() {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
    glScissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  }
  FramebufferGuard(const FramebufferGuard &) = delete;
  FramebufferGuard &operator=(const FramebufferGuard &) = delete;

 private:
  GLint draw_ = 0, read_ = 0, viewport_[4] = {}, scissor_[4] = {};
};

}  // namespace c3de::render
