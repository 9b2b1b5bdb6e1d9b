// SPDX-License-Identifier: Apache-2.0
// Operations and bytes of one force evaluation on a lattice, counted from the kernels' formulas
// (plugins/pointbased/core/ src/kernels); recount when they change. A multiply-add is two operations, an addition,
// multiplication, division and square root one; signs, comparisons, maxima and shuffles are none.
#pragma once

#include <cstddef>

namespace counts {

// Per cell, neo-Hookean law with the energy of the modes.
inline constexpr double kSignSums = 3 * 23;  // three components; 8 + 8 + 7 sums of the corners
inline constexpr double kFit = 9 * 7;        // G: one product, three multiply-adds
inline constexpr double kStrain = 30 + 15    // GᵀG: six times 5; E: 3 multiply-adds, 3 times two sums and a product
                                  + 27 + 9   // cof G: nine times 3; minors
                                  + 2 + 9;   // tr G; J - 1: tr cof G, G·cof G, two sums
// mean, diagonal, its squares, across, scatter, width, bound
inline constexpr double kStretch = 3 + 6 + 5 + 5 + 2 + 2 + 2;
inline constexpr double kLogarithm = 25;  // log(1 + x) of Highway: about 8 multiply-adds, a division, sums
inline constexpr double kLaw = 1 + kLogarithm + 1 + 1 + 5    // J, ln J, 1/J, λ ln J, push
                               + 4 + 12                      // cof F, F - cof F
                               + 9 + 18                      // P
                               + 1 + 5;                      // g', g''
inline constexpr double kTangentBound = 17                   // |cof F|²
                                        + 30 + 9 + kStretch  // largest eigenvalue of cofᵀcof
                                        + 5                  // size
                                        + 2 + 13 + 2 + 1     // wave, along, across, their sum
                                        + 2;                 // ratios to rest
inline constexpr double kScale = 9;                          // v P
inline constexpr double kModes = 9                           // A
                                 + 54                        // B = A + GᵀA
                                 + 6 + 3 + 12 + 6 + 3 + 21   // dU/dB: shears, common, s, p, squares, entries
                                 + 54 + 54                   // S += A Dᵀ, D + G D
                                 + 1 + 3 + 9;                // twist, products with the k
inline constexpr double kUnfit = 3 * (3 + 3 * 4 + 6);        // three components: x y z; xy xz yz; xyz
inline constexpr double kSpreadSigns = 3 * 22;               // 6 + 8 + 8 sums
inline constexpr double kCornerSums = 8 * 4;                 // a corner's force and stiffness are added to its phyxel
/// In the kernel of cells.
inline constexpr double kCellOperations = kSignSums + kFit + kStrain + kStretch + kLaw + kTangentBound + kScale +
                                          kModes + kUnfit + kSpreadSigns + kCornerSums;
/// Besides the kernel, per phyxel of a chunk: its contribution is added to the force.
inline constexpr double kCollectOperations = 3;

/// Minimal memory traffic in bytes: each datum is transferred once, regardless of the caches. Per cell: 8 corners; the
/// numbers of a cell are counted with their arrays, since whole cells share theirs.
inline constexpr double kCellBytes = 8 * 2;
/// Per phyxel of a chunk: its index, four numbers out (zeroed first, in the first-level cache).
constexpr double localBytes(std::size_t number) { return 4 + 4 * static_cast<double>(number); }
/// Per phyxel: u.
inline constexpr double kFieldBytes = 24;
/// Besides the kernel: per phyxel of a chunk its index and four numbers in, per phyxel a row's offset and the force
/// out.
constexpr double collectBytes(std::size_t number) { return 4 + 4 * static_cast<double>(number); }
inline constexpr double kForceBytes = 4 + 24;

}  // namespace counts
