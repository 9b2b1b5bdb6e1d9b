// SPDX-License-Identifier: Apache-2.0
#include "vector_forces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "entry_forces.h"
#include "kernels/cell_kernel.h"
#include "kernels/cell_layout.h"
#include "pointbased/engine.h"
#include "point_loops.h"

namespace pointbased::detail {
namespace {

using namespace kernels;

constexpr std::size_t kPhyxelGrain = 256, kSliceGrain = 8;

// What the kernels know: the answer to the present strain alone.
bool suits(const Material &m) {
  const bool law = m.law != MaterialLaw::neoHookean || m.lambda() >= 0.0;
  return law && !m.relaxes() && !m.plastic.enabled() && !(m.viscosity > 0.0);
}

double strayAnswer(const void *context, std::size_t material, const double *F, double *stress) {
  const auto &constitution = *static_cast<const Constitution *>(context);
  const Mat3 gradient = Eigen::Map<const Mat3>(F);
  const Material &m = constitution.materials[material];
  Eigen::Map<Mat3> answer(stress);
  answer = firstPiolaStress(m, gradient);
  return tangentRatio(m, gradient);
}

// The points that are no cells, in short runs, so that the loops of the scalar engine run over them alone.
class OtherPoints {
 public:
  explicit OtherPoints(std::span<const Index> points) {
    for (const Index q : points)
      if (!runs_.empty() && runs_.back().second == q && q - runs_.back().first < kPointGrain) {
        ++runs_.back().second;
      } else {
        runs_.emplace_back(q, q + 1);
      }
  }
  [[nodiscard]] bool empty() const { return runs_.empty(); }
  /// A parallelFor over them, whatever n is.
  [[nodiscard]] ParallelFor loop(const ParallelFor &parallelFor) const {
    return [this, &parallelFor](std::size_t, std::size_t, const std::function<void(std::size_t, std::size_t)> &body) {
      const auto some = [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) body(runs_[r].first, runs_[r].second);
      };
      parallelFor(runs_.size(), 1, std::cref(some));
    };
  }

 private:
  std::vector<std::pair<Index, Index>> runs_;
};

template <class T>
class Forces final : public VectorForces {
 public:
  Forces(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution, const CellPlan &plan)
      : stencils_(stencils), positions_(positions), constitution_(constitution), cells_(sliceCells<T>(stencils, plan)),
        others_(plan.others) {
    for (const Material &m : constitution_.materials) laws_.push_back(lawNumbers<T>(m, constitution_.stabilisation));
    const std::size_t n = positions.size(), own = cells_.count() * kCorners * kLanes<T>;
    displacements_.resize(4 * n);
    ratios_.resize(cells_.count());
    layEntries(plan, own);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) axes_[r][c] = stencils.axes(r, c);
    turned_ = stencils.axes != Mat3::Identity();
  }

  double evaluate(std::span<const Vec3> u, std::span<Vec3> forces, const ParallelFor &parallelFor) override {
    pack(u, parallelFor);
    const CellJob<T> job{&cells_, laws_, controlOf(constitution_, stencils_) == Control::modal, displacements_.data(),
                         entries_.data(), ratios_.data()};
    runLoop(parallelFor, cells_.count(), kSliceGrain, [&](std::size_t begin, std::size_t end) {
      cellForces(job, &strayAnswer, &constitution_, begin, end);
    });
    double ratio = 1.0;
    if (!others_.empty()) ratio = evaluateOthers(u, parallelFor);
    for (const T r : ratios_) {
      // A NaN must not be lost in the comparison.
      if (!(r <= ratio)) ratio = r;
      if (std::isnan(ratio)) break;
    }
    collect(forces, parallelFor);
    return ratio;
  }

  [[nodiscard]] std::size_t memory() const override {
    const auto bytes = [](const auto &v) { return v.capacity() * sizeof(v[0]); };
    return bytes(cells_.corners) + bytes(cells_.numbers) + bytes(cells_.materials) + bytes(displacements_) +
           bytes(entries_) + bytes(ratios_) + bytes(rows_.offsets) + bytes(rows_.indices) + bytes(otherEntries_) +
           bytes(otherForces_) + bytes(gradients_) + bytes(stresses_) + bytes(otherRatios_);
  }

