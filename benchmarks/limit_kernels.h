// SPDX-License-Identifier: Apache-2.0
// What this core can do at best, by the vector instructions that the program picks when it runs.
#pragma once

#include <cstddef>

namespace limits {

/// Of the instruction set that is used: "AVX3", "AVX2", …
[[nodiscard]] const char *target();

/// Chains of fused multiply-adds that do not wait for each other, in registers alone.
/// @return floating-point operations done, a multiply-add counted as two
double multiplyAdds(float seed, std::size_t rounds, float &out);
double multiplyAdds(double seed, std::size_t rounds, double &out);

/// a = b + s c. Aligned to 64 bytes, n a multiple of 16: 24 bytes per element, without what a store reads first.
void triad(double *a, const double *b, const double *c, double s, std::size_t n);

}  // namespace limits
