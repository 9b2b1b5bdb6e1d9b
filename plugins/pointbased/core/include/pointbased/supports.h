// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pointbased/interpolation.h"
#include "pointbased/region.h"
#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// A part of a body that follows a prescribed rigid motion.
struct Fix {
  Region region;                     ///< material coordinates, world, m
  Vec3 displacement = Vec3::Zero();  ///< m, reached at the end of the ramp
  Vec3 rotation_deg = Vec3::Zero();  ///< about x, then y, then z through the centre; reached at the end of the ramp
  std::optional<Vec3> centre;        ///< world, m; default: centroid of the held part
  double ramp = 0.0;                 ///< s, >= 0; in a quasi-static solution the load factor replaces it
  std::optional<Vec3> rotationVector = std::nullopt;  ///< rad, about this one axis, in place of rotation_deg

  /// Whether it prescribes a motion; otherwise the held part is static.
  [[nodiscard]] bool prescribesMotion() const {
    return !displacement.isZero(0.0) || !rotation_deg.isZero(0.0) || rotationVector.has_value();
  }
};

/// A force or a pressure on a part of a body.
struct Load {
  Region region;  ///< material coordinates, world, m
  /// N, total over the surface in the region (over its volume if the region contains no surface)
  Vec3 force = Vec3::Zero();
  double pressure = 0.0;  ///< Pa, positive into the body
  bool follower = true;   ///< a pressure rotates with the surface and scales with its area: -p cof(F) N; else -p N
  double ramp = 0.0;      ///< s, >= 0
};

/// The continuum of a fix, on the phyxels. A phyxel is held directly if everything it moves is held, or if it is on a
/// held surface. Elsewhere the mean displacement of each patch of the held border is prescribed, with one row per
/// patch,
///
///     Σ_j φ_pj x_j = prescribed position of the patch,   enforced with k_p = stiffness E A_p / d
///
/// Means per patch are used instead of every point, because a trilinear cell that is held at every point of a plane
/// through it cannot deform at all.
struct ConstrainedRegion {
  std::vector<Index> phyxels;     ///< held directly, ascending
  Csr rows;                       ///< per patch: phyxels
  std::vector<double> weights;    ///< per entry: φ, sum 1 per patch
  std::vector<double> areas;      ///< per patch, m²
  std::vector<double> stiffness;  ///< per patch: kPatchStiffness or kEdgePatchStiffness
  Vec3 centroid = Vec3::Zero();   ///< of the held part, m, in the frame of the phyxels
  double volume = 0.0;            ///< of the body inside the region, m³
  double area = 0.0;              ///< of its surface inside the region, m²
  [[nodiscard]] bool empty() const { return phyxels.empty() && areas.empty(); }
};

/// Stiffness of a held patch in units of E A / d: under the stress σ the patch yields by σ d/(60 E). Stiffer patches
/// make bodies that are held across their cells too stiff (beams and ellipsoids; measured over 10 … 1000).
inline constexpr double kPatchStiffness = 60.0;
/// The same of patches at the edge of a held part of a smooth face. A cell whose face is held from 0 to f extends the held
/// part by 0.21 + s/(1 + s) of a cell, s = k f³/4: the mean of a linear function over the patch has a weight f/2 on the
/// far corner. With 12, that is f within 0.04 for f in 0.2 … 1 (docs/theory/lattice.md).
inline constexpr double kEdgePatchStiffness = 12.0;

/// The continuum of a load, on the phyxels.
struct LoadedPart {
  Interpolation points;           ///< sample points of the surface (or of the volume if the region contains no surface)
  std::vector<Vec3> areaVectors;  ///< per point: N dA, m²; zero for points of the volume
  std::vector<double> shares;     ///< per point: fraction of the total, sum 1
  double area = 0.0;              ///< m²
};

/// Rigid motion of a fix at a load factor s in [0, 1]: x = c + R(s) (X - c) + s d. Angles grow with s.
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 centre = Vec3::Zero(), displacement = Vec3::Zero();  ///< m, in the frame of the phyxels
  [[nodiscard]] Vec3 displacementOf(const Vec3 &X) const { return rotation * (X - centre) + centre + displacement - X; }
};
[[nodiscard]] RigidMotion motionAt(const Fix &fix, const ConstrainedRegion &part, const Vec3 &origin, double s);
/// Velocity field of the same motion: dx/ds at X.
[[nodiscard]] Vec3 motionRate(const Fix &fix, const ConstrainedRegion &part, const Vec3 &origin, double s,
                              const Vec3 &X);

/// Holds the phyxels of a cloud inside the region, and patches of its surface there by moving least squares. A patch
/// consists of what is nearest to one phyxel, and has no row if everything that moves it is held. A cloud without a
/// surface is held by its phyxels only. Region, positions and surface are in the frame of the phyxels.
/// Errors: a region that validate() refuses, or that contains no part of the body.
[[nodiscard]] Result<ConstrainedRegion> holdCloud(const Region &region, std::span<const Vec3> positions,
                                                  std::span<const double> volumes, double spacing,
                                                  const Surface &surface, const ParallelFor &parallelFor);

/// Points and shares of a load. `bind` returns the interpolation of points with outward normals. Region, surface and
/// points are in the frame of the phyxels.
/// Errors: a region that validate() refuses or that contains no part of the body; a pressure without a surface inside;
/// force or pressure not finite.
/// @param spacing       of the sample points, m
/// @param volumePoints, volumes  points of the volume with their shares, for regions without a surface
using Binder = std::function<Interpolation(std::span<const Vec3> points, std::span<const Vec3> normals)>;
[[nodiscard]] Result<LoadedPart> loadedPart(const Load &load, const Surface &surface, double spacing,
                                            const Binder &bind, std::span<const Vec3> volumePoints,
                                            std::span<const double> volumes);

/// Adds the forces of a load at load factor s, N: s force in total, however the surface is sampled, and s p on every
/// point's area. On a closed surface the resultant of a pressure is zero, and its work in affine motions is -p dV.
/// @param displacements  [phyxels] u, for followers
/// @threads serial, no allocation, bitwise reproducible
void addLoadForces(const Load &load, const LoadedPart &part, double s, std::span<const Vec3> displacements,
                   std::span<Vec3> forces);

}  // namespace pointbased
