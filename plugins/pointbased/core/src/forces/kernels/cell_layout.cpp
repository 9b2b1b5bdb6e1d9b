// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/cell_layout.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/cancellation_poll.h"
#include "forces/viscous_hourglass.h"

namespace pointbased::kernels {
namespace {

bool isWhole(const std::array<double, kCellNumbers> &n) {
  const double edge = 0.25 / n[kGradient];
  for (const CellNumber k : {kFirstX, kFirstY, kFirstZ, kMixedX, kMixedY, kMixedZ})
    if (std::abs(n[k]) > 1e-9 * n[kGradient]) return false;
  // Body volumes are scaled to the volume enclosed by the surface.
  return n[kVolume] > 0.5 * edge * edge * edge;
}

// Numbers of slices; equal ones, up to round-off, are stored once.
template <class T>
class Blocks {
 public:
  Index of(const StencilSet &s, std::span<const Index> points, std::size_t used) {
    std::vector<T> block(kCellNumbers * kLanes<T>);
    std::vector<std::int64_t> key;
    for (std::size_t lane = 0; lane < kLanes<T>; ++lane) {
      std::array<double, kCellNumbers> n = *cellNumbers(s, points[lane]);
      if (lane >= used)
        for (const CellNumber extent : {kVolume, kRootX, kRootY, kRootZ, kTwist}) n[extent] = 0.0;
      const double edge = 0.25 / n[kGradient], volume = edge * edge * edge, root = std::sqrt(volume) * edge;
      const std::array<double, kCellNumbers> unit = {unitGradient(n[kGradient]),
                                                     n[kGradient],
                                                     n[kGradient],
                                                     n[kGradient],
                                                     n[kGradient],
                                                     n[kGradient],
                                                     n[kGradient],
                                                     1.0 / (edge * edge),
                                                     1.0 / (edge * edge),
                                                     1.0 / (edge * edge),
                                                     1.0 / volume,
                                                     volume,
                                                     root,
                                                     root,
                                                     root,
                                                     edge};
      for (std::size_t k = 0; k < kCellNumbers; ++k) {
        block[k * kLanes<T> + lane] = static_cast<T>(n[k]);
        key.push_back(std::llround(n[k] / unit[k] * 1e12));
      }
    }
    bool whole = used == kLanes<T>;
    for (const Index q : points) whole = whole && isWhole(*cellNumbers(s, q));
    const auto [found, fresh] = known_.emplace(std::move(key), static_cast<Index>(known_.size()));
    if (fresh) {
      numbers_.insert(numbers_.end(), block.begin(), block.end());
      whole_.push_back(whole ? 1 : 0);
    }
    return found->second;
  }
  [[nodiscard]] std::vector<std::uint8_t> whole() { return std::move(whole_); }
  [[nodiscard]] AlignedVector<T> take() {
    numbers_.shrink_to_fit();
    return std::move(numbers_);
  }

 private:
  double unitGradient(double g) {
    if (!(first_ > 0.0)) first_ = g;
    return first_;
  }

  double first_ = 0.0;
  std::map<std::vector<std::int64_t>, Index> known_;
  AlignedVector<T> numbers_;
  std::vector<std::uint8_t> whole_;
};

template <class T>
void addLaminates(const StencilSet &s, std::span<const Index> points, std::size_t used,
                  const detail::Laminates &laminates, CellSlices<T> &out) {
  const bool isAny = std::any_of(points.begin(), points.end(), [&](Index q) { return laminates.at(q) != nullptr; });
  constexpr std::size_t kSize = kLaminateNumbers * kLanes<T>;
  out.laminates.push_back(isAny ? static_cast<Index>(out.laminateNumbers.size() / kSize) : kNoLaminate);
  if (!isAny) return;
  const std::size_t first = out.laminateNumbers.size();
  out.laminateNumbers.resize(first + kSize, T(0));
  for (std::size_t lane = 0; lane < used; ++lane) {
    const auto set = [&](std::size_t k, double value) {
      out.laminateNumbers[first + k * kLanes<T> + lane] = static_cast<T>(value);
    };
    if (!laminates.plain.empty()) {
      const detail::ModeForm modes = laminates.modesAt(s, points[lane]);
      for (std::size_t k = 0; k < modes.size(); ++k) set(kModeForm + k, modes[k]);
    }
    const detail::Laminate *laminate = laminates.at(points[lane]);
    if (laminate == nullptr) continue;
    for (std::size_t c = 0; c < 3; ++c) set(kNormalX + c, laminate->normal[static_cast<Eigen::Index>(c)]);
    set(kShare, laminate->share);
    set(kLimitSquared, laminate->limit * laminate->limit);
    for (const auto &[at, moduli] : {std::pair(kOwnModuli, laminate->own), std::pair(kOtherModuli, laminate->other)}) {
      set(at, moduli.shear);
      set(at + 1, moduli.trace);
      set(at + 2, moduli.across);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      set(kOtherFirst + c, laminate->first[static_cast<Eigen::Index>(c)]);
      set(kOtherFirst + 3 + c, laminate->mixed[static_cast<Eigen::Index>(c)]);
    }
  }
}

}  // namespace

std::optional<std::array<double, kCellNumbers>> cellNumbers(const StencilSet &s, std::size_t q) {
  const HangingCells::Point *hanging = s.hanging.find(q);
  const QuadraticPoints::Point *quadratic = s.quadratic.find(q);
  const auto shape = hanging != nullptr ? hanging->shape : quadratic != nullptr ? quadratic->corners : findShape(s, q);
  if (!shape) return {};
  if (hanging != nullptr && s.phyxels.row(q).size() > kMaxOfCell) return {};
  std::array<double, kCellNumbers> n{};
  n[kGradient] = shape->gradient;
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    n[kFirstX + k] = shape->first[c];
    n[kMixedX + k] = shape->mixed[c];
    n[kModeXY + k] = shape->modes[c];
  }
  const Vec3 root = (s.volumes[q] * s.variances[q]).cwiseSqrt();
  const double spread = s.variances[q].mean();
  n[kModeXYZ] = shape->modes[3];
  n[kVolume] = s.volumes[q];
  n[kRootX] = root[0];
  n[kRootY] = root[1];
  n[kRootZ] = root[2];
  n[kTwist] = s.volumes[q] * spread * spread * shape->modes[3] * shape->modes[3];
  return n;
}

