// SPDX-License-Identifier: Apache-2.0
#include "kernels/cell_layout.h"

#include <algorithm>
#include <cmath>

#include "modes.h"

namespace pointbased::kernels {
namespace {

double sign(std::size_t corner, std::size_t axis) { return (corner >> axis & 1) != 0 ? 1.0 : -1.0; }

double modeSign(std::size_t corner, int mode) {
  const double x = sign(corner, 0), y = sign(corner, 1), z = sign(corner, 2);
  return mode == 0 ? x * y : mode == 1 ? x * z : mode == 2 ? y * z : x * y * z;
}

// What the stencil of a cell with these numbers has at corner j.
Vec3 gradientAt(const std::array<double, kCellNumbers> &n, std::size_t j) {
  const double xy = modeSign(j, 0), xz = modeSign(j, 1), yz = modeSign(j, 2), xyz = modeSign(j, 3);
  return {n[kGradient] * sign(j, 0) + n[kFirstY] * xy + n[kFirstZ] * xz + n[kMixedX] * xyz,
          n[kGradient] * sign(j, 1) + n[kFirstX] * xy + n[kFirstZ] * yz + n[kMixedY] * xyz,
          n[kGradient] * sign(j, 2) + n[kFirstX] * xz + n[kFirstY] * yz + n[kMixedZ] * xyz};
}

constexpr double kSame = 1e-11;  // relative: stencils carry the round-off of their making

}  // namespace

std::optional<std::array<double, kCellNumbers>> cellNumbers(const StencilSet &s, std::size_t q) {
  const Index first = s.phyxels.offsets[q];
  if (s.modes.empty() || !s.reference.empty() || s.rank[q] != 3 || s.phyxels.offsets[q + 1] - first != kCorners) return {};
  std::array<Vec3, kCorners> g;
  for (std::size_t j = 0; j < kCorners; ++j) g[j] = s.axes.transpose() * s.gradients[first + j];
  const auto mean = [&](auto &&value) {
    double sum = 0.0;
    for (std::size_t j = 0; j < kCorners; ++j) sum += value(j);
    return sum / static_cast<double>(kCorners);
  };
  std::array<double, kCellNumbers> n{};
  n[kGradient] = mean([&](std::size_t j) { return sign(j, 0) * g[j].x(); });
  n[kFirstX] = mean([&](std::size_t j) { return modeSign(j, 0) * g[j].y(); });
  n[kFirstY] = mean([&](std::size_t j) { return modeSign(j, 0) * g[j].x(); });
  n[kFirstZ] = mean([&](std::size_t j) { return modeSign(j, 1) * g[j].x(); });
  n[kMixedX] = mean([&](std::size_t j) { return modeSign(j, 3) * g[j].x(); });
  n[kMixedY] = mean([&](std::size_t j) { return modeSign(j, 3) * g[j].y(); });
  n[kMixedZ] = mean([&](std::size_t j) { return modeSign(j, 3) * g[j].z(); });
  std::array<double, 4> modes{};
  for (int m = 0; m < 4; ++m)
    modes[static_cast<std::size_t>(m)] = mean([&](std::size_t j) { return modeSign(j, m) * s.modes[first + j][m]; });
  for (std::size_t m = 0; m < 3; ++m) n[kModeXY + m] = modes[m];
  for (std::size_t j = 0; j < kCorners; ++j) {
    if (!((gradientAt(n, j) - g[j]).cwiseAbs().maxCoeff() <= kSame * n[kGradient])) return {};
    for (int m = 0; m < 4; ++m) {
      const double k = modes[static_cast<std::size_t>(m)];
      if (!(std::abs(k * modeSign(j, m) - s.modes[first + j][m]) <= kSame * std::abs(k))) return {};
    }
  }
  const Vec3 root = (s.volumes[q] * s.spreads[q]).cwiseSqrt();
  const double spread = s.spreads[q].mean();
  n[kVolume] = s.volumes[q];
  n[kRootX] = root[0];
  n[kRootY] = root[1];
  n[kRootZ] = root[2];
  n[kTwist] = s.volumes[q] * spread * spread * modes[3] * modes[3];
  return n;
}

CellPlan planCells(const StencilSet &s, std::size_t lanes, std::span<const std::uint8_t> suits) {
  CellPlan plan;
  std::vector<std::vector<Index>> byMaterial(suits.size());
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const std::size_t material = s.materials.empty() ? 0 : s.materials[q];
    if (suits[material] != 0 && cellNumbers(s, q)) {
      byMaterial[material].push_back(static_cast<Index>(q));
    } else {
      plan.others.push_back(static_cast<Index>(q));
    }
  }
  for (std::size_t m = 0; m < byMaterial.size(); ++m) {
    const std::vector<Index> &points = byMaterial[m];
    for (std::size_t first = 0; first < points.size(); first += lanes) {
      const std::size_t used = std::min(lanes, points.size() - first);
      for (std::size_t lane = 0; lane < lanes; ++lane) plan.points.push_back(points[first + std::min(lane, used - 1)]);
      plan.used.push_back(used);
      plan.materials.push_back(static_cast<std::uint16_t>(m));
    }
  }
  return plan;
}

template <class T>
CellSlices<T> sliceCells(const StencilSet &s, const CellPlan &plan) {
  constexpr std::size_t kSlice = kLanes<T>;
  CellSlices<T> out;
  out.materials = plan.materials;
  out.corners.resize(plan.points.size() * kCorners);
  out.numbers.resize(plan.points.size() * kCellNumbers);
  for (std::size_t slice = 0; slice < out.count(); ++slice)
    for (std::size_t lane = 0; lane < kSlice; ++lane) {
      const std::size_t q = plan.points[slice * kSlice + lane];
      std::array<double, kCellNumbers> n = *cellNumbers(s, q);
      if (lane >= plan.used[slice])
        for (const CellNumber extent : {kVolume, kRootX, kRootY, kRootZ, kTwist}) n[extent] = 0.0;
      for (std::size_t k = 0; k < kCellNumbers; ++k)
        out.numbers[(slice * kCellNumbers + k) * kSlice + lane] = static_cast<T>(n[k]);
      for (std::size_t j = 0; j < kCorners; ++j)
        out.corners[(slice * kCorners + j) * kSlice + lane] = s.phyxels.indices[s.phyxels.offsets[q] + j];
    }
  return out;
}

template <class T>
LawNumbers<T> lawNumbers(const Material &m, double stabilisation) {
  const detail::ModalEnergy modal(m, stabilisation);
  const double lambda = m.lambda() + m.volumeStiffness;
  LawNumbers<T> n;
  n.law = static_cast<int>(m.law);
  n.lambda = static_cast<T>(m.lambda());
  n.mu = static_cast<T>(m.mu());
  n.volume = static_cast<T>(m.volumeStiffness);
  n.modalMu = static_cast<T>(modal.mu());
  n.modalLambda = static_cast<T>(modal.lambda());
  n.modalTwist = static_cast<T>(modal.twistModulus());
  n.twoEta = static_cast<T>(2.0 * m.viscosity);
  n.waveAtRest = static_cast<T>(lambda + 2.0 * m.mu());
  n.allAtRest = static_cast<T>(std::max(3.0 * lambda, 0.0) + 2.0 * m.mu());
  return n;
}

template CellSlices<float> sliceCells<float>(const StencilSet &, const CellPlan &);
template CellSlices<double> sliceCells<double>(const StencilSet &, const CellPlan &);
template LawNumbers<float> lawNumbers<float>(const Material &, double);
template LawNumbers<double> lawNumbers<double>(const Material &, double);

}  // namespace pointbased::kernels
