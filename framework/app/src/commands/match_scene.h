// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/run_options.h"

namespace c3de::app {

struct MatchOptions {
  /// Session, scene, overrides, unit of a mesh, report, outputs of the matched state, quiet.
  RunOptions run;
  // Replace the keys of [match] of the same names:
  std::string body, label, use, unit;
  std::filesystem::path surface, points, labels, landmarks;
  std::optional<double> noise_mm, weight;
  bool isRigid = false;             ///< no deformation
  std::filesystem::path residuals;  ///< empty: not requested
  /// A sequence in place of surface, points and labels (matchFrames()), and its table; empty: none
  std::filesystem::path frames, frameTable;
  /// Address of a tracking system that sends the frames; empty: none
  std::string stream;
  std::optional<long long> streamFrames;  ///< none: until the stream ends
  std::optional<double> streamTimeout_s;  ///< without points, until the sequence ends
  std::string streamTool;                 ///< whose tip is tracked; empty: frames are POINT messages
  std::optional<int> streamToolPoints;    ///< points of a frame of the tool
  bool sendsSlice = false;                ///< sends a slice of the deformed image after each frame
};

/// Brings a body of a scene to what was measured and prints the result. Returns the exit code: kFailed where the motion
/// is ambiguous, kInput where none is credible; the outputs are written then as well.
int matchScene(const MatchOptions &options);

}  // namespace c3de::app
