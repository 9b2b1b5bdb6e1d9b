// SPDX-License-Identifier: Apache-2.0
// Blocks and balls in contact, and quantities of several bodies together.
#pragma once

#include "pointbased/simulator.h"

namespace shapes {

[[nodiscard]] pointbased::Material soft(double modulus, double poisson, double viscosity = 0.0);
/// On a lattice with its stabilisation.
[[nodiscard]] std::unique_ptr<pointbased::Body> bodyOf(const pointbased::BodyShape &shape, double spacing,
                                                       const pointbased::Material &material,
                                                       std::vector<pointbased::Fix> fixes = {},
                                                       std::vector<pointbased::Load> loads = {});
/// @param n  squares along an edge of its skin
[[nodiscard]] std::unique_ptr<pointbased::Body> block(const pointbased::Vec3 &low, const pointbased::Vec3 &high,
                                                      double spacing, const pointbased::Material &material, int n,
                                                      std::vector<pointbased::Fix> fixes = {},
                                                      std::vector<pointbased::Load> loads = {});
/// Built once for all balls of the same position and size.
/// @param n  faces of its skin around the equator
[[nodiscard]] std::unique_ptr<pointbased::Body> ball(const pointbased::Vec3 &centre, double radius, double spacing,
                                                     const pointbased::Material &material, int n);
/// Five blocks of 50 mm stacked on the ground, under their weight; the lowest first.
[[nodiscard]] std::vector<std::size_t> stackOfFive(pointbased::Simulator &simulator);
void setVelocity(pointbased::Simulator &simulator, std::size_t id, const pointbased::Vec3 &velocity);

/// Of all bodies.
struct Total {
  pointbased::Vec3 momentum = pointbased::Vec3::Zero(), angular = pointbased::Vec3::Zero();
  double energy = 0.0;  ///< J, with attachments
};
[[nodiscard]] Total totalOf(pointbased::Simulator &simulator);

/// Null: they do not touch.
[[nodiscard]] const pointbased::ContactSummary *between(const std::vector<pointbased::ContactSummary> &contacts,
                                                        std::size_t a, std::size_t b);

}  // namespace shapes
