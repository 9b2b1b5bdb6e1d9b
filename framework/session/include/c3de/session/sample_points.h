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

/// A material point of a body, where it is before anything moves, in the frame of the simulation.
struct SamplePoint {
  std::string body;
  Vec3 at_m{};
  int line = 0;  ///< of its file; 0: none
};

/// The most points of a file.
inline constexpr std::size_t kMostSamplePoints = 100000;

/// Reads CSV with the columns `body`, `x [m]`, `y [m]`, `z [m]`, in any order; others are left alone. Errors
/// (ErrorCode::input) say file and line.
[[nodiscard]] Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file);
/// The same of three other columns in the place of x, y and z.
[[nodiscard]] Expected<std::vector<SamplePoint>> readSamplePoints(const std::filesystem::path &file,
                                                                  const std::array<const char *, 3> &columns);
/// Writes what readSamplePoints() reads.
[[nodiscard]] Expected<void> writeSamplePoints(const std::filesystem::path &file,
                                               const std::vector<SamplePoint> &points);

/// Where the points are now, m, in their order: as probes that are added for it and removed again, so that every
/// simulator answers, and states and reports stay as they are. The thread that steps it, between two steps.
/// @param where      what errors begin with: the file of the points
/// @param takeError  the text that the last failing call left; may be empty
[[nodiscard]] Expected<std::vector<Vec3>> positionsOf(c3de_object *simulator, const std::vector<SamplePoint> &points,
                                                      const std::string &where,
                                                      const std::function<std::string()> &takeError);

/// CSV: `body,x [m],y [m],z [m],x at the end [m],…`, in the order of the points.
[[nodiscard]] Expected<void> writeSampled(const std::filesystem::path &file, const std::vector<SamplePoint> &points,
                                          const std::vector<Vec3> &positions_m);
/// Reads the positions at the end of what writeSampled() has written.
[[nodiscard]] Expected<std::vector<Vec3>> readSampled(const std::filesystem::path &file);

}  // namespace c3de::session
