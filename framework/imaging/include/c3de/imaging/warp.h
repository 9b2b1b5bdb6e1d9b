// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/volume.h"

namespace c3de {
class ThreadPool;
}

/// Images deformed to the present configuration: the value at x is that at x - u(x) in the reference image, all in LPS
/// mm. The grid of u may differ from that of the image; outside it the displacement is zero.
///
/// Results are on the grid of the image and do not depend on the number of threads. `threads`: null creates a separate
/// pool with as many threads as the machine has. Progress is reported on the calling thread. Errors: usage (a
/// displacement grid without points, with the wrong number of values, with non-finite values, non-invertible geometry,
/// insufficient memory), internal (voxels that do not match their geometry), cancelled. Any thread.
namespace c3de::imaging {

/// linear: between voxel centres, rounded to the stored type (halves away from zero). nearest: the voxel with the
/// nearest centre, for images whose values are label numbers; outside the reference its lowest value.
enum class WarpSampling { linear, nearest };

/// Stored voxels. Linear: outside the reference the values of its outermost voxels continue. Where u is exactly zero,
/// voxels are copied bit by bit.
[[nodiscard]] Expected<Volume> warped(const Volume &reference, const DisplacementGrid &u,
                                      const ProgressFn &progress = {}, ThreadPool *threads = nullptr,
                                      WarpSampling sampling = WarpSampling::linear);

/// The nearest label, 0 where vacated; outside the reference the border continues as for images. Labels that no longer
/// occur are removed from the list.
[[nodiscard]] Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u,
                                        const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// Same on another grid: a voxel gets the label nearest to the reference position of its centre, 0 outside the map.
[[nodiscard]] Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u,
                                        const VolumeGeometry &grid, const ProgressFn &progress = {},
                                        ThreadPool *threads = nullptr);

/// |u| at every voxel centre as float, unit "mm"; 0 in fixed regions.
[[nodiscard]] Expected<Volume> magnitudeOf(const DisplacementGrid &u, const VolumeGeometry &grid,
                                           const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// 1 where a body has moved away and the present content is unknown (DisplacementGrid), otherwise 0; all 0 where u has
/// no information about bodies.
[[nodiscard]] Expected<Mask> emptiedRegions(const DisplacementGrid &u, const VolumeGeometry &grid,
                                            const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

/// u at the points of another grid, 0 in fixed regions, for writeVectorField().
[[nodiscard]] Expected<DisplacementGrid> resampled(const DisplacementGrid &u, const VolumeGeometry &grid,
                                                   const ProgressFn &progress = {}, ThreadPool *threads = nullptr);

}  // namespace c3de::imaging
