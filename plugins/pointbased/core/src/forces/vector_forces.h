// SPDX-License-Identifier: Apache-2.0
// Forces of a body by vector kernels. Private to the core.
#pragma once

#include <memory>

#include "pointbased/constitution.h"
#include "pointbased/engine.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// History of the points of a body, and the step by which an evaluation advances it.
struct HistoryStep {
  PointHistory &history;
  double dt;  ///< s; 0: nothing relaxes or flows, as after a jump
};

/// One fused evaluation of all internal forces of a body: fit, law, control of the modes and distribution to the
/// phyxels in one pass over cells, then one over phyxels. Points that no kernel handles (see cell_layout.h) are
/// computed by the scalar engine within the same evaluation.
///
/// The same bits for any number of threads. On instruction sets with a fused multiply-add also the same bits
/// everywhere; older ones round twice and differ in the last digits.
class VectorForces {
 public:
  virtual ~VectorForces() = default;
  /// @param displacements  [phyxels] u, m
  /// @param velocities  [phyxels] m/s, or empty: without viscous stress
  /// @param step  points flow and relax by it, as plasticFlow(), pointStresses() and relaxModes() do
  /// @param forces  [phyxels] out: N
  /// @return bound of the growth of the squared largest frequency relative to rest, >= 1; NaN if anything is NaN.
  ///         Lattices: largest Σ_q τ_q v_q (λ + 2 μ) |g_qj|² / m_j of the phyxels over that at rest, τ_q the
  ///         tangentRatio() (and stretch of modes) of a cell; clouds: largest τ_q
  /// @threads  writes only `forces`, the history and its own scratch; no allocation, no lock
  virtual double evaluate(std::span<const Vec3> displacements, std::span<const Vec3> velocities,
                          const HistoryStep &step, std::span<Vec3> forces, const ParallelFor &parallelFor) = 0;
  /// Energies of the same, J; for clouds by the scalar engine.
  [[nodiscard]] virtual ElasticEnergy energy(std::span<const Vec3> displacements, const PointHistory &history,
                                             const ParallelFor &parallelFor) = 0;
  /// Stores the tangent at these displacements for differential(). Both ignore history.
  virtual void linearise(std::span<const Vec3> displacements, const ParallelFor &parallelFor) = 0;
  /// df = -K du, as forceDifferential(), with the viscous forces of velocities viscousScale du.
  virtual void differential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                            const ParallelFor &parallelFor) = 0;
  /// Converts gradients of cells to those of the materials of their points, where these differ (laminate.h).
  /// @param gradients  [points] F
  virtual void toMaterials(std::span<Mat3> gradients) const { (void)gradients; }
  /// Frees the memory of linearise().
  virtual void dropTangent() = 0;
};

/// Null if no kernel handles at least half of the points: renewed references, clouds that flow or relax.
/// @param masses  [phyxels] kg; must outlive the object
/// @param parallelFor  used for building only
[[nodiscard]] std::unique_ptr<VectorForces> vectorForces(const StencilSet &stencils, std::span<const Vec3> positions,
                                                         std::span<const double> masses,
                                                         const Constitution &constitution, Precision precision,
                                                         const ParallelFor &parallelFor);

}  // namespace pointbased::detail
