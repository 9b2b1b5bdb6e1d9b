// SPDX-License-Identifier: Apache-2.0
// Vectorised forces of lattices.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "base/cancellation_poll.h"
#include "forces/kernels/cell_history_kernel.h"
#include "forces/kernels/cell_kernel.h"
#include "forces/kernels/cell_tangent_kernel.h"
#include "forces/kernels/quadratic_kernel.h"
#include "forces/kernels/quadratic_layout.h"
#include "forces/laminate.h"
#include "forces/relaxing_hourglass.h"
#include "forces/vector_forces_parts.h"
#include "forces/wave_stiffness.h"
#include "pointbased/plasticity.h"

namespace pointbased::detail {
namespace {

using namespace kernels;

PhyxelField fieldOf(std::span<const Vec3> field) {
  return {field.empty() ? nullptr : field.front().data(), field.size()};
}

// Plastic flow of one point, called by the kernel.
struct PointFlow {
  const Constitution &constitution;
  const Mat3 &axes;
  const HistoryStep &step;

  static void run(const void *context, std::size_t material, Index point, const double *F) {
    const auto &self = *static_cast<const PointFlow *>(context);
    const Mat3 world = self.axes * Eigen::Map<const Mat3>(F) * self.axes.transpose();
    (void)plasticFlow(self.constitution.materials[material].plastic, world, self.step.dt,
                      self.step.history.plasticInverse[point]);
  }
};

// History of the cells in the format of the kernel; empty for bodies without history.
class CellHistories {
 public:
  CellHistories(const Constitution &constitution, const CellPlan &plan)
      : materials_(constitution.hasHistory() ? constitution.materials.size() : 0) {
    if (materials_.empty()) return;
    points_ = plan.points;
    used_ = plan.used;
  }
  [[nodiscard]] bool any() const { return !materials_.empty(); }

  /// @param flow  must outlive the job
  [[nodiscard]] HistoryJob job(const Constitution &constitution, const HistoryStep &step, const PointFlow &flow) {
    HistoryJob job = energyJob(constitution, step.history);
    for (std::size_t m = 0; m < materials_.size(); ++m) {
      const Material &material = constitution.materials[m];
      if (materials_[m].flows) materials_[m].flowShare = flowShare(material.plastic, step.dt);
      if (!materials_[m].relaxes) continue;
      const PronyStep prony = pronyStep(material, step.dt);
      const RelaxingHourglass modes(material, constitution.stabilisation, prony.freshSum);
      materials_[m].keep = prony.keep;
      materials_[m].fresh = prony.fresh;
      materials_[m].old = prony.old;
      materials_[m].acrossOfPast = modes.acrossOfPast();
      materials_[m].acrossOfSum = modes.acrossOfSum();
    }
    static_assert(sizeof(PronyPoint) == 27 * sizeof(double) && sizeof(HourglassHistory) == 36 * sizeof(double));
    if (!step.history.prony.empty()) job.prony = step.history.prony.front().previous.data();
    if (!step.history.modes.empty()) job.modes = step.history.modes.front().previous.data();
    if (!step.history.plasticInverse.empty() && step.dt > 0.0) {
      job.flow = &PointFlow::run;
      job.flowContext = &flow;
    }
    return job;
  }

  [[nodiscard]] HistoryJob energyJob(const Constitution &constitution, const PointHistory &history) {
    for (std::size_t m = 0; m < materials_.size(); ++m) {
      const Material &material = constitution.materials[m];
      materials_[m].flows = !history.plasticInverse.empty() && material.plastic.enabled();
      materials_[m].relaxes = !history.prony.empty() && material.relaxes();
      // Same criterion as plasticFlow(), with a margin for rounding.
      const double limit = (1.0 - 1e-9) * material.plastic.yield / (1.0 + 2.0 * material.plastic.yield);
      materials_[m].elasticLimit2 = limit * limit;
      materials_[m].yield = material.plastic.yield;
      materials_[m].plasticMax = material.plastic.max;
    }
    HistoryJob job;
    job.points = points_;
    job.used = used_;
    job.materials = materials_;
    // Without plastic flow it is only read.
    if (!history.plasticInverse.empty())
      job.plasticInverse = const_cast<double *>(history.plasticInverse.front().data());
    return job;
  }

