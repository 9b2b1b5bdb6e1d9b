// SPDX-License-Identifier: Apache-2.0
// Surfaces with known areas, for tests of supports and loads.
#pragma once

#include "pointbased/sampling.h"
#include "shapes.h"

namespace shapes {

/// Twelve triangles, or each face divided into n x n squares.
[[nodiscard]] pointbased::Surface boxSurface(const pointbased::Vec3 &min, const pointbased::Vec3 &max, int n = 1);
/// The box with this surface.
[[nodiscard]] pointbased::BodyShape box(const pointbased::Vec3 &min, const pointbased::Vec3 &max, int n);
/// A latitude and longitude net with about 2 n² triangles.
[[nodiscard]] pointbased::Surface ballSurface(const pointbased::Vec3 &centre, double radius, int n);

/// Both, triangles of the second after those of the first.
[[nodiscard]] pointbased::Surface joined(pointbased::Surface a, const pointbased::Surface &b);

/// The body inside a closed surface, by its solid angle and the distance of its triangles: slow, for small surfaces.
[[nodiscard]] pointbased::BodyShape inside(const pointbased::Surface &surface);

[[nodiscard]] double volumeOf(const pointbased::Surface &surface);
[[nodiscard]] double areaOf(const pointbased::Surface &surface);
[[nodiscard]] double sum(const std::vector<double> &values);

}  // namespace shapes
