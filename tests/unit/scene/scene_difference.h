// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/scene/scene_file.h"

/// The first member in which two scenes differ, without lines; empty: none.
std::string difference(const c3de::scene::SceneFile &a, const c3de::scene::SceneFile &b);