 private:
  std::vector<Index> points_;
  std::vector<std::size_t> used_;
  std::vector<MaterialHistory> materials_;
};

template <class T>
class CellForces final : public VectorForces {
 public:
  /// @param second  cells with functions of second order
  CellForces(const StencilSet &stencils, std::span<const Vec3> positions, std::span<const double> masses,
             const Constitution &constitution, const CellPlan &plan, const CellPlan &second, Laminates laminates,
             const ParallelFor &parallelFor)
      : stencils_(stencils), masses_(masses), constitution_(constitution), laminates_(std::move(laminates)),
        cells_(sliceCells<T>(stencils, plan, parallelFor, laminates_)),
        second_(sliceQuadraticCells<T>(stencils, second, parallelFor)), laws_(lawsOf<T>(constitution)),
        memories_(constitution, plan), fallback_(stencils, positions, constitution_, plan.others),
        turned_(stencils.axes != Mat3::Identity()) {
    laminates_.modes = {};
    layRows(positions.size());
    detail::checkCancelled(parallelFor);
    stiffnessAtRest_ = largestStiffnessAtRest(plan.others, parallelFor);
  }

  double evaluate(std::span<const Vec3> u, std::span<const Vec3> v, const HistoryStep &step, std::span<Vec3> forces,
                  const ParallelFor &parallelFor) override {
    CellJob<T> job = this->job(u);
    job.velocities = fieldOf(v);
    const ScalarLaw scalar = scalarLaw(constitution_);
    const PointFlow flow{constitution_, stencils_.axes, step};
    const HistoryJob history = memories_.any() ? memories_.job(constitution_, step, flow) : HistoryJob();
    forChunks(parallelFor, [&](std::size_t begin, std::size_t end) {
      if constexpr (std::is_same_v<T, double>) {
        if (memories_.any()) return cellHistoryForces(job, history, scalar, begin, end);
      }
      cellForces(job, scalar, begin, end);
    });
    forQuadraticChunks(job, parallelFor, [&](const CellJob<T> &second, std::size_t begin, std::size_t end) {
      quadraticForces(second, second_, scalar, begin, end);
    });
    if (!fallback_.empty()) {
      (void)fallback_.evaluate(u, v, step, parallelFor);
      takeOthers(true);
    }
    const double stiffness = collect(masses_, forces, parallelFor);
    // Round-off never makes a body softer than at rest.
    return stiffness <= stiffnessAtRest_ ? 1.0 : stiffness / stiffnessAtRest_;
  }

  [[nodiscard]] ElasticEnergy energy(std::span<const Vec3> u, const PointHistory &history,
                                     const ParallelFor &parallelFor) override {
    energies_.resize(2 * (cells_.count() + second_.cells.count()));
    const CellJob<T> job = this->job(u);
    const ScalarLaw scalar = scalarLaw(constitution_);
    const HistoryJob memory = memories_.any() ? memories_.energyJob(constitution_, history) : HistoryJob();
    forChunks(parallelFor, [&](std::size_t begin, std::size_t end) {
      if constexpr (std::is_same_v<T, double>) {
        if (memories_.any()) return cellHistoryEnergies(job, memory, scalar, begin, end);
      }
      cellEnergies(job, scalar, begin, end);
    });
    forQuadraticChunks(job, parallelFor, [&](const CellJob<T> &second, std::size_t begin, std::size_t end) {
      quadraticEnergies(second, second_, scalar, begin, end);
    });
    ElasticEnergy sum = fallback_.empty() ? ElasticEnergy() : fallback_.energy(u, history);
    for (std::size_t slice = 0; slice < energies_.size() / 2; ++slice) {
      sum.strain += energies_[2 * slice];
      sum.stabilisation += energies_[2 * slice + 1];
    }
    return sum;
  }

  void linearise(std::span<const Vec3> u, const ParallelFor &parallelFor) override {
    tangents_.resize(quadraticTangent() + second_.cells.count() * kQuadraticTangentNumbers * kLanes<T>);
    laminateTangents_.resize(cells_.laminateNumbers.size() / kLaminateNumbers * kLaminateTangentNumbers);
    const CellJob<T> job = this->job(u);
    const ScalarLaw scalar = scalarLaw(constitution_);
    forChunks(parallelFor, [&](std::size_t begin, std::size_t end) { cellTangents(job, scalar, begin, end); });
    forQuadraticChunks(job, parallelFor, [&](const CellJob<T> &second, std::size_t begin, std::size_t end) {
      quadraticTangents(second, second_, scalar, begin, end);
    });
    if (!fallback_.empty()) fallback_.linearise(u, parallelFor);
  }

