// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/match_scene.h"

namespace c3de::app {

/// Brings a body of a scene to each frame of a sequence of points, one after the other, and prints the result. Returns
/// the exit code: kFailed where the motion of the first frame is ambiguous or a frame cannot be matched, kInput where
/// no motion is credible; the outputs contain the frames before.
int matchFrames(const MatchOptions &options);

}  // namespace c3de::app
