// SPDX-License-Identifier: Apache-2.0
// OffscreenContext on Windows: OpenGL requires a window, so a small one is created and never shown.
#include <epoxy/gl.h>
// After gl.h; includes windows.h.
#include <epoxy/wgl.h>
#include <fmt/format.h>

#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "gl_platform.h"

namespace c3de::render {
namespace {

constexpr const wchar_t *kClassName = L"c3de-offscreen";

struct WglNames {
  HWND window = nullptr;
  HDC device = nullptr;
  HGLRC context = nullptr;

  void release() {
    if (context != nullptr) {
      if (wglGetCurrentContext() == context) wglMakeCurrent(nullptr, nullptr);
      wglDeleteContext(context);
    }
    if (device != nullptr) ReleaseDC(window, device);
    if (window != nullptr) DestroyWindow(window);
    *this = {};
  }
};

class WglContext final : public OffscreenContext {
 public:
  explicit WglContext(WglNames names) : names_(names) {}
  ~WglContext() override { names_.release(); }

 private:
  WglNames names_;
};

tl::unexpected<Error> giveUp(WglNames &names, const char *what) {
  const auto code = static_cast<unsigned long>(GetLastError());
  names.release();
  return fail(ErrorCode::graphics, fmt::format("no offscreen OpenGL context: {} (Windows error {})", what, code));
}

/// The newest available core context, or null; the query needs a current context.
HGLRC createCoreContext(HDC device) {
  if (!epoxy_has_wgl_extension(device, "WGL_ARB_create_context_profile")) return nullptr;
  constexpr int kVersions[][2] = {{4, 5}, {4, 3}};
  for (const auto &version : kVersions) {
    const int wanted[] = {WGL_CONTEXT_MAJOR_VERSION_ARB,
                          version[0],
                          WGL_CONTEXT_MINOR_VERSION_ARB,
                          version[1],
                          WGL_CONTEXT_PROFILE_MASK_ARB,
                          WGL_CONTEXT_CORE_PROFILE_BIT_ARB,
                          0};
    if (const HGLRC context = wglCreateContextAttribsARB(device, nullptr, wanted)) return context;
  }
  return nullptr;
}

}  // namespace

Expected<std::unique_ptr<OffscreenContext>> OffscreenContext::create() {
  const HINSTANCE instance = GetModuleHandleW(nullptr);
  WNDCLASSEXW windowClass{};
  windowClass.cbSize = sizeof(windowClass);
  windowClass.style = CS_OWNDC;
  windowClass.lpfnWndProc = DefWindowProcW;
  windowClass.hInstance = instance;
  windowClass.lpszClassName = kClassName;
  WglNames names;
  if (RegisterClassExW(&windowClass) == 0 && GetLastError() != ERROR_CLASS_ALREADY_EXISTS)
    return giveUp(names, "the window class was refused");
  names.window = CreateWindowExW(0, kClassName, L"", WS_POPUP, 0, 0, 16, 16, nullptr, nullptr, instance, nullptr);
  if (names.window == nullptr) return giveUp(names, "the hidden window was refused");
  names.device = GetDC(names.window);
  if (names.device == nullptr) return giveUp(names, "the hidden window has no device context");

  PIXELFORMATDESCRIPTOR format{};
  format.nSize = sizeof(format);
  format.nVersion = 1;
  format.dwFlags = PFD_DRAW_TO_WINDOW | PFD_SUPPORT_OPENGL | PFD_DOUBLEBUFFER;
  format.iPixelType = PFD_TYPE_RGBA;
  format.cColorBits = 32;
  format.cDepthBits = 24;
  const int chosen = ChoosePixelFormat(names.device, &format);
  if (chosen == 0 || SetPixelFormat(names.device, chosen, &format) == FALSE)
    return giveUp(names, "no pixel format for OpenGL");

  // A core context can only be requested through a function that exists while some other context is current.
  names.context = wglCreateContext(names.device);
  if (names.context == nullptr || wglMakeCurrent(names.device, names.context) == FALSE)
    return giveUp(names, "the first OpenGL context was refused");
  if (const HGLRC core = createCoreContext(names.device)) {
    wglMakeCurrent(nullptr, nullptr);
    wglDeleteContext(names.context);
    names.context = core;
    if (wglMakeCurrent(names.device, core) == FALSE) return giveUp(names, "the OpenGL context cannot be made current");
  }
  // Otherwise the plain context is used, and the version check reports it.
  return std::make_unique<WglContext>(names);
}

void refreshGlFunctions() { epoxy_handle_external_wglMakeCurrent(); }

}  // namespace c3de::render
