// SPDX-License-Identifier: Apache-2.0
// What the vector kernels read and write: plain numbers in slices, as a GPU would want them too. Private to the core.
#pragma once

#include <cstdint>
#include <span>

#include "aligned_vector.h"
#include "pointbased/types.h"

namespace pointbased::kernels {

/// Evaluation points per slice: one register of AVX-512. Narrower registers take a slice in parts, so that neither the layout
/// nor the order of any sum depends on the machine.
template <class T>
inline constexpr std::size_t kLanes = 64 / sizeof(T);

/// Corners of a cell; corner j lies at the signs (j & 1, j >> 1 & 1, j >> 2).
inline constexpr std::size_t kCorners = 8;

/// What a cell needs beside its corners, in this order. With C_s = Σ_j s_j u_j for the eight products s of the corners' signs,
/// h the edge and <·> means over the part of the body in the cell, in edges from its centre:
///
///     G_x = C_x/(4h) + C_xy <η>/(2h) + C_xz <ζ>/(2h) + C_xyz <ηζ>/h   (G = F - I; y and z alike)
///     a_m = k_m C_m,   m = xy, xz, yz, xyz
enum CellNumber : std::size_t {
  kGradient,                  ///< 1/(4h), 1/m
  kFirstX, kFirstY, kFirstZ,  ///< <ξ>/(2h), …, 1/m
  kMixedX, kMixedY, kMixedZ,  ///< <ηζ>/h, <ξζ>/h, <ξη>/h, 1/m
  kModeXY, kModeXZ, kModeYZ, kModeXYZ,  ///< k_m, 1/m² and 1/m³
  kVolume,                    ///< v, m³; 0 in lanes that stand for nothing
  kRootX, kRootY, kRootZ,     ///< √(v s), s the spreads, m^2.5
  kTwist,                     ///< v s̄², m⁷
  kCellNumbers
};

/// Cells of a lattice, kLanes of one material to a slice.
template <class T>
struct CellSlices {
  AlignedVector<Index> corners;            ///< [slices][kCorners][lanes] phyxels
  AlignedVector<T> numbers;                ///< [slices][kCellNumbers][lanes]
  std::vector<std::uint16_t> materials;    ///< [slices]

  [[nodiscard]] std::size_t count() const { return materials.size(); }
};

/// Numbers of a law, once per material.
template <class T>
struct LawNumbers {
  int law = 0;                         ///< MaterialLaw
  T lambda{}, mu{}, volume{};          ///< Pa
  T modalMu{}, modalLambda{}, modalTwist{};  ///< Pa; stabilisation × μ, λ*, kTwistStiffness E
  T waveAtRest{}, allAtRest{};         ///< Pa: what tangentRatio() divides by
};

/// One evaluation of cells. Vectors of phyxels and entries are padded to four numbers.
template <class T>
struct CellJob {
  const CellSlices<T> *cells = nullptr;
  std::span<const LawNumbers<T>> laws;   ///< [materials]
  bool modal = false;                    ///< with the energy of the modes
  const T *displacements = nullptr;      ///< [phyxels][4], lattice axes, m
  T *entries = nullptr;                  ///< [slices][kCorners][lanes][4] out: force on the corner, N
  T *ratios = nullptr;                   ///< [slices] out: largest tangentRatio() of the slice; NaN if any is
};

}  // namespace pointbased::kernels
