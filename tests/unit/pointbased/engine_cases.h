// SPDX-License-Identifier: Apache-2.0
// Hand-made stencils of all kinds, for tests of the engine without bodies.
#pragma once

#include <string>

#include "pointbased/engine.h"
#include "shapes.h"

namespace engine_cases {

using namespace pointbased;

/// Stencils with all other data that the engine needs.
struct EngineCase {
  std::string name;
  StencilSet stencils;
  std::vector<Vec3> positions;
  std::vector<double> masses;
  double spacing = 0.0;
  double stabilisation = 0.0;

  [[nodiscard]] std::size_t phyxels() const { return positions.size(); }
  [[nodiscard]] bool full() const;  ///< no flat stencil
};

/// nx x ny x nz cells in rotated axes; cells of the border contain a random box of the body, whose mean trilinear
/// gradients and mode rows are exact.
[[nodiscard]] EngineCase lattice(int nx, int ny, int nz, bool cut = true);
/// The same with corners moved at random and gradients disturbed within Σ g = 0, Σ X g^T = I.
[[nodiscard]] EngineCase jitteredLattice();
/// A box oblique to its lattice, with functions of second order (LatticeOrder::quadratic).
[[nodiscard]] EngineCase quadraticLattice();
[[nodiscard]] EngineCase cloud(std::string name, std::vector<Vec3> positions, double spacing);
/// Lattice, jittered lattice, lattice of second order, full cloud, sheet, line and pair.
[[nodiscard]] const std::vector<EngineCase> &all();

[[nodiscard]] Constitution constitution(const EngineCase &c, MaterialLaw law);
inline constexpr MaterialLaw kLaws[] = {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                        MaterialLaw::neoHookean};
[[nodiscard]] const char *nameOf(MaterialLaw law);

/// F, stresses and forces at displacements.
struct Evaluated {
  std::vector<Mat3> gradients, stresses;
  std::vector<double> ratios;
  std::vector<Vec3> forces;
  double ratio = 1.0;
};
[[nodiscard]] Evaluated evaluate(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                                 const PointHistory &history = {}, double dt = 0.0,
                                 std::span<const Vec3> velocities = {}, const ParallelFor &parallelFor = serialFor());
[[nodiscard]] ElasticEnergy energyAt(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                                     const PointHistory &history = {});
/// -K du at u.
[[nodiscard]] std::vector<Vec3> differential(const EngineCase &c, const Constitution &constitution,
                                             std::span<const Vec3> u, std::span<const Vec3> du,
                                             const PointHistory &history = {}, double dt = 0.0,
                                             double viscousScale = 0.0);

[[nodiscard]] std::vector<Vec3> displaced(const EngineCase &c, const Mat3 &A, const Vec3 &shift);
[[nodiscard]] std::vector<Vec3> noise(const EngineCase &c, double amplitude, std::uint64_t seed);
/// A rotated, stretched and perturbed state; the pair is not near its own collapse.
[[nodiscard]] std::vector<Vec3> generalState(const EngineCase &c);
[[nodiscard]] std::vector<Vec3> plus(std::span<const Vec3> a, double factor, std::span<const Vec3> b);
[[nodiscard]] double dot(std::span<const Vec3> a, std::span<const Vec3> b);
using shapes::largest;

}  // namespace engine_cases
