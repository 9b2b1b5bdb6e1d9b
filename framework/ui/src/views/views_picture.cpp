// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/views_picture.h"

#ifdef C3DE_IMGUI_FLAT_BACKENDS
#include <imgui_impl_opengl3.h>
#else
#include <backends/imgui_impl_opengl3.h>
#endif

#include "c3de/render_gl/picture.h"
#include "c3de/scene/scene_graph.h"
#include "frame/file_dialog.h"
#include "views/four_views.h"
#include "views/view_decorations.h"

namespace c3de::ui {
namespace {

/// Dear ImGui without a window, for one frame.
class FrameWithoutWindow {
 public:
  FrameWithoutWindow(int width, int height) {
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
    io.DeltaTime = 1.0f / 60.0f;
    theme_ = applyTheme(1.0f);
    isReady_ = ImGui_ImplOpenGL3_Init("#version 430 core");
    if (!isReady_) return;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
  }
  ~FrameWithoutWindow() {
    if (isReady_) ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
  }
  FrameWithoutWindow(const FrameWithoutWindow &) = delete;
  FrameWithoutWindow &operator=(const FrameWithoutWindow &) = delete;

  [[nodiscard]] bool isReady() const { return isReady_; }
  [[nodiscard]] const Theme &theme() const { return theme_; }

 private:
  Theme theme_;
  bool isReady_ = false;
};

}  // namespace

Expected<render::Image> pictureOfViews(render::Renderer &renderer, ImageViews &images, scene::SceneGraph &scene,
                                       const std::string &title, int width, int height) {
  ImageViews *const shown = images.image() != nullptr ? &images : nullptr;
  const PixelRect area{0, 0, static_cast<float>(width), static_cast<float>(height)};
  const std::array<PixelRect, 4> panes = layOutViews(area, shown);
  const PixelRect &space = panes[static_cast<std::size_t>(Pane::space)];
  render::Camera camera;
  if (shown) viewOfImages(camera);
  if (const auto bounds = scene.bounds(); bounds && !space.isEmpty())
    camera.fit(bounds->min, bounds->max, space.w / space.h);

  FrameWithoutWindow imgui(width, height);
  if (!imgui.isReady())
    return fail(ErrorCode::graphics, "texts cannot be drawn: Dear ImGui does not start with this OpenGL");
  WindowServices services;
  services.scene = &scene;
  services.images = shown;
  const WindowActions actions;
  SimulationView simulation;
  simulation.exists = true;
  simulation.title = title;
  AutomationState automation{std::filesystem::path()};
  WindowState state;
  Modes modes(camera);
  FileDialog dialog;
  FrameContext frame{services, actions, simulation, imgui.theme(), automation, state, modes, dialog, camera};
  frame.area = area;
  frame.view = space;
  frame.panes = panes;
  frame.windowSize = {width, height};
  frame.mouseX = frame.mouseY = -1e9;  // read-outs are those of the cross-hair
  drawViewDecorations(frame);
  drawSliceDecorations(frame, renderer);
  ImGui::Render();

  const auto viewportOf = [height](const PixelRect &rect) {
    render::Viewport port;
    port.x = static_cast<int>(rect.x);
    port.width = static_cast<int>(rect.w);
    port.height = static_cast<int>(rect.h);
    port.y = height - static_cast<int>(rect.y) - port.height;
    return port;
  };
  return render::paintPicture(width, height, [&] {
    showInSpace(renderer, shown);
    for (const Pane pane : kSlicePanes)
      if (const PixelRect &rect = panes[static_cast<std::size_t>(pane)]; shown && renderer.images() && !rect.isEmpty())
        drawSlice(renderer, *shown, pane, viewportOf(rect));
    if (!space.isEmpty()) renderer.draw(camera, viewportOf(space));
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  });
}

}  // namespace c3de::ui
