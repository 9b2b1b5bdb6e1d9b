// SPDX-License-Identifier: Apache-2.0
// Energies of lattice cells and products with their tangent. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Computes job.tangents and job.laminateTangents at job.displacements, for cellProducts().
/// @threads  any, disjoint ranges of chunks; no allocation; bits as cellForces()
void cellTangents(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cellTangents(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Change of the forces on the phyxels of the chunks (job.partials) for changes of the displacements
/// (job.displacements).
void cellProducts(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cellProducts(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Computes job.energies, each summed lane by lane.
void cellEnergies(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cellEnergies(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
