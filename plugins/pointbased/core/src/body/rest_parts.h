// SPDX-License-Identifier: Apache-2.0
// Pieces of a rest state that are made for the first one and for renewed ones. Private to the core.
#pragma once

#include "pointbased/rest_state.h"

namespace pointbased::detail {

/// Connected parts of a graph.
[[nodiscard]] std::size_t countComponents(const Csr &neighbors);

/// Surfels, skin, binder, and where the surface has triangles the contact points of a cloud; `rest` has positions and
/// spacing already.
/// @param local    frame of the phyxels, m
/// @param normals  of its vertices, or empty
void bindSkinToCloud(RestState &rest, const Surface &local, std::span<const Vec3> normals,
                     const ParallelFor &parallelFor);

}  // namespace pointbased::detail
