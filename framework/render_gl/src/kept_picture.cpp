// SPDX-License-Identifier: Apache-2.0
#include "c3de/render_gl/kept_picture.h"

#include <cstring>
#include <optional>
#include <vector>

#include "gl_objects.h"
#include "kept_target.h"

namespace c3de::render {

namespace {

struct Buffers {
  Texture colour = Texture::create();
  Renderbuffer depth = Renderbuffer::create();
  Framebuffer target = Framebuffer::create();
};

/// Pixels of a framebuffer that is not multisampled, top row first.
std::optional<Image> readPixels(GLuint framebuffer, const Viewport &part) {
  const FramebufferGuard kept;
  while (glGetError() != GL_NO_ERROR) {
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
  const auto width = static_cast<std::size_t>(part.width), height = static_cast<std::size_t>(part.height);
  std::vector<std::uint8_t> rows(3 * width * height);
  glReadPixels(part.x, part.y, part.width, part.height, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  if (glGetError() != GL_NO_ERROR) return {};
  Image image{part.width, part.height, std::vector<std::uint8_t>(rows.size())};
  for (std::size_t row = 0; row < height; ++row)
    std::memcpy(image.rgb.data() + 3 * width * row, rows.data() + 3 * width * (height - 1 - row), 3 * width);
  return image;
}

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

std::optional<Image> CachedPicture::read(const Viewport &part) const {
  const bool isInside = part.x >= 0 && part.y >= 0 && part.width > 0 && part.height > 0 &&
                        part.x + part.width <= impl_->width && part.y + part.height <= impl_->height;
  if (!impl_->buffers || !isInside) return {};
  return readPixels(impl_->buffers->target.name(), part);
}

struct FramebufferCopy::Impl {
  Renderbuffer colour = Renderbuffer::create();
  Framebuffer target = Framebuffer::create();
  int width = 0, height = 0;
  bool isTaken = false;
};

FramebufferCopy::FramebufferCopy() = default;
FramebufferCopy::~FramebufferCopy() = default;

void FramebufferCopy::take(const Viewport &part) {
  if (part.width < 1 || part.height < 1) return impl_.reset();
  GLint source = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &source);
  const FramebufferGuard kept;
  while (glGetError() != GL_NO_ERROR) {
  }
  if (!impl_) impl_ = std::make_unique<Impl>();
  Impl &copy = *impl_;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, copy.target.name());
  if (copy.width != part.width || copy.height != part.height) {
    glBindRenderbuffer(GL_RENDERBUFFER, copy.colour.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, part.width, part.height);
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, copy.colour.name());
    copy.width = part.width;
    copy.height = part.height;
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(source));
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(part.x, part.y, part.x + part.width, part.y + part.height, 0, 0, part.width, part.height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  copy.isTaken = glGetError() == GL_NO_ERROR;
}

std::optional<Image> FramebufferCopy::read() const {
  if (!impl_ || !impl_->isTaken) return {};
  return readPixels(impl_->target.name(), {0, 0, impl_->width, impl_->height});
}

}  // namespace c3de::render
