// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Splits, collapses and flips edges until they have about the target length and vertices have about six neighbours.
/// Preserves a closed 2-manifold and its topology. Records volume changes (volume_ledger.h).
/// @param edges  target lengths by tag of the vertices
/// @param round  called after every round with the completed fraction; may move vertices. False: stop
/// @source Botsch and Kobbelt, A Remeshing Approach to Multiresolution Modeling, SGP 2004
[[nodiscard]] bool remesh(EditMesh &mesh, std::span<const double> edges, const std::function<bool(double)> &round);

/// Smooths without shrinkage: alternates a step towards the neighbours and a slightly larger one away from them.
/// Nevertheless records volume changes.
/// @source Taubin, A Signal Processing Approach to Fair Surface Design, SIGGRAPH 1995
void fair(EditMesh &mesh, std::size_t times);

}  // namespace c3de::imaging
