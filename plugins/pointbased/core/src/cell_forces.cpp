// SPDX-License-Identifier: Apache-2.0
// Vector forces of lattices.
#include <algorithm>

#include "kernels/cell_kernel.h"
#include "kernels/cell_tangent_kernel.h"
#include "vector_forces_parts.h"

namespace pointbased::detail {
namespace {

using namespace kernels;

template <class T>
class CellForces final : public VectorForces {
 public:
  CellForces(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution, const CellPlan &plan)
      : stencils_(stencils), constitution_(constitution), cells_(sliceCells<T>(stencils, plan)),
        laws_(lawsOf<T>(constitution)), others_(stencils, positions, constitution_, plan.others) {
    const std::size_t n = positions.size(), own = cells_.count() * kCorners * kLanes<T>;
    ratios_.resize(cells_.count());
    layEntries(plan, n, own);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) axes_[r][c] = stencils.axes(r, c);
    turned_ = stencils.axes != Mat3::Identity();
  }

  double evaluate(std::span<const Vec3> u, std::span<const Vec3> v, std::span<Vec3> forces,
                  const ParallelFor &parallelFor) override {
    pack(u, displacements_, parallelFor);
    if (!v.empty()) pack(v, velocities_, parallelFor);
    CellJob<T> job = this->job();
    if (!v.empty()) job.velocities = velocities_.data();
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, cells_.count(), kSliceGrain, [&](std::size_t begin, std::size_t end) {
      cellForces(job, scalar, begin, end);
    });
    const double others = others_.empty() ? 1.0 : evaluateOthers(u, v, parallelFor);
    const double ratio = largestRatio<T>(ratios_, others);
    collect(forces, parallelFor);
    return ratio;
  }

