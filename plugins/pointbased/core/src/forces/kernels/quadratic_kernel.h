// SPDX-License-Identifier: Apache-2.0
// Forces, energies and tangents of lattice cells with functions of second order. Private to the core.
#pragma once

#include "quadratic_slices.h"

namespace pointbased::kernels {

/// The four of cell_kernel.h and cell_tangent_kernel.h for cells of second order; job.cells is second.cells, and
/// job.tangents has kQuadraticTangentNumbers rows for a slice.
/// @threads  any, disjoint ranges of chunks; no allocation; bits as cellForces()
void quadraticForces(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                     std::size_t begin, std::size_t end);
void quadraticForces(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                     std::size_t begin, std::size_t end);
void quadraticTangents(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);
void quadraticTangents(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);
void quadraticProducts(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);
void quadraticProducts(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);
void quadraticEnergies(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);
void quadraticEnergies(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
