// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "pointbased/interpolation.h"
#include "pointbased/region.h"
#include "pointbased/sampling.h"
#include "pointbased/stencil.h"
#include "pointbased/supports.h"

namespace pointbased {

/// Finer cells in a part of the body; neighbouring cells differ by a factor of two at most.
struct Refinement {
  Region region;         ///< world, m
  double spacing = 0.0;  ///< m; cells are halved until they are at most this
};

/// Cells of a lattice to be refined, by cell indices: the result of adaptSampling() (adaptive_sampling.h).
struct FinerCells {
  using Place = std::array<std::int32_t, 3>;
  Vec3 corner = Vec3::Zero();    ///< world, m: corner of cell (0, 0, 0)
  Mat3 axes = Mat3::Identity();  ///< of the lattice, columns
  double edge = 0.0;             ///< of these cells, m
  std::vector<Place> places;     ///< ascending; empty: no refinement
  double spacing = 0.0;          ///< m; cells with their centre in one of these are halved until they are at most this

  /// Indices of the cell that contains a point of the world, m, whether it is to be refined or not; at most 10⁹ from
  /// the first cell.
  [[nodiscard]] Place placeOf(const Vec3 &x) const;
  [[nodiscard]] bool holds(const Vec3 &x) const;  ///< whether a point of the world, m, is in one of them
};

/// Functions of cells that the surface cuts.
enum class LatticeOrder {
  linear,    ///< trilinear, from the eight corners
  quadratic  ///< quadratic along edges: values in their middle follow from four corners in a row
};

struct LatticeSampling {
  double spacing = 0.0;      ///< edge of the cells, m; 0: from count
  std::size_t count = 1000;  ///< target number of phyxels
  std::vector<Refinement> refinements;
  double surfaceSpacing = 0.0;  ///< > 0: largest size of cells that the surface cuts, m
  FinerCells finer;
  /// Axes of the lattice, columns; a rotation. Empty: along the faces of the body if it has such, else along the border
  /// of the first half-space among `held`, else along the world axes (latticeDirection() in src/discretisation/lattice)
  std::optional<Mat3> axes;
  /// 0 … 0.3: phyxels whose cells are completely inside are displaced by up to this fraction of the spacing
  double jitter = 0.0;
  std::uint64_t seed = 1;  ///< of the jitter
  /// World, m: parts that will follow a prescribed motion (one ConstrainedRegion each)
  std::vector<Region> held;
  std::vector<std::pair<Region, std::uint16_t>> materials;  ///< later ones take precedence; elsewhere material 0
  LatticeOrder order = LatticeOrder::linear;                ///< quadratic: not with jitter
};

/// Edge of the smallest cells of a lattice whose coarsest cells have the edge `spacing`, m.
[[nodiscard]] double finestSpacing(const LatticeSampling &sampling, double spacing);

/// Finds the cell that contains a material point, and the shape functions there. Const, any thread.
class CellMap {
 public:
  virtual ~CellMap() = default;
  /// Functions of the cell (LatticeOrder), or of the nearest cell for a point outside of all (extrapolated). A normal
  /// selects the side of a thin gap to which a point of the surface belongs; empty: the part of the cell nearest to the
  /// point.
  /// @param points   frame of the phyxels, m
  /// @param normals  outwards, or empty
  [[nodiscard]] virtual Interpolation bind(std::span<const Vec3> points, std::span<const Vec3> normals,
                                           const ParallelFor &parallelFor) const = 0;
};

/// A body on the cells of a lattice: phyxels at the corners of every cell that contains a part of the body, one
/// evaluation point (stress point) per cell and connected part.
struct LatticeBody {
  Vec3 origin = Vec3::Zero();   ///< world, m; everything below is relative to it
  double spacing = 0.0;         ///< m, of the coarsest cells
  Vec3 corner = Vec3::Zero();   ///< m, corner of the coarsest cells, along `stencils.axes` from there
  std::vector<Vec3> positions;  ///< [phyxels] X, m, sorted in space; some are outside of the body
  std::vector<double> volumes;  ///< [phyxels] m³, > 0; sum: the body's volume (density times it is the mass)
  /// [phyxels] m³, ∫N_j: share of each in a uniform load on the material; same sum
  std::vector<double> weightVolumes;
  /// [phyxels] m³: part of `weightVolumes` that moves with a support; empty: nothing is held
  std::vector<double> heldVolumes;
  /// [phyxels] m³: part of `volumes`, of the mass, that moves with a support; empty: nothing is held
  std::vector<double> supportVolumes;
  StencilSet stencils;
  std::shared_ptr<const CellMap> cells;
  std::vector<ConstrainedRegion> held;  ///< one per LatticeSampling::held
  std::vector<Vec3> pointCentres;       ///< [points] centroid of the part of the body that each represents, m
  std::size_t components = 0;           ///< connected parts of the body
  double countedVolume = 0.0;           ///< m³, volume found inside, before it was scaled to the volume of the body
};

/// Cells of a lattice cut by a body.
///
/// Every cell is sampled at 4³ points. A point counts with the fraction of its subcell that is inside, from its
/// distance to the surface. For every connected part of (cell ∩ body):
///
///     v_q = volume of the part,   g_qj = mean of ∇N_j over the part,   N_j trilinear
///
/// The mean gradient makes Σ_q v_q g_qj = ∫ N_j n dA over the body's border. Constant stress is therefore in exact
/// balance with its tractions however the surface cuts the cells (gradients at the centre of the cell made a beam 22 %
/// too stiff). Parts of neighbouring cells share nodes only where the body continues through the common face. Parts on
/// two sides of a gap have separate corners, so nothing couples across it. Nodes that hang on a larger cell follow its
/// corners linearly, so affine fields stay exact and forces balanced across a change of spacing.
///
/// Parts of less than a fiftieth of their cell are dropped where the body continues next to them; the remainder is
/// scaled to the volume of the body. Without BodyShape::crosses, gaps of half a spacing separate; with it, thinner ones
/// as well.
///
/// Mode rows: see StencilSet::modes. Masses have the second moments of the body, not only its centre, as far as a
/// reasonable explicit step permits; see LatticeBody::volumes and weightVolumes. Material inside `held` takes no part
/// in v_q and g_qj (it moves rigidly) but keeps its mass. A held layer thinner than a quarter of the spacing acts as
/// its surface.
///
/// Errors: spacing, count, jitter or a region out of range, more than kMaximumPhyxels, nothing inside, a held region or
/// a material's region that contains no part of the body, cancelled.
[[nodiscard]] Result<LatticeBody> fillLattice(const BodyShape &shape, const LatticeSampling &sampling,
                                              const ParallelFor &parallelFor, const SamplingProgress &progress = {});

}  // namespace pointbased
