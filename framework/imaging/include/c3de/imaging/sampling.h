// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// Rescaled values at points in world space (mm), linear between voxel centres. The outer half of a border voxel has
/// the value of the border; points outside all voxels, and non-finite points, get `outside`.
/// @param out  as many as points
void sampleLinear(const Volume &volume, std::span<const Vec3> points, double outside, std::span<double> out);

}  // namespace c3de::imaging
