// SPDX-License-Identifier: Apache-2.0
// Bodies with known volumes, for tests of the physics without files.
#pragma once

#include <memory>

#include "pointbased/body.h"
#include "pointbased/simulator.h"
#include "support/random.h"

namespace c3de {
class ThreadPool;
}

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

[[nodiscard]] pointbased::ParallelFor loopsOf(c3de::ThreadPool &pool);

/// As a recipe says; a requirement of the test case.
[[nodiscard]] std::shared_ptr<const pointbased::RestState> restState(const pointbased::BodyShape &shape,
                                                                     const pointbased::BodyRecipe &recipe,
                                                                     const std::vector<Vec3> &normals = {});
/// With the stabilisation of its kind of evaluation points.
[[nodiscard]] std::unique_ptr<pointbased::Body> makeBody(std::shared_ptr<const pointbased::RestState> rest,
                                                         std::vector<pointbased::Material> materials,
                                                         const std::string &name = "body");

[[nodiscard]] double largest(std::span<const Vec3> field);
[[nodiscard]] Vec3 total(std::span<const Vec3> field);
/// F, stress and forces at the body's current displacements.
void evaluate(pointbased::Body &body);

/// Largest difference of a scalar function's derivative by central differences from -forces, relative to the largest
/// force.
[[nodiscard]] double forceError(pointbased::Body &body, double step);

}  // namespace shapes