CellPlan planCells(const StencilSet &s, std::size_t lanes, std::span<const std::uint8_t> suits,
                   const ParallelFor &parallelFor, const detail::Laminates &laminates) {
  CellPlan plan;
  detail::CancellationPoll look(parallelFor);
  std::vector<std::vector<Index>> byMaterial(suits.size());
  std::vector<std::uint8_t> whole(s.pointCount(), 0);
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    look();
    const std::size_t material = s.materials.empty() ? 0 : s.materials[q];
    const bool isTrilinear = s.quadratic.find(q) == nullptr;
    const auto numbers = isTrilinear && suits[material] != 0 ? cellNumbers(s, q) : std::nullopt;
    if (numbers) {
      byMaterial[material].push_back(static_cast<Index>(q));
      whole[q] = isWhole(*numbers) ? 1 : 0;
    } else {
      plan.others.push_back(static_cast<Index>(q));
    }
  }
  for (std::size_t m = 0; m < byMaterial.size(); ++m) {
    std::vector<Index> &points = byMaterial[m];
    for (std::size_t first = 0; first < points.size(); first += kChunkCells) {
      const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = points.begin() + static_cast<std::ptrdiff_t>(std::min(first + kChunkCells, points.size()));
      const auto cut = std::stable_partition(begin, end, [&](Index q) { return whole[q] != 0; });
      std::stable_partition(cut, end, [&](Index q) { return laminates.at(q) == nullptr; });
    }
    addSlices(points, static_cast<std::uint16_t>(m), lanes, plan);
  }
  return plan;
}

void addSlices(std::span<const Index> points, std::uint16_t material, std::size_t lanes, CellPlan &plan) {
  for (std::size_t first = 0; first < points.size(); first += lanes) {
    const std::size_t used = std::min(lanes, points.size() - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) plan.points.push_back(points[first + std::min(lane, used - 1)]);
    plan.used.push_back(used);
    plan.materials.push_back(material);
  }
}

namespace {

/// Corners of the points of a chunk, numbered: phyxels first, then hanging corners.
class ChunkCorners {
 public:
  explicit ChunkCorners(const StencilSet &s) : s_(s) {}

  void begin(std::span<const Index> points) {
    phyxels_.clear();
    hanging_.clear();
    for (const Index q : points) {
      const std::span<const Index> row = s_.phyxels.row(q);
      phyxels_.insert(phyxels_.end(), row.begin(), row.end());
      if (const HangingCells::Point *point = s_.hanging.find(q))
        for (const Index corner : point->corners)
          if ((corner & HangingCells::kHangs) != 0) hanging_.push_back(corner);
    }
    for (std::vector<Index> *some : {&phyxels_, &hanging_}) {
      std::ranges::sort(*some);
      some->erase(std::unique(some->begin(), some->end()), some->end());
    }
  }
  /// Local indices of the corners of a point of the chunk.
  [[nodiscard]] std::array<std::uint16_t, kCorners> of(Index q) const {
    const HangingCells::Point *point = s_.hanging.find(q);
    std::array<std::uint16_t, kCorners> out;
    for (std::size_t j = 0; j < kCorners; ++j)
      out[j] = local(point != nullptr ? point->corners[j] : s_.phyxels.row(q)[j]);
    return out;
  }
  template <class T>
  void end(CellSlices<T> &out) const {
    out.phyxels.insert(out.phyxels.end(), phyxels_.begin(), phyxels_.end());
    out.firstLocals.push_back(static_cast<Index>(out.phyxels.size()));
    for (const Index corner : hanging_) {
      const Index row = corner & ~HangingCells::kHangs;
      for (Index e = s_.hanging.phyxels.offsets[row]; e < s_.hanging.phyxels.offsets[row + 1]; ++e) {
        out.followed.push_back(local(s_.hanging.phyxels.indices[e]));
        out.followedWeights.push_back(static_cast<T>(s_.hanging.weights[e]));
      }
      out.followedRows.push_back(static_cast<Index>(out.followed.size()));
    }
    out.firstHanging.push_back(static_cast<Index>(out.followedRows.size() - 1));
  }

