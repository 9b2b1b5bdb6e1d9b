// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

struct SurfaceSettings {
  /// Target edge length, mm; 0: adapted to the image. One and a half voxels, longer where that would give more than 40
  /// 000 triangles, shorter where the mask is thin: three across 4 V/A (the diameter of a tube), down to one voxel, 0.7
  /// voxels where more than a hundredth of it is less than three voxels thick, and up to 240 000 triangles.
  double edgeLength = 0.0;
  /// Steps closer together than about twice this are smoothed, mm; 0: two of the longest voxel edges.
  double smoothingLength = 0.0;
};

/// The border of a mask: closed, 2-manifold, counter-clockwise seen from outside for either handedness of the index,
/// LPS mm. Where the mask touches the border of the grid, the surface is closed half a voxel outside.
///
/// Edges have about the chosen length (most within a factor of 1.5), whatever the voxels; those of small parts are at
/// most half the cube root of the part's volume. Every part, and every cavity, keeps its volume in voxels; together
/// they enclose voxel count times voxel volume within 1e-4, less the lost volume (below). Volume is restored near where
/// it is lost, within about two smoothing lengths (volume_ledger.h): the centroid of branching tubes of one to six
/// voxels stays within a tenth of a voxel, and thick parts do not swell to compensate for thin ones. Vertices stay
/// within about half a voxel of the border (measured on organs, plates and letters with edges of up to two voxels: at
/// most 0.65), so thin parts are preserved. In corners, and at rims of parts thinner than the edge length, triangles
/// are up to an edge length away from it. Triangles do not intersect, except for noise-like masks, or with edges longer
/// than the thickness of parts. Voxels that touch only in an edge or a corner are not connected. With edges of five
/// voxels or more, the mask is resampled to blocks two and a half times shorter than the edges. Parts that fill no
/// block to a half, or are not connected to others in the blocks (removeSpecks()), are lost with their volume, except
/// for volume next to blocks that remain, which is added to these. notEnclosed() returns what was lost.
///
/// Errors: an empty mask, an edge length that is not finite and >= 0, or that gives more than five million triangles,
/// cancelled. Any thread.
///
/// @source Gibson, Constrained Elastic Surface Nets, MICCAI 1998; Botsch and Kobbelt, A Remeshing Approach to
///         Multiresolution Modeling, SGP 2004; Taubin, A Signal Processing Approach to Fair Surface Design, SIGGRAPH
///         1995
[[nodiscard]] Expected<geometry::TriangleMesh> surfaceOf(const Mask &mask, const SurfaceSettings &settings = {},
                                                         const ProgressFn &progress = {});

/// A coarse surface for display while a mask is edited, in time proportional to its bounding box. The mask is resampled
/// to blocks of voxels; parts that fill no block to a half are left out. Closed, counter-clockwise seen from outside,
/// LPS mm. Unlike surfaceOf(), it conserves no volume, and triangles may intersect.
/// @param maxBlocks  > 0; of the bounding box of the mask
/// Errors: an empty mask, or one that fills no block to a half, such as noise; cancelled. Any thread.
/// @source Gibson, Constrained Elastic Surface Nets, MICCAI 1998
[[nodiscard]] Expected<geometry::TriangleMesh> previewSurfaceOf(const Mask &mask, std::size_t maxBlocks,
                                                                const ProgressFn &progress = {});

}  // namespace c3de::imaging
