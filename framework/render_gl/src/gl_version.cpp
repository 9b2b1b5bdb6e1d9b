// SPDX-License-Identifier: Apache-2.0
#include <epoxy/gl.h>
#include <fmt/format.h>

#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "gl_platform.h"

namespace c3de::render {
namespace {

constexpr int kNeeded = 43;  // compute shaders, explicit uniform locations, debug output

std::string textOf(GLenum name) {
  const auto *text = reinterpret_cast<const char *>(glGetString(name));
  return text ? text : "unknown";
}

}  // namespace

Expected<void> checkGlVersion() {
  refreshGlFunctions();
  if (!glGetString(GL_VERSION))
    return fail(ErrorCode::graphics, "OpenGL 4.3 core is needed, found no current OpenGL context on this thread");
  const int version = epoxy_gl_version();
  const bool desktop = epoxy_is_desktop_gl();
  if (desktop && version >= kNeeded) return {};
  return fail(ErrorCode::graphics,
              fmt::format("OpenGL 4.3 core is needed, found {}{}.{} ({}, {}); update the graphics driver",
                          desktop ? "" : "ES ", version / 10, version % 10, textOf(GL_VERSION), textOf(GL_RENDERER)));
}

}  // namespace c3de::render
