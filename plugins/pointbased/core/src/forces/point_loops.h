// SPDX-License-Identifier: Apache-2.0
// Loops over evaluation points that select material and law outside of the loop. Private to the core.
#pragma once

#include "material/laws.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

inline constexpr std::size_t kPointGrain = 64;

/// parallelFor without the allocation of a std::function with large captures.
template <class Body>
void runLoop(const ParallelFor &parallelFor, std::size_t n, std::size_t grain, const Body &body) {
  parallelFor(n, grain, std::cref(body));
}

/// Calls body(material, begin, end) for every run of points of one material in [begin, end).
template <class Body>
void forMaterialRuns(const Constitution &constitution, const StencilSet &s, std::size_t begin, std::size_t end,
                     Body &&body) {
  if (s.materials.empty()) {
    body(constitution.materials.front(), begin, end);
    return;
  }
  while (begin < end) {
    std::size_t next = begin + 1;
    while (next < end && s.materials[next] == s.materials[begin]) ++next;
    body(constitution.materials[s.materials[begin]], begin, next);
    begin = next;
  }
}

inline const Material &materialOfPoint(const Constitution &constitution, const StencilSet &s, std::size_t q) {
  return constitution.materials[s.materials.empty() ? 0 : s.materials[q]];
}

/// Sums the entries of every phyxel, in the order of the entries.
template <class T>
void gather(const StencilSet &s, std::span<const T> entries, std::span<T> out, const ParallelFor &parallelFor) {
  runLoop(parallelFor, out.size(), 4 * kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      T sum = T::Zero();
      for (Index k = s.entriesOfPhyxel.offsets[j]; k < s.entriesOfPhyxel.offsets[j + 1]; ++k)
        sum += entries[s.entriesOfPhyxel.indices[k]];
      out[j] = sum;
    }
  });
}

/// Energy that controls the modes which one evaluation per point cannot detect.
enum class Stabilisation { none, hourglass, isotropic };

inline Stabilisation stabilisationOf(const Constitution &constitution, const StencilSet &s) {
  if (!(constitution.stabilisation > 0.0)) return Stabilisation::none;
  if (s.isLattice()) return Stabilisation::hourglass;
  return s.weights.empty() ? Stabilisation::none : Stabilisation::isotropic;
}

}  // namespace pointbased::detail