  void differential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                    const ParallelFor &parallelFor) override {
    CellJob<T> job = this->job(du);
    job.viscousScale = static_cast<T>(viscousScale);
    const ScalarLaw scalar = scalarLaw(constitution_);
    forChunks(parallelFor, [&](std::size_t begin, std::size_t end) { cellProducts(job, scalar, begin, end); });
    forQuadraticChunks(job, parallelFor, [&](const CellJob<T> &second, std::size_t begin, std::size_t end) {
      quadraticProducts(second, second_, scalar, begin, end);
    });
    if (!fallback_.empty()) {
      fallback_.differential(du, viscousScale, parallelFor);
      takeOthers(false);
    }
    (void)collect({}, df, parallelFor);
  }

  void dropTangent() override {
    tangents_ = {};
    laminateTangents_ = {};
  }

  void toMaterials(std::span<Mat3> gradients) const override {
    toMaterialGradients(laminates_, stencils_, constitution_, gradients);
  }

 private:
  [[nodiscard]] CellJob<T> job(std::span<const Vec3> u) {
    CellJob<T> job;
    job.cells = &cells_;
    job.laws = laws_;
    job.hourglass = stabilisationOf(constitution_, stencils_) == Stabilisation::hourglass;
    setAxes(job);
    job.displacements = fieldOf(u);
    job.partials = partials_.data();
    job.tangents = tangents_.data();
    job.laminateTangents = laminateTangents_.data();
    job.energies = energies_.data();
    return job;
  }

  template <class Job>
  void setAxes(Job &job) const {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) job.axes[r][c] = stencils_.axes(r, c);
    job.turned = turned_;
  }

  template <class Body>
  void forChunks(const ParallelFor &parallelFor, const Body &body) const {
    runLoop(parallelFor, cells_.chunks(), 1, body);
  }

  // Calls body(job, begin, end) for the chunks of cells of second order.
  template <class Body>
  void forQuadraticChunks(CellJob<T> job, const ParallelFor &parallelFor, const Body &body) {
    if (second_.cells.chunks() == 0) return;
    job.cells = &second_.cells;
    job.partials += 4 * cells_.phyxels.size();
    job.tangents = tangents_.data() + (tangents_.empty() ? 0 : quadraticTangent());
    job.energies = energies_.data() + (energies_.empty() ? 0 : 2 * cells_.count());
    runLoop(parallelFor, second_.cells.chunks(), 1, [&](std::size_t begin, std::size_t end) { body(job, begin, end); });
  }
  [[nodiscard]] std::size_t quadraticTangent() const { return cells_.count() * kTangentNumbers * kLanes<T>; }
  /// Partials of all chunks.
  [[nodiscard]] std::size_t ofChunks() const { return cells_.phyxels.size() + second_.cells.phyxels.size(); }

  // Partials that every phyxel sums, ascending: first those of chunks, then entries of other points.
  void layRows(std::size_t phyxels) {
    const std::size_t trilinear = cells_.phyxels.size(), own = ofChunks(), all = own + fallback_.entries().size();
    const auto phyxelOf = [&](std::size_t place) {
      return place < trilinear ? cells_.phyxels[place]
             : place < own     ? second_.cells.phyxels[place - trilinear]
                               : stencils_.phyxels.indices[fallback_.entries()[place - own]];
    };
    rows_.offsets.assign(phyxels + 1, 0);
    for (std::size_t place = 0; place < all; ++place) ++rows_.offsets[phyxelOf(place) + 1];
    for (std::size_t i = 0; i < phyxels; ++i) rows_.offsets[i + 1] += rows_.offsets[i];
    rows_.indices.resize(all);
    std::vector<Index> next(rows_.offsets.begin(), rows_.offsets.end() - 1);
    for (std::size_t place = 0; place < all; ++place)
      rows_.indices[next[phyxelOf(place)]++] = static_cast<Index>(place);
    partials_.assign(4 * all, T(0));
  }

  // v (λ + 2 μ), the factor of |g|² in a stiffness at rest, N m.
  [[nodiscard]] double waveStiffness(std::size_t q) const {
    return stencils_.volumes[q] * materialOfPoint(constitution_, stencils_, q).waveModulus();
  }

