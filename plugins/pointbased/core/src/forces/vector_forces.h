// SPDX-License-Identifier: Apache-2.0
// The forces of a body by vector kernels. Private to the core.
#pragma once

#include <memory>

#include "pointbased/constitution.h"
#include "pointbased/engine.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// What the points of a body remember, and the step over which an evaluation takes it further.
struct HistoryStep {
  PointHistory &history;
  double dt;  ///< s; 0: nothing relaxes or flows, as after a jump
};

/// One evaluation of all internal forces of a body, fused: fit, law, control of the modes and the way back to the
/// phyxels in one pass over cells, then one over phyxels. Points that no kernel takes (see cell_layout.h) are answered
/// by the scalar engine within the same evaluation.
///
/// The same bits for any number of threads. On instruction sets with a fused multiply-add also the same bits
/// everywhere; SSE4 and older ones round twice, and so differ in the last digits.
class VectorForces {
 public:
  virtual ~VectorForces() = default;
  /// @param displacements  [phyxels] u, m
  /// @param velocities     [phyxels] m/s, or empty: without viscous stress
  /// @param step           points flow and relax by it, as plasticFlow(), pointStresses() and relaxModes() do
  /// @param forces         [phyxels] out: N
  /// @return how much the square of the largest frequency may have grown against rest, >= 1; NaN if anything is.
  ///         Lattices: largest Σ_q τ_q v_q (λ + 2 μ) |g_qj|² / m_j of the phyxels over that at rest, τ_q the
  ///         tangentRatio() (and stretch of modes) of a cell; clouds: largest τ_q
  /// @threads writes only `forces`, the history and its own scratch; no allocation, no lock
  virtual double evaluate(std::span<const Vec3> displacements, std::span<const Vec3> velocities,
                          const HistoryStep &step, std::span<Vec3> forces, const ParallelFor &parallelFor) = 0;
  /// The energies of the same, J; of clouds by the scalar engine.
  [[nodiscard]] virtual ElasticEnergy energy(std::span<const Vec3> displacements, const PointHistory &history,
                                             const ParallelFor &parallelFor) = 0;
  /// Keeps the tangent at these displacements for differential(). Both know no history.
  virtual void linearise(std::span<const Vec3> displacements, const ParallelFor &parallelFor) = 0;
  /// df = -K du, as forceDifferential(), with the viscous forces of velocities viscousScale du.
  virtual void differential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                            const ParallelFor &parallelFor) = 0;
  /// From gradients of cells to those of the materials of their points, where these differ (laminate.h).
  /// @param gradients  [points] F
  virtual void toMaterials(std::span<Mat3> gradients) const { (void)gradients; }
  /// Gives back the memory of linearise().
  virtual void dropTangent() = 0;
};

/// Null where no kernel would take at least half of the points: renewed references, clouds that flow or relax.
/// @param masses       [phyxels] kg; has to live as long
/// @param parallelFor  of the building alone
[[nodiscard]] std::unique_ptr<VectorForces> vectorForces(const StencilSet &stencils, std::span<const Vec3> positions,
                                                         std::span<const double> masses,
                                                         const Constitution &constitution, Precision precision,
                                                         const ParallelFor &parallelFor);

}  // namespace pointbased::detail
