// SPDX-License-Identifier: Apache-2.0
// Vectorised forces of clouds.
#include "base/cancellation_poll.h"
#include "forces/cloud_stabilisation.h"
#include "forces/kernels/cloud_kernel.h"
#include "forces/vector_forces_parts.h"

namespace pointbased::detail {
namespace {

using namespace kernels;

// Phyxels with a full stencil, by material; the others still need their share of pairs with those.
struct CloudPlan {
  std::vector<Index> points;             // [slices][lanes]
  std::vector<std::uint16_t> materials;  // [slices]
  std::vector<Index> others;

  CloudPlan(const StencilSet &s, std::size_t lanes, std::span<const std::uint8_t> suits) : full(s.pointCount(), 0) {
    std::vector<std::vector<Index>> rows(suits.size());
    for (std::size_t q = 0; q < s.pointCount(); ++q) {
      const std::size_t material = s.materials.empty() ? 0 : s.materials[q];
      full[q] = s.rank[q] == 3 && suits[material] != 0;
      if (!full[q]) others.push_back(static_cast<Index>(q));
      rows[material].push_back(static_cast<Index>(q));
    }
    for (std::size_t m = 0; m < rows.size(); ++m)
      for (std::size_t first = 0; first < rows[m].size(); first += lanes) {
        for (std::size_t lane = 0; lane < lanes; ++lane)
          points.push_back(first + lane < rows[m].size() ? rows[m][first + lane] : kNoPoint);
        materials.push_back(static_cast<std::uint16_t>(m));
      }
  }

  std::vector<std::uint8_t> full;  // [points]
};

template <class T>
class CloudForces final : public VectorForces {
 public:
  CloudForces(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution,
              const CloudPlan &plan, const ParallelFor &parallelFor)
      : stencils_(stencils), positions_(positions), constitution_(constitution), points_(plan.points),
        materials_(plan.materials), laws_(lawsOf<T>(constitution)),
        fallback_(stencils, positions, constitution_, plan.others) {
    const std::size_t n = positions.size();
    layPairs(stencils, positions, plan.full, parallelFor);
    layPoints(stencils, positions, plan.full, parallelFor);
    tensors_.assign(16 * n, T(0));
    own_.assign(4 * n, T(0));
    ratios_.resize(materials_.size());
    for (std::size_t k = 0; k < fallback_.entries().size(); ++k)
      phyxelOfOther_.push_back(stencils.phyxels.indices[fallback_.entries()[k]]);
  }

  double evaluate(std::span<const Vec3> u, std::span<const Vec3> v, const HistoryStep &step, std::span<Vec3> forces,
                  const ParallelFor &parallelFor) override {
    pack(u, displacements_, parallelFor);
    if (!v.empty()) pack(v, velocities_, parallelFor);
    CloudJob<T> job = this->job();
    if (!v.empty()) job.velocities = velocities_.data();
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, materials_.size(), 1,
            [&](std::size_t begin, std::size_t end) { cloudTensors(job, scalar, begin, end); });
    collect(job, forces, parallelFor);
    const double others = fallback_.empty() ? 1.0 : fallback_.evaluate(u, v, step, parallelFor);
    addOthers(forces);
    return largestRatio<T>(ratios_, others);
  }

  [[nodiscard]] ElasticEnergy energy(std::span<const Vec3> u, const PointHistory &history,
                                     const ParallelFor &parallelFor) override {
    gradients_.resize(stencils_.pointCount());
    deformationGradients(stencils_, u, gradients_, parallelFor);
    return elasticEnergy(constitution_, stencils_, positions_, u, gradients_, history);
  }

  void linearise(std::span<const Vec3> u, const ParallelFor &parallelFor) override {
    pack(u, displacements_, parallelFor);
    tangents_.resize(materials_.size() * kTangentNumbers * kLanes<T>);
    const CloudJob<T> job = this->job();
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, materials_.size(), 1,
            [&](std::size_t begin, std::size_t end) { cloudTangents(job, scalar, begin, end); });
    if (!fallback_.empty()) fallback_.linearise(u, parallelFor);
  }

