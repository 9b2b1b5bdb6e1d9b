// SPDX-License-Identifier: Apache-2.0
#include "window/imgui_session.h"

#ifdef C3DE_IMGUI_FLAT_BACKENDS
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
#else
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#endif

#include "c3de/abi/tools.h"

namespace c3de::ui {

ImGuiSession::ImGuiSession(const GlfwWindow &window) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  theme_ = applyTheme(window.contentScale());
  // Without its callbacks: events are passed on one frame's worth at a time.
  ImGui_ImplGlfw_InitForOpenGL(window.handle(), false);
  ImGui_ImplOpenGL3_Init("#version 430 core");
}

ImGuiSession::~ImGuiSession() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void ImGuiSession::setLook(const GlfwWindow &window, ThemeKind kind, double fontSize_px) {
  if (kind == theme_.kind && fontSize_px == fontSize_px_) return;
  fontSize_px_ = fontSize_px;
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui::GetIO().Fonts->Clear();
  theme_ = applyTheme(window.contentScale(), kind, fontSize_px);
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void ImGuiSession::take(const GlfwWindow &window, const OsEvent &event) {
  using Kind = OsEvent::Kind;
  switch (event.kind) {
    case Kind::press:
      buttons_ |= event.button;
      isSecondPress_ = clicks_.isSecond(event);
      break;
    case Kind::release: buttons_ &= ~event.button; break;
    case Kind::wheel: ImGui_ImplGlfw_ScrollCallback(window.handle(), event.wheelX, event.wheel); break;
    case Kind::keyDown:
    case Kind::keyUp:
      // 1 is GLFW_PRESS, 0 GLFW_RELEASE.
      ImGui_ImplGlfw_KeyCallback(window.handle(), event.rawKey, event.scanCode, event.kind == Kind::keyDown ? 1 : 0,
                                 event.rawModifiers);
      break;
    case Kind::character: ImGui_ImplGlfw_CharCallback(window.handle(), event.character); break;
    case Kind::focusLost:
      buttons_ = 0;
      ImGui_ImplGlfw_WindowFocusCallback(window.handle(), 0);
      break;
    case Kind::focusGained: ImGui_ImplGlfw_WindowFocusCallback(window.handle(), 1); break;
    default: break;
  }
  if (event.kind == Kind::leave && buttons_ == 0)
    mouse_ = ImVec2(-FLT_MAX, -FLT_MAX);
  else if (event.kind == Kind::press || event.kind == Kind::release || event.kind == Kind::move ||
           event.kind == Kind::wheel)
    mouse_ = ImVec2(static_cast<float>(event.x), static_cast<float>(event.y));
}

void ImGuiSession::beginFrame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  // The back end uses the present mouse position; this frame shows the position at its events.
  ImGuiIO &io = ImGui::GetIO();
  io.MouseDrawCursor = false;  // set in each frame by widgets that need it
  io.MousePos = mouse_;
  io.MouseDown[0] = (buttons_ & C3DE_BUTTON_LEFT) != 0;
  io.MouseDown[1] = (buttons_ & C3DE_BUTTON_RIGHT) != 0;
  io.MouseDown[2] = (buttons_ & C3DE_BUTTON_MIDDLE) != 0;
  // Dear ImGui would measure the time in frames, and a frame may take longer than a double click.
  io.MouseDoubleClickTime = isSecondPress_ ? FLT_MAX : 0.0f;
  isSecondPress_ = false;
  // With the focus ring, Enter presses buttons and menu items as Space does, once for each press.
  if ((io.ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) != 0 && !ImGui::IsAnyItemActive())
    for (const ImGuiKey key : {ImGuiKey_Enter, ImGuiKey_KeyPadEnter})
      if (io.KeysDown[ImGui::GetKeyIndex(key)] && io.KeysDownDuration[ImGui::GetKeyIndex(key)] < 0.0f)
        io.NavInputs[ImGuiNavInput_Activate] = 1.0f;
  ImGui::NewFrame();
}

void ImGuiSession::endFrame() { ImGui::Render(); }
void ImGuiSession::draw() { ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData()); }

}  // namespace c3de::ui
