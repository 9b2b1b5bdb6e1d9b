// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/frame_match.h"
#include "c3de/session/measurements.h"
#include "c3de/tracking/tracking_link.h"

namespace c3de::app {

/// Frames of a tracking system that a body is matched to, one after the other. Main thread.
class MatchStream {
 public:
  explicit MatchStream(std::unique_ptr<tracking::TrackingLink> link) : link_(std::move(link)) {}

  struct Frame {
    std::vector<Vec3> points_mm;
    std::vector<Landmark> landmarks;  ///< those that were measured, with their targets
  };
  /// The newest frame that was not taken; none: there is none.
  /// @param landmarks  points with their names are landmarks
  [[nodiscard]] std::optional<Frame> take(const std::vector<Landmark> &landmarks);
  /// The result of a frame. Sends the motion, and where landmarks are expected in the space of the body.
  void onMatched(const session::FrameMatch &match, const std::vector<session::MeasuredLandmark> &landmarks);
  /// A frame was left out.
  void onFailed(const std::string &why);

  /// Of the last frame, if the next one can start from it.
  [[nodiscard]] const std::optional<Mat4> &motion() const { return motion_; }
  /// For the panel.
  [[nodiscard]] std::string status() const;
  /// That the connection has been made or lost since the last call.
  struct Change {
    bool isBad = false;
    std::string text;
  };
  [[nodiscard]] std::optional<Change> takeChange();
  [[nodiscard]] std::string address() const { return textOf(link_->address()); }

  bool canUndo = false;  ///< the state before the first match is a step of undo

 private:
  std::unique_ptr<tracking::TrackingLink> link_;
  std::optional<Mat4> motion_;
  std::size_t matched_ = 0, unmatched_ = 0;
  double wall_s_ = 0.0;  ///< of the last match
  std::string failure_;  ///< of the last frame; empty: it was matched
  tracking::ConnectionChange connection_;
};

}  // namespace c3de::app
