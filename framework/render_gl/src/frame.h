// SPDX-License-Identifier: Apache-2.0
// What the passes of one frame share.
#pragma once

#include <array>

#include "c3de/render/camera.h"
#include "gl_objects.h"
#include "view_math.h"

namespace c3de::render {

/// Made once; see shaders.h.
struct Programs {
  Program background, mesh, sphere, line, label;
};
/// @param arePeeled  of those that draw what blends only the part between two depths is drawn: see kPeelFunction
[[nodiscard]] Expected<Programs> buildPrograms(bool arePeeled = false);

/// In view space: what lies on the negative side is left out.
using Cuts = std::array<std::array<float, 4>, 3>;
inline constexpr Cuts kNoCuts{{{0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}}};

struct Frame {
  Mat4 view{}, projection{};  ///< in double, so that scenes far from the origin stay sharp
  Mat4f projectionF{};
  int width = 0, height = 0;
  float nearPlane = 1.0f;
  bool multisampled = false;
  Cuts cuts = kNoCuts;       ///< of images
  bool cutsProxies = false;  ///< and of everything else
};

/// For the program in use, which has kCutFunction.
void setCuts(const Frame &frame);

/// Proxies are cut while it lives, where the frame says so.
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
