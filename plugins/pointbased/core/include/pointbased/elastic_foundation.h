// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "pointbased/interpolation.h"
#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// Support of a body's surface by its surroundings: springs per area towards the position of each point in the
/// reference. All 0: no support.
struct Foundation {
  double stiffness = 0.0;        ///< k_n, Pa/m, finite, >= 0: along the normal of the reference
  double tangential = 0.0;       ///< k_t, Pa/m, finite, >= 0: tangential
  double retardationTime = 0.0;  ///< τ, s, finite, >= 0: of a Kelvin-Voigt layer, traction k (u + τ v); 0: no damping

  [[nodiscard]] bool acts() const { return stiffness > 0.0 || tangential > 0.0; }
  /// True if it resists every rigid motion.
  [[nodiscard]] bool holds() const { return stiffness > 0.0 && tangential > 0.0; }
  [[nodiscard]] bool operator==(const Foundation &) const = default;
};
/// Errors: text names the number, its value and the accepted range.
[[nodiscard]] Result<void> validate(const Foundation &foundation);

/// An elastic foundation (Winkler). The soft tissue around the body pulls every point p of the skin, with its share A_p
/// of the area, towards its position in the reference, independently of its neighbours.
///
///     U = ½ Σ_p A_p u_p · K_p u_p,    K_p = k_n N_p N_p^T + k_t (I - N_p N_p^T),    u_p = Σ_j φ_pj u_j
///
/// The energy is quadratic in the displacements of the phyxels, so its Hessian is constant; with k_n = k_t it is
/// isotropic. A rigid block of surface A is held with k A. The energy is exactly zero in the reference. The surrounding
/// tissue has no mass and does not slide. N is that of the reference, so rotations should remain small if k_n ≠ k_t.
/// @source  Winkler, Die Lehre von der Elasticität und Festigkeit, 1867; Kerr, Elastic and viscoelastic foundation
///          models, J. Appl. Mech. 31, 1964 (with damping)
class ElasticFoundation {
 public:
  ElasticFoundation() = default;
  explicit ElasticFoundation(const Foundation &settings) : settings_(settings) {}

  /// Sets the points and their binding. Retains the settings.
  /// @param points   represent the surface; their areas and first moments are those of the surface
  /// @param binding  of these points
  /// @param phyxels  number of phyxels of the body
  void bind(SurfacePoints points, Interpolation binding, std::size_t phyxels);
  void unbind() { *this = ElasticFoundation(settings_); }
  [[nodiscard]] bool bound() const { return !touched_.empty(); }
  /// @param settings  valid
  void set(const Foundation &settings);
  [[nodiscard]] const Foundation &settings() const { return settings_; }
  [[nodiscard]] bool acts() const { return settings_.acts() && !touched_.empty(); }
  [[nodiscard]] double area() const { return area_; }  ///< m², Σ A_p, if it acts

  [[nodiscard]] double energy(std::span<const Vec3> u) const;  ///< J
  /// Adds -K (u + τ v).
  /// @param velocities  [phyxels] m/s; empty: no damping
  /// @threads each phyxel's sum is computed by one thread in fixed order: bitwise reproducible
  void addForces(std::span<const Vec3> u, std::span<const Vec3> velocities, std::span<Vec3> forces,
                 const ParallelFor &parallelFor) const;
  /// Adds scale K du.
  void addProduct(double scale, std::span<const Vec3> du, std::span<Vec3> out, const ParallelFor &parallelFor) const;
  /// Adds the diagonal blocks of scale K; the second function adds all of it as triplets.
  void addBlocks(double scale, std::span<Mat3> blocks) const;
  void addTriplets(double scale, std::vector<Eigen::Triplet<double>> &out) const;

  /// Upper bound of ω² of M^-1 K, 1/s²: the largest row sum of M^-1/2 K M^-1/2.
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
  std::vector<Index> touched_;                      // phyxels that carry points, ascending
  std::vector<Index> indexOf_;                      // [phyxels] index in touched_
  Csr rows_;                                        // [touched] entries by index, ascending
  std::vector<double> couplings_;                   // [entries] Σ_p A φ_pi φ_pj, m²
  std::vector<Mat3> normals_;                       // [entries] Σ_p A φ_pi φ_pj N N^T, m²; empty while k_n = k_t
  mutable std::vector<Vec3> touchedDisplacements_;  // [touched] scratch
};

}  // namespace pointbased
