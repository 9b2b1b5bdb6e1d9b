// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/session/measured_points.h"

namespace c3de::session {

/// Adds the measured position of a landmark, LPS mm. Errors (ErrorCode::input): a second row of the landmark, more than
/// kMaxLandmarks.
[[nodiscard]] Expected<void> addMeasuredLandmark(const std::filesystem::path &file, int line, const std::string &name,
                                                 const Vec3 &at_mm, MeasuredPoints &out);

}  // namespace c3de::session
