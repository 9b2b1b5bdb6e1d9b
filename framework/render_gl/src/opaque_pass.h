// SPDX-License-Identifier: Apache-2.0
// Opaque proxies: drawn from their own buffers, in any order, with depth.
#pragma once

#include "c3de/render/renderer.h"
#include "frame.h"
#include "retained_renderer.h"

namespace c3de::render {

/// Uploads changes and draws one mesh, sphere or line proxy.
/// @param statistics  created vertex arrays and draw calls are added
/// @param isDepthOnly  draws only the depth of a mesh given by Material::cover
void drawOpaque(Proxy &proxy, const Frame &frame, const Programs &programs, RenderStatistics &statistics,
                bool isDepthOnly = false);

}  // namespace c3de::render
