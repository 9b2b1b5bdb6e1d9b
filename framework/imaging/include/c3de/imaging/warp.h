// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/volume.h"

namespace c3de {
class ThreadPool;
}

/// Images as the tissue now lies: what is at x was at x - u(x) in the reference image, all in LPS mm. The grid of u
/// need not be that of the image; outside of it nothing moves.
///
/// Results lie on the grid of the image and are the same for any number of threads. `threads`: null for threads of its
/// own, as many as the machine has. Progress is told on the calling thread. Errors: usage (a grid of displacements
/// without points, with another count of values, with values that are not finite, geometry without an inverse, too
/// little memory), internal (voxels that do not fit their geometry), cancelled. Any thread.
namespace c3de::imaging {

/// linear: between voxel centres, rounded to the stored type (halves away from zero). nearest: the voxel whose centre is
/// nearest, for images whose values are numbers of labels; beyond the border of the reference its lowest value.
enum class WarpSampling { linear, nearest };

/// Stored voxels. Linear: behind the border of the reference its outermost voxels go on. Where u is exactly zero voxels are
/// copied, to the bit.
[[nodiscard]] Expected<Volume> warped(const Volume &reference, const DisplacementGrid &u,
                                      const ProgressFn &progress = {}, ThreadPool *threads = nullptr,
                                      WarpSampling sampling = WarpSampling::linear);

/// The nearest label, 0 where vacated; the border goes on as in images. Labels that no longer occur are left out of the
/// list.
[[nodiscard]] Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u,
                                        const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// The same on another grid: a voxel there takes the label nearest to where its centre was, 0 where the map ends.
[[nodiscard]] Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u,
                                        const VolumeGeometry &grid, const ProgressFn &progress = {},
                                        ThreadPool *threads = nullptr);

/// |u| at every voxel centre as float, unit "mm"; 0 in what stays.
[[nodiscard]] Expected<Volume> magnitudeOf(const DisplacementGrid &u, const VolumeGeometry &grid,
                                           const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// 1 where a body has gone away and nothing is known of what is there now (DisplacementGrid), else 0; all 0 where u
/// does not know of bodies.
[[nodiscard]] Expected<Mask> vacatedPlaces(const DisplacementGrid &u, const VolumeGeometry &grid,
                                           const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// u at the points of another grid, 0 in what stays, for writeVectorField().
[[nodiscard]] Expected<DisplacementGrid> resampled(const DisplacementGrid &u, const VolumeGeometry &grid,
                                                   const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

}  // namespace c3de::imaging
