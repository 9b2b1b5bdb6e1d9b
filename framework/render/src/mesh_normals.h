// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/render/renderer.h"

namespace c3de::render {

/// Unit normals of the vertices: the mean over the adjacent triangles, weighted by area. A vertex without triangles, or
/// only with triangles without area, gets the zero vector.
/// @pre every index is below positions.size()
void computeVertexNormals(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                          std::vector<Vec3f> &normals);

}  // namespace c3de::render
