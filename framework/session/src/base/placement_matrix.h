// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/core/vec.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// Maps the scan to the placed position of a body at rest, mm.
[[nodiscard]] Mat4 matrixOf(const scene::ScenePlacement &placement);

}  // namespace c3de::session
