// SPDX-License-Identifier: Apache-2.0
// The two scenes, identical for every engine: fixed region, material, measured displacement, and its reference value.
#pragma once

#include <filesystem>
#include <optional>

#include "moving_body.h"
#include "pointbased/rest_state.h"
#include "tetra_mesh.h"

namespace peers {

struct Scene {
  std::string name;
  pointbased::BodyShape shape;
  pointbased::Region held;
  Solid soft;   ///< of the costs
  Solid stiff;  ///< of the static errors: small strains, so that all material laws agree
  std::function<TetraMesh(std::size_t nodes)> mesh;
  std::function<pointbased::LatticeSampling(std::size_t nodes)> sampling;
  /// The measured displacement of a body of this engine, m.
  std::function<Vec3(const pointbased::RestState &, std::span<const Vec3> displacements)> measure;
  double truth = 0.0;  ///< m, vertical component of the measured displacement of `stiff`; 0: unknown
  std::string origin;  ///< source of the reference value
  double size = 0.0;   ///< m, longest edge of the bounds
};

/// 0.2 x 0.04 x 0.04 m, x = 0 fixed; the mean displacement of the far end.
[[nodiscard]] Scene cantilever();

/// The organ of a file (mm) that hangs from its uppermost fifth; the mean displacement of the part below. Errors: why
/// the file cannot be used.
[[nodiscard]] pointbased::Result<Scene> hangingOrgan(const std::filesystem::path &file);

}  // namespace peers
