// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/imaging/masks.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/coverage.h"
#include "c3de/session/preparation.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// The geometry of a body as passed to a simulator: its skin, and the part of an image that it fills.
struct BodyGeometry {
  geometry::LoadedMesh skin;
  imaging::Fill fill;                          ///< empty for a mesh
  double volume_mm3 = 0.0;                     ///< voxel count times voxel volume; 0 for a mesh
  Coverage coverage;                           ///< of the mask; empty for a mesh
  std::optional<std::array<float, 3>> colour;  ///< linear RGB of its label; none if it does not come from a label
  Preparation took;                            ///< time spent on its preparation
  /// For a body of many tissues: the fill of each tissue that has a part, in the order of SceneVolume::tissues. Null: a
  /// tissue that was only found by its name has no voxels left.
  std::vector<std::shared_ptr<const imaging::Fill>> tissues;
  std::shared_ptr<TissueVoxels> tissueVoxels;  ///< of a body of many tissues
  std::vector<double> thickness_mm;            ///< thicknessOf() such a body, in the order of SceneVolume::tissues
  std::shared_ptr<const imaging::Fill> rigid;  ///< of the rigid tissues; null: there are none
};

/// The geometry of a mask without its specks. Errors are those of surface and fill.
/// @param edge_mm   edge length of the triangles of the skin; 0: automatic
/// @param points    approximate minimum number of points; voxels are averaged down to a sixteenth of the point spacing
/// @param isOfTissues  addTissues() follows
[[nodiscard]] Expected<BodyGeometry> bodyGeometryOf(const imaging::Mask &mask, double edge_mm, double points,
                                                    bool isOfTissues, const ProgressFn &progress);

/// Adds the fills of its tissues to a geometry.
/// @param points  as in bodyGeometryOf()
/// Errors: a tissue that the scene names has no voxel.
[[nodiscard]] Expected<void> addTissues(const scene::SceneVolume &volume, const imaging::LabelMap &tissues,
                                        double points, BodyGeometry &geometry);

}  // namespace c3de::session
