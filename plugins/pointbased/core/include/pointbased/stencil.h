// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "pointbased/types.h"

namespace pointbased {

/// Compressed rows: the entries of row i are [offsets[i], offsets[i+1]).
struct Csr {
  std::vector<Index> offsets{0};
  std::vector<Index> indices;

  [[nodiscard]] std::size_t rows() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const Index> row(std::size_t i) const {
    return std::span<const Index>(indices).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
};

/// Compact representation of the rows of a stencil over the eight corners of a cell, where they are means of the
/// trilinear functions over a part of it. With the signs of corner j, s_x = ±1 and so on, in lattice axes:
///
///     g_x = g s_x + first_y s_x s_y + first_z s_x s_z + mixed_x s_x s_y s_z   (y and z alike)
///     γ_m = modes_m s_m,   s_m the products of the signs
struct CellShape {
  double gradient = 0.0;  ///< 1/(4h), 1/m
  /// Means of the position and of its products over the part: see CellNumber in src/forces/kernels/slices.h, 1/m
  Vec3 first, mixed;
  Eigen::Vector4d modes;  ///< 1/m², of xyz 1/m³
  bool operator==(const CellShape &) const = default;
};

/// Points of cells next to larger ones. Some of their corners are hanging nodes in the middle of an edge or a face of a
/// larger cell. These are not phyxels, but means of a few. Over all eight corners the rows of such a point have a
/// CellShape; the rows of its stencil are those, distributed to the phyxels that the corners follow.
struct HangingCells {
  /// Marks a hanging corner; the other bits are its row of `phyxels`.
  static constexpr Index kHangs = 0x80000000u;
  struct Point {
    Index point = 0;
    CellShape shape;
    std::array<Index, 8> corners{};  ///< a phyxel, or kHangs and a row
  };
  std::vector<Point> points;    ///< ascending
  Csr phyxels;                  ///< per hanging corner: the phyxels it follows
  std::vector<double> weights;  ///< per entry of `phyxels`; the weights of a corner sum to one

  /// Calls of(phyxel, weight) for the phyxel of a corner, or for those that it follows.
  template <class Of>
  void visit(Index corner, const Of &of) const {
    if ((corner & kHangs) == 0) return of(corner, 1.0);
    const Index row = corner & ~kHangs;
    for (Index e = phyxels.offsets[row]; e < phyxels.offsets[row + 1]; ++e) of(phyxels.indices[e], weights[e]);
  }
  /// Null: no corner of its cell is hanging.
  [[nodiscard]] const Point *find(std::size_t point) const {
    const auto at = std::lower_bound(points.begin(), points.end(), point,
                                     [](const Point &one, std::size_t other) { return one.point < other; });
    return at != points.end() && at->point == point ? &*at : nullptr;
  }
};

/// Points of cells whose functions are quadratic along edges (LatticeOrder::quadratic). Their rows have the eight
/// corners of the cell first, then phyxels next to it. The mean of the second derivatives of the motion over the
/// part is known:
/// xy, xz, yz from `StencilSet::modes`, xx, yy, zz from `bends`.
struct QuadraticPoints {
  static constexpr Index kNone = 0xffffffffu;
  static constexpr Index kCorners = 8;
  /// Edge 4 a + i is along lattice axis a; bits of i: its side along the axes a + 1 and a + 2 (modulo 3). Its
  /// function is 1 in its middle, 0 at both ends and on the other edges.
  static constexpr std::size_t kEdges = 12;
  struct Point {
    CellShape corners;                  ///< rows over its corners alone, of trilinear functions
    std::array<Index, kEdges> edges{};  ///< rows of `edgePhyxels`, or kNone: linear along this edge
    /// Means over the part, in edges of the cell from its centre: x², and x_a² x_b in row a, column b
    Vec3 second = Vec3::Zero();
    Mat3 cubic = Mat3::Zero();
    double triple = 0.0;             ///< mean of x y z, likewise
    Mat3 covariance = Mat3::Zero();  ///< of the material of the part, lattice axes, m²
    Index first = 0;                 ///< its first row in `bends`
  };
  std::vector<Index> of;      ///< per point of the set: index into `points`, or kNone; empty: no such points
  std::vector<Point> points;  ///< ascending
  std::vector<Vec3> bends;    ///< per entry of these points: rows of xx, yy, zz, lattice axes, 1/m²
  /// Per edge: phyxels and weights of the displacement in its middle less the mean of its ends. Affine motions: zero
  Csr edgePhyxels;
  std::vector<double> edgeWeights;

