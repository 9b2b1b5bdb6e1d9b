// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "pointbased/lattice.h"

/// Cells, parts and corners for fillLattice; see lattice.h for the method.
///
/// "Lattice axes" are coordinates along LatticeSampling::axes relative to LatticeBody::origin, m. Corner c of a cell is
/// at (c & 1, c >> 1 & 1, c >> 2), sample s at ((s & 3) + ½, (s >> 2 & 3) + ½, (s >> 4) + ½) / 4 of its edges.
namespace pointbased::lattice {

inline constexpr int kSamplesPerAxis = 4;
inline constexpr int kSamples = 64;
inline constexpr Index kNone = 0xffffffffu;
/// Samples with less than this share of their small cell do not connect parts.
inline constexpr double kConnectingShare = 0.05;
/// A held layer thinner than this part of the edge acts as a surface.
inline constexpr double kThinLayer = 0.25;

[[nodiscard]] inline double cornerSign(int corner, int axis) { return (corner >> axis & 1) != 0 ? 1.0 : -1.0; }
[[nodiscard]] inline int sampleCoordinate(int sample, int axis) { return sample >> (2 * axis) & 3; }
/// Position of a sample in its cell, in edges from the centre.
[[nodiscard]] inline Vec3 sampleOffset(int sample) {
  return (Vec3(sample & 3, sample >> 2 & 3, sample >> 4) + Vec3::Constant(0.5 - 0.5 * kSamplesPerAxis)) /
         kSamplesPerAxis;
}

using Cell3 = std::array<std::int32_t, 3>;

/// Position and axes of the lattice.
struct Frame {
  Vec3 origin = Vec3::Zero();  ///< world, m
  Mat3 axes = Mat3::Identity();
  Vec3 low = Vec3::Zero();  ///< first corner, lattice axes, m
  double spacing = 0.0;     ///< of the coarsest cells, m
  Cell3 n{1, 1, 1};         ///< coarsest cells
  int levels = 0;           ///< halvings down to the finest cells

  [[nodiscard]] std::int32_t finest() const { return std::int32_t{1} << levels; }
  [[nodiscard]] double unit() const { return spacing / finest(); }
  [[nodiscard]] Vec3 world(const Vec3 &local) const { return origin + axes * local; }
  /// Position of a corner, from units of the finest cells.
  [[nodiscard]] Vec3 place(const Cell3 &at) const { return low + unit() * Vec3(at[0], at[1], at[2]); }
};

/// Signed distances of the samples of a cell, m, negative inside.
using Samples = std::array<double, kSamples>;

struct Cell {
  Cell3 at{};             ///< first corner, units of the finest cells
  std::int32_t size = 1;  ///< edge, same unit
  Index samples = kNone;  ///< into CellSet::samples; kNone: wholly inside
};

/// Finds cells by position: a binary search among the codes of their first corners.
class CellIndex {
 public:
  /// @param cells  in Morton order
  void build(std::span<const Cell> cells, const Frame &frame);
  /// Cell `k` of level `level`, or kNone.
  [[nodiscard]] Index find(int level, const Cell3 &k) const;
  /// The cell that contains a position in units of the finest cells, or kNone.
  [[nodiscard]] Index holding(const Cell3 &at) const;
  /// mortonCode() of the first corner of every cell, ascending.
  [[nodiscard]] std::span<const std::uint64_t> codes() const { return codes_; }
  [[nodiscard]] static int levelOf(const Cell &cell, const Frame &frame);
  [[nodiscard]] static std::uint64_t key(int level, const Cell3 &k) {
    return static_cast<std::uint64_t>(level) << 60 | static_cast<std::uint64_t>(k[0]) << 40 |
           static_cast<std::uint64_t>(k[1]) << 20 | static_cast<std::uint64_t>(k[2]);
  }

 private:
  std::vector<std::uint64_t> codes_;
  std::vector<std::uint8_t> cellLevels_;
  Cell3 end_{};  // units of the finest cells
  int levels_ = 0;
};

/// All cells that contain part of the body, in Morton order.
struct CellSet {
  Frame frame;
  std::vector<Cell> cells;
  std::vector<Samples> samples;
  bool measured = true;  ///< false: the shape provides no distances, samples are ± the edge
  CellIndex index;

  [[nodiscard]] double edge(const Cell &cell) const { return frame.unit() * cell.size; }
  [[nodiscard]] Vec3 centre(const Cell &cell) const { return frame.place(cell.at) + Vec3::Constant(0.5 * edge(cell)); }
};

/// Share of a small cell of edge `width` that is inside, from the signed distance of its centre.
[[nodiscard]] inline double shareOf(double distance, double width) {
  const double share = 0.5 - distance / width;
  // Rounding of large coordinates must not turn a full cell into a cut one.
  return share < 1e-7 ? 0.0 : share > 1.0 - 1e-7 ? 1.0 : share;
}

/// Order along a Z curve; 20 bits per axis.
[[nodiscard]] std::uint64_t mortonCode(const Cell3 &at);

/// Batched queries of the shape at points in lattice axes.
class Questions {
 public:
  Questions(const BodyShape &shape, const Frame &frame) : shape_(shape), frame_(frame) {}
  [[nodiscard]] bool measures() const { return static_cast<bool>(shape_.surfaceDistance); }
  [[nodiscard]] bool knowsShares() const { return static_cast<bool>(shape_.shares); }
  void distances(std::span<const Vec3> local, std::span<double> out) const;
  /// BodyShape::shares of cubes along the lattice.
  void shares(std::span<const Vec3> local, double edge, std::span<double> parts, std::span<double> distances) const;
  void inside(std::span<const Vec3> local, std::span<std::uint8_t> out) const;

 private:
  const BodyShape &shape_;
  const Frame &frame_;
};

/// The lattice is aligned along each axis on which a held region ends across it; the first such region counts. Corners
/// are on a held face or sheet, and a border through the body is in the middle of cells. There the means of its patches
/// are about as stiff as the continuum. Individually held corners in that plane made organs of 1 000 phyxels 4 to 10 %
/// too stiff; arbitrary positions of the border within the cells scattered by 2 %. Otherwise the lattice is symmetric
/// about the centre of the bounds, so that a box whose edges are multiples of the spacing has corners on its faces.
[[nodiscard]] Frame frameOver(const BodyShape &shape, const LatticeSampling &sampling, double spacing);

/// Finds the cells, refined and graded. Errors: cancelled, too many.
/// @param progress  of this stage, 0 … 1
[[nodiscard]] Result<CellSet> findCells(const BodyShape &shape, const LatticeSampling &sampling, double spacing,
                                        const ParallelFor &parallelFor, const SamplingProgress &progress);

/// Approximate number of corners of the unrefined cells at this spacing; needs far fewer queries than findCells.
[[nodiscard]] std::size_t estimateCorners(const BodyShape &shape, const LatticeSampling &sampling, double spacing,
                                          const ParallelFor &parallelFor);

/// Approximate number of corners of all cells of this edge, from volume and area alone; within some per cent for a
/// smooth body.
[[nodiscard]] double expectedCorners(const BodyShape &shape, double spacing);
/// The contribution of the surface to it.
[[nodiscard]] double expectedSurfaceCorners(const BodyShape &shape, double spacing);

/// Factor by which the expected size may be too small before a finished body is rejected after all.
inline constexpr double kExpectationSlack = 1.1;

/// Returns an error if a spacing cannot be used; before anything is allocated.
[[nodiscard]] Result<void> checkSize(const BodyShape &shape, const LatticeSampling &sampling, double spacing);

}  // namespace pointbased::lattice
