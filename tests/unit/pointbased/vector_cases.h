// SPDX-License-Identifier: Apache-2.0
// Bodies and deformations for tests of the vector kernels.
#pragma once

#include "pointbased/lattice.h"
#include "shapes.h"

namespace vector_cases {

using namespace pointbased;

struct Case {
  const char *name;
  std::shared_ptr<const RestState> rest;
};

[[nodiscard]] std::shared_ptr<const RestState> latticeBody(const BodyShape &shape, LatticeSampling sampling);
/// Lattices: cut cells, rotated axes, two sizes of cells, two lobes, three sizes of cells.
[[nodiscard]] std::vector<Case> bodies();
/// Clouds: few and many neighbours, flat stencils.
[[nodiscard]] std::vector<Case> clouds();

/// Nearly incompressible, E = 6 kPa.
[[nodiscard]] Material materialOf(MaterialLaw law);
inline constexpr MaterialLaw kLaws[] = {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                        MaterialLaw::neoHookean};

/// A stretch, a rotation and some noise.
/// @param noise  spacings
void deform(Body &body, double size, double noise, std::uint64_t seed);

using shapes::largest;
/// Largest difference over the largest entry of `of`.
[[nodiscard]] double relativeDifference(std::span<const Vec3> of, std::span<const Vec3> other);

/// Runs loops backwards in pieces of seven.
[[nodiscard]] ParallelFor inPieces();

/// Runs kernels with other instruction sets during its lifetime.
class InstructionSets {
 public:
  InstructionSets();
  ~InstructionSets();
  /// Those of this machine with a fused multiply-add.
  [[nodiscard]] std::span<const std::int64_t> fused() const { return fused_; }
  void use(std::int64_t target) const;

 private:
  std::vector<std::int64_t> fused_;
};

}  // namespace vector_cases
