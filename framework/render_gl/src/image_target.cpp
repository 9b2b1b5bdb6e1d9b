// SPDX-License-Identifier: Apache-2.0
#include "image_target.h"

#include <fmt/format.h>

#include <algorithm>

namespace c3de::render {
namespace {

constexpr GLint kSamples = 4;

Expected<void> checkComplete(int width, int height) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return {};
  return fail(ErrorCode::graphics, fmt::format("no framebuffer for an image of {} x {} pixels: OpenGL status 0x{:04x}",
                                               width, height, status));
}

}  // namespace

Expected<ImageTarget> ImageTarget::create(int width, int height) {
  ImageTarget target;
  target.width_ = width;
  target.height_ = height;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target.previousDraw_);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &target.previousRead_);
  target.bound_ = true;
  GLint mostSamples = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &mostSamples);
  const GLint samples = std::min(kSamples, mostSamples);

  while (glGetError() != GL_NO_ERROR) {
  }
  target.colour_ = Renderbuffer::create();
  glBindRenderbuffer(GL_RENDERBUFFER, target.colour_.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, width, height);
  target.depth_ = Renderbuffer::create();
  glBindRenderbuffer(GL_RENDERBUFFER, target.depth_.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, width, height);
  target.resolvedColour_ = Renderbuffer::create();
  glBindRenderbuffer(GL_RENDERBUFFER, target.resolvedColour_.name());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  if (glGetError() != GL_NO_ERROR)
    return fail(ErrorCode::graphics,
                fmt::format("the graphics memory does not hold an image of {} x {} pixels", width, height));

  target.resolved_ = Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, target.resolved_.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.resolvedColour_.name());
  if (auto complete = checkComplete(width, height); !complete) return tl::unexpected(complete.error());
  target.samples_ = Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, target.samples_.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.colour_.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth_.name());
  if (auto complete = checkComplete(width, height); !complete) return tl::unexpected(complete.error());
  return target;
}

ImageTarget::ImageTarget(ImageTarget &&other) noexcept
    : width_(other.width_), height_(other.height_), previousDraw_(other.previousDraw_),
      previousRead_(other.previousRead_), bound_(std::exchange(other.bound_, false)),
      samples_(std::move(other.samples_)), resolved_(std::move(other.resolved_)), colour_(std::move(other.colour_)),
      depth_(std::move(other.depth_)), resolvedColour_(std::move(other.resolvedColour_)) {}

ImageTarget::~ImageTarget() {
  if (!bound_) return;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(previousDraw_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(previousRead_));
}

Expected<Image> ImageTarget::read() {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, samples_.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.name());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.name());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  std::vector<std::uint8_t> rgba(4 * width * height);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    return fail(ErrorCode::graphics, fmt::format("reading the image failed: OpenGL error 0x{:04x}", error));

  // OpenGL's first row is the lowest.
  Image image{width_, height_, std::vector<std::uint8_t>(3 * width * height)};
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t *from = rgba.data() + 4 * width * (height - 1 - y);
    std::uint8_t *to = image.rgb.data() + 3 * width * y;
    for (std::size_t x = 0; x < width; ++x, from += 4, to += 3) std::copy(from, from + 3, to);
  }
  return image;
}

}  // namespace c3de::render
