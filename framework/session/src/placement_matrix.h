// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/core/vec.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// From the scan to where a body is placed at rest, mm.
[[nodiscard]] Mat4 matrixOf(const scene::ScenePlacement &placement);

}  // namespace c3de::session
