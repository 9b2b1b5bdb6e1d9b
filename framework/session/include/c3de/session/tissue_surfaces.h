// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/session/tissue_motion.h"

namespace c3de::session {

/// The surface of a tissue of a body, for display.
struct TissueSurface {
  std::string body, name;         ///< name: of the tissue
  std::array<float, 3> colour{};  ///< sRGB: of the scene, else of its largest label; rigid: ivory
  bool isRigid = false;
  geometry::TriangleMesh reference;  ///< with the body placed at rest, mm
};
/// The surfaces of all visible tissues that have voxels, without the background. Voxels are merged and cavities
/// omitted, so that a tissue has some ten thousand triangles. A tissue too thin for that has no surface. Errors:
/// cancelled. Any thread.
[[nodiscard]] Expected<std::vector<TissueSurface>> tissueSurfaces(const std::vector<TissueVoxels> &bodies,
                                                                  const ProgressFn &progress);

/// Present positions of the vertices of surfaces, mm.
struct SurfacePositions {
  std::shared_ptr<const std::vector<TissueSurface>> of;
  std::vector<std::vector<std::array<float, 3>>> vertices;  ///< of each surface; empty for a rigid one, which is fixed
};
/// Any thread. @param before  positions of the same surfaces, which speeds up the search; null: they were at rest.
///                              Vertices that the displacement does not reach keep their last displacement.
///                              @param goesOn  false ends it
[[nodiscard]] Expected<SurfacePositions> followSurfaces(const TissueSnapshot &snapshot,
                                                        std::shared_ptr<const std::vector<TissueSurface>> surfaces,
                                                        const SurfacePositions *before,
                                                        const std::function<bool()> &goesOn = {});

}  // namespace c3de::session
