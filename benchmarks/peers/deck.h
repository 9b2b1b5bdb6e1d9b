// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "moving_body.h"
#include "tetra_mesh.h"

namespace peers {

/// The static problem for CalculiX: 10-node tetrahedra with the middles of the edges, St. Venant-Kirchhoff, NLGEOM.
/// Prints displacements, of which organ_truth.py takes the mean.
void writeDeck(const TetraMesh &mesh, const Solid &solid, std::ostream &out);

}  // namespace peers
