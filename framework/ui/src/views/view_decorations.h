// SPDX-License-Identifier: Apache-2.0
// What is drawn over the views, into the current ImGui frame.
#pragma once

#include "frame/frame_context.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::ui {

/// Over the 3D view: axes, and instructions when nothing is loaded.
void drawViewDecorations(FrameContext &frame);
/// Landmarks, distances and angles in the 3D view, in front of everything.
void drawMeasurementsInSpace(FrameContext &frame);
/// Over the slices: letters, cross-hair, outlines of bodies, scale bar, read-out. Nothing without an image.
void drawSliceDecorations(FrameContext &frame, const render::Renderer &renderer);

}  // namespace c3de::ui
