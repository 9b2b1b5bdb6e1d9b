// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <cstddef>
#include <map>
#include <memory>

#include "c3de/render/renderer.h"

namespace c3de::ui {

/// Pictures as textures of Dear ImGui, each uploaded when it is first drawn. Needs a current OpenGL context, also in
/// clear(), which must be called before the context is destroyed. Main thread.
class PictureTextures {
 public:
  /// @param picture  not null; kept until the next clear()
  [[nodiscard]] ImTextureID of(const std::shared_ptr<const render::Image> &picture);
  /// Not between of() and the end of the frame.
  void clear();
  [[nodiscard]] std::size_t count() const { return textures_.size(); }

 private:
  std::map<std::shared_ptr<const render::Image>, unsigned> textures_;
};

}  // namespace c3de::ui
