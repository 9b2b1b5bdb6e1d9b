// SPDX-License-Identifier: Apache-2.0
// The peak performance of this core, with the vector instructions that the program selects at run time.
#pragma once

#include <cstddef>

namespace limits {

/// The instruction set in use: "AVX3", "AVX2", …
[[nodiscard]] const char *target();

/// Independent chains of fused multiply-adds, only in registers.
/// @return floating-point operations done, a multiply-add counted as two
double multiplyAdds(float seed, std::size_t rounds, float &out);
double multiplyAdds(double seed, std::size_t rounds, double &out);

/// a = b + s c. Aligned to 64 bytes, n a multiple of 16: 24 bytes per element, without the read that precedes a store.
void triad(double *a, const double *b, const double *c, double s, std::size_t n);

}  // namespace limits