  [[nodiscard]] ElasticEnergy energy(std::span<const Vec3> u, const ParallelFor &parallelFor) override {
    pack(u, displacements_, parallelFor);
    energies_.resize(2 * cells_.count());
    const CellJob<T> job = this->job();
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, cells_.count(), kSliceGrain,
            [&](std::size_t begin, std::size_t end) { cellEnergies(job, scalar, begin, end); });
    ElasticEnergy sum = others_.empty() ? ElasticEnergy() : others_.energy(u);
    for (std::size_t slice = 0; slice < cells_.count(); ++slice) {
      sum.strain += energies_[2 * slice];
      sum.stabilisation += energies_[2 * slice + 1];
    }
    return sum;
  }

  void linearise(std::span<const Vec3> u, const ParallelFor &parallelFor) override {
    pack(u, displacements_, parallelFor);
    tangents_.resize(cells_.count() * kTangentNumbers * kLanes<T>);
    const CellJob<T> job = this->job();
    runLoop(parallelFor, cells_.count(), kSliceGrain,
            [&](std::size_t begin, std::size_t end) { cellTangents(job, begin, end); });
    if (!others_.empty()) others_.linearise(u, parallelFor);
  }

  void differential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                    const ParallelFor &parallelFor) override {
    pack(du, displacements_, parallelFor);
    CellJob<T> job = this->job();
    job.viscousScale = static_cast<T>(viscousScale);
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, cells_.count(), kSliceGrain,
            [&](std::size_t begin, std::size_t end) { cellProducts(job, scalar, begin, end); });
    if (!others_.empty()) {
      others_.differential(du, viscousScale, parallelFor);
      takeOthers();
    }
    collect(df, parallelFor);
  }

  [[nodiscard]] std::size_t memory() const override {
    return bytesOf(cells_.corners) + bytesOf(cells_.numbers) + bytesOf(cells_.materials) + bytesOf(displacements_) + bytesOf(velocities_) +
           bytesOf(entries_) + bytesOf(ratios_) + bytesOf(tangents_) + bytesOf(energies_) + bytesOf(rows_.offsets) + bytesOf(rows_.indices) + others_.memory();
  }

 private:
  [[nodiscard]] CellJob<T> job() {
    CellJob<T> job;
    job.cells = &cells_;
    job.laws = laws_;
    job.modal = controlOf(constitution_, stencils_) == Control::modal;
    job.displacements = displacements_.data();
    job.entries = entries_.data();
    job.ratios = ratios_.data();
    job.tangents = tangents_.data();
    job.energies = energies_.data();
    return job;
  }

  // Where the force of every entry goes, and which entries every phyxel sums, ascending.
  void layEntries(const CellPlan &plan, std::size_t phyxels, std::size_t own) {
    std::vector<std::pair<Index, Index>> all;  // phyxel, place
    for (std::size_t slice = 0; slice < cells_.count(); ++slice)
      for (std::size_t j = 0; j < kCorners; ++j)
        for (std::size_t lane = 0; lane < plan.used[slice]; ++lane) {
          const std::size_t place = (slice * kCorners + j) * kLanes<T> + lane;
          all.emplace_back(cells_.corners[place], static_cast<Index>(place));
        }
    for (std::size_t k = 0; k < others_.entries().size(); ++k)
      all.emplace_back(stencils_.phyxels.indices[others_.entries()[k]], static_cast<Index>(own + k));
    std::sort(all.begin(), all.end());
    rows_.offsets.assign(phyxels + 1, 0);
    rows_.indices.reserve(all.size());
    for (const auto &[phyxel, place] : all) {
      ++rows_.offsets[phyxel + 1];
      rows_.indices.push_back(place);
    }
    for (std::size_t i = 0; i < phyxels; ++i) rows_.offsets[i + 1] += rows_.offsets[i];
    entries_.assign(4 * (own + others_.entries().size()), T(0));
  }

  // Relative to the first phyxel, so that a body far from where it was made loses no digits; in lattice axes.
  void pack(std::span<const Vec3> u, AlignedVector<T> &packed, const ParallelFor &parallelFor) const {
    packed.resize(4 * u.size());
    const Vec3 base = u.front();
    runLoop(parallelFor, u.size(), kPhyxelGrain, [&](std::size_t begin, std::size_t end) {
      T *out = packed.data();
      for (std::size_t i = begin; i < end; ++i) {
        const double x = u[i][0] - base[0], y = u[i][1] - base[1], z = u[i][2] - base[2];
        if (!turned_) {
          out[4 * i] = static_cast<T>(x);
          out[4 * i + 1] = static_cast<T>(y);
          out[4 * i + 2] = static_cast<T>(z);
          continue;
        }
        for (int c = 0; c < 3; ++c)
          out[4 * i + static_cast<std::size_t>(c)] = static_cast<T>(axes_[0][c] * x + axes_[1][c] * y + axes_[2][c] * z);
      }
    });
  }

  double evaluateOthers(std::span<const Vec3> u, std::span<const Vec3> v, const ParallelFor &parallelFor) {
    const double ratio = others_.evaluate(u, v, parallelFor);
    takeOthers();
    return ratio;
  }

  // Forces of the other points into their entries.
  void takeOthers() {
    T *out = entries_.data() + entries_.size() - 4 * others_.entries().size();
    for (std::size_t k = 0; k < others_.entries().size(); ++k) {
      const Vec3 f = stencils_.axes.transpose() * others_.force(k);
      for (int c = 0; c < 3; ++c) out[4 * k + static_cast<std::size_t>(c)] = static_cast<T>(f[c]);
    }
  }

  void collect(std::span<Vec3> forces, const ParallelFor &parallelFor) {
    runLoop(parallelFor, forces.size(), kPhyxelGrain, [&](std::size_t begin, std::size_t end) {
      const T *entries = entries_.data();
      const Index *indices = rows_.indices.data(), *offsets = rows_.offsets.data();
      for (std::size_t i = begin; i < end; ++i) {
        T sum[4] = {};
        for (Index k = offsets[i]; k < offsets[i + 1]; ++k) {
          const T *entry = entries + 4 * std::size_t{indices[k]};
          for (int c = 0; c < 4; ++c) sum[c] += entry[c];
        }
        const double x = sum[0], y = sum[1], z = sum[2];
        if (!turned_) {
          forces[i] = Vec3(x, y, z);
          continue;
        }
        for (int r = 0; r < 3; ++r) forces[i][r] = axes_[r][0] * x + axes_[r][1] * y + axes_[r][2] * z;
      }
    });
  }

  const StencilSet &stencils_;
  const Constitution constitution_;
  CellSlices<T> cells_;
  std::vector<LawNumbers<T>> laws_;
  OtherPoints others_;
  Csr rows_;                          // [phyxels] places in entries_
  AlignedVector<T> displacements_, velocities_;  // [phyxels][4]
  AlignedVector<T> entries_;          // [places][4]
  AlignedVector<T> ratios_;           // [slices]
  AlignedVector<T> tangents_;         // of differential(); empty before
  std::vector<double> energies_;      // [slices][2]
  double axes_[3][3];
  bool turned_ = false;
};

}  // namespace

std::unique_ptr<VectorForces> cellForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                           const Constitution &constitution, Precision precision) {
  std::vector<std::uint8_t> suits;
  // The kernel's neo-Hookean law is the one with the square of the logarithm.
  for (const Material &m : constitution.materials)
    suits.push_back(m.law != MaterialLaw::neoHookean || m.lambda() >= 0.0 ? 1 : 0);
  const bool single = precision == Precision::singlePrecision;
  const CellPlan plan = planCells(stencils, single ? kLanes<float> : kLanes<double>, suits);
  if (2 * plan.others.size() > stencils.pointCount()) return nullptr;
  if (single) return std::make_unique<CellForces<float>>(stencils, positions, constitution, plan);
  return std::make_unique<CellForces<double>>(stencils, positions, constitution, plan);
}

}  // namespace pointbased::detail
