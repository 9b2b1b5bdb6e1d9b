// SPDX-License-Identifier: Apache-2.0
// Evaluation of an interpolation at one point, for the loops over all points. Private to the core.
#pragma once

#include "discretisation/rank_deficient_gradient.h"
#include "pointbased/interpolation.h"

namespace pointbased::detail {

inline int rankOf(const Interpolation &binding, std::size_t p) { return binding.rank.empty() ? 3 : binding.rank[p]; }

/// Σ φ a, relative to the first phyxel: a uniform field is reproduced to the last bit.
inline Vec3 fieldAt(const Interpolation &binding, std::size_t p, std::span<const Vec3> field) {
  const Index first = binding.phyxels.offsets[p], last = binding.phyxels.offsets[p + 1];
  if (first == last) return Vec3::Zero();
  const Vec3 anchor = field[binding.phyxels.indices[first]];
  Vec3 sum = Vec3::Zero();
  for (Index e = first + 1; e < last; ++e) sum += binding.weights[e] * (field[binding.phyxels.indices[e]] - anchor);
  return anchor + sum;
}

/// F, completed where the phyxels do not span space.
inline Mat3 gradientAt(const Interpolation &binding, std::size_t p, std::span<const Vec3> displacements) {
  const Index first = binding.phyxels.offsets[p], last = binding.phyxels.offsets[p + 1];
  Mat3 F = Mat3::Identity();
  if (first == last) return F;
  const Vec3 anchor = displacements[binding.phyxels.indices[first]];
  for (Index e = first + 1; e < last; ++e) {
    const Vec3 d = displacements[binding.phyxels.indices[e]] - anchor;
    const Vec3 &g = binding.gradients[e];
    F.col(0) += g[0] * d;
    F.col(1) += g[1] * d;
    F.col(2) += g[2] * d;
  }
  const int rank = rankOf(binding, p);
  return rank < 3 ? completed(F, rank, binding.frames[binding.frameOf[p]]) : F;
}

/// x_p - X_p; F from gradientAt(), used for rank < 3 only.
inline Vec3 displacementAt(const Interpolation &binding, std::size_t p, std::span<const Vec3> displacements,
                           const Mat3 &F) {
  Vec3 u = fieldAt(binding, p, displacements);
  if (rankOf(binding, p) < 3) {
    const Vec3 &offset = binding.offsets[binding.frameOf[p]];
    u += F * offset - offset;
  }
  return u;
}

/// Adds φ f to the phyxels.
inline void spreadForce(const Interpolation &binding, std::size_t p, const Vec3 &force, std::span<Vec3> forces) {
  for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
    forces[binding.phyxels.indices[e]] += binding.weights[e] * force;
}

}  // namespace pointbased::detail
