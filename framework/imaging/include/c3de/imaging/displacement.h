// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What a voxel of DisplacementGrid::bodies shows in the reference; 0: what goes with the bodies beside it.
inline constexpr std::uint8_t kBodyVoxel = 1;  ///< a body
/// What stays, bone or air: a body may come over it, nothing else moves it
inline constexpr std::uint8_t kStillVoxel = 2;
inline constexpr std::uint8_t kRigidVoxel = 3;  ///< rigid tissue of a body: stays, too

/// A quantity of the tissue at the points of a grid, as it lies now.
struct TissueField {
  std::string name, unit;        ///< as the simulator calls it, SI
  std::vector<float> values;     ///< one for each point of the grid; NaN: no tissue is near
  double low = 0.0, high = 0.0;  ///< nearly all of the tissue is between them
};
/// Name of the field det F: the volume now over that of the reference.
inline constexpr const char *kVolumeRatio = "det F";

/// A spatial displacement: the material that is now at x was at x - u(x) in the reference image. Linear between the
/// points of the grid, zero outside; a millionth of a cell outside still counts as the border.
///
/// Where a body has gone away the reference image still shows it, and u, which falls to nothing around bodies, leads
/// there. Such a place is vacated: X = x - u(x) lies in a body, and the gap at x is more than leastGap(). Outside of
/// the grid, which holds all bodies as they are now, everything that was a body has gone.
///
/// What stays is where the reference shows it: u is 0 there, unless X lies in a body, which has come over it. What was
/// beside it and has moved away by more than a quarter of leastGap(), so that X lies in what stays, leaves a gap:
/// vacated, too. Beside rigid tissue of a body the simulator knows of gaps: without one what lies beside it is attached
/// to it, and where the grid, which is coarser than the border, leads X across it, u is 0 as well.
struct DisplacementGrid {
  VolumeGeometry geometry;
  std::vector<float> xyz_mm;    ///< 3 for each point, i fastest
  std::vector<float> gap_mm{};  ///< for each point, how far the material of X is from it now; empty: not known
  /// The reference, on a grid of its own: 0 or k…Voxel; null: nothing is vacated or stays
  std::shared_ptr<const Mask> bodies{};
  bool hasStill = false;              ///< kStillVoxel or kRigidVoxel occurs
  std::vector<TissueField> fields{};  ///< those that somebody looks at, on the same grid

  /// u at a point of the world, mm; 0 in what stays.
  [[nodiscard]] Vec3 at(const Vec3 &world) const;
  /// The same, as if nothing stayed: continuous.
  [[nodiscard]] Vec3 toldAt(const Vec3 &world) const;
  /// Whether the tissue that the reference shows there has gone away and nothing has come.
  [[nodiscard]] bool isVacated(const Vec3 &world) const;
  [[nodiscard]] bool knowsVacated() const { return bodies != nullptr && !gap_mm.empty(); }
  /// Whether the tissue of a body is there now; where it is not known, whether there is a displacement.
  [[nodiscard]] bool hasTissue(const Vec3 &world) const;
  /// Null: nobody looks at it.
  [[nodiscard]] const TissueField *field(const std::string &name) const;
  /// Of one of the fields; nothing where there is no tissue.
  [[nodiscard]] std::optional<double> valueOf(const TissueField &field, const Vec3 &world) const;
  /// Half the finest step, mm: the surface of a body is not known better.
  [[nodiscard]] double leastGap() const;
};

/// det F = 1 / det(1 - grad u) at the points of the grid, by differences between points in tissue, so that what u does
/// beside bodies does not count; beside them the mean of the neighbours in tissue. NaN elsewhere, and all where it is
/// not known where tissue is.
[[nodiscard]] std::vector<float> volumeRatios(const DisplacementGrid &u);

/// Where the material points of bodies are now, and how far each speaks for what is around it.
struct MaterialPoints {
  std::vector<Vec3> at_mm;
  std::vector<double> reach_mm;
};
/// What points have, at those of a grid: a mean of those within reach, near ones first. NaN: there is none.
[[nodiscard]] std::vector<float> spread(const VolumeGeometry &grid, const MaterialPoints &points,
                                        std::span<const double> values);

}  // namespace c3de::imaging
