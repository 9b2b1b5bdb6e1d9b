// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Divides, joins and turns edges until they are about as long as wanted and vertices have about six neighbours; stays
/// a closed 2-manifold of the same topology. Books what volumes it changes (volume_ledger.h).
/// @param edges  wanted lengths by tag of the vertices
/// @param round  called after every round with the part that is done; may move vertices. False: stop
/// @source Botsch and Kobbelt, A Remeshing Approach to Multiresolution Modeling, SGP 2004
[[nodiscard]] bool remesh(EditMesh &mesh, std::span<const double> edges, const std::function<bool(double)> &round);

/// Evens out without shrinking: one step towards the neighbours, one a little larger away from them, again and again.
/// Books what volumes it changes all the same.
/// @source Taubin, A Signal Processing Approach to Fair Surface Design, SIGGRAPH 1995
void fair(EditMesh &mesh, std::size_t times);

}  // namespace c3de::imaging