  void differential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                    const ParallelFor &parallelFor) override {
    pack(du, displacements_, parallelFor);
    CloudJob<T> job = this->job();
    job.viscousScale = static_cast<T>(viscousScale);
    const ScalarLaw scalar = scalarLaw(constitution_);
    runLoop(parallelFor, materials_.size(), 1,
            [&](std::size_t begin, std::size_t end) { cloudProducts(job, scalar, begin, end); });
    collect(job, df, parallelFor);
    if (!fallback_.empty()) fallback_.differential(du, viscousScale, parallelFor);
    addOthers(df);
  }

  void dropTangent() override { tangents_ = {}; }

 private:
  [[nodiscard]] CloudJob<T> job() {
    CloudJob<T> job;
    job.offsets = offsets_;
    job.neighbours = neighbours_;
    job.weights = weights_.data();
    job.places = places_.data();
    job.points = points_;
    job.materials = materials_;
    job.numbers = numbers_.data();
    job.laws = laws_;
    job.displacements = displacements_.data();
    job.tensors = tensors_.data();
    job.own = own_.data();
    job.ratios = ratios_.data();
    job.tangents = tangents_.data();
    return job;
  }

  // Relative to the first phyxel, so that no digits are lost far from the initial position.
  void pack(std::span<const Vec3> u, AlignedVector<T> &packed, const ParallelFor &parallelFor) const {
    packed.resize(4 * u.size());
    const Vec3 base = u.front();
    runLoop(parallelFor, u.size(), kPhyxelGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t c = 0; c < 3; ++c)
          packed[4 * i + c] = static_cast<T>(u[i][static_cast<int>(c)] - base[static_cast<int>(c)]);
    });
  }

  void collect(const CloudJob<T> &job, std::span<Vec3> forces, const ParallelFor &parallelFor) {
    runLoop(parallelFor, forces.size(), 16,
            [&](std::size_t begin, std::size_t end) { cloudForces(job, forces.front().data(), begin, end); });
  }

  void addOthers(std::span<Vec3> forces) {
    for (std::size_t k = 0; k < phyxelOfOther_.size(); ++k) forces[phyxelOfOther_[k]] += fallback_.force(k);
  }

  // Stiffness of the control of a point divided by the factor of its weights; 0 for points that the kernel does not
  // handle.
  double controlOfPoint(const StencilSet &s, std::size_t q, bool full) const {
    if (!full || detail::stabilisationOf(constitution_, s) != Stabilisation::isotropic) return 0.0;
    return s.weightFactors[q] *
           residualScale(materialOfPoint(constitution_, s, q), constitution_.stabilisation, s.volumes[q]);
  }

  void layPairs(const StencilSet &s, std::span<const Vec3> X, std::span<const std::uint8_t> full,
                const ParallelFor &parallelFor) {
    CancellationPoll look(parallelFor);
    const std::size_t n = X.size();
    offsets_.assign(1, 0);
    places_.resize(4 * n);
    for (std::size_t q = 0; q < n; ++q) {
      look();
      for (Index e = s.phyxels.offsets[q] + 1; e < s.phyxels.offsets[q + 1]; ++e) {
        neighbours_.push_back(s.phyxels.indices[e]);
        weights_.push_back(static_cast<T>(s.weights[e] / s.weightFactors[q]));
      }
      offsets_.push_back(static_cast<Index>(neighbours_.size()));
      for (std::size_t c = 0; c < 3; ++c) places_[4 * q + c] = static_cast<T>(X[q][static_cast<int>(c)]);
      places_[4 * q + 3] = static_cast<T>(controlOfPoint(s, q, full[q] != 0));
    }
    neighbours_.shrink_to_fit();
    weights_.shrink_to_fit();
  }

  void layPoints(const StencilSet &s, std::span<const Vec3> X, std::span<const std::uint8_t> full,
                 const ParallelFor &parallelFor) {
    constexpr std::size_t kSlice = kLanes<T>;
    numbers_.assign(materials_.size() * kCloudNumbers * kSlice, T(0));
    runLoop(parallelFor, points_.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; ++at) {
        const Index q = points_[at];
        if (q == kNoPoint || full[q] == 0) continue;
        Mat3 A = Mat3::Zero();
        Vec3 rest = Vec3::Zero();
        for (Index e = s.phyxels.offsets[q] + 1; e < s.phyxels.offsets[q + 1]; ++e) {
          const Vec3 d = X[s.phyxels.indices[e]] - X[q];
          const double w = s.weights[e] / s.weightFactors[q];
          A += w * d * d.transpose();
          rest += w * d;
        }
        const Mat3 inverse = A.inverse();
        T *numbers = numbers_.data() + at / kSlice * kCloudNumbers * kSlice + at % kSlice;
        const auto set = [&](CloudNumber which, double value) { numbers[which * kSlice] = static_cast<T>(value); };
        set(kInverseXX, inverse(0, 0));
        set(kInverseYY, inverse(1, 1));
        set(kInverseZZ, inverse(2, 2));
        set(kInverseXY, inverse(0, 1));
        set(kInverseXZ, inverse(0, 2));
        set(kInverseYZ, inverse(1, 2));
        set(kRestX, rest[0]);
        set(kRestY, rest[1]);
        set(kRestZ, rest[2]);
        set(kCloudVolume, s.volumes[q]);
        set(kControl, controlOfPoint(s, q, true));
      }
    });
  }

  const StencilSet &stencils_;
  std::span<const Vec3> positions_;
  const Constitution constitution_;
  std::vector<Index> offsets_, neighbours_;
  AlignedVector<T> weights_, places_;
  std::vector<Index> points_;
  std::vector<std::uint16_t> materials_;
  AlignedVector<T> numbers_;
  std::vector<LawNumbers<T>> laws_;
  ScalarFallback fallback_;
  std::vector<Index> phyxelOfOther_;  // [entries of other points]
  AlignedVector<T> displacements_, velocities_, tensors_, own_, ratios_, tangents_;
  std::vector<Mat3> gradients_;  // for energy(); empty before
};

}  // namespace

std::unique_ptr<VectorForces> cloudForcesOf(const StencilSet &stencils, std::span<const Vec3> positions,
                                            const Constitution &constitution, Precision precision,
                                            const ParallelFor &parallelFor) {
  if (stencils.weightFactors.empty()) return nullptr;
  std::vector<std::uint8_t> suits;
  for (const Material &m : constitution.materials) suits.push_back(kernelKnows(m) ? 1 : 0);
  const bool single = precision == Precision::singlePrecision;
  const CloudPlan plan(stencils, single ? kLanes<float> : kLanes<double>, suits);
  if (2 * plan.others.size() > stencils.pointCount()) return nullptr;
  if (single) return std::make_unique<CloudForces<float>>(stencils, positions, constitution, plan, parallelFor);
  return std::make_unique<CloudForces<double>>(stencils, positions, constitution, plan, parallelFor);
}

}  // namespace pointbased::detail