 private:
  // Where the force of every entry goes, and which entries every phyxel sums, ascending.
  void layEntries(const CellPlan &plan, std::size_t own) {
    std::vector<std::pair<Index, Index>> all;  // phyxel, place
    for (std::size_t slice = 0; slice < cells_.count(); ++slice)
      for (std::size_t j = 0; j < kCorners; ++j)
        for (std::size_t lane = 0; lane < plan.used[slice]; ++lane) {
          const std::size_t place = (slice * kCorners + j) * kLanes<T> + lane;
          all.emplace_back(cells_.corners[place], static_cast<Index>(place));
        }
    for (const Index q : plan.others)
      for (Index e = stencils_.phyxels.offsets[q]; e < stencils_.phyxels.offsets[q + 1]; ++e) {
        all.emplace_back(stencils_.phyxels.indices[e], static_cast<Index>(own + otherEntries_.size()));
        otherEntries_.push_back(e);
      }
    std::sort(all.begin(), all.end());
    rows_.offsets.assign(positions_.size() + 1, 0);
    for (const auto &[phyxel, place] : all) {
      ++rows_.offsets[phyxel + 1];
      rows_.indices.push_back(place);
    }
    rows_.indices.shrink_to_fit();
    for (std::size_t i = 0; i < positions_.size(); ++i) rows_.offsets[i + 1] += rows_.offsets[i];
    entries_.assign(4 * (own + otherEntries_.size()), T(0));
    if (otherEntries_.empty()) return;
    otherForces_.resize(stencils_.phyxels.indices.size());
    gradients_.resize(stencils_.pointCount());
    stresses_.resize(stencils_.pointCount());
    otherRatios_.assign(stencils_.pointCount(), 1.0);
  }

  // Relative to the first phyxel, so that a body far from where it was made loses no digits; in lattice axes.
  void pack(std::span<const Vec3> u, const ParallelFor &parallelFor) {
    const Vec3 base = u.front();
    runLoop(parallelFor, u.size(), kPhyxelGrain, [&](std::size_t begin, std::size_t end) {
      T *out = displacements_.data();
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

  double evaluateOthers(std::span<const Vec3> u, const ParallelFor &parallelFor) {
    const ParallelFor loop = others_.loop(parallelFor);
    deformationGradients(stencils_, u, gradients_, loop);
    const double ratio = pointStresses(constitution_, stencils_, gradients_, {}, PointHistory(), 0.0, nullptr, stresses_,
                                       otherRatios_, loop);
    entryForcesOf(constitution_, stencils_, positions_, u, gradients_, stresses_, {}, otherForces_, loop);
    T *out = entries_.data() + entries_.size() - 4 * otherEntries_.size();
    for (std::size_t k = 0; k < otherEntries_.size(); ++k) {
      const Vec3 f = stencils_.axes.transpose() * otherForces_[otherEntries_[k]];
      for (int c = 0; c < 3; ++c) out[4 * k + static_cast<std::size_t>(c)] = static_cast<T>(f[c]);
    }
    return ratio;
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
  std::span<const Vec3> positions_;
  const Constitution constitution_;
  CellSlices<T> cells_;
  std::vector<LawNumbers<T>> laws_;
  OtherPoints others_;
  Csr rows_;                          // [phyxels] places in entries_
  AlignedVector<T> displacements_;    // [phyxels][4]
  AlignedVector<T> entries_;          // [places][4]
  AlignedVector<T> ratios_;           // [slices]
  double axes_[3][3];
  bool turned_ = false;
  // Of the other points; empty without them.
  std::vector<Index> otherEntries_;
  std::vector<Vec3> otherForces_;
  std::vector<Mat3> gradients_, stresses_;
  std::vector<double> otherRatios_;
};

}  // namespace

std::unique_ptr<VectorForces> vectorForces(const StencilSet &stencils, std::span<const Vec3> positions,
                                           const Constitution &constitution, Precision precision) {
  if (positions.empty() || stencils.modes.empty()) return nullptr;
  std::vector<std::uint8_t> suited;
  for (const Material &m : constitution.materials) {
    suited.push_back(suits(m) ? 1 : 0);
    // The scalar engine answers other points of the same body, but knows no history here.
    if (suited.back() == 0 && (m.relaxes() || m.plastic.enabled() || m.viscosity > 0.0)) return nullptr;
  }
  const bool single = precision == Precision::singlePrecision;
  const CellPlan plan = planCells(stencils, single ? kLanes<float> : kLanes<double>, suited);
  if (2 * plan.others.size() > stencils.pointCount()) return nullptr;
  if (single) return std::make_unique<Forces<float>>(stencils, positions, constitution, plan);
  return std::make_unique<Forces<double>>(stencils, positions, constitution, plan);
}

}  // namespace pointbased::detail
