// SPDX-License-Identifier: Apache-2.0
// The instruction sets that kernels are compiled for, which is most of what they take to compile: AVX-512, AVX2, NEON,
// scalar code, and SSE4 unless the kernel defines C3DE_KERNEL_WITHOUT_SSE4. Before <hwy/foreach_target.h>.
#pragma once

// Vectors of a length that is known only at run time (SVE, RVV) cannot be members. No processor in use stops at SSSE3.
#define C3DE_TARGETS_LEFT_OUT (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#ifdef C3DE_KERNEL_WITHOUT_SSE4
#define HWY_DISABLED_TARGETS (C3DE_TARGETS_LEFT_OUT | HWY_SSE4)
#else
#define HWY_DISABLED_TARGETS C3DE_TARGETS_LEFT_OUT
#endif
