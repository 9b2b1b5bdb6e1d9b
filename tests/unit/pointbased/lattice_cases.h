// SPDX-License-Identifier: Apache-2.0
// Bodies on lattices and the conditions that every one of them must fulfil.
#pragma once

#include "pointbased/lattice.h"
#include "shapes.h"

namespace lattice_cases {

using namespace pointbased;

[[nodiscard]] LatticeBody filled(const BodyShape &shape, const LatticeSampling &sampling,
                                 const ParallelFor &parallelFor = serialFor());
[[nodiscard]] LatticeSampling withSpacing(double spacing);

/// A box with its surface, and a ball with its surface.
[[nodiscard]] BodyShape box(const Vec3 &min, const Vec3 &max);
[[nodiscard]] BodyShape ball(const Vec3 &centre, double radius);
/// The union of convex bodies that do not touch; a segment from one to the other counts as crossing.
[[nodiscard]] BodyShape together(const BodyShape &a, const BodyShape &b);
/// Wider bounds, so that the lattice is offset from the body by `shift` spacings (each 0 … 1) along its axes.
[[nodiscard]] BodyShape shifted(const BodyShape &shape, double spacing, const Vec3 &shift);
[[nodiscard]] Mat3 rotation(int axis, double degrees);
[[nodiscard]] double sum(std::span<const double> values);
/// Ranges of `grain` on several threads, in no order.
[[nodiscard]] ParallelFor threadedFor(std::size_t threads);

/// The largest errors of Σ g = 0, Σ X g^T = I, Σ γ = 0, Σ γ X = 0 over all points, in units of a spacing.
struct Consistency {
  double gradientSum = 0.0, gradientMoment = 0.0, modeSum = 0.0, modeMoment = 0.0;
  [[nodiscard]] double worst() const { return std::max({gradientSum, gradientMoment, modeSum, modeMoment}); }
};
[[nodiscard]] Consistency consistencyOf(const LatticeBody &body);

/// Largest |Σ_q v_q g_qj - Σ_p φ_pj N_p dA_p| over the phyxels, in units of spacing².
/// The second sum runs over points of the surface: the loads of a constant stress.
[[nodiscard]] double patchError(const LatticeBody &body, const BodyShape &shape);

/// The largest errors of Σ φ = 1, Σ φ X = X_p, Σ ∇φ = 0, Σ X ∇φ^T = I, in units of a spacing.
[[nodiscard]] double bindingError(const LatticeBody &body, std::span<const Vec3> points, std::span<const Vec3> normals);

/// Linear elasticity on the stencils of a lattice: E = 10 kPa, the hourglass energy with its factors 0.92 and `twist`
/// for xyz.
struct LinearSolution {
  std::vector<Vec3> displacements;
  double tip = 0.0;  ///< mean displacement along the load, m
};
/// A total force spread over the surface in `loaded`; held parts at rest.
[[nodiscard]] LinearSolution solveLinear(const LatticeBody &body, const BodyShape &shape, const Region &loaded,
                                         const Vec3 &force, double twist = 0.1, double poissonRatio = 0.3);

}  // namespace lattice_cases
