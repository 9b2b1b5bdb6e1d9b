// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/imaging/volume.h"

namespace itk_truth {

enum class Sampling { linear, nearest };

/// The result of ITK's ResampleImageFilter for an image whose voxel at x comes from sourceOf * x (LPS mm), on the same
/// grid. The stored voxels are passed as float, which is exact below 2^24. Before, the outermost voxels are repeated
/// `border` times around the image; the region beyond that is NaN. @throws std::exception  ITK's
std::vector<float> resampled(const c3de::imaging::Volume &image, const c3de::Mat4 &sourceOf, Sampling sampling,
                             unsigned border);

}  // namespace itk_truth
