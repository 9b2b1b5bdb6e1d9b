// SPDX-License-Identifier: Apache-2.0
// Proxies that do not blend: drawn from buffers of their own, any order, with depth.
#pragma once

#include "c3de/render/renderer.h"
#include "frame.h"
#include "retained_renderer.h"

namespace c3de::render {

/// Uploads what changed and draws one mesh, sphere or line proxy.
/// @param statistics  counts of made vertex arrays and draw calls are added to
/// @param isCover  of a mesh the depth that Material::cover says alone is drawn
void drawOpaque(Proxy &proxy, const Frame &frame, const Programs &programs, RenderStatistics &statistics,
                bool isCover = false);

}  // namespace c3de::render
