// SPDX-License-Identifier: Apache-2.0
#include "frame/frame_without_window.h"

#include <imgui_internal.h>  // the width of smoothed edges

#include <algorithm>

#ifdef C3DE_IMGUI_FLAT_BACKENDS
#include <imgui_impl_opengl3.h>
#else
#include <backends/imgui_impl_opengl3.h>
#endif

namespace c3de::ui {

FrameWithoutWindow::FrameWithoutWindow(int width, int height, float scale) : context_(ImGui::CreateContext()) {
  const Use use(*this);
  ImGuiIO &io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = 1.0f / 60.0f;
  theme_ = applyTheme(scale);
  // Characters have the resolution of the picture, everything is laid out in logical pixels.
  for (ImFont *font : {theme_.regular, theme_.bold, theme_.small}) font->Scale = 1.0f / theme_.scale;
  theme_.scale = 1.0f;
  ImGui::GetStyle().CircleTessellationMaxError /= std::max(scale, 1.0f);
  isReady_ = ImGui_ImplOpenGL3_Init("#version 430 core");
  if (!isReady_) return;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  ImGui::GetBackgroundDrawList()->_FringeScale = 1.0f / scale;
}

FrameWithoutWindow::~FrameWithoutWindow() {
  {
    const Use use(*this);
    if (isReady_) ImGui_ImplOpenGL3_Shutdown();
  }
  ImGui::DestroyContext(context_);
}

void FrameWithoutWindow::draw(ImVec2 at, ImVec2 size, int width, int height) const {
  const Use use(*this);
  ImDrawData *data = ImGui::GetDrawData();
  data->DisplayPos = at;
  data->DisplaySize = size;
  // The back end rounds down the number of pixels.
  data->FramebufferScale =
      ImVec2((static_cast<float>(width) + 0.25f) / size.x, (static_cast<float>(height) + 0.25f) / size.y);
  ImGui_ImplOpenGL3_RenderDrawData(data);
}

}  // namespace c3de::ui