  [[nodiscard]] double largestStiffnessAtRest(std::span<const Index> others, const ParallelFor &parallelFor) const {
    const std::vector<double> sums =
        waveStiffnesses(constitution_, stencils_, masses_.size(), parallelFor,
                        [&](std::size_t q) { return !std::ranges::binary_search(others, q); });
    double largest = 0.0;
    for (std::size_t i = 0; i < sums.size(); ++i) largest = std::max(largest, sums[i] / masses_[i]);
    return largest;
  }

  // Copies the forces of the other points to their slots, and their stiffness.
  void takeOthers(bool stiffness) {
    T *out = partials_.data() + 4 * ofChunks();
    for (std::size_t k = 0; k < fallback_.entries().size(); ++k) {
      const Vec3 f = stencils_.axes.transpose() * fallback_.force(k);
      for (int c = 0; c < 3; ++c) out[4 * k + static_cast<std::size_t>(c)] = static_cast<T>(f[c]);
      const Index entry = fallback_.entries()[k], q = stencils_.pointOfEntry(entry);
      out[4 * k + 3] =
          stiffness
              ? static_cast<T>(fallback_.ratio(q) * waveStiffness(q) * GradientRows(stencils_, q)[entry].squaredNorm())
              : T(0);
    }
  }

  // @return largest stiffness over mass, 1/s²
  double collect(std::span<const double> masses, std::span<Vec3> forces, const ParallelFor &parallelFor) {
    CollectJob<T> job;
    job.offsets = rows_.offsets;
    job.places = rows_.indices;
    job.partials = partials_.data();
    setAxes(job);
    job.forces = forces.front().data();
    job.masses = masses.empty() ? nullptr : masses.data();
    // Non-negative floating-point numbers and their bit patterns have the same order, with NaN last: a maximum without
    // a lock.
    std::atomic<std::uint64_t> largest{0};
    runLoop(parallelFor, forces.size(), kPhyxelGrain, [&](std::size_t begin, std::size_t end) {
      const auto here = std::bit_cast<std::uint64_t>(std::abs(collectForces(job, begin, end)));
      std::uint64_t known = largest.load(std::memory_order_relaxed);
      while (here > known && !largest.compare_exchange_weak(known, here, std::memory_order_relaxed)) {
      }
    });
    return std::bit_cast<double>(largest.load());
  }

  const StencilSet &stencils_;
  std::span<const double> masses_;
  const Constitution constitution_;
  Laminates laminates_;  // without modes, which are part of the slices
  CellSlices<T> cells_;
  QuadraticSlices<T> second_;
  std::vector<LawNumbers<T>> laws_;
  CellHistories memories_;
  ScalarFallback fallback_;
  bool turned_;
  Csr rows_;                      // [phyxels] indices into partials_
  AlignedVector<T> partials_;     // [partials][4]
  double stiffnessAtRest_ = 0.0;  // largest of all phyxels over their mass, 1/s²
  AlignedVector<T> tangents_;     // for differential(), first of cells_, then of second_; empty before
  AlignedVector<T> laminateTangents_;
  std::vector<double> energies_;  // [slices of cells_, then of second_][2]; empty before
};

}  // namespace

std::unique_ptr<VectorForces> cellForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                           std::span<const double> masses, const Constitution &constitution,
                                           Precision precision, const ParallelFor &parallelFor) {
  std::vector<std::uint8_t> suits;
  for (const Material &m : constitution.materials) suits.push_back(kernelKnows(m) ? 1 : 0);
  const bool single = precision == Precision::singlePrecision && !constitution.hasHistory();  // reason: see HistoryJob
  Laminates laminates = findLaminates(stencils, constitution);
  const std::size_t lanes = single ? kLanes<float> : kLanes<double>;
  CellPlan plan = planCells(stencils, lanes, suits, parallelFor, laminates), second;
  // The kernels of second order do not support history.
  if (!constitution.hasHistory()) second = planQuadraticCells(stencils, lanes, suits, plan.others);
  if (2 * plan.others.size() > stencils.pointCount()) return nullptr;
  if (single)
    return std::make_unique<CellForces<float>>(stencils, positions, masses, constitution, plan, second,
                                               std::move(laminates), parallelFor);
  return std::make_unique<CellForces<double>>(stencils, positions, masses, constitution, plan, second,
                                              std::move(laminates), parallelFor);
}

}  // namespace pointbased::detail
