// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/frame_match.h"
#include "c3de/session/measured_frames.h"
#include "c3de/session/session.h"
#include "commands/match_scene.h"

namespace c3de::app {

/// The measurements of a sequence, one after the other.
class MeasuredSource {
 public:
  struct Frame {
    session::MeasuredFrame measured;
    std::vector<session::Landmark> landmarks;  ///< with their targets in this frame
  };
  virtual ~MeasuredSource() = default;

  /// Waits for the next frame; none: the sequence has ended. Errors: why it ends early; cancelled.
  [[nodiscard]] virtual Expected<std::optional<Frame>> next(const ProgressFn &progress) = 0;
  /// Number of all frames; none: not known before the end.
  [[nodiscard]] virtual std::optional<std::size_t> count() const = 0;
  /// Frames arrive while others are matched: one that cannot be matched is left out, and an interrupt is the regular end.
  [[nodiscard]] virtual bool isLive() const { return false; }
  /// Sends the result of the last frame where it was requested. [sim]
  [[nodiscard]] virtual Expected<void> send(const session::FrameMatch &match) = 0;
  /// `match.stream` of a report; empty: there is none.
  [[nodiscard]] virtual std::string streamJson() const { return {}; }
};

/// Frames of a folder or a table. Errors: a file or an unknown landmark (input), options without effect (usage).
[[nodiscard]] Expected<std::unique_ptr<MeasuredSource>> measuredFiles(const MatchOptions &options,
                                                                      const scene::SceneFile &scene,
                                                                      const scene::SceneMatch &wanted);

/// What a stream needs of the simulation.
struct StreamContext {
  session::Session &session;
  const scene::SceneFile &scene;
  const struct SceneAtRest &built;
  session::BodySources &sources;
  std::string body;  ///< its name in the simulator
};
/// Frames that a tracking system sends. All references must outlive it. Errors (usage): the address, options without
/// effect, no image for a slice. [sim]
[[nodiscard]] Expected<std::unique_ptr<MeasuredSource>> measuredStream(const MatchOptions &options,
                                                                       StreamContext context);

}  // namespace c3de::app
