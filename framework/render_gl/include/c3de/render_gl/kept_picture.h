// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "c3de/render/renderer.h"

namespace c3de::render {

/// A cached picture, in addition to a window's framebuffer, for content that is not redrawn in every frame. Needs a
/// current OpenGL context, also when it is destroyed. Main thread.
class CachedPicture {
 public:
  enum class State {
    none,   ///< no picture: insufficient graphics memory, or the bound framebuffer is multisampled
    empty,  ///< it was just created
    kept
  };

  CachedPicture();
  ~CachedPicture();
  CachedPicture(const CachedPicture &) = delete;
  CachedPicture &operator=(const CachedPicture &) = delete;

  /// Creates it at this size, in pixels, unless it has it already.
  [[nodiscard]] State prepare(int width, int height);
  /// Draws into the picture, which has a depth buffer.
  void paint(const std::function<void()> &paint);
  /// Copies a part of the picture to the same position in the bound framebuffer.
  void show(const Viewport &part) const;
  /// A part of the picture in memory. Empty: there is no picture, or the part is not inside it.
  [[nodiscard]] std::optional<Image> read(const Viewport &part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A copy of a part of the bound framebuffer, in graphics memory, where no CachedPicture is possible. Needs a current
/// OpenGL context, also when it is destroyed. Main thread.
class FramebufferCopy {
 public:
  FramebufferCopy();
  ~FramebufferCopy();
  FramebufferCopy(const FramebufferCopy &) = delete;
  FramebufferCopy &operator=(const FramebufferCopy &) = delete;

  /// Replaces the copy. The framebuffer may be multisampled. Does not wait for the graphics card.
  void take(const Viewport &part);
  /// The copy in memory. Empty: there is none, or not enough graphics memory.
  [[nodiscard]] std::optional<Image> read() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::render
