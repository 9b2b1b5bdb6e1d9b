// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// Material points that are moved by phyxels: surfels, probes, points of force application or contact. Const once
/// bound.
///
///     x_p = Σ_j φ_pj x_j,   F_p = Σ_j x_j ∇φ_pj^T,   Σ φ = 1,  Σ X φ = X_p,  Σ ∇φ = 0,  Σ X ∇φ^T = I
///
/// so affine motions are reproduced exactly. A force f on the point acts on the phyxels as φ_pj f, with the same work,
/// force and torque. On a lattice φ are the trilinear functions of the cell; in a cloud they are a moving-least-squares
/// fit to the nearest phyxels. Where these are coplanar, collinear or isolated, φ fits the available directions and the
/// remainder rotates with the completed F (see engine.h); `offsets` is then the part outside of the fit, and a force
/// acts as if it were applied at Σ φ x.
struct Interpolation {
  std::vector<Vec3> positions;     ///< X, m, in the frame of the phyxels
  Csr phyxels;                     ///< per point
  std::vector<double> weights;     ///< per entry: φ
  std::vector<Vec3> gradients;     ///< per entry: ∇φ, 1/m
  std::vector<std::uint8_t> rank;  ///< per point; empty: all 3
  std::vector<Mat3> frames;        ///< per point of rank < 3, by frameOf; columns as in StencilSet
  std::vector<Index> frameOf;      ///< per point, or empty
  std::vector<Vec3> offsets;       ///< per point of rank < 3, by frameOf: X_p - Σ φ X, m

  [[nodiscard]] std::size_t count() const { return positions.size(); }
};

/// Number of phyxels to which a point of a cloud is bound. A point farther from their plane than they are wide uses up
/// to eight times as many, until they span space.
inline constexpr std::size_t kPhyxelsPerPoint = 16;

/// Moving-least-squares binding to the nearest phyxels, for any position of the point: one outside of every support
/// follows the affine motion of the nearest ones.
///
///     ∇φ_j = w_j A^+ (X_j - X̄),   φ_j = w_j + ∇φ_j · (X_p - X̄),   A = Σ w (X - X̄)(X - X̄)^T,   X̄ = Σ w X,   Σ w = 1
///
/// A^+ is truncated at kMomentCutOff; the support ends kSupportMargin beyond the farthest of the phyxels.
[[nodiscard]] Interpolation bindToCloud(std::span<const Vec3> points, std::span<const Vec3> phyxelPositions,
                                        const ParallelFor &parallelFor);

/// x_p - X_p of every point, m.
/// @param displacements  [phyxels] u, m
/// @param out            [points]
/// @threads writes only out
void interpolateDisplacements(const Interpolation &binding, std::span<const Vec3> phyxelPositions,
                              std::span<const Vec3> displacements, std::span<Vec3> out, const ParallelFor &parallelFor);

/// Σ φ a of any field of the phyxels (velocities); exact for rank 3, otherwise without the rotating part.
void interpolateField(const Interpolation &binding, std::span<const Vec3> field, std::span<Vec3> out,
                      const ParallelFor &parallelFor);

/// F of every point.
void interpolateGradients(const Interpolation &binding, std::span<const Vec3> displacements, std::span<Mat3> out,
                          const ParallelFor &parallelFor);

/// Adds φ_pj f_p to the phyxels, in the order of the points. Serial, bitwise reproducible.
void spreadForces(const Interpolation &binding, std::span<const Vec3> pointForces, std::span<Vec3> forces);

/// Points and normals of the skin: x_p, and n_p = cof(F_p) N_p normalised.
/// @param restNormals  [points] N, unit; empty with normals empty
/// @source  Müller et al. 2004, animation of the surface; normals by Nanson's formula
void updateSurfels(const Interpolation &binding, std::span<const Vec3> restNormals,
                   std::span<const Vec3> phyxelPositions, std::span<const Vec3> displacements,
                   std::span<Vec3> positions, std::span<Vec3> normals, const ParallelFor &parallelFor);

}  // namespace pointbased
