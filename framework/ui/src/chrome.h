// SPDX-License-Identifier: Apache-2.0
// What stands around the 3D view. Each function draws one part into the current ImGui frame.
#pragma once

#include "frame_context.h"
#include "imgui_panel.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::ui {

/// Height in pixels.
float drawMenuBar(FrameContext &frame);
void drawToolbar(FrameContext &frame, const PixelRect &area);
/// Scene list and plugin panels.
void drawSidePanel(FrameContext &frame, ImGuiPanels &panels, const PixelRect &area);
/// Drag to make the side panel wider or narrower.
void drawSplitter(FrameContext &frame, const PixelRect &area);
void drawStatusBar(FrameContext &frame, const PixelRect &area);
/// Over the view: axes, what to do when nothing is loaded.
void drawViewDecorations(FrameContext &frame);
/// Over the slices: letters, cross-hair, outlines of bodies, scale bar, read-out. Nothing without an image.
void drawSliceDecorations(FrameContext &frame, const render::Renderer &renderer);
/// Over the view: messages and running jobs. Fills state.overlays.
void drawNotifications(FrameContext &frame);
void drawJobs(FrameContext &frame);
/// A step that takes more than a second is said while it lasts.
void drawLongStep(FrameContext &frame);
void drawShortcuts(FrameContext &frame);
void drawAbout(FrameContext &frame);

/// Begins a window without decoration at a fixed place. Always followed by ImGui::End().
void beginFixed(const char *name, const PixelRect &area, const ImVec4 &background, ImVec2 padding, int extraFlags = 0);

}  // namespace c3de::ui
