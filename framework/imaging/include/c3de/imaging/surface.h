// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

struct SurfaceSettings {
  /// Wanted, mm; 0: so that the skin shows what the image does. One and a half voxels, longer where that would make
  /// more than 40 000 triangles, shorter where the mask is thin: three across 4 V/A (the diameter of a tube), down to
  /// one voxel, 0.7 voxels where more than a hundredth of it is less than three voxels thick, and up to 240 000
  /// triangles.
  double edgeLength = 0.0;
  /// Steps nearer to each other than about twice this are evened out, mm; 0: two of the longest voxel edges.
  double smoothingLength = 0.0;
};

/// The border of a mask: closed, 2-manifold, counter-clockwise seen from outside for either handedness of the index,
/// LPS mm. What touches the border of the grid is closed there, half a voxel outside.
///
/// Edges are about as long as chosen (most within a factor of 1.5), whatever the voxels; those of small parts at most
/// half the cube root of the part's volume. Every part, and every cavity, keeps its volume in voxels; together they
/// enclose voxel count times voxel volume within 1e-4, less what is lost (below). It is kept where it is lost, within
/// about two smoothing lengths (volume_ledger.h): the centroid of branching tubes of one to six voxels stays within a
/// tenth of a voxel, and thick parts do not swell for thin ones. Vertices stay within about half a voxel of the border
/// (measured on organs, plates and letters with edges of up to two voxels: at most 0.65), so thin parts stay; in
/// corners, and at rims of parts thinner than the edges are long, triangles lie up to an edge away from it. Triangles
/// do not go through each other, but for masks like noise, or with edges longer than parts are thick. Voxels that touch
/// in an edge or a corner alone do not hang together. Where edges are five voxels long or more the mask is seen through
/// voxels two and a half times shorter than them; what fills none of those to a half, or hangs together with nothing
/// else in them (withoutSpecks()), is lost with its volume, but for what lies beside blocks that stay, which these take
/// along. notEnclosed() says what it was.
///
/// Errors: an empty mask, an edge length that is not finite and >= 0, or that makes more than five million triangles,
/// cancelled. Any thread.
///
/// @source Gibson, Constrained Elastic Surface Nets, MICCAI 1998; Botsch and Kobbelt, A Remeshing Approach to
///         Multiresolution Modeling, SGP 2004; Taubin, A Signal Processing Approach to Fair Surface Design, SIGGRAPH
///         1995
[[nodiscard]] Expected<geometry::TriangleMesh> surfaceOf(const Mask &mask, const SurfaceSettings &settings = {},
                                                         const ProgressFn &progress = {});

}  // namespace c3de::imaging
