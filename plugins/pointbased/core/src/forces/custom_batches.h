// SPDX-License-Identifier: Apache-2.0
// Custom laws over runs of points: many points per call, because a call costs as much as a point. Private to the core.
#pragma once

#include <algorithm>
#include <array>

#include "material/laws.h"

namespace pointbased::detail {

/// Points per call. Few enough that input and output stay in the first-level cache.
inline constexpr std::size_t kLawBatch = 64;

/// Calls body(first, count) for pieces of [from, to).
template <class Body>
void forBatches(std::size_t from, std::size_t to, Body &&body) {
  for (; from < to; from += kLawBatch) body(from, std::min(kLawBatch, to - from));
}

/// Energy densities of points that are requested one after the other.
class CustomEnergies {
 public:
  /// @param sameUntil  () -> points [q, sameUntil) are of this material
  template <class SameUntil>
  [[nodiscard]] double at(const Material &material, std::span<const Mat3> gradients, std::size_t q,
                          const SameUntil &sameUntil) {
    if (q < first_ || q >= last_) {
      first_ = q;
      last_ = std::min(q + kLawBatch, sameUntil());
      material.custom->energies(gradients.subspan(first_, last_ - first_), std::span(W_).first(last_ - first_));
    }
    return W_[q - first_] + VolumeTerm::energy(Moduli(material), gradients[q]);
  }

 private:
  std::size_t first_ = 0, last_ = 0;
  std::array<double, kLawBatch> W_{};
};

}  // namespace pointbased::detail
