// SPDX-License-Identifier: Apache-2.0
#include "c3de/render_gl/kept_picture.h"

#include <optional>

#include "gl_objects.h"
#include "kept_target.h"

namespace c3de::render {

namespace {

struct Buffers {
  Texture colour = Texture::create();
  Renderbuffer depth = Renderbuffer::create();
  Framebuffer target = Framebuffer::create();
};

}  // namespace

struct CachedPicture::Impl {
  std::optional<Buffers> buffers;
  int width = 0, height = 0;

  [[nodiscard]] bool make();
};

bool CachedPicture::Impl::make() {
  const FramebufferGuard kept;
  Buffers &b = buffers.emplace();
  while (glGetError() != GL_NO_ERROR) {
  }
  // The byte order of windows, so that a software renderer copies quickly.
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, b.colour.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBindRenderbuffer(GL_RENDERBUFFER, b.depth.name());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, b.target.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, b.colour.name(), 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, b.depth.name());
  const bool isComplete =
      glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && glGetError() == GL_NO_ERROR;
  if (!isComplete) buffers.reset();
  return isComplete;
}

CachedPicture::CachedPicture() : impl_(std::make_unique<Impl>()) {}
CachedPicture::~CachedPicture() = default;

CachedPicture::State CachedPicture::prepare(int width, int height) {
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLE_BUFFERS, &samples);
  if (samples > 0 || width < 1 || height < 1) {
    impl_->buffers.reset();
    impl_->width = impl_->height = 0;
    return State::none;
  }
  if (impl_->width == width && impl_->height == height) return impl_->buffers ? State::kept : State::none;
  impl_->width = width;
  impl_->height = height;
  return impl_->make() ? State::empty : State::none;
}

void CachedPicture::paint(const std::function<void()> &paint) {
  const FramebufferGuard kept;
  glBindFramebuffer(GL_FRAMEBUFFER, impl_->buffers->target.name());
  paint();
}

void CachedPicture::show(const Viewport &part) const {
  GLint read = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->buffers->target.name());
  const GLint x1 = part.x + part.width, y1 = part.y + part.height;
  glBlitFramebuffer(part.x, part.y, x1, y1, part.x, part.y, x1, y1, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
}

}  // namespace c3de::render
