// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// Values of DisplacementGrid::bodies in the reference image; 0: material that moves with the bodies next to it.
inline constexpr std::uint8_t kBodyVoxel = 1;  ///< a body
/// Fixed bone or air: a body may move over it, nothing else moves it
inline constexpr std::uint8_t kFixedVoxel = 2;
inline constexpr std::uint8_t kRigidVoxel = 3;  ///< rigid tissue of a body: fixed as well

/// A field of the tissue at the points of a grid, in the present configuration.
struct TissueField {
  std::string name, unit;        ///< as named by the simulator, SI
  std::vector<float> values;     ///< one for each point of the grid; NaN: no tissue nearby
  double low = 0.0, high = 0.0;  ///< range of nearly all of the tissue
};
/// Name of the field det F: present volume over reference volume.
inline constexpr const char *kVolumeRatio = "det F";

/// A spatial displacement: the material that is now at x was at x - u(x) in the reference image. Linear between the
/// points of the grid, zero outside; a point up to a millionth of a cell outside still counts as on the border.
///
/// Where a body has moved away, the reference image still shows it, and u, which falls to zero around bodies, leads
/// there. Such a location is vacated: X = x - u(x) is in a body, and the gap at x exceeds leastGap(). Outside the grid,
/// which contains all bodies in their present positions, every location of a body in the reference is vacated.
///
/// Fixed regions remain where the reference shows them: u is 0 there, unless X is in a body, which has moved over them.
/// Material next to a fixed region that has moved away by more than a quarter of leastGap(), so that X is in the fixed
/// region, leaves a gap, which is vacated too. Next to rigid tissue of a body the simulator reports gaps. Without a gap
/// the neighbouring material is attached to it, and u is also 0 where the grid, which is coarser than the border, leads
/// X across the border.
struct DisplacementGrid {
  VolumeGeometry geometry;
  std::vector<float> xyz_mm;    ///< 3 for each point, i fastest
  std::vector<float> gap_mm{};  ///< for each point, the present distance to the material of X; empty: unknown
  /// The reference, on its own grid: 0 or k…Voxel; null: nothing is vacated or fixed
  std::shared_ptr<const Mask> bodies{};
  bool hasFixedRegions = false;       ///< kFixedVoxel or kRigidVoxel occurs
  std::vector<TissueField> fields{};  ///< the displayed fields, on the same grid

  /// u at a point in world space, mm; 0 in fixed regions.
  [[nodiscard]] Vec3 at(const Vec3 &world) const;
  /// Same, ignoring fixed regions: continuous.
  [[nodiscard]] Vec3 continuousAt(const Vec3 &world) const;
  /// Whether the tissue that the reference shows there has moved away and no other has taken its position.
  [[nodiscard]] bool isEmptied(const Vec3 &world) const;
  [[nodiscard]] bool hasEmptiedRegion() const { return bodies != nullptr && !gap_mm.empty(); }
  /// Whether tissue of a body is there now; where that is unknown, whether there is a displacement.
  [[nodiscard]] bool hasTissue(const Vec3 &world) const;
  /// Null: not requested.
  [[nodiscard]] const TissueField *field(const std::string &name) const;
  /// The value of one of the fields; none where there is no tissue.
  [[nodiscard]] std::optional<double> valueOf(const TissueField &field, const Vec3 &world) const;
  /// Half the finest step, mm: the accuracy of body surfaces.
  [[nodiscard]] double leastGap() const;
};

/// det F = 1 / det(1 - grad u) at the points of the grid, by differences between points in tissue, so that u outside
/// bodies has no effect. Points next to tissue get the mean of the neighbours in tissue. NaN elsewhere, and everywhere
/// if it is unknown where tissue is.
[[nodiscard]] std::vector<float> volumeRatios(const DisplacementGrid &u);

/// Present positions of the material points of bodies, and the distance within which each contributes.
struct MaterialPoints {
  std::vector<Vec3> at_mm;
  std::vector<double> reach_mm;
};
/// Interpolates point values to a grid: a weighted mean of the points within reach, with larger weights for near ones.
/// NaN: there is none.
[[nodiscard]] std::vector<float> scatterToGrid(const VolumeGeometry &grid, const MaterialPoints &points,
                                               std::span<const double> values);

}  // namespace c3de::imaging
