// SPDX-License-Identifier: Apache-2.0
// Bodies of a requested size without files, and operations on them.
#pragma once

#include <memory>
#include <string>

#include "bench/command_line.h"
#include "bench/timing.h"
#include "c3de/core/thread_pool.h"
#include "pointbased/simulator.h"

namespace bench {

inline constexpr double kSpacing = 0.01;  ///< m, of the balls below
inline constexpr pointbased::NeighborChoice kNeighbours{26, 1.8};

[[nodiscard]] pointbased::ParallelFor parallelForOf(c3de::ThreadPool &pool);

/// The points of a cubic lattice nearest to a centre: a ball of exactly `count` phyxels.
[[nodiscard]] pointbased::PhyxelCloud ballCloud(std::size_t count);
/// m, of the ball with the volume of that many cells.
[[nodiscard]] double ballRadius(std::size_t count);
/// Points spread evenly over a sphere about the origin.
[[nodiscard]] std::vector<pointbased::Vec3> sphere(std::size_t count, double radius);

/// Evaluated at the phyxels; `surfels` on the sphere around the ball.
[[nodiscard]] std::shared_ptr<const pointbased::RestState> cloudBall(std::size_t phyxels, std::size_t surfels,
                                                                     const pointbased::ParallelFor &parallelFor);
/// A ball filled with lattice cells so that it has about that many phyxels, with surfels as above.
[[nodiscard]] std::shared_ptr<const pointbased::RestState> latticeBall(std::size_t phyxels, std::size_t surfels,
                                                                       const pointbased::ParallelFor &parallelFor);

/// Neo-Hookean liver (E = 6 kPa, nu = 0.45) with the stabilisation that fits the evaluation.
[[nodiscard]] pointbased::Constitution constitutionFor(
    const pointbased::RestState &rest, pointbased::MaterialLaw law = pointbased::MaterialLaw::neoHookean);
/// "stress points" or "phyxels", with ", float" for kernels in single precision.
[[nodiscard]] std::string evaluationName(const pointbased::Body &body);
/// Stretched, compressed and bent by a few percent, differently everywhere.
void deform(pointbased::Body &body);

/// A simulator with one body.
struct World {
  World(std::unique_ptr<pointbased::Body> body, const pointbased::WorldSettings &settings,
        const pointbased::ParallelFor &parallelFor = pointbased::serialFor());

  [[nodiscard]] pointbased::Body &body() { return *simulator.body(id); }
  void step() { valueOf(simulator.step()); }
  /// Steps a quasi-static solution to its end. Throws with the reason where there is none.
  void solve();

  pointbased::Simulator simulator;
  std::size_t id = 0;
};

/// A deformed ball that falls; its step is half of the stable one at rest, so it is one substep.
[[nodiscard]] std::unique_ptr<World> fallingBall(
    const std::shared_ptr<const pointbased::RestState> &rest,
    pointbased::Precision precision = pointbased::Precision::doublePrecision,
    const pointbased::ParallelFor &parallelFor = pointbased::serialFor());

/// Neo-Hookean, with the stabilisation of lattices.
[[nodiscard]] pointbased::Constitution elastic(double youngsModulus, double poissonRatio, double density = 1060.0);

/// A fixed or moved region.
[[nodiscard]] pointbased::Fix heldIn(const pointbased::Region &region,
                                     const pointbased::Vec3 &displacement = pointbased::Vec3::Zero());

/// Closed surfaces by formulas, m: box, beam, liver, kidney, tube. Throws where there is no body of that name.
[[nodiscard]] pointbased::Surface surfaceNamed(const std::string &name, int rings = 24, int around = 40);

/// The update of positions and normals of the surfels as for the screen, in single precision.
[[nodiscard]] Timing measureSurfelUpdate(double seconds, const pointbased::Body &body,
                                         const pointbased::ParallelFor &parallelFor);

/// One evaluation of the internal forces at the current displacements: the only function in which a benchmark requests
/// it.
void evaluateForces(pointbased::Body &body, const pointbased::ParallelFor &parallelFor);

}  // namespace bench
