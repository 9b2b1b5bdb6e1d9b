// SPDX-License-Identifier: Apache-2.0
#include "forces/vector_forces.h"

#include "forces/kernels/cell_kernel.h"
#include "forces/vector_forces_parts.h"
#include "material/relaxation.h"

namespace pointbased::detail {

namespace {

const Material &materialAt(const void *constitution, std::size_t material) {
  return static_cast<const Constitution *>(constitution)->materials[material];
}

}  // namespace

kernels::ScalarLaw scalarLaw(const Constitution &constitution) {
  using Matrix = Eigen::Map<const Mat3>;
  kernels::ScalarLaw law;
  law.context = &constitution;
  law.stress = [](const void *context, std::size_t material, const double *F, double *P) {
    const Mat3 gradient = Matrix(F);
    Eigen::Map<Mat3> answer(P);
    answer = firstPiolaStress(materialAt(context, material), gradient);
    return tangentRatio(materialAt(context, material), gradient);
  };
  law.differential = [](const void *context, std::size_t material, const double *F, const double *dF, double *dP) {
    const Mat3 gradient = Matrix(F), change = Matrix(dF);
    Eigen::Map<Mat3> answer(dP);
    answer = stressDifferential(materialAt(context, material), gradient, change);
  };
  law.energy = [](const void *context, std::size_t material, const double *F) {
    const Mat3 gradient = Matrix(F);
    return energyDensity(materialAt(context, material), gradient);
  };
  law.drive = [](const void *context, std::size_t material, const double *F, double *D) {
    Eigen::Map<Mat3> answer(D);
    answer = pronyDrive(materialAt(context, material), Matrix(F));
  };
  law.pushed = [](const void *context, std::size_t material, const double *F, const double *Q, double *P) {
    Eigen::Map<Mat3> answer(P);
    answer = pronyPushed(materialAt(context, material), Matrix(F), Matrix(Q));
  };
  return law;
}

ScalarFallback::ScalarFallback(const StencilSet &stencils, std::span<const Vec3> positions,
                               const Constitution &constitution, std::span<const Index> points)
    : stencils_(stencils), positions_(positions), constitution_(constitution) {
  if (points.empty()) return;
  for (const Index q : points) {
    if (!runs_.empty() && runs_.back().second == q && q - runs_.back().first < kPointGrain) {
      ++runs_.back().second;
    } else {
      runs_.emplace_back(q, q + 1);
    }
    for (Index e = stencils.phyxels.offsets[q]; e < stencils.phyxels.offsets[q + 1]; ++e) entries_.push_back(e);
  }
  entryForces_.resize(stencils.phyxels.indices.size());
  gradients_.resize(stencils.pointCount());
  stresses_.resize(stencils.pointCount());
  ratios_.assign(stencils.pointCount(), 1.0);
}

ParallelFor ScalarFallback::loop(const ParallelFor &parallelFor) const {
  return [this, &parallelFor](std::size_t, std::size_t, const std::function<void(std::size_t, std::size_t)> &body) {
    const auto some = [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) body(runs_[r].first, runs_[r].second);
    };
    parallelFor(runs_.size(), 1, std::cref(some));
  };
}

double ScalarFallback::evaluate(std::span<const Vec3> u, std::span<const Vec3> v, const HistoryStep &step,
                                const ParallelFor &parallelFor) {
  const ParallelFor own = loop(parallelFor);
  deformationGradients(stencils_, u, gradients_, own);
  rates_.resize(v.empty() ? 0 : gradients_.size());
  if (!v.empty()) gradientRates(stencils_, v, rates_, own);
  PointHistory &history = step.history;
  (void)plasticFlow(constitution_, stencils_, gradients_, step.dt, history, own);
  const double ratio =
      pointStresses(constitution_, stencils_, gradients_, rates_, history, step.dt, &history, stresses_, ratios_, own);
  relaxedModes_.resize(history.modes.size());
  if (!history.modes.empty())
    relaxModes(constitution_, stencils_, u, gradients_, history, step.dt, &history, relaxedModes_, own);
  entryForcesOf(constitution_, stencils_, positions_, u, gradients_, stresses_, relaxedModes_, v, entryForces_, own);
  return ratio;
}

void ScalarFallback::linearise(std::span<const Vec3> u, const ParallelFor &parallelFor) {
  linearisedAt_.assign(u.begin(), u.end());
  deformationGradients(stencils_, linearisedAt_, gradients_, loop(parallelFor));
}

void ScalarFallback::differential(std::span<const Vec3> du, double viscousScale, const ParallelFor &parallelFor) {
  entryDifferentialsOf(constitution_, stencils_, positions_, linearisedAt_, gradients_, PointHistory(), 0.0,
                       viscousScale, du, entryForces_, loop(parallelFor));
}

ElasticEnergy ScalarFallback::energy(std::span<const Vec3> u, const PointHistory &history) const {
  std::vector<Mat3> gradients(stencils_.pointCount());
  ElasticEnergy sum;
  for (const auto &[begin, end] : runs_) {
    const ParallelFor run = [begin = begin, end = end](std::size_t, std::size_t,
                                                       const std::function<void(std::size_t, std::size_t)> &body) {
      body(begin, end);
    };
    deformationGradients(stencils_, u, gradients, run);
    const ElasticEnergy part =
        elasticEnergyOf(constitution_, stencils_, positions_, u, gradients, history, {}, begin, end);
    sum.strain += part.strain;
    sum.stabilisation += part.stabilisation;
  }
  return sum;
}

std::unique_ptr<VectorForces> vectorForces(const StencilSet &stencils, std::span<const Vec3> positions,
                                           std::span<const double> masses, const Constitution &constitution,
                                           Precision precision, const ParallelFor &parallelFor) {
  if (positions.empty() || !stencils.reference.empty()) return nullptr;
  if (stencils.isLattice()) return cellForcesOf(stencils, positions, masses, constitution, precision, parallelFor);
  // The kernels of clouds do not support history.
  return constitution.hasHistory() ? nullptr : cloudForcesOf(stencils, positions, constitution, precision, parallelFor);
}

}  // namespace pointbased::detail

std::string pointbased::kernelTarget() { return kernels::kernelTarget(); }
