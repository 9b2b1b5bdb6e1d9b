// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/material.h"
#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// Isotropic control of the modes that one evaluation per phyxel cannot see:
///
///     U_q = 1/2 alpha E v_q Σ_k w_qk |r_qk|²,   r_qk = (x_k - x_q) - F_q (X_k - X_q)
///
/// what the affine fit misses, with an exact gradient; zero for every affine motion. alpha = 0.1 keeps a body filled on a
/// lattice free of rattling; larger values stiffen bending.
inline constexpr double kDefaultStabilisation = 0.1;

/// Deformation gradient of every evaluation point.
///
/// F_q = I + Σ_k (u_k - u_anchor) g_qk^T; where the stencil is flat, completed so that a rotation stays a rotation:
/// coplanar F n = F t1 x F t2 normalised, collinear by the shortest rotation, alone F = I.
///
/// @param displacements  [phyxels] u, m
/// @param gradients      [points] out: F; row = component of x, column = component of X
/// @threads writes only `gradients`; no allocation
/// @source  Müller et al. 2004, the moving-least-squares fit, for the displacement vector at once
void deformationGradients(const StencilSet &stencils, std::span<const Vec3> displacements, std::span<Mat3> gradients,
                          const ParallelFor &parallelFor);

/// dF/dt of every evaluation point from the velocities (not completed: the flat directions are zero).
void gradientRates(const StencilSet &stencils, std::span<const Vec3> velocities, std::span<Mat3> rates,
                   const ParallelFor &parallelFor);

/// v_q P_q, J: first Piola-Kirchhoff stress times the rest volume of the point.
///
/// @param rates        [points] dF/dt, or empty: no viscous part (S_v = 2 eta dE/dt)
/// @param stresses     [points] out: v P, Pa m³
/// @return the largest tangentRatio() of all points: how much stiffer than at rest the body is now
double stresses(const Material &material, const StencilSet &stencils, std::span<const Mat3> gradients,
                std::span<const Mat3> rates, std::span<Mat3> stresses, std::span<double> tangentRatios,
                const ParallelFor &parallelFor);

/// f_j = -Σ_q (v_q P_q g_qj + dU_q/dx_j), N: the negative gradient of elastic and stabilisation energy.
///
/// For an isotropic law the completion of flat stencils adds nothing to the elastic part: S is block-diagonal in the
/// frame and the added column only turns. Its part in r_qk is carried along exactly.
///
/// @param positions     [phyxels] X, m
/// @param entryForces   [entries] scratch
/// @param forces        [phyxels] out, N; overwritten
/// @threads no allocation; summed in the order of the entries, so the same bits for any number of threads
void internalForces(const Material &material, double stabilisation, const StencilSet &stencils,
                    std::span<const Vec3> positions, std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                    std::span<const Mat3> stresses, std::span<Vec3> entryForces, std::span<Vec3> forces,
                    const ParallelFor &parallelFor);

struct ElasticEnergy {
  double strain = 0.0;         ///< Σ v_q W(F_q), J
  double stabilisation = 0.0;  ///< Σ U_q, J
};
[[nodiscard]] ElasticEnergy elasticEnergy(const Material &material, double stabilisation, const StencilSet &stencils,
                                          std::span<const Vec3> positions, std::span<const Vec3> displacements,
                                          std::span<const Mat3> gradients);

/// Largest angular frequency of the body at rest, rad/s, by power iteration on the linearised forces over the masses.
/// An estimate from below; the stable step takes a margin.
[[nodiscard]] double largestFrequency(const Material &material, double stabilisation, const StencilSet &stencils,
                                      std::span<const Vec3> positions, std::span<const double> masses,
                                      const ParallelFor &parallelFor);

}  // namespace pointbased