 private:
  [[nodiscard]] std::uint16_t local(Index corner) const {
    const bool hangs = (corner & HangingCells::kHangs) != 0;
    const std::vector<Index> &all = hangs ? hanging_ : phyxels_;
    const auto place = std::ranges::lower_bound(all, corner) - all.begin();
    return static_cast<std::uint16_t>((hangs ? phyxels_.size() : 0) + static_cast<std::size_t>(place));
  }

  const StencilSet &s_;
  std::vector<Index> phyxels_, hanging_;  // ascending
};

}  // namespace

template <class T>
CellSlices<T> sliceCells(const StencilSet &s, const CellPlan &plan, const ParallelFor &parallelFor,
                         const detail::Laminates &laminates) {
  constexpr std::size_t kSlice = kLanes<T>;
  CellSlices<T> out;
  out.materials = plan.materials;
  out.corners.resize(plan.points.size() * kCorners);
  Blocks<T> blocks;
  ChunkCorners chunk(s);
  for (std::size_t begin = 0; begin < out.count(); begin += kChunkSlices<T>) {
    const std::size_t end = std::min(out.count(), begin + kChunkSlices<T>);
    if (begin / kChunkSlices<T> % 64 == 0) detail::checkCancelled(parallelFor);
    chunk.begin(std::span(plan.points).subspan(begin * kSlice, (end - begin) * kSlice));
    for (std::size_t slice = begin; slice < end; ++slice) {
      const std::span<const Index> points = std::span(plan.points).subspan(slice * kSlice, kSlice);
      for (std::size_t lane = 0; lane < kSlice; ++lane) {
        const auto corners = chunk.of(points[lane]);
        for (std::size_t j = 0; j < kCorners; ++j) out.corners[(slice * kCorners + j) * kSlice + lane] = corners[j];
      }
      addLaminates(s, points, plan.used[slice], laminates, out);
      out.blocks.push_back(blocks.of(s, points, plan.used[slice]));
    }
    chunk.end(out);
  }
  out.phyxels.shrink_to_fit();
  out.numbers = blocks.take();
  out.whole = blocks.whole();
  return out;
}

template <class T>
LawNumbers<T> lawNumbers(const Material &m, double stabilisation) {
  const detail::HourglassEnergy hourglass(m, stabilisation);
  const double lambda = m.lambda() + m.volumeStiffness;
  LawNumbers<T> n;
  n.law = static_cast<int>(m.law);
  n.lambda = static_cast<T>(m.lambda());
  n.mu = static_cast<T>(m.mu());
  n.volume = static_cast<T>(m.volumeStiffness);
  n.hourglassMu = static_cast<T>(hourglass.mu());
  n.hourglassLambda = static_cast<T>(hourglass.lambda());
  n.hourglassTwist = static_cast<T>(hourglass.twistModulus());
  const detail::HourglassEnergy viscous = detail::viscousHourglass(m, stabilisation);
  n.viscousMu = static_cast<T>(viscous.mu());
  n.viscousLambda = static_cast<T>(viscous.lambda());
  n.viscousTwist = static_cast<T>(viscous.twistModulus());
  n.twoEta = static_cast<T>(2.0 * m.viscosity);
  n.waveAtRest = static_cast<T>(lambda + 2.0 * m.mu());
  n.allAtRest = static_cast<T>(std::max(3.0 * lambda, 0.0) + 2.0 * m.mu());
  return n;
}

template CellSlices<float> sliceCells<float>(const StencilSet &, const CellPlan &, const ParallelFor &,
                                             const detail::Laminates &);
template CellSlices<double> sliceCells<double>(const StencilSet &, const CellPlan &, const ParallelFor &,
                                               const detail::Laminates &);
template LawNumbers<float> lawNumbers<float>(const Material &, double);
template LawNumbers<double> lawNumbers<double>(const Material &, double);

}  // namespace pointbased::kernels
