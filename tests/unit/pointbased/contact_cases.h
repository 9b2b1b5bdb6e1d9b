// SPDX-License-Identifier: Apache-2.0
// Obstacles given by formulas, and bodies that collide with them.
#pragma once

#include "pointbased/simulator.h"

namespace shapes {

/// Counts the queries of an obstacle.
struct Asked {
  std::size_t closest = 0, crossing = 0;
};

/// All points with (x - point) · normal < 0.
[[nodiscard]] pointbased::Obstacle halfSpace(const pointbased::Vec3 &point, const pointbased::Vec3 &normal,
                                             double friction, Asked *asked = nullptr);
/// An open sheet in the plane y = height, |x|, |z| < half: distances are never negative.
[[nodiscard]] pointbased::Obstacle sheet(double height, double half, double friction);
/// A solid box with sharp edges.
[[nodiscard]] pointbased::Obstacle solidBox(const pointbased::Vec3 &min, const pointbased::Vec3 &max, double friction,
                                            Asked *asked = nullptr);

/// A box filled with a lattice, its skin divided into n x n squares per side.
[[nodiscard]] std::unique_ptr<pointbased::Body> latticeBox(const pointbased::Vec3 &min, const pointbased::Vec3 &max,
                                                           double spacing, const pointbased::Material &material,
                                                           int n = 8);
[[nodiscard]] pointbased::Material rubber(double youngsModulus, double viscosity = 0.0);

/// Automatic explicit steps; others of kImplicitStep.
[[nodiscard]] pointbased::WorldSettings worldOf(pointbased::Integrator integrator, const pointbased::Vec3 &gravity);

/// Highest and lowest contact point along an axis.
struct Extent {
  double low = 0.0, high = 0.0;
};
[[nodiscard]] Extent extent(pointbased::Body &body, const pointbased::Vec3 &axis);
[[nodiscard]] pointbased::Vec3 meanVelocity(const pointbased::Body &body);
[[nodiscard]] pointbased::Vec3 meanDisplacement(const pointbased::Body &body);
/// Σ m v and Σ (X + u) x m v about the origin of the body's frame.
struct Momenta {
  pointbased::Vec3 linear = pointbased::Vec3::Zero(), angular = pointbased::Vec3::Zero();
  double size = 0.0;  ///< Σ m |v|
};
[[nodiscard]] Momenta momenta(const pointbased::Body &body);
/// Of that kind, whose text contains `text`.
[[nodiscard]] long countEvents(const pointbased::Simulator &simulator, const std::string &kind,
                               const std::string &text = {});
/// Kinetic, elastic and gravity.
[[nodiscard]] double totalEnergy(const pointbased::Simulator &simulator, std::size_t id);

}  // namespace shapes
