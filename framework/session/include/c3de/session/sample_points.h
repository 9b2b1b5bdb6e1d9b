// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::session {

/// A material point of a body: its position before any motion, in the frame of the simulation.
struct SamplePoint {
  std::string body;
  Vec3 at_m{};
  int line = 0;  ///< in its file; 0: none
};

/// Maximum number of points in a file.
inline constexpr std::size_t kMaxSamplePoints = 100000;

/// Reads CSV with the columns `body`, `x [m]`, `y [m]`, `z [m]`, in any order; other columns are ignored. Errors
/// (ErrorCode::input) state file and line.
[[nodiscard]] Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file);
/// Same, with three other columns instead of x, y and z.
[[nodiscard]] Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file,
                                                                  const std::array<const char *, 3> &columns);
/// Writes the format of readSamplePoints().
[[nodiscard]] Expected<void> writeSamplePoints(const std::filesystem::path &file,
                                               const std::vector<SamplePoint> &points);

/// The present positions of the points, m, in their order. They are added as probes and removed again, so every
/// simulator supports this, and states and reports stay unchanged. Call on the thread that steps the simulator, between
/// two steps.
/// @param where      prefix of errors: the file of the points
/// @param takeError  returns the text of the last failed call; may be empty
[[nodiscard]] Expected<std::vector<Vec3>> positionsOf(c3de_object *simulator, const std::vector<SamplePoint> &points,
                                                      const std::string &where,
                                                      const std::function<std::string()> &takeError);

/// CSV: `body,x [m],y [m],z [m],x at the end [m],…`, in the order of the points.
[[nodiscard]] Expected<void> writeSampled(const std::filesystem::path &file, const std::vector<SamplePoint> &points,
                                          const std::vector<Vec3> &positions_m);
/// Reads the end positions from a file written by writeSampled().
[[nodiscard]] Expected<std::vector<Vec3>> readSampled(const std::filesystem::path &file);

}  // namespace c3de::session
