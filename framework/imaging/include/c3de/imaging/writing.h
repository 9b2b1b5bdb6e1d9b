// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// Writers choose the format by the extension: .nrrd, .nii, .nii.gz, .mha. An existing file is replaced once the new
/// one is complete. Only geometry, voxels and labels are written. Errors: output; geometry that is not finite or not
/// invertible, voxels that do not match it.
///
/// All three formats store sheared grids here (NIfTI as sform without qform); many programs read the directions of a
/// MetaImage as if they were orthogonal. NIfTI-1 stores its affine in single precision (6e-5 mm at 1 m).

/// NIfTI stores the original type with slope and intercept. The other formats cannot: rescaled values are written, as
/// 32-bit or smaller integers where slope and intercept are integers, otherwise as floating point.
[[nodiscard]] Expected<void> writeVolume(const std::filesystem::path &path, const Volume &volume);

/// NRRD stores names and colours as segments; for the others a table in ITK-SNAP's format is written next to it:
/// a.label.
[[nodiscard]] Expected<void> writeLabelMap(const std::filesystem::path &path, const LabelMap &labels);

/// Three floats per voxel, x y z together, in LPS millimetres (also in NIfTI, as in ANTs and ITK: intent "vector").
[[nodiscard]] Expected<void> writeVectorField(const std::filesystem::path &path, const VolumeGeometry &geometry,
                                              std::span<const float> xyz);

}  // namespace c3de::imaging