  /// Null: an ordinary point.
  [[nodiscard]] const Point *find(std::size_t q) const {
    return of.empty() || of[q] == kNone ? nullptr : &points[of[q]];
  }
};

/// Evaluation points with their stencils over the phyxels, from the reference state; const afterwards.
///
/// All quantities of the method at a point q are linear in the displacements of a few phyxels:
///
///     F_q = I + Σ_k u_k g_qk^T,   Σ_k g_qk = 0,   Σ_k X_k g_qk^T = I
///
/// In Müller's method q runs over the phyxels; on a lattice over stress points, one per cell and connected part of the
/// body in it. The sampling determines which points exist. The first entry of a stencil is its anchor: displacements
/// are relative to it, so that a body far from its initial position loses no precision.
struct StencilSet {
  Csr phyxels;                  ///< per point: the anchor, then the others
  std::vector<Vec3> gradients;  ///< per entry: g, 1/m; for compact sets only where `rowsOf` refers to them
  /// Per entry, clouds: stabilisation weight, 0 for the anchor; Σ w |X - X_anchor|² = 3 m²; else empty
  std::vector<double> weights;
  /// Per point, clouds: ratio of the weights to those of kernelWeight(), which are symmetric; else empty
  std::vector<double> weightFactors;
  /// Per entry, lattices: rows γ of the four modes (xy, xz, yz, xyz) that the affine fit does not resolve, in lattice
  /// axes: a_m = Σ_j γ_mj x_j is the coefficient of ξη, ξζ, ηζ (1/m² · m) and ξηζ (1/m³ · m) in the motion of the cell.
  /// Each row is zero on affine fields: Σ γ = 0, Σ γ X = 0 (Flanagan and Belytschko's projection). Empty for clouds.
  std::vector<Eigen::Vector4d> modes;
  /// For compact sets (compactRows()): the distinct shapes of cells, and per point its shape, or the number of shapes
  /// plus the start of its rows in `gradients` and `modes`. Empty: entry e has gradients[e] and modes[e]. See
  /// GradientRows.
  std::vector<CellShape> shapes;
  std::vector<Index> rowsOf;
  HangingCells hanging;          ///< for lattices with finer cells, at rest as created
  QuadraticPoints quadratic;     ///< for lattices of second order
  std::vector<Vec3> variances;   ///< per point, lattices: variance of the part's material along the lattice axes, m²
  Mat3 axes = Mat3::Identity();  ///< lattice axes, columns; x, y, z of modes and variances
  std::vector<std::uint16_t> materials;  ///< per point: index into the body's materials; empty: the first
  std::vector<double> volumes;           ///< per point: rest volume it represents, m³
  /// Per point: F of the reference shape itself, symmetric; empty: the identity everywhere. A body whose reference has
  /// been renewed (rereferencing.h) is strained in it: F_q = S_q + Σ_k u_k g_qk^T, and g_qk is S_q times the gradient
  /// of the fit. Then Σ_k X_k g_qk^T = S_q, and forces, energies and tangents need no special treatment.
  std::vector<Mat3> reference;
  std::vector<Mat3> referenceInverse;  ///< per point: S^-1; empty if `reference` is
  std::vector<std::uint8_t> rank;      ///< per point: 3 = full; 2 coplanar, 1 collinear, 0 isolated: F is completed
  std::vector<Mat3> frames;    ///< per point of rank < 3, by frameOf: columns t1, t2, n (rank 2) or t, ., . (rank 1)
  std::vector<Index> frameOf;  ///< per point: index into frames, or kNoFrame

  /// Per phyxel: its entries (of all stencils), ascending; used to gather the forces.
  Csr entriesOfPhyxel;  ///< indices are entry numbers

  static constexpr Index kNoFrame = 0xffffffffu;
  [[nodiscard]] std::size_t pointCount() const { return volumes.size(); }
  [[nodiscard]] bool isLattice() const { return !variances.empty(); }
  /// The shape of a point of a compact set, or null.
  [[nodiscard]] const CellShape *shapeOf(std::size_t q) const {
    return !rowsOf.empty() && rowsOf[q] < shapes.size() ? &shapes[rowsOf[q]] : nullptr;
  }
  /// Same, over its corners if some of them are hanging.
  [[nodiscard]] const CellShape *cellShapeOf(std::size_t q) const {
    if (const CellShape *shape = shapeOf(q)) return shape;
    const HangingCells::Point *point = hanging.find(q);
    return point != nullptr ? &point->shape : nullptr;
  }
  /// First row of a point without a shape.
  [[nodiscard]] std::size_t firstRow(std::size_t q) const {
    return rowsOf.empty() ? phyxels.offsets[q] : rowsOf[q] - shapes.size();
  }
  /// The point that an entry belongs to, by search.
  [[nodiscard]] Index pointOfEntry(Index entry) const {
    // If all stencils have the same length, the first guess is right.
    const auto guess = static_cast<std::size_t>(std::uint64_t{entry} * pointCount() / phyxels.indices.size());
    if (phyxels.offsets[guess] <= entry && entry < phyxels.offsets[guess + 1]) return static_cast<Index>(guess);
    const auto next = std::upper_bound(phyxels.offsets.begin(), phyxels.offsets.end(), entry);
    return static_cast<Index>(next - phyxels.offsets.begin() - 1);
  }
  /// Whether the phyxel of an entry is a corner of the cell of point q, not one beyond it.
  [[nodiscard]] bool isCorner(Index entry, std::size_t q) const {
    return quadratic.find(q) == nullptr || entry - phyxels.offsets[q] < QuadraticPoints::kCorners;
  }
  /// A displacement in the reference shape, with its strain removed.
  [[nodiscard]] Vec3 unstrained(std::size_t q, const Vec3 &displacement) const {
    return referenceInverse.empty() ? displacement : Vec3(referenceInverse[q] * displacement);
  }
};

/// g of all corners of a cell; the columns of `axes` are those of the lattice.
void cellGradients(const CellShape &shape, const Mat3 &axes, std::array<Vec3, 8> &out);
/// γ of all corners.
void cellModes(const CellShape &shape, std::array<Eigen::Vector4d, 8> &out);

/// Gradients of the entries of one point, by entry number; for any lattice or cloud, compact or not.
class GradientRows {
 public:
  GradientRows(const StencilSet &s, std::size_t q) : first_(s.phyxels.offsets[q]) {
    if (const CellShape *shape = s.shapeOf(q)) {
      cellGradients(*shape, s.axes, own_);
      rows_ = own_.data();
    } else {
      rows_ = s.gradients.data() + s.firstRow(q);
    }
  }
  GradientRows(const GradientRows &) = delete;
  GradientRows &operator=(const GradientRows &) = delete;
  [[nodiscard]] const Vec3 &operator[](Index entry) const { return rows_[entry - first_]; }

