// SPDX-License-Identifier: Apache-2.0
// Deformed bodies with known loads, and what a measurement sees of them: truths of the inverse problem.
#pragma once

#include <string>

#include "pointbased/surface_match.h"
#include "shapes.h"

namespace match_truths {

using namespace pointbased;

/// A body, how it is held, and the sizes of what acts on it.
struct Organ {
  std::string name;
  Surface surface;
  std::vector<Fix> fixes;
  Foundation foundation;
  double spacing = 0.0;             ///< m, of the match; the truth is solved on 0.8 of it
  Vec3 seenFrom = Vec3::UnitZ();    ///< the quarter of the surface farthest along it is measured
  double modulus = 6e3, force = 1;  ///< Pa, N
};

/// A beam that is held at one end; an ellipsoid and the organ of resources/meshes, held at a cap, on foundations.
[[nodiscard]] std::vector<Organ> organs();
inline constexpr int kLoads = 5;  ///< of each organ

struct Truth {
  std::vector<Vec3> references;  ///< points inside, at rest, world, m
  std::vector<Vec3> positions;   ///< of the same, in the space of the measurement
  std::vector<MatchPoint> points;
  std::vector<MatchLandmark> landmarks;  ///< four on the seen surface, far from each other
  MatchMotion motion;
};
/// @param load  0 … kLoads - 1
/// @param noise  m, normal along each axis
[[nodiscard]] Truth truthOf(const Organ &organ, int load, std::size_t points, double noise);

/// The body of the match, with `stiffness` times the true modulus.
[[nodiscard]] Result<SurfaceMatch> matchOf(const Organ &organ, double stiffness,
                                           const ParallelFor &parallelFor = serialFor());
/// The same body for other solutions.
[[nodiscard]] std::unique_ptr<Body> bodyOf(const Organ &organ, double stiffness);
/// m, at the points inside: of a result, or of its rigid motion alone.
[[nodiscard]] std::vector<double> errorsOf(const Organ &organ, const Truth &truth, const SurfaceMatchResult &result);
/// m, at the same points; NaN: not known.
[[nodiscard]] std::vector<double> expectedErrorsOf(const Organ &organ, const Truth &truth,
                                                   const SurfaceMatchResult &result);
[[nodiscard]] std::vector<double> rigidErrorsOf(const Truth &truth, const SurfaceMatchResult &result);
[[nodiscard]] double meanOf(const std::vector<double> &values);

}  // namespace match_truths
