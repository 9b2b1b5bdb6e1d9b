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

/// Material points at which displacement fields are compared.
struct Samples {
  std::vector<session::SamplePoint> points;  ///< inside the bodies first, then on their skins
  std::size_t inside = 0;                    ///< number of points inside
  std::size_t skinBegin = 0;                 ///< index of the first point on a skin
  /// Represented volume of points inside, m^3, and area of points on a skin, m^2
  std::vector<double> weights;
};

/// Initial skin of a body, before anything moves.
struct Skin {
  std::string body;
  geometry::TriangleMesh mesh;  ///< mm, in the frame of the simulation
};

/// Draws points uniformly over the volume of the bodies (where the winding number indicates inside) and over their
/// skins. There are `count` of each, at least 8 per body. Equal seeds give equal points on every machine. The error
/// (ErrorCode::input) names a body that has almost no interior.
[[nodiscard]] Expected<Samples> drawSamples(const std::vector<Skin> &skins, std::size_t count, std::uint64_t seed);

}  // namespace c3de::study
