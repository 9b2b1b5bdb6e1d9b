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

/// The border of a tissue of a body, for the eye.
struct TissueSurface {
  std::string body, name;         ///< of the tissue
  std::array<float, 3> colour{};  ///< sRGB: as the scene says, of its largest label, of rigid ones ivory
  bool isRigid = false;
  geometry::TriangleMesh reference;  ///< as the body is placed at rest, mm
};
/// Those of all tissues that are to be shown and have voxels, without the background. Voxels are taken together, and
/// cavities left out, so that a tissue has some ten thousand triangles; one that is too thin for that has no surface.
/// Errors: cancelled. Any thread.
[[nodiscard]] Expected<std::vector<TissueSurface>> tissueSurfaces(const std::vector<TissuePlaces> &bodies,
                                                                  const ProgressFn &progress);

/// Where the vertices of surfaces are now, mm.
struct SurfacePlaces {
  std::shared_ptr<const std::vector<TissueSurface>> of;
  std::vector<std::vector<std::array<float, 3>>> vertices;  ///< of each surface; of a rigid one none: it stays
};
/// Any thread. @param before  of the same surfaces; makes it quick; null: they were at rest. Vertices to which the
///                            displacement does not lead go on from there. @param goesOn  false ends it
[[nodiscard]] Expected<SurfacePlaces> followSurfaces(const TissueSnapshot &snapshot,
                                                     std::shared_ptr<const std::vector<TissueSurface>> surfaces,
                                                     const SurfacePlaces *before,
                                                     const std::function<bool()> &goesOn = {});

}  // namespace c3de::session
