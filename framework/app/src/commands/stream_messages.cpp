// SPDX-License-Identifier: Apache-2.0
#include "commands/stream_messages.h"

#include <algorithm>

#include "c3de/session/match_stages.h"

namespace c3de::app {

std::vector<Vec3> takeSurfacePoints(const tracking::TrackedFrame &frame, std::vector<session::Landmark> &landmarks) {
  std::vector<Vec3> out;
  for (session::Landmark &landmark : landmarks) landmark.target_mm.reset();
  for (const tracking::TrackedPoint &point : frame.points) {
    const auto landmark = std::find_if(landmarks.begin(), landmarks.end(),
                                       [&](const session::Landmark &one) { return one.name == point.name; });
    if (landmark != landmarks.end())
      landmark->target_mm = point.at_mm;
    else
      out.push_back(point.at_mm);
  }
  landmarks = session::withTargets(landmarks);
  return out;
}

void sendMatch(tracking::TrackingLink &link, const Mat4 &measuredFromBody,
               const std::vector<session::MeasuredLandmark> &landmarks) {
  link.sendTransform(kMotionMessage, measuredFromBody);
  std::vector<tracking::TrackedPoint> points;
  points.reserve(landmarks.size());
  for (const session::MeasuredLandmark &one : landmarks)
    points.push_back({one.landmark.name, transformPoint(measuredFromBody, one.position_mm)});
  if (!points.empty()) link.sendPoints(kLandmarksMessage, points);
}

}  // namespace c3de::app
