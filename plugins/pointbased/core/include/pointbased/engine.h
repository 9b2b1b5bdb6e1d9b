// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "pointbased/constitution.h"
#include "pointbased/material.h"
#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// Factor of the hourglass energies of lattices (see hourglassEnergy in the theory page): 1 would be the energy of an
/// assumed linear strain in plane stress within each cell; with 0.92 a cantilever of 3 and 5 layers is exact to 0.2 %.
inline constexpr double kLatticeStabilisation = 0.92;
/// Isotropic control for clouds: U_q = 1/2 alpha E v_q Σ_k w_qk |r_qk|².
inline constexpr double kCloudStabilisation = 0.1;

/// Deformation gradient of every evaluation point.
///
/// F_q = I + Σ_k (u_k - u_anchor) g_qk^T. Where the stencil is flat, F is completed such that a rotation stays a
/// rotation: coplanar F n = F t1 x F t2 normalised, collinear by the shortest rotation, isolated F = I.
///
/// @param displacements  [phyxels] u, m
/// @param gradients      [points] out: F; row = component of x, column = component of X
/// @threads writes only `gradients`; no allocation
/// @source  Müller et al. 2004, the moving-least-squares fit, for the displacement vector at once
void deformationGradients(const StencilSet &stencils, std::span<const Vec3> displacements, std::span<Mat3> gradients,
                          const ParallelFor &parallelFor);

/// dF/dt of every evaluation point from the velocities (not completed: zero in the flat directions).
void gradientRates(const StencilSet &stencils, std::span<const Vec3> velocities, std::span<Mat3> rates,
                   const ParallelFor &parallelFor);

/// vP of every point, including history: elastic law on F F_p^-1, Prony terms advanced by dt, viscous part.
///
/// @param rates    [points] dF/dt, or empty: no viscous part (S_v = 2 eta dE/dt)
/// @param before   history at the beginning of the step; empty vectors: elastic
/// @param after    [points] null, or receives the Prony terms at the end of the step (may be `before` itself)
/// @param out      [points] v P, Pa m³
/// @param ratios   [points] tangentRatio()
/// @return  the largest ratio; NaN if any is
double pointStresses(const Constitution &constitution, const StencilSet &stencils, std::span<const Mat3> gradients,
                     std::span<const Mat3> rates, const PointHistory &before, double dt, PointHistory *after,
                     std::span<Mat3> out, std::span<double> ratios, const ParallelFor &parallelFor);

/// Plastic flow of every point over dt.
/// @return  number of points that flowed
std::size_t plasticFlow(const Constitution &constitution, const StencilSet &stencils, std::span<const Mat3> gradients,
                        double dt, PointHistory &history, const ParallelFor &parallelFor);

/// Relaxation of the modes of lattice cells at the end of a step, corresponding to pointStresses() for the stress of
/// the points. The strain dev e of a mode follows linear viscoelasticity of the shear modulus in plane stress, with the
/// recursion of pronyStress(): dβ_k/dt = (g_k dev e - β_k)/τ_k. Volume changes do not relax.
///
/// @param gradients  [points] F at `displacements`
/// @param before     with `modes` of all points
/// @param after      null, or receives the memory at the end of the step (may be `before` itself)
/// @param relaxed    [points] out: Σ_k β_k at the end of the step, for internalForces()
void relaxModes(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> displacements,
                std::span<const Mat3> gradients, const PointHistory &before, double dt, PointHistory *after,
                std::span<HourglassStrain> relaxed, const ParallelFor &parallelFor);

/// f_j = -Σ_q (v_q P_q g_qj + dU_q/dx_j), N: the negative gradient of elastic and stabilisation energy.
/// @param relaxed  [points] from relaxModes(): relaxed part of the hourglass strain, which exerts no force; empty:
///                 nothing has relaxed
void internalForces(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                    std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                    std::span<const Mat3> stresses, std::span<Vec3> entryForces, std::span<Vec3> forces,
                    const ParallelFor &parallelFor, std::span<const HourglassStrain> relaxed = {});

/// Scratch storage of forceDifferential(), so that repeated calls do not allocate.
struct TangentScratch {
  std::vector<Vec3> entries;
};

/// df = -K du at the present displacements: the exact directional derivative of internalForces (of its elastic, plastic
/// and Prony part at fixed history), for du of any size.
/// @param viscousScale  1/s: adds the viscous forces of velocities viscousScale · du (backward Euler 1/dt, midpoint
///                      2/dt); 0: none
/// @param dt            s, of the Prony terms; 0 if there are none
void forceDifferential(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                       std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                       const PointHistory &history, double dt, double viscousScale, std::span<const Vec3> du,
                       TangentScratch &scratch, std::span<Vec3> df, const ParallelFor &parallelFor);

/// The 3x3 diagonal blocks of K (of the same forces), made positive definite where necessary.
void stiffnessBlocks(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                     std::span<const Vec3> displacements, std::span<const Mat3> gradients, const PointHistory &history,
                     double dt, double viscousScale, std::span<Mat3> blocks, const ParallelFor &parallelFor);

/// All of K as triplets (row, column in 0 … 3n-1). The tangent of each point is made positive semi-definite first, so
/// that a factorisation of the sum is a usable preconditioner at any deformation.
void stiffnessTriplets(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                       std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                       const PointHistory &history, double dt, double viscousScale,
                       std::vector<Eigen::Triplet<double>> &out);

struct ElasticEnergy {
  double strain = 0.0;         ///< Σ v_q W(F_q F_p^-1), J
  double stabilisation = 0.0;  ///< Σ U_q, J
};
/// @param perPoint  empty, or [points] out: (strain, stabilisation) of each, J
[[nodiscard]] ElasticEnergy elasticEnergy(const Constitution &constitution, const StencilSet &stencils,
                                          std::span<const Vec3> positions, std::span<const Vec3> displacements,
                                          std::span<const Mat3> gradients, const PointHistory &history,
                                          std::span<Eigen::Vector2d> perPoint = {});

/// Largest angular frequency at rest, rad/s, by Lanczos's method on the exact tangent over the masses. `extra` adds a
/// diagonal stiffness (held patches), N/m, or is empty. The estimate is from below, by less than 1e-3; the margin of
/// the stable step covers this.
[[nodiscard]] double largestFrequency(const Constitution &constitution, const StencilSet &stencils,
                                      std::span<const Vec3> positions, std::span<const double> masses,
                                      std::span<const double> extra, const ParallelFor &parallelFor);

/// Instruction set of the active vector kernels: "AVX3" (AVX-512), "AVX2", "SSE2", "NEON", …
[[nodiscard]] std::string kernelTarget();

}  // namespace pointbased
