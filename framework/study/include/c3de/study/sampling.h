// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/session/sample_points.h"

namespace c3de::study {

/// Material points that displacement fields are compared at.
struct Samples {
  std::vector<session::SamplePoint> points;  ///< inside the bodies first, then on their skins
  std::size_t inside = 0;                    ///< so many are inside
  std::size_t skinBegin = 0;                 ///< from there on they are on a skin
  /// What each stands for: of those inside m^3, of those on a skin m^2
  std::vector<double> weights;
};

/// A body as it lies before anything moves.
struct Skin {
  std::string body;
  geometry::TriangleMesh mesh;  ///< mm, in the frame of the simulation
};

/// Draws points evenly over the volume of the bodies (where the winding number says inside) and over their skins, as
/// many of each as asked for, at least 8 per body; the same ones for the same seed, on every machine. The error
/// (ErrorCode::input) names a body that has no inside to speak of.
[[nodiscard]] Expected<Samples> drawSamples(const std::vector<Skin> &skins, std::size_t count, std::uint64_t seed);

}  // namespace c3de::study
