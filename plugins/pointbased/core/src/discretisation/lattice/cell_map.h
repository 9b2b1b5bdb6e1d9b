// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_edges.h"

namespace pointbased::lattice {

/// Entries of one point over the phyxels, with hanging corners distributed to the corners they hang on; scratch
/// storage.
struct Row {
  std::vector<Index> phyxels;
  std::vector<double> weights;
  std::vector<Vec3> gradients;
  std::vector<Eigen::Vector4d> modes;
  std::vector<Vec3> bends;  ///< xx, yy, zz

  void clear();
  /// Adds `weight` etc. of a corner to the phyxels of its row.
  void add(const NodeTable &corners, Index node, double weight, const Vec3 &gradient,
           const Eigen::Vector4d &modes = Eigen::Vector4d::Zero());
  /// Same for a row of edges.
  void add(const QuadraticEdges &edges, Index edge, double weight, const Vec3 &gradient,
           const Eigen::Vector4d &modes = Eigen::Vector4d::Zero(), const Vec3 &bends = Vec3::Zero());

 private:
  void addTo(Index phyxel, double weight, const Vec3 &gradient, const Eigen::Vector4d &modes, const Vec3 &bends);
};

/// The cells with their parts and corners; assigns points to parts.
class LatticeCellMap : public CellMap {
 public:
  LatticeCellMap(CellSet &&set, PartSet &&parts, NodeTable &&corners);

  [[nodiscard]] Interpolation bind(std::span<const Vec3> points, std::span<const Vec3> normals,
                                   const ParallelFor &parallelFor) const override;

  [[nodiscard]] const CellSet &set() const { return set_; }
  [[nodiscard]] std::span<const CutCellFragment> parts() const { return parts_.parts; }
  /// Available until release().
  [[nodiscard]] std::span<const FragmentLink> links() const { return parts_.links; }
  [[nodiscard]] std::size_t components() const { return parts_.components; }
  [[nodiscard]] const NodeTable &corners() const { return corners_; }

  /// The part that a point belongs to.
  /// @param local  lattice axes, m
  /// @param outward  unit, lattice axes, or zero
  [[nodiscard]] Index partOf(const Vec3 &local, const Vec3 &outward) const;
  [[nodiscard]] const QuadraticEdges &edges() const { return edges_; }
  void setEdges(QuadraticEdges edges) { edges_ = std::move(edges); }
  /// N_j and ∇N_j (1/m, lattice axes) of the cell of a part, extrapolated outside of it.
  void functionsAt(Index part, const Vec3 &local, std::array<double, 8> &functions,
                   std::array<Vec3, 8> &gradients) const;

  /// Functions of the edges of its cell there, likewise; of a cell that is not distorted.
  [[nodiscard]] EdgeFunctions edgeFunctionsAt(Index part, const Vec3 &local) const;

  /// Moves phyxels; `distorted`: cells (by index) that are no longer cubes.
  void move(std::vector<Vec3> positions, std::vector<std::uint8_t> distorted);
  [[nodiscard]] bool distorted(Index cell) const { return !distorted_.empty() && distorted_[cell] != 0; }
  /// Nodes of a cell without hanging corners.
  [[nodiscard]] std::array<Vec3, 8> hexahedron(Index part) const;
  /// Frees data needed for building only.
  void release();

 private:
  // A point of the surface, lattice axes, m: the point, its normal or zero, and a position slightly inside.
  struct Target {
    Vec3 at, outward, within;
    double inFront = 0.0;  // how far in front of the point samples may be, edges
  };
  [[nodiscard]] double squaredDistance(const CutCellFragment &part, const Target &target) const;
  void nearestIn(std::size_t firstCell, std::size_t lastCell, const Target &target, double &best, Index &part) const;
  [[nodiscard]] Index nearestPart(const Target &target) const;
  /// Distance of a point outside of the cell of a part, in edges; negative inside.
  [[nodiscard]] double outsideOf(Index part, const Vec3 &local) const;
  [[nodiscard]] bool shareCorner(Index a, Index b) const;
  [[nodiscard]] Index neighbourHolding(Index part, const Vec3 &local) const;

  CellSet set_;
  PartSet parts_;
  NodeTable corners_;
  QuadraticEdges edges_;
  std::vector<std::uint8_t> distorted_;  // per cell, or empty
};

}  // namespace pointbased::lattice
