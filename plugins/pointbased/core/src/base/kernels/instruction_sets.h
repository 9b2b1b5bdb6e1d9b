// SPDX-License-Identifier: Apache-2.0
// The instruction sets that kernels are compiled for: AVX-512, AVX2, NEON and the baseline of the platform. Each of them
// adds a third to the compile time of a kernel. Include before <hwy/foreach_target.h>.
#pragma once

// SVE and RVV vectors have a length that is known only at run time and cannot be members. SSSE3 and SSE4 add nothing to
// the baseline that these kernels use; processors without AVX2 take the baseline.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
