// SPDX-License-Identifier: Apache-2.0
// OffscreenContext through EGL: without any display if the driver supports it (surfaceless), otherwise on the default
// display with a tiny pixel buffer.
#include <epoxy/gl.h>
// After gl.h.
#include <epoxy/egl.h>
#include <fmt/format.h>

#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "gl_platform.h"

namespace c3de::render {
namespace {

struct EglNames {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLSurface surface = EGL_NO_SURFACE;
  EGLContext context = EGL_NO_CONTEXT;
};

class EglContext final : public OffscreenContext {
 public:
  explicit EglContext(EglNames names) : names_(names) {}
  ~EglContext() override {
    // The display stays initialised: there is one per process and other code may use it.
    if (eglGetCurrentContext() == names_.context)
      eglMakeCurrent(names_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (names_.surface != EGL_NO_SURFACE) eglDestroySurface(names_.display, names_.surface);
    eglDestroyContext(names_.display, names_.context);
  }

 private:
  EglNames names_;
};

std::string eglProblem(const char *what) { return fmt::format("{} (EGL error 0x{:04x})", what, eglGetError()); }

/// The newest available core context; if it is below the required version, the caller's check states the version found.
EGLContext createContext(EGLDisplay display, EGLConfig config) {
  constexpr EGLint kVersions[][2] = {{4, 5}, {4, 3}, {3, 3}, {3, 1}};
  for (const auto &[major, minor] : kVersions) {
    const EGLint core[] = {
        EGL_CONTEXT_MAJOR_VERSION,           major,   EGL_CONTEXT_MINOR_VERSION, minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, core);
    if (context != EGL_NO_CONTEXT) return context;
  }
  return eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
}

Expected<EglNames> open(EGLDisplay display, bool surfaceless) {
  EglNames names;
  names.display = display;
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
    return fail(ErrorCode::graphics, eglProblem("no EGL display"));
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return fail(ErrorCode::graphics, eglProblem("EGL without OpenGL"));
  const EGLint surface = surfaceless ? 0 : EGL_PBUFFER_BIT;
  const EGLint wanted[] = {EGL_SURFACE_TYPE, surface, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (eglChooseConfig(display, wanted, &config, 1, &found) == EGL_FALSE || found == 0)
    return fail(ErrorCode::graphics, eglProblem("no EGL configuration for OpenGL"));
  names.context = createContext(display, config);
  if (names.context == EGL_NO_CONTEXT) return fail(ErrorCode::graphics, eglProblem("no OpenGL context"));
  if (!surfaceless) {
    const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    names.surface = eglCreatePbufferSurface(display, config, size);
  }
  if (eglMakeCurrent(display, names.surface, names.surface, names.context) == EGL_FALSE) {
    const std::string problem = eglProblem("the OpenGL context cannot be made current");
    if (names.surface != EGL_NO_SURFACE) eglDestroySurface(display, names.surface);
    eglDestroyContext(display, names.context);
    return fail(ErrorCode::graphics, problem);
  }
  return names;
}

}  // namespace

Expected<std::unique_ptr<OffscreenContext>> OffscreenContext::create() {
  if (!epoxy_has_egl())
    return fail(ErrorCode::graphics, "no offscreen OpenGL context: the EGL library is not installed");
  std::string problems;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") &&
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    auto names = open(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr), true);
    if (names) return std::make_unique<EglContext>(*names);
    problems = "surfaceless: " + names.error().message + "; ";
  }
  auto names = open(eglGetDisplay(EGL_DEFAULT_DISPLAY), false);
  if (names) return std::make_unique<EglContext>(*names);
  return fail(ErrorCode::graphics,
              fmt::format("no offscreen OpenGL context: {}default display: {}", problems, names.error().message));
}

void refreshGlFunctions() {}

}  // namespace c3de::render
