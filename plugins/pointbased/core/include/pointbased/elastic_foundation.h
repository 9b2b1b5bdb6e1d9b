// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "pointbased/interpolation.h"
#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// How the surroundings of a body hold its surface: springs per area towards where each point is in the reference.
/// All 0: they do not.
struct Foundation {
  double stiffness = 0.0;        ///< k_n, Pa/m, finite, >= 0: along the normal of the reference
  double tangential = 0.0;       ///< k_t, Pa/m, finite, >= 0: across it
  double retardationTime = 0.0;  ///< τ, s, finite, >= 0: of a Kelvin-Voigt layer, traction k (u + τ v); 0: no damping

  [[nodiscard]] bool acts() const { return stiffness > 0.0 || tangential > 0.0; }
  /// Against every rigid motion.
  [[nodiscard]] bool holds() const { return stiffness > 0.0 && tangential > 0.0; }
  [[nodiscard]] bool operator==(const Foundation &) const = default;
};
/// Errors: which number, its value and what is accepted.
[[nodiscard]] Result<void> validate(const Foundation &foundation);

/// An elastic foundation (Winkler): every point p of the skin, with its share A_p of the area, is pulled towards its
/// place in the reference by the soft tissue around the body, whatever its neighbours do.
///
///     U = ½ Σ_p A_p u_p · K_p u_p,    K_p = k_n N_p N_p^T + k_t (I - N_p N_p^T),    u_p = Σ_j φ_pj u_j
///
/// Quadratic in the displacements of the phyxels, so its Hessian is one matrix for good; with k_n = k_t it is
/// isotropic. A rigid block of surface A is held with k A. Zero in the reference, exactly. The tissue around has no
/// mass and does not slide; N is of the reference, so with k_n ≠ k_t turns should stay small.
/// @source  Winkler, Die Lehre von der Elasticität und Festigkeit, 1867; Kerr, Elastic and viscoelastic foundation
///          models, J. Appl. Mech. 31, 1964 (with damping)
class ElasticFoundation {
 public:
  ElasticFoundation() = default;
  explicit ElasticFoundation(const Foundation &settings) : settings_(settings) {}

  /// Which points there are, and what carries them. Keeps the settings.
  /// @param points   that stand for the surface; areas and first moments of them are those of the surface
  /// @param binding  of these points
  /// @param phyxels  how many the body has
  void bind(SurfacePoints points, Interpolation binding, std::size_t phyxels);
  void unbind() { *this = ElasticFoundation(settings_); }
  [[nodiscard]] bool bound() const { return !touched_.empty(); }
  /// @param settings  valid ones
  void set(const Foundation &settings);
  [[nodiscard]] const Foundation &settings() const { return settings_; }
  [[nodiscard]] bool acts() const { return settings_.acts() && !touched_.empty(); }
  [[nodiscard]] double area() const { return area_; }  ///< m², Σ A_p, of one that acts

  [[nodiscard]] double energy(std::span<const Vec3> u) const;  ///< J
  /// Adds -K (u + τ v).
  /// @param velocities  [phyxels] m/s; empty: no damping
  /// @threads each phyxel's sum is one thread's, in fixed order: the same bits always
  void addForces(std::span<const Vec3> u, std::span<const Vec3> velocities, std::span<Vec3> forces,
                 const ParallelFor &parallelFor) const;
  /// Adds scale K du.
  void addProduct(double scale, std::span<const Vec3> du, std::span<Vec3> out, const ParallelFor &parallelFor) const;
  /// Adds the diagonal blocks of scale K; and all of it as triplets.
  void addBlocks(double scale, std::span<Mat3> blocks) const;
  void addTriplets(double scale, std::vector<Eigen::Triplet<double>> &out) const;

  /// ω² of M^-1 K is at most this, 1/s²: the largest row sum of M^-1/2 K M^-1/2.
  /// @param masses  [phyxels] kg, > 0
  [[nodiscard]] double squaredFrequencyBound(std::span<const double> masses) const;

 private:
  [[nodiscard]] Vec3 times(Index entry, const Vec3 &w) const;
  [[nodiscard]] Mat3 block(Index entry) const;
  template <class Visit>
  void forPairs(const Visit &visit) const;
  [[nodiscard]] std::size_t entryOf(Index row, Index column) const;
  void coupleNormals();
  void apply(double scale, std::span<Vec3> out, const ParallelFor &parallelFor) const;

  Foundation settings_;
  SurfacePoints points_;
  Interpolation binding_;
  double area_ = 0.0;
  std::vector<Index> touched_;      // phyxels that carry points, ascending
  std::vector<Index> placeOf_;      // [phyxels] in touched_
  Csr rows_;                        // [touched] entries by place, ascending
  std::vector<double> couplings_;   // [entries] Σ_p A φ_pi φ_pj, m²
  std::vector<Mat3> normals_;       // [entries] Σ_p A φ_pi φ_pj N N^T, m²; empty while k_n = k_t
  mutable std::vector<Vec3> ways_;  // [touched] scratch
};

}  // namespace pointbased
