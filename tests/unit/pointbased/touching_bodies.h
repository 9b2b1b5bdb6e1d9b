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
/// Blocks of 50 mm stacked on the ground; the lowest first.
[[nodiscard]] std::vector<std::size_t> addStack(pointbased::Simulator &simulator, int count);
/// Five of them under their weight, with self-contact.
[[nodiscard]] std::vector<std::size_t> stackOfFive(pointbased::Simulator &simulator);
/// Each block presses on the one below it with the weight of those above, to 2 %, and skins do not cross.
void checkWeights(pointbased::Simulator &simulator, const std::vector<std::size_t> &ids);
/// At 0.4 m/s against each other, 10 mm off centre, without friction.
[[nodiscard]] std::pair<std::size_t, std::size_t> addCollidingBalls(pointbased::Simulator &simulator);
/// A block on a larger one that is fixed to the ground, with friction. Viscous, so that their oscillations decay.
/// @param spacings  of the larger one, of the smaller one
/// @return  the smaller one
[[nodiscard]] std::size_t addBlockOnBlock(pointbased::Simulator &simulator, double friction,
                                          std::pair<double, double> spacings, double gap);
void setVelocity(pointbased::Simulator &simulator, std::size_t id, const pointbased::Vec3 &velocity);

/// Of all bodies.
struct Total {
  pointbased::Vec3 momentum = pointbased::Vec3::Zero(), angular = pointbased::Vec3::Zero();
  double energy = 0.0;  ///< J, with attachments
};
[[nodiscard]] Total totalOf(pointbased::Simulator &simulator);

/// Largest values while two bodies collide.
struct Collision {
  double energy = 0.0;         ///< over that at the beginning
  double momentumError = 0.0;  ///< over the momentum of the first body
  double angularError = 0.0;   ///< over the angular momentum
  std::size_t crossings = 0;
  bool touched = false;
};
/// @param every  crossings are counted every so many steps
[[nodiscard]] Collision collide(pointbased::Simulator &simulator, std::size_t a, std::size_t b, double until,
                                std::size_t every = 1);

/// Of the bodies, m.
[[nodiscard]] std::vector<pointbased::Vec3> meanDisplacements(const pointbased::Simulator &simulator,
                                                              const std::vector<std::size_t> &ids);

/// Null: they do not touch.
[[nodiscard]] const pointbased::ContactSummary *between(const std::vector<pointbased::ContactSummary> &contacts,
                                                        std::size_t a, std::size_t b);

}  // namespace shapes
