// SPDX-License-Identifier: Apache-2.0
// Everything around the 3D view. Each function draws one part into the current ImGui frame.
#pragma once

#include "frame/frame_context.h"
#include "panels/imgui_panel.h"
#include "window/picture_textures.h"

namespace c3de::ui {

/// Returns the height in pixels.
float drawMenuBar(FrameContext &frame);
/// Reports a failure as a message.
void runPluginCommand(const WindowServices &services, Handle command);
void drawToolbar(FrameContext &frame, const PixelRect &area);
/// The labels of a body of many tissues and their motion.
void drawTissueTable(FrameContext &frame, const TissueTable &table);
/// Landmarks, distances and angles.
void drawMeasurements(FrameContext &frame, MeasurementList &list);
/// Scene list, tissues and plugin panels.
void drawSidePanel(FrameContext &frame, ImGuiPanels &panels, const PixelRect &area);
/// Drag to make the side panel wider or narrower.
void drawSplitter(FrameContext &frame, const PixelRect &area);
void drawStatusBar(FrameContext &frame, const PixelRect &area);
/// Below the panels: messages and running jobs, until they disappear. Sets its height in state.dock.
void drawDock(FrameContext &frame, const PixelRect &area);
/// Over the views while there is neither image nor simulation: buttons that open files, and the recent files. Adds to
/// state.overlays.
void drawStartPage(FrameContext &frame, PictureTextures &textures);
/// File > Open recent.
void drawRecentMenu(FrameContext &frame);
/// Panels that require input before there is anything to see, over the view. Adds to state.overlays.
void drawViewPanels(FrameContext &frame, ImGuiPanels &panels);
void drawShortcuts(FrameContext &frame);
/// Dialog that finds commands and tools by words, while it is open.
void drawCommandPalette(FrameContext &frame);
void drawMessages(FrameContext &frame);
void drawAbout(FrameContext &frame);
void drawPluginManager(FrameContext &frame);
/// Dialog for files of a session that are missing or have changed, while it is shown.
void drawMissingFiles(FrameContext &frame);
/// Dialog for the properties of a whole-scan body, while it is open.
void drawScanBody(FrameContext &frame);
/// Above the views while the region of the scan's body is being drawn: its size and the buttons that end the drawing. 0
/// otherwise.
[[nodiscard]] float regionBarHeight(const FrameContext &frame);
void drawRegionBar(FrameContext &frame, const PixelRect &area);
/// Below the views while a recording is replayed: its timeline. 0 otherwise.
[[nodiscard]] float timelineBarHeight(const FrameContext &frame);
void drawTimelineBar(FrameContext &frame, const PixelRect &area);
/// Dialog that exports a stretch of the recording, while it is open.
void drawStretchDialog(FrameContext &frame);
/// Dialog that saves a report about a problem, while it is open.
void drawReportDialog(FrameContext &frame);
/// Below the views while it is shown: curves over simulated time. 0 otherwise.
[[nodiscard]] float plotStripHeight(const FrameContext &frame);
void drawPlotStrip(FrameContext &frame, const PixelRect &area);
/// Dialog that saves a figure, while it is open.
void drawFigureDialog(FrameContext &frame);
/// File > Screenshot size.
void drawScreenshotMenu(FrameContext &frame);
/// Dialog of what the user prefers, while it is open.
void drawPreferences(FrameContext &frame);
/// Shows state.question until there is a state.answer.
void drawQuestion(FrameContext &frame);

/// A window in the middle, above all others; `isShown` becomes false when it is closed. Size in logical pixels. If this
/// returns true, endDialog() draws the close button.
/// @param flags  ImGuiWindowFlags
[[nodiscard]] bool beginDialog(FrameContext &frame, const char *title, const char *id, bool &isShown, ImVec2 size,
                               int flags = 0);
void endDialog(FrameContext &frame, bool &isShown);

/// Begins a window without decoration at a fixed position. Always followed by ImGui::End().
void beginFixed(const char *name, const PixelRect &area, const ImVec4 &background, ImVec2 padding, int extraFlags = 0);

}  // namespace c3de::ui
