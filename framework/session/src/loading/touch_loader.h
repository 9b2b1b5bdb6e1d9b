// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "loading/loading_scene.h"

namespace c3de::session {

/// Adds the interactions to a simulator that has its obstacles and bodies: attachments, grasps, probe tools and contact
/// pairs. Errors begin with the location in the scene.
[[nodiscard]] Expected<void> addTouch(const LoadingScene &loading, NamedHandles handles);

}  // namespace c3de::session
