// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pointbased/types.h"

namespace pointbased::lattice {

/// Records errors of the first and second moments of lumped volumes, and corrects them. One thread at a time.
class MomentErrors {
 public:
  /// @param positions   of the phyxels, lattice axes, m; must outlive this object
  /// @param components  [phyxels] connected part of the body; the volume of each is preserved
  MomentErrors(std::span<const Vec3> positions, std::vector<Index> components);

  /// Records that a phyxel has `volume` too much (m³; negative: too little). The moments are taken about the phyxel
  /// `about`. The volumes recorded for one error sum to zero.
  void add(Index about, Index phyxel, double volume);

  /// Reduces the recorded errors by changes of the volumes. The volume of each component does not change, and no volume
  /// decreases by more than is available. In overlapping patches, whose nodes are about `spacing` apart, the available
  /// decrease of each phyxel is multiplied by a polynomial of second degree. Patches whose second moments are accurate
  /// to kTolerated are not changed; if none is, nothing changes. An error remains where the phyxels do not determine
  /// the polynomial, or where the available decrease is too small. Throws Stopped.
  /// @param volumes    [phyxels] m³, in and out
  /// @param available  [phyxels] m³, ≥ 0: largest decrease
  /// @param spacing    m
  /// @param parallelFor  used to check for cancellation only
  void correct(std::vector<double> &volumes, std::vector<double> available, double spacing,
               const ParallelFor &parallelFor) const;
  static constexpr double kTolerated = 0.02;

 private:
  struct Moments {
    Vec3 first = Vec3::Zero();   // m⁴, about the phyxel
    Mat3 second = Mat3::Zero();  // m⁵
  };
  std::span<const Vec3> positions_;
  std::vector<Index> components_;
  std::vector<Index> record_;  // [phyxels] into errors_, or kNone
  std::vector<Moments> errors_;
};

}  // namespace pointbased::lattice
