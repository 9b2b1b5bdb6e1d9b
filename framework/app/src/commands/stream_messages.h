// SPDX-License-Identifier: Apache-2.0
// What is received from a tracking system during a match, and what is sent to it.
#pragma once

#include <vector>

#include "c3de/session/measurements.h"
#include "c3de/tracking/tracking_link.h"

namespace c3de::app {

/// Names of the messages that are sent.
inline constexpr const char *kMotionMessage = "C3DE_Motion", *kLandmarksMessage = "C3DE_Landmarks",
                            *kSliceMessage = "C3DE_Slice";

/// The points without the name of a landmark, LPS mm. The others become targets: afterwards `landmarks` are those that
/// were measured.
[[nodiscard]] std::vector<Vec3> takeSurfacePoints(const tracking::TrackedFrame &frame,
                                                  std::vector<session::Landmark> &landmarks);

/// Sends a rigid motion, and landmarks of the body where it moves them.
/// @param measuredFromBody  mm
void sendMatch(tracking::TrackingLink &link, const Mat4 &measuredFromBody,
               const std::vector<session::MeasuredLandmark> &landmarks);

}  // namespace c3de::app
