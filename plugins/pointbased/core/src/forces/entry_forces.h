// SPDX-License-Identifier: Apache-2.0
// Distributes stress and hourglass forces of a point to the phyxels of its stencil. Private to the core.
#pragma once

#include "forces/hourglass_energy.h"
#include "pointbased/engine.h"

namespace pointbased::detail {

/// First part of internalForces(), up to the forces of the entries, for the points of parallelFor.
/// @param velocities  for the viscosity of the modes; empty: none
void entryForcesOf(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                   std::span<const Vec3> displacements, std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                   std::span<const HourglassStrain> relaxed, std::span<const Vec3> velocities,
                   std::span<Vec3> entryForces, const ParallelFor &parallelFor);

/// internalForces() including the viscosity of the modes.
void internalForcesOf(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                      std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                      std::span<const Mat3> stresses, std::span<const HourglassStrain> relaxed,
                      std::span<const Vec3> velocities, std::span<Vec3> entryForces, std::span<Vec3> forces,
                      const ParallelFor &parallelFor);

/// First part of forceDifferential(), up to the entries.
void entryDifferentialsOf(const Constitution &constitution, const StencilSet &stencils, std::span<const Vec3> positions,
                          std::span<const Vec3> displacements, std::span<const Mat3> gradients,
                          const PointHistory &history, double dt, double viscousScale, std::span<const Vec3> du,
                          std::span<Vec3> entries, const ParallelFor &parallelFor);

/// elasticEnergy() of the points [begin, end).
[[nodiscard]] ElasticEnergy elasticEnergyOf(const Constitution &constitution, const StencilSet &stencils,
                                            std::span<const Vec3> positions, std::span<const Vec3> displacements,
                                            std::span<const Mat3> gradients, const PointHistory &history,
                                            std::span<Eigen::Vector2d> perPoint, std::size_t begin, std::size_t end);

/// Entry e gets -pull(e), the anchor the negative sum.
template <class Pull>
void spread(const StencilSet &s, std::size_t q, std::span<Vec3> entries, Pull &&pull) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  Vec3 sum = Vec3::Zero();
  for (Index e = first + 1; e < last; ++e) {
    const Vec3 f = pull(e);
    entries[e] = -f;
    sum += f;
  }
  entries[first] = sum;
}

/// Factors of g and γ of an entry, in columns padded for vector registers.
struct ModalConjugates {
  Eigen::Matrix<double, 4, 7> columns;

  ModalConjugates(const Mat3 &stress, const Mat3 &modes, const Vec3 &twist) {
    for (int c = 0; c < 3; ++c) {
      columns.col(c) = padded(stress.col(c));
      columns.col(3 + c) = padded(modes.col(c));
    }
    columns.col(6) = padded(twist);
  }
};

inline void spread(const ModalConjugates &conjugates, const StencilSet &s, std::size_t q, std::span<Vec3> entries) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const auto &C = conjugates.columns;
  const GradientRows gradients(s, q);
  const ModeRows modes(s, q);
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (Index e = first + 1; e < last; ++e) {
    const Vec3 &g = gradients[e];
    const Eigen::Vector4d &row = modes[e];
    Eigen::Vector4d f = C.col(0) * g[0] + C.col(1) * g[1] + C.col(2) * g[2];
    for (int m = 0; m < 4; ++m) f += C.col(3 + m) * row[m];
    entries[e] = -f.head<3>();
    sum += f;
  }
  entries[first] = sum.head<3>();
}

}  // namespace pointbased::detail
