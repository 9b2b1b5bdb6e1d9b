// SPDX-License-Identifier: Apache-2.0
// A mesh from a file as a shape that the core can fill, without plugin and host.
#pragma once

#include <filesystem>

#include "c3de/geometry/mesh_io.h"
#include "pointbased/sampling.h"

namespace validation {

/// The mesh with the lowest point of its box at height `lowest` over the origin, `width` wide along its longest axis,
/// m. Throws std::runtime_error with the reason for a refusal.
[[nodiscard]] pointbased::BodyShape meshShape(const std::filesystem::path &file, c3de::geometry::LengthUnit unit,
                                              double width, double lowest);

/// A closed surface as a shape at its own position, m: as fast for large surfaces as for files. Throws as above.
[[nodiscard]] pointbased::BodyShape meshShape(const pointbased::Surface &surface);

}  // namespace validation
