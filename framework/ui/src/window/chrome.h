// SPDX-License-Identifier: Apache-2.0
// What stands around the 3D view. Each function draws one part into the current ImGui frame.
#pragma once

#include "panels/imgui_panel.h"
#include "window/frame_context.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::ui {

/// Height in pixels.
float drawMenuBar(FrameContext &frame);
/// A failure becomes a message.
void runPluginCommand(const WindowServices &services, Handle command);
void drawToolbar(FrameContext &frame, const PixelRect &area);
/// The labels of a body of many tissues and what they have done.
void drawTissueTable(FrameContext &frame, const TissueTable &table);
/// Scene list, tissues and plugin panels.
void drawSidePanel(FrameContext &frame, ImGuiPanels &panels, const PixelRect &area);
/// Drag to make the side panel wider or narrower.
void drawSplitter(FrameContext &frame, const PixelRect &area);
void drawStatusBar(FrameContext &frame, const PixelRect &area);
/// Over the view: axes, what to do when nothing is loaded.
void drawViewDecorations(FrameContext &frame);
/// Over the slices: letters, cross-hair, outlines of bodies, scale bar, read-out. Nothing without an image.
void drawSliceDecorations(FrameContext &frame, const render::Renderer &renderer);
/// Below the panels: messages and running jobs, until they go. Says in state.dock how high that is.
void drawDock(FrameContext &frame, const PixelRect &area);
/// Panels that ask something before there is anything to see, over the view. Fills state.overlays.
void drawViewPanels(FrameContext &frame, ImGuiPanels &panels);
void drawShortcuts(FrameContext &frame);
void drawMessages(FrameContext &frame);
void drawAbout(FrameContext &frame);
void drawPluginManager(FrameContext &frame);
/// What the body of a whole scan is to be, while that is asked.
void drawScanBody(FrameContext &frame);
/// Above the views while the region of the scan's body is drawn: its size and what ends it. 0 while nothing is drawn.
[[nodiscard]] float regionBarHeight(const FrameContext &frame);
void drawRegionBar(FrameContext &frame, const PixelRect &area);
/// Asks state.question until there is a state.answer.
void drawQuestion(FrameContext &frame);

/// A window over all others, in the middle; `isShown` becomes false when it is closed. Logical pixels. When it is
/// begun, endDialog() draws what closes it.
[[nodiscard]] bool beginDialog(FrameContext &frame, const char *title, const char *id, bool &isShown, ImVec2 size);
void endDialog(FrameContext &frame, bool &isShown);

/// Begins a window without decoration at a fixed place. Always followed by ImGui::End().
void beginFixed(const char *name, const PixelRect &area, const ImVec4 &background, ImVec2 padding, int extraFlags = 0);

}  // namespace c3de::ui
