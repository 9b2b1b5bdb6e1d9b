// SPDX-License-Identifier: Apache-2.0
// Input of the kernels of cells whose functions are quadratic along edges. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Edges of a cell, numbered as in QuadraticPoints.
inline constexpr std::size_t kCellEdges = 12;
/// Corners, then edges.
inline constexpr std::size_t kCellNodes = kCorners + kCellEdges;
/// Phyxels of the row of an edge, at most.
inline constexpr std::size_t kOfEdge = 4;

/// Data of a cell besides CellNumber, in this order. Let b be the coefficients of the edges' functions and B = -4 b.
/// For the four edges along a, with i and j the axes after it and s the signs of their sides, B_0 = Σ B, B_i = Σ s_i B,
/// B_j = Σ s_j B, B_ij = Σ s_i s_j B. With h, <·> and the coefficients of CellNumber (f = first, m = mixed):
///
///     G_a += f_a B_0 + m_j B_i + m_i B_j + T B_ij                 T = 2<abc>/h
///     G_i += P_a B_i + R_aj B_ij,   G_j += P_a B_j + R_ai B_ij
///     P_a = -(1 - 4<a²>)/(8h),   R_ai = -(<i> - 4<a² i>)/(4h)
///
/// and for H, the mean second derivatives of the motion times h/2, the corners and each axis add
///
///     H_xy = C_xy/(4h) + f_z C_xyz   (xz and yz alike)
///     H_aa += B_0/(4h) + f_i B_i + f_j B_j + m_a B_ij
///     H_ai += f_a B_i + m_i B_ij,   H_aj += f_a B_j + m_j B_ij,   H_ij += P_a B_ij
enum QuadraticNumber : std::size_t {
  kTriple,                   ///< T, 1/m
  kSquare,                   ///< 3: P, 1/m
  kCubic = kSquare + 3,      ///< 6: R_ai, R_aj for every axis a, 1/m
  kCovariance = kCubic + 6,  ///< 6: 4 v C/(h² kLatticeStabilisation), xx yy zz xy xz yz, m³; 0 in unused lanes
  kQuadraticNumbers = kCovariance + 6
};

/// Data of a point for a product with the tangent: TangentNumber, without the modes xy, xz and yz, then H.
inline constexpr std::size_t kTangentH = kTangentNumbers, kQuadraticTangentNumbers = kTangentNumbers + 18;

/// Locals of a chunk, at most: phyxels of its cells, edges and a record for edges without a function.
inline constexpr std::size_t kMaxQuadraticLocals = kChunkCells * (kCorners + 2 * kCellEdges + kCellEdges) + 1;

/// Cells in slices and chunks as in CellSlices. The locals of a chunk are its phyxels, its edges with B as field, and
/// one more record of zeros.
template <class T>
struct QuadraticSlices {
  CellSlices<T> cells;                 ///< their corners, and numbers of trilinear functions
  AlignedVector<std::uint16_t> edges;  ///< [slices][kCellEdges][lanes] local
  AlignedVector<T> numbers;            ///< [slices][kQuadraticNumbers][lanes]
  std::vector<Index> firstEdges{0};    ///< [chunks + 1] into rows
  std::vector<std::uint16_t> rows;     ///< [edges][kOfEdge] phyxels of the chunk
  std::vector<T> weights;              ///< [edges][kOfEdge] of B; they sum to zero
};

}  // namespace pointbased::kernels
