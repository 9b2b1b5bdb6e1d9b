// SPDX-License-Identifier: Apache-2.0
// Bodies of a requested size without files, and operations on them.
#pragma once

#include <memory>
#include <string>

#include "c3de/core/thread_pool.h"
#include "pointbased/body.h"

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

/// One evaluation of the internal forces at the current displacements: the only function in which a benchmark requests
/// it.
void evaluateForces(pointbased::Body &body, const pointbased::ParallelFor &parallelFor);

}  // namespace bench