 private:
  Index first_;
  const Vec3 *rows_;
  std::array<Vec3, 8> own_;
};

/// Mode rows of the entries of one point of a lattice; clouds have none.
class ModeRows {
 public:
  ModeRows(const StencilSet &s, std::size_t q) : first_(s.phyxels.offsets[q]) {
    if (const CellShape *shape = s.shapeOf(q)) {
      cellModes(*shape, own_);
      rows_ = own_.data();
    } else {
      rows_ = s.modes.empty() ? nullptr : s.modes.data() + s.firstRow(q);
    }
  }
  ModeRows(const ModeRows &) = delete;
  ModeRows &operator=(const ModeRows &) = delete;
  [[nodiscard]] const Eigen::Vector4d &operator[](Index entry) const { return rows_[entry - first_]; }

 private:
  Index first_;
  const Eigen::Vector4d *rows_;
  std::array<Eigen::Vector4d, 8> own_;
};

/// The shape that reproduces rows over the corners of a cell up to round-off (kSameRows); empty: jittered cells.
/// @param gradients  lattice axes, 1/m
[[nodiscard]] std::optional<CellShape> shapeOfRows(const std::array<Vec3, 8> &gradients,
                                                   const std::array<Eigen::Vector4d, 8> &modes);
/// Shape of a point; empty: corners that hang on a larger cell, jittered cells, a renewed reference, flat stencils,
/// clouds.
[[nodiscard]] std::optional<CellShape> findShape(const StencilSet &stencils, std::size_t q);
/// Replaces rows by shapes wherever a point has one; equal shapes are stored once.
void compactRows(StencilSet &stencils);
/// Inverse of compactRows(): rows of all entries, so that they can be changed.
void expandRows(StencilSet &stencils);
/// The same points with trilinear functions: every quadratic point has only the rows of its corners. For
/// preconditioners, which need narrow rows.
[[nodiscard]] StencilSet withTrilinearRows(const StencilSet &stencils);

/// Relative to the gradient: rows contain the round-off of their computation.
inline constexpr double kSameRows = 1e-11;

/// Relative cut-off of the truncated inverse of a moment matrix: directions with a singular value below this fraction
/// of the largest are treated as flat. About a tenth of the support in length; dimensionless.
inline constexpr double kMomentCutOff = 1e-2;

/// g_qj = w_qj A_q^+ (X_j - X_q) for the neighbours of every phyxel, -Σ for q itself.
///
/// A_q = Σ_j w_qj (X_j - X_q)(X_j - X_q)^T is inverted once by eigenvalues, truncated at kMomentCutOff.
/// @param positions      [n] X, m
/// @param neighbors      symmetric, without i itself
/// @param supportRadii   [n] h, m; the weight of a pair uses the larger one
/// @param volumes        [n] m³
/// @source  Müller et al., Point Based Animation of Elastic, Plastic and Melting Objects, SCA 2004, the
///          moving-least-squares fit of the displacement gradient
[[nodiscard]] StencilSet buildPhyxelStencils(std::span<const Vec3> positions, const Csr &neighbors,
                                             std::span<const double> supportRadii, std::span<const double> volumes,
                                             const ParallelFor &parallelFor);

/// Fills entriesOfPhyxel from phyxels.
void buildGather(StencilSet &stencils, std::size_t phyxelCount);

/// Weight of a neighbour at distance r: (1 - (r/h)²)³, 0 from h on. The polynomial of Müller et al. 2003, without its
/// normalisation, which cancels in the fit.
[[nodiscard]] inline double kernelWeight(double r, double h) {
  const double q = r / h;
  if (q >= 1.0) return 0.0;
  const double s = 1.0 - q * q;
  return s * s * s;
}

}  // namespace pointbased
