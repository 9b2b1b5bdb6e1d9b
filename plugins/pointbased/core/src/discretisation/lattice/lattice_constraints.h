// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "discretisation/lattice/cell_map.h"
#include "discretisation/lattice/lattice_moments.h"

namespace pointbased::lattice {

/// Content of a part: all of it, and what is free to deform.
struct PartContent {
  Moments all, free;
  bool touched = false;  ///< by a held region
  [[nodiscard]] bool isFree() const { return free.share > 1e-3 * all.share; }
};

/// Content of a small cell on both sides of the border of a region.
struct DividedSample {
  SampleContent inside, outside;
  double border = 0.0;  ///< part of the border within the small cell that is inside the body
};
/// Divides the small cell around a sample by a planar border.
[[nodiscard]] DividedSample divideSample(const CellSet &set, const Region &region, const Cell &cell, int sample,
                                         const SampleContent &content);
/// Same for a held region: voxels hold the volume they fill, and nothing beyond a gap.
[[nodiscard]] DividedSample divideHeld(const BodyShape &shape, const CellSet &set, const Region &region,
                                       const Cell &cell, int sample, const SampleContent &content);
/// Share of the small cell around a sample that voxels fill, however thin they are in it; no plane is fitted. Empty for
/// other regions.
[[nodiscard]] std::optional<double> voxelShare(const CellSet &set, const Region &region, const Cell &cell, int sample);

/// Integrals of the functions of the corners of a cell, then of its edges.
using PatchFunctions = std::array<double, 8 + kEdges>;

/// A piece of the border of a region inside the body.
struct BorderPiece {
  Vec3 place = Vec3::Zero();  ///< in edges of the cell from its centre
  double area = 0.0;          ///< m²
};

/// Intersection of a held region with one part, or a part next to one whose surface is held; means are area-weighted.
struct HeldPatch {
  Index part = 0;
  Moments held;                     ///< material inside the region
  double borderArea = 0.0;          ///< of the region's border inside the body, m²
  std::vector<BorderPiece> border;  ///< the pieces of it
  double surfaceArea = 0.0;         ///< of the body's surface inside the region, m²
  PatchFunctions surface{};         ///< Σ area N there, m²
  /// Of the part's surface that continues a held face beyond the edge of the region, m².
  double uncoveredArea = 0.0;
  /// Part of that which faces away from the border: the other side of a held layer, m²
  double facingArea = 0.0;
  PatchFunctions facing{};            ///< Σ area N there, m²
  Vec3 surfaceCentre = Vec3::Zero();  ///< Σ area X, lattice axes, m³
  Vec3 surfaceNormal = Vec3::Zero();  ///< Σ area n, lattice axes, m²
  bool thin = false;                  ///< acts as a surface: its material remains free
};

/// By region, then by part.
using HeldPatches = std::vector<std::vector<HeldPatch>>;

/// Measures the material held by the regions, and removes it from the free part of `contents`.
[[nodiscard]] HeldPatches findHeld(const BodyShape &shape, const LatticeSampling &sampling, const LatticeCellMap &map,
                                   std::vector<PartContent> &contents, const ParallelFor &parallelFor);

/// @param scale  of the volumes
/// Errors: a region that meets no part of the body.
[[nodiscard]] Result<std::vector<ConstrainedRegion>> holdLattice(const BodyShape &shape,
                                                                 const LatticeSampling &sampling,
                                                                 const LatticeCellMap &map, const HeldPatches &patches,
                                                                 std::span<const PartContent> contents, double scale,
                                                                 const ParallelFor &parallelFor);

}  // namespace pointbased::lattice
