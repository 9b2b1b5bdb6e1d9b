// SPDX-License-Identifier: Apache-2.0
// Bodies with known volumes, for tests of the physics without files.
#pragma once

#include <memory>

#include "pointbased/body.h"
#include "pointbased/simulator.h"
#include "support/random.h"

namespace shapes {

using pointbased::Vec3;
using support::Random;

[[nodiscard]] pointbased::BodyShape box(const Vec3 &min, const Vec3 &max);
[[nodiscard]] pointbased::BodyShape ball(const Vec3 &centre, double radius);
/// Two lobes joined by a bridge: a U of 0.3 x 0.2 x 0.1 m, with a slot of 0.1 m.
[[nodiscard]] pointbased::BodyShape horseshoe();

/// The body rotated about the origin, with its surface.
[[nodiscard]] pointbased::BodyShape turned(pointbased::BodyShape shape, const pointbased::Mat3 &turn);

[[nodiscard]] pointbased::PhyxelCloud filled(const pointbased::BodyShape &shape, double spacing);
[[nodiscard]] std::shared_ptr<const pointbased::RestState> restState(const pointbased::BodyShape &shape, double spacing,
                                                                     const pointbased::NeighborChoice &choice = {});
/// An unchanged cloud with equal volumes of spacing³.
[[nodiscard]] std::shared_ptr<const pointbased::RestState> restState(const std::vector<Vec3> &points, double spacing,
                                                                     const pointbased::NeighborChoice &choice = {});

/// F, stress and forces at the body's current displacements.
void evaluate(pointbased::Body &body);

/// Largest difference of a scalar function's derivative by central differences from -forces, relative to the largest
/// force.
[[nodiscard]] double forceError(pointbased::Body &body, double step);

}  // namespace shapes
