// SPDX-License-Identifier: Apache-2.0
// Input and output of the vector kernels: plain numbers in slices, a layout that suits GPUs as well. Private to the
// core.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "aligned_vector.h"
#include "pointbased/types.h"

namespace pointbased::kernels {

/// Evaluation points per slice: one register of AVX-512. Narrower registers process a slice in parts, so that neither
/// the layout nor the order of any sum depends on the machine.
template <class T>
inline constexpr std::size_t kLanes = 64 / sizeof(T);

/// Corners of a cell; corner j is at the signs (j & 1, j >> 1 & 1, j >> 2).
inline constexpr std::size_t kCorners = 8;

/// Data of a cell besides its corners, in this order. With C_s = Σ_j s_j u_j for the eight products s of the corners'
/// signs, h the edge and <·> means over the part of the body in the cell, in edges from its centre:
///
///     G_x = C_x/(4h) + C_xy <η>/(2h) + C_xz <ζ>/(2h) + C_xyz <ηζ>/h   (G = F - I; y and z alike)
///     a_m = k_m C_m,   m = xy, xz, yz, xyz;   |a_xyz|² v s̄² = t |C_xyz|²
enum CellNumber : std::size_t {
  kGradient,  ///< 1/(4h), 1/m
  kFirstX,
  kFirstY,
  kFirstZ,  ///< <ξ>/(2h), …, 1/m
  kMixedX,
  kMixedY,
  kMixedZ,  ///< <ηζ>/h, <ξζ>/h, <ξη>/h, 1/m
  kModeXY,
  kModeXZ,
  kModeYZ,   ///< k_m, 1/m²
  kModeXYZ,  ///< 1/m³
  kVolume,   ///< v, m³; 0 in unused lanes
  kRootX,
  kRootY,
  kRootZ,  ///< √(v s), s the variances, m^2.5
  kTwist,  ///< t, m
  kCellNumbers
};

/// Additional data of a lane of two materials, in this order: detail::Laminate, lattice axes; zeros for a single
/// material.
enum LaminateNumber : std::size_t {
  kNormalX,
  kNormalY,
  kNormalZ,
  kShare,
  kLimitSquared,
  kOwnModuli,                      ///< 3
  kOtherModuli = kOwnModuli + 3,   ///< 3
  kOtherFirst = kOtherModuli + 3,  ///< 6: first, mixed
  kModeForm = kOtherFirst + 6,     ///< detail::ModeForm, also for lanes of one material
  kLaminateNumbers = kModeForm + 33
};
inline constexpr Index kNoLaminate = 0xffffffffu;

/// Cells that are processed together: their phyxels stay in the first-level cache, where the forces on each phyxel are
/// summed before they are stored.
inline constexpr std::size_t kChunkCells = 64;
template <class T>
inline constexpr std::size_t kChunkSlices = kChunkCells / kLanes<T>;
/// Phyxels of one cell with hanging corners, at most.
inline constexpr std::size_t kMaxOfCell = 16;
inline constexpr std::size_t kMaxLocals = kChunkCells * (kMaxOfCell + kCorners);  ///< corners and phyxels of a chunk

/// Cells of a lattice: kLanes of one material to a slice, kChunkSlices slices to a chunk.
template <class T>
struct CellSlices {
  std::vector<std::uint16_t> materials;  ///< [slices]
  /// [slices][kCorners][lanes] index into the phyxels of the chunk, followed by its hanging corners
  AlignedVector<std::uint16_t> corners;
  AlignedVector<T> numbers;             ///< [blocks][kCellNumbers][lanes]; slices of whole cells share a block
  std::vector<Index> blocks;            ///< [slices] index of the block
  std::vector<std::uint8_t> whole;      ///< [blocks] 1: all cells are whole, so that |g_j|² = 3 kGradient²
  std::vector<Index> laminates;         ///< [slices] index, or kNoLaminate
  AlignedVector<T> laminateNumbers;     ///< [slices with laminates][kLaminateNumbers][lanes]
  std::vector<Index> firstLocals{0};    ///< [chunks + 1] into phyxels
  std::vector<Index> phyxels;           ///< [chunks][those of its cells, ascending]
  std::vector<Index> firstHanging{0};   ///< [chunks + 1] into the rows of `followed`
  std::vector<Index> followedRows{0};   ///< [hanging corners + 1] into followed
  std::vector<std::uint16_t> followed;  ///< phyxels of the chunk
  std::vector<T> followedWeights;       ///< [followed]

