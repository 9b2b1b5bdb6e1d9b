// SPDX-License-Identifier: Apache-2.0
// Data shared by the passes of one frame.
#pragma once

#include <array>

#include "c3de/render/camera.h"
#include "gl_objects.h"
#include "view_math.h"

namespace c3de::render {

/// Created once; see shaders.h.
struct Programs {
  Program background, mesh, sphere, line, label;
};
/// @param isDepthPeeled  the programs for transparent primitives draw only the part between two depths: see kPeelFunction
[[nodiscard]] Expected<Programs> buildPrograms(bool isDepthPeeled = false);

/// In view space: the negative side is cut away.
using Cuts = std::array<std::array<float, 4>, 3>;
inline constexpr Cuts kNoCuts{{{0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}}};

struct Frame {
  Mat4 view{}, projection{};  ///< in double, for precision far from the origin
  Mat4f projectionF{};
  int width = 0, height = 0;
  float scale = 1.0f;    ///< pixels per pixel of text, lines and legends
  bool isLight = false;  ///< dark text on a light ground
  float nearPlane = 1.0f;
  bool multisampled = false;
  Cuts cuts = kNoCuts;       ///< of images
  bool cutsProxies = false;  ///< also cuts everything else

  /// Size in the pixels that widths of lines and positions of text are counted in.
  [[nodiscard]] std::array<float, 2> scaledSize() const {
    return {static_cast<float>(width) / scale, static_cast<float>(height) / scale};
  }
};

/// For the program in use, which must contain kCutFunction.
void setCuts(const Frame &frame);

/// Enables the cuts of proxies during its lifetime, if the frame requests them.
class CutProxies {
 public:
  explicit CutProxies(const Frame &frame) : isOn_(frame.cutsProxies) {
    for (GLenum i = 0; isOn_ && i < frame.cuts.size(); ++i) glEnable(GL_CLIP_DISTANCE0 + i);
  }
  ~CutProxies() {
    for (GLenum i = 0; isOn_ && i < std::tuple_size_v<Cuts>; ++i) glDisable(GL_CLIP_DISTANCE0 + i);
  }
  CutProxies(const CutProxies &) = delete;
  CutProxies &operator=(const CutProxies &) = delete;

 private:
  bool isOn_;
};

}  // namespace c3de::render
