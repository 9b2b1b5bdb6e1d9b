// SPDX-License-Identifier: Apache-2.0
// What the passes of one frame share.
#pragma once

#include "c3de/render/camera.h"
#include "gl/gl_objects.h"
#include "view_math.h"

namespace c3de::render {

/// Made once; see shaders.h.
struct Programs {
  Program background, mesh, sphere, line, label;
};
[[nodiscard]] Expected<Programs> buildPrograms();

struct Frame {
  Mat4 view{}, projection{};  ///< in double, so that scenes far from the origin stay sharp
  Mat4f projectionF{};
  int width = 0, height = 0;
  float nearPlane = 1.0f;
  bool multisampled = false;
};

}  // namespace c3de::render
