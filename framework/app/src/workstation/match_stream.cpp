// SPDX-License-Identifier: Apache-2.0
#include "workstation/match_stream.h"

#include <fmt/format.h>

#include <utility>

#include "commands/stream_messages.h"

namespace c3de::app {

std::optional<MatchStream::Frame> MatchStream::take(const std::vector<Landmark> &landmarks) {
  auto tracked = link_->takeFrame(std::chrono::milliseconds{0});
  if (!tracked) return std::nullopt;
  Frame out;
  out.landmarks = landmarks;
  out.points_mm = takeSurfacePoints(*tracked, out.landmarks);
  return out;
}

void MatchStream::onMatched(const session::FrameMatch &match, const std::vector<session::MeasuredLandmark> &landmarks) {
  ++matched_;
  failure_.clear();
  wall_s_ = match.wall_s;
  motion_.reset();
  if (match.canContinue()) motion_ = match.measuredFromBody();
  sendMatch(*link_, match.measuredFromBody(), landmarks);
}

void MatchStream::onFailed(const std::string &why) {
  ++unmatched_;
  failure_ = why;
  motion_.reset();
}

std::string MatchStream::status() const {
  std::string text = fmt::format("{}; {} matched", textOf(link_->status()), matched_);
  if (matched_ > 0) text += fmt::format(", the last one in {:.2f} s", wall_s_);
  if (unmatched_ > 0) text += fmt::format("; {} left out", unmatched_);
  if (!failure_.empty()) text += "; the last frame: " + failure_;
  return text;
}

std::optional<MatchStream::Change> MatchStream::takeChange() {
  const tracking::LinkStatus status = link_->status();
  if (!connection_.update(status.state)) return std::nullopt;
  return Change{status.state == tracking::LinkState::lost, textOf(status)};
}

}  // namespace c3de::app
