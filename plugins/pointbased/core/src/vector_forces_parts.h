// SPDX-License-Identifier: Apache-2.0
// What the vector forces of lattices and clouds share. Private to the core.
#pragma once

#include <cmath>

#include "entry_forces.h"
#include "kernels/cell_layout.h"
#include "point_loops.h"
#include "pointbased/engine.h"
#include "vector_forces.h"

namespace pointbased::detail {

inline constexpr std::size_t kPhyxelGrain = 256, kSliceGrain = 8;

[[nodiscard]] std::unique_ptr<VectorForces> cellForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                                         const Constitution &constitution, Precision precision);
[[nodiscard]] std::unique_ptr<VectorForces> cloudForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                                          const Constitution &constitution, Precision precision);

/// kernels::StrayLaw of a Constitution.
[[nodiscard]] double strayAnswer(const void *constitution, std::size_t material, const double *F, double *stress);

template <class T>
[[nodiscard]] std::size_t bytesOf(const T &vector) {
  return vector.capacity() * sizeof(vector[0]);
}

template <class T>
[[nodiscard]] std::vector<kernels::LawNumbers<T>> lawsOf(const Constitution &constitution) {
  std::vector<kernels::LawNumbers<T>> laws;
  for (const Material &m : constitution.materials) laws.push_back(kernels::lawNumbers<T>(m, constitution.stabilisation));
  return laws;
}

/// The largest of all and of `atLeast`; a NaN is not lost.
template <class T>
[[nodiscard]] double largestRatio(std::span<const T> ratios, double atLeast) {
  for (const T r : ratios) {
    if (!(r <= atLeast)) atLeast = r;
    if (std::isnan(atLeast)) break;
  }
  return atLeast;
}

/// Points that no kernel takes, answered by the scalar engine.
class OtherPoints {
 public:
  OtherPoints(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution,
              std::span<const Index> points);
  [[nodiscard]] bool empty() const { return runs_.empty(); }
  /// Their entries, in the order of forces().
  [[nodiscard]] std::span<const Index> entries() const { return entries_; }
  /// @return largest ratio
  double evaluate(std::span<const Vec3> displacements, const ParallelFor &parallelFor);
  [[nodiscard]] const Vec3 &force(std::size_t entry) const { return entryForces_[entries_[entry]]; }
  [[nodiscard]] std::size_t memory() const;

 private:
  const StencilSet &stencils_;
  std::span<const Vec3> positions_;
  const Constitution &constitution_;
  std::vector<std::pair<Index, Index>> runs_;  // short ones, for the loops of the scalar engine
  std::vector<Index> entries_;
  std::vector<Vec3> entryForces_;
  std::vector<Mat3> gradients_, stresses_;
  std::vector<double> ratios_;
};

}  // namespace pointbased::detail
