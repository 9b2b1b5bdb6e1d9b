// SPDX-License-Identifier: Apache-2.0
// Parts of rest states shared by building and by rereferencing. Private to the core.
#pragma once

#include "pointbased/rest_state.h"

namespace pointbased::detail {

/// Number of connected components of a graph.
[[nodiscard]] std::size_t countComponents(const Csr &neighbors);

/// Binds surfels and skin, and sets the binder. For surfaces with triangles it also sets the contact points of a cloud.
/// `rest` must already contain positions and spacing.
/// @param local  surface in the frame of the phyxels, m
/// @param normals  of its vertices, or empty
void bindSkinToCloud(RestState &rest, const Surface &local, std::span<const Vec3> normals,
                     const ParallelFor &parallelFor);

}  // namespace pointbased::detail
