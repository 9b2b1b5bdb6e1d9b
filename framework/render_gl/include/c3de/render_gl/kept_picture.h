// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "c3de/render/renderer.h"

namespace c3de::render {

/// A picture beside a window's framebuffer that stays from frame to frame, for what is not drawn anew in each. Needs a
/// current OpenGL context, also when it is destroyed. Main thread.
class KeptPicture {
 public:
  enum class State {
    none,   ///< there is no picture: no graphics memory, or the framebuffer that is bound smooths edges
    empty,  ///< it was made just now
    kept
  };

  KeptPicture();
  ~KeptPicture();
  KeptPicture(const KeptPicture &) = delete;
  KeptPicture &operator=(const KeptPicture &) = delete;

  /// Makes it that large, in pixels, unless it is.
  [[nodiscard]] State prepare(int width, int height);
  /// What `paint` draws goes into the picture, which has depth.
  void paint(const std::function<void()> &paint);
  /// Copies a part of the picture to the same place of the framebuffer that is bound.
  void show(const Viewport &part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::render