  [[nodiscard]] std::size_t count() const { return materials.size(); }
  [[nodiscard]] std::size_t chunks() const { return firstLocals.size() - 1; }
};

/// Constants of a law, once per material.
template <class T>
struct LawNumbers {
  int law = 0;                                           ///< MaterialLaw
  T lambda{}, mu{}, volume{};                            ///< Pa
  T hourglassMu{}, hourglassLambda{}, hourglassTwist{};  ///< Pa; stabilisation × μ, λ*, kTwistStiffness E
  T waveAtRest{}, allAtRest{};                           ///< Pa: divisors of tangentRatio()
  T twoEta{};                                            ///< Pa s: twice the viscosity
  T viscousMu{}, viscousLambda{}, viscousTwist{};        ///< Pa s, of the modes: viscousHourglass()
};

/// Scalar laws for lanes that are collapsed or rotated beyond the validity of the kernels. F, P and their changes are
/// column-major, in lattice axes.
struct ScalarLaw {
  const void *context = nullptr;
  /// @return tangentRatio() of the law
  double (*stress)(const void *context, std::size_t material, const double *F, double *P) = nullptr;
  void (*differential)(const void *context, std::size_t material, const double *F, const double *dF,
                       double *dP) = nullptr;
  double (*energy)(const void *context, std::size_t material, const double *F) = nullptr;
  /// pronyDrive() and pronyPushed()
  void (*drive)(const void *context, std::size_t material, const double *F, double *D) = nullptr;
  void (*pushed)(const void *context, std::size_t material, const double *F, const double *Q, double *P) = nullptr;
};

/// History of a material, and its change over a step, once per evaluation.
struct MaterialHistory {
  bool flows = false, relaxes = false;
  /// Squared norm of the Green strain of F_e up to which no point flows, whatever its strain is otherwise
  double elasticLimit2 = 0.0;
  double yield = 0.0, flowShare = 0.0, plasticMax = 0.0;  ///< Plasticity; share of the excess that flows in the step
  std::array<double, 2> keep{1.0, 1.0}, fresh{}, old{};   ///< PronyStep
  double acrossOfPast = 0.0, acrossOfSum = 0.0;           ///< RelaxingHourglass
};

/// History of a body, stored in the body: plain numbers, point after point, in world axes; that of the modes in lattice
/// axes. Kernels transpose it into lanes and back. Double precision only: over a step of 1e-6 relaxation times,
/// increments in single precision would be lost in round-off.
struct HistoryJob {
  std::span<const Index> points;               ///< [slices][lanes]
  std::span<const std::size_t> used;           ///< [slices] lanes that represent a point
  std::span<const MaterialHistory> materials;  ///< [materials]
  double *plasticInverse = nullptr;            ///< [points][9] F_p^-1, in and out
  double *prony = nullptr;                     ///< [points][27] PronyPoint, in and out
  double *modes = nullptr;                     ///< [points][36] HourglassHistory, in and out; null: modes do not relax
  /// plasticFlow() of a point at this F (column-major, lattice axes), for cases that the kernel does not cover; null:
  /// no plastic flow.
  void (*flow)(const void *context, std::size_t material, Index point, const double *F) = nullptr;
  const void *flowContext = nullptr;
};

/// Data of a point for a product with the tangent, in this order; the last two only for the corotated law.
enum TangentNumber : std::size_t {
  kTangentG,                          ///< 9: G
  kTangentA = kTangentG + 9,          ///< 9: amplitudes of the modes xy, xz, yz, 1/m
  kTangentTwist = kTangentA + 9,      ///< 3: Σ s u of the mode xyz, m
  kTangentFirst = kTangentTwist + 3,  ///< dW/dJ; corotated: 2 μ - λ (tr U - 3)
  kTangentSecond,                     ///< d²W/dJ²
  kTangentStray,                      ///< 1 where the scalar law is needed, else 0
  kTangentR,                          ///< 9: R
  kTangentTurn = kTangentR + 9,       ///< 6: (tr(U) 1 - U)^-1, xx yy zz xy xz yz
  kTangentNumbers = kTangentTurn + 6
};

/// Additional data of a slice with laminates: G of both layers and v P of the material with its modes.
enum LaminateTangentNumber : std::size_t {
  kLayerG,
  kMaterialStress = kLayerG + 2 * 9,
  kLaminateTangentNumbers = kMaterialStress + 9
};

/// A field of phyxels as stored in the body: [phyxels][3], world axes. The kernels subtract its first vector, so that
/// no digits are lost far from the initial position, and rotate it into lattice axes.
struct PhyxelField {
  const double *at = nullptr;  ///< null: no such field
  std::size_t count = 0;       ///< phyxels
};

/// One evaluation of cells. Records of four numbers are vectors, padded.
template <class T>
struct CellJob {
  const CellSlices<T> *cells = nullptr;
  std::span<const LawNumbers<T>> laws;  ///< [materials]
  bool hourglass = false;               ///< includes the energy of the modes
  double axes[3][3] = {};               ///< of the lattice, columns
  bool turned = false;                  ///< axes are not those of the world
  PhyxelField displacements;            ///< m; of products: their changes
  PhyxelField velocities;               ///< m/s; without them no viscous stress
  T viscousScale{};                     ///< 1/s, for products: adds viscous forces of velocities of that times u
  /// [locals of all chunks][4] out: force of the chunk on the phyxel, N, lattice axes; and its stiffness there, N/m:
  /// Σ τ v (λ + 2 μ) |g_j|², τ the tangentRatio() (and stretch of modes) of a cell; NaN if anything is NaN.
  T *partials = nullptr;
  T *tangents = nullptr;          ///< [slices][kTangentNumbers][lanes] from cellTangents()
  T *laminateTangents = nullptr;  ///< [slices with laminates][kLaminateTangentNumbers][lanes] from cellTangents()
  double *energies = nullptr;     ///< [slices][2] out of cellEnergies(): strain and modes, J
};

/// Sums of partials: one row per phyxel, its partials in ascending order.
template <class T>
struct CollectJob {
  std::span<const Index> offsets, places;
  const T *partials = nullptr;  ///< [places][4]
  double axes[3][3] = {};
  bool turned = false;
  double *forces = nullptr;        ///< [phyxels][3] out: N, world axes
  const double *masses = nullptr;  ///< [phyxels] kg; null: stiffness over mass is not computed
};

/// Data of a point of a cloud besides its pairs, in this order. With w the symmetric weights and d the vectors to the
/// neighbours at rest:
///
///     N = Σ w Δu dᵀ,  G = N A^-1,  A = Σ w d dᵀ
///     f_j = M_j Σ_k w d_jk + Σ_k w M_k d_jk + Σ_k w (a_j + a_k)(u_k - u_j),   M = v P A^-1 - a G
///
/// which is the sum over both stencils of every pair: the weights are symmetric, and the residual of a fit is
/// u_k - u_j + d - F d.
enum CloudNumber : std::size_t {
  kInverseXX,
  kInverseYY,
  kInverseZZ,
  kInverseXY,
  kInverseXZ,
  kInverseYZ,  ///< A^-1, 1/m²
  kRestX,
  kRestY,
  kRestZ,        ///< Σ w d, m
  kCloudVolume,  ///< v, m³; 0 in unused lanes
  kControl,      ///< a, N/m: stiffness of the control over the norm of the weights
  kCloudNumbers
};

inline constexpr Index kNoPoint = 0xffffffffu;

/// One evaluation of a cloud. Records of phyxels are padded to the alignment of a register.
template <class T>
struct CloudJob {
  std::span<const Index> offsets, neighbours;  ///< rows of pairs, without the phyxel itself
  const T *weights = nullptr;                  ///< [pairs] w
  const T *places = nullptr;                   ///< [phyxels][4] X, m, and a
  std::span<const Index> points;               ///< [slices][lanes] phyxels; kNoPoint: unused
  std::span<const std::uint16_t> materials;    ///< [slices]
  const T *numbers = nullptr;                  ///< [slices][kCloudNumbers][lanes]
  std::span<const LawNumbers<T>> laws;         ///< [materials]
  const T *displacements = nullptr;            ///< [phyxels][4] m
  const T *velocities = nullptr;               ///< [phyxels][4] m/s; null: no viscous stress
  T viscousScale{};                            ///< 1/s, of cloudProducts(), as in CellJob
  T *tensors = nullptr;                        ///< [phyxels][16] out: columns of M, padded, and zeros
  T *own = nullptr;                            ///< [phyxels][4] out: part of the force without M of neighbours, N
  T *ratios = nullptr;                         ///< [slices] out, as in CellJob
  T *tangents = nullptr;                       ///< [slices][kTangentNumbers][lanes] from cloudTangents()
};

}  // namespace pointbased::kernels
