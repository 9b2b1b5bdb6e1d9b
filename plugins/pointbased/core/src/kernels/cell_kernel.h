// SPDX-License-Identifier: Apache-2.0
// Elastic and modal forces of lattice cells, several cells at a time. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Forces of the slices [begin, end) on their corners.
///
/// F by Hadamard's transform of the corners, the law and its bound of the tangent, the energy of the modes, and the transposed
/// transform back to the corners, all in registers. Lanes do not meet: the same bits with any number of threads, and on all
/// instruction sets that have a fused multiply-add.
/// @threads any, disjoint ranges; no allocation
void cellForces(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cellForces(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Of the instruction set that is used now: "AVX3", "AVX2", …
[[nodiscard]] const char *kernelTarget();

}  // namespace pointbased::kernels
