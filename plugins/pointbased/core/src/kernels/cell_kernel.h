// SPDX-License-Identifier: Apache-2.0
// Elastic and modal forces of lattice cells, several cells at a time. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Where a lane has to be answered by the scalar law: collapsed or turned beyond what the kernel's formulas hold.
/// @param F       column after column, lattice axes
/// @param stress  out: P likewise, Pa
/// @return tangentRatio() of the law
using StrayLaw = double (*)(const void *context, std::size_t material, const double *F, double *stress);

/// Forces of the slices [begin, end) on their corners.
///
/// F by Hadamard's transform of the corners, the law and its bound of the tangent, the energy of the modes, and the transposed
/// transform back to the corners, all in registers. Lanes do not meet: the same bits with any number of threads, and on all
/// instruction sets that have a fused multiply-add.
/// @threads any, disjoint ranges; no allocation
void cellForces(const CellJob<float> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end);
void cellForces(const CellJob<double> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end);

/// Of the instruction set that is used now: "AVX3", "AVX2", …
[[nodiscard]] const char *kernelTarget();

}  // namespace pointbased::kernels
