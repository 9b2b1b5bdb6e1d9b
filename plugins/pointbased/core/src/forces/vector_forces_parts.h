// SPDX-License-Identifier: Apache-2.0
// Shared by the vector forces of lattices and clouds. Private to the core.
#pragma once

#include <cmath>

#include "forces/entry_forces.h"
#include "forces/kernels/cell_layout.h"
#include "forces/point_loops.h"
#include "forces/vector_forces.h"
#include "pointbased/engine.h"

namespace pointbased::detail {

inline constexpr std::size_t kPhyxelGrain = 256;

[[nodiscard]] std::unique_ptr<VectorForces> cellForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                                         std::span<const double> masses,
                                                         const Constitution &constitution, Precision precision,
                                                         const ParallelFor &parallelFor);
[[nodiscard]] std::unique_ptr<VectorForces> cloudForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                                          const Constitution &constitution, Precision precision,
                                                          const ParallelFor &parallelFor);

/// Whether the kernels support the law; their neo-Hookean law is the one with the squared logarithm.
[[nodiscard]] inline bool kernelKnows(const Material &m) {
  return m.law != MaterialLaw::custom && (m.law != MaterialLaw::neoHookean || m.lambda() >= 0.0);
}

/// The laws of a constitution, which has to outlive the result.
[[nodiscard]] kernels::ScalarLaw scalarLaw(const Constitution &constitution);

template <class T>
[[nodiscard]] std::vector<kernels::LawNumbers<T>> lawsOf(const Constitution &constitution) {
  std::vector<kernels::LawNumbers<T>> laws;
  for (const Material &m : constitution.materials)
    laws.push_back(kernels::lawNumbers<T>(m, constitution.stabilisation));
  return laws;
}

/// The largest of all ratios and of `atLeast`; NaN if any is NaN.
template <class T>
[[nodiscard]] double largestRatio(std::span<const T> ratios, double atLeast) {
  for (const T r : ratios) {
    if (!(r <= atLeast)) atLeast = r;
    if (std::isnan(atLeast)) break;
  }
  return atLeast;
}

/// Points that no kernel handles, computed by the scalar engine.
class ScalarFallback {
 public:
  ScalarFallback(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution,
                 std::span<const Index> points);
  [[nodiscard]] bool empty() const { return runs_.empty(); }
  /// Entries of these points, in the order of force().
  [[nodiscard]] std::span<const Index> entries() const { return entries_; }
  /// @return largest ratio
  double evaluate(std::span<const Vec3> displacements, std::span<const Vec3> velocities, const HistoryStep &step,
                  const ParallelFor &parallelFor);
  void linearise(std::span<const Vec3> displacements, const ParallelFor &parallelFor);
  /// Changes of their forces, returned by force().
  void differential(std::span<const Vec3> du, double viscousScale, const ParallelFor &parallelFor);
  [[nodiscard]] ElasticEnergy energy(std::span<const Vec3> displacements, const PointHistory &history) const;
  [[nodiscard]] const Vec3 &force(std::size_t entry) const { return entryForces_[entries_[entry]]; }
  /// Ratio of a point at the last evaluate().
  [[nodiscard]] double ratio(std::size_t point) const { return ratios_[point]; }

 private:
  [[nodiscard]] ParallelFor loop(const ParallelFor &parallelFor) const;

  const StencilSet &stencils_;
  std::span<const Vec3> positions_;
  const Constitution &constitution_;
  std::vector<std::pair<Index, Index>> runs_;  // short ranges, for the loops of the scalar engine
  std::vector<Index> entries_;
  std::vector<Vec3> entryForces_;
  std::vector<Mat3> gradients_, rates_, stresses_;
  std::vector<HourglassStrain> relaxedModes_;
  std::vector<double> ratios_;
  std::vector<Vec3> linearisedAt_;  // [phyxels] m
};

}  // namespace pointbased::detail
