// SPDX-License-Identifier: Apache-2.0
// Elastic and hourglass forces of lattice cells, vectorised over cells. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Forces of the chunks [begin, end) on their phyxels: job.partials.
///
/// F by a Hadamard transform of the corners, the law and the bound of its tangent, the energy of the modes, and the
/// transposed transform back to the corners, all in registers. Lanes are independent: the same bits with any number of
/// threads, and on all instruction sets that have a fused multiply-add.
/// @threads  any, disjoint ranges; no allocation
void cellForces(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cellForces(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Sums the forces of the phyxels [begin, end), after all chunks.
/// @return largest stiffness over mass, 1/s²; NaN if any is; 0 without masses
/// @threads  any, disjoint ranges
double collectForces(const CollectJob<float> &job, std::size_t begin, std::size_t end);
double collectForces(const CollectJob<double> &job, std::size_t begin, std::size_t end);

/// Name of the instruction set in use: "AVX3", "AVX2", …
[[nodiscard]] const char *kernelTarget();

}  // namespace pointbased::kernels
