// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "moving_body.h"
#include "tetra_mesh.h"

namespace peers {

/// The static problem for CalculiX: 10-node tetrahedra with straight edges and mid-edge nodes, St. Venant-Kirchhoff,
/// NLGEOM. Prints displacements; organ_truth.py computes their mean.
void writeDeck(const TetraMesh &mesh, const Solid &solid, std::ostream &out);

}  // namespace peers
