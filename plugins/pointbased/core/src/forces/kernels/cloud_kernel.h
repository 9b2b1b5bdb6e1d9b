// SPDX-License-Identifier: Apache-2.0
// Forces of clouds evaluated at their phyxels (Müller et al. 2004). Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// M, and the own part of the force, of the slices [begin, end). Sums over pairs hold the columns of N in one register;
/// the law is evaluated with one point per lane.
/// @threads  any, disjoint ranges; no allocation; bits as cellForces()
void cloudTensors(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cloudTensors(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Computes job.tangents at job.displacements, for cloudProducts().
void cloudTangents(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cloudTangents(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Same output as cloudTensors(), for the change of the forces with changes of the displacements (job.displacements):
/// forces are linear in M and in u.
void cloudProducts(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);
void cloudProducts(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end);

/// Forces of the phyxels [begin, end) from M of their neighbours, after all cloudTensors() (or their change after
/// cloudProducts()).
/// @param forces  [phyxels][3] out: N
void cloudForces(const CloudJob<float> &job, double *forces, std::size_t begin, std::size_t end);
void cloudForces(const CloudJob<double> &job, double *forces, std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
