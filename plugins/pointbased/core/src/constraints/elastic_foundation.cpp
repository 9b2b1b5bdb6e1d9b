// SPDX-License-Identifier: Apache-2.0
#include "pointbased/elastic_foundation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/expects.h"
#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr std::size_t kRowGrain = 128;

}  // namespace

Result<void> validate(const Foundation &f) {
  const auto refuse = [](const char *what, double value, const char *unit) {
    return tl::make_unexpected(std::string(what) + " is " + detail::number(value) + " " + unit +
                               "; accepted: a finite number >= 0");
  };
  const auto good = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!good(f.stiffness)) return refuse("the stiffness of the foundation", f.stiffness, "Pa/m");
  if (!good(f.tangential)) return refuse("the tangential stiffness of the foundation", f.tangential, "Pa/m");
  if (!good(f.retardationTime)) return refuse("the retardation time of the foundation", f.retardationTime, "s");
  return {};
}

void ElasticFoundation::set(const Foundation &settings) {
  settings_ = settings;
  if (!bound()) return;
  if (settings_.stiffness == settings_.tangential)
    std::vector<Mat3>().swap(normals_);
  else if (normals_.empty())
    coupleNormals();
}

std::size_t ElasticFoundation::entryOf(Index row, Index column) const {
  const auto first = rows_.indices.begin() + rows_.offsets[row], last = rows_.indices.begin() + rows_.offsets[row + 1];
  return static_cast<std::size_t>(std::lower_bound(first, last, column) - rows_.indices.begin());
}

// visit(slot of i, slot of j, A_p φ_pi φ_pj, p) in the order of the points.
template <class Visit>
void ElasticFoundation::forPairs(const Visit &visit) const {
  const Csr &of = binding_.phyxels;
  const std::vector<double> &weights = binding_.weights;
  for (Index p = 0; p < points_.count(); ++p)
    for (Index e = of.offsets[p]; e < of.offsets[p + 1]; ++e)
      for (Index f = of.offsets[p]; f < of.offsets[p + 1]; ++f)
        visit(indexOf_[of.indices[e]], indexOf_[of.indices[f]], points_.areas[p] * weights[e] * weights[f], p);
}

void ElasticFoundation::bind(SurfacePoints points, Interpolation binding, std::size_t phyxels) {
  POINTBASED_EXPECTS(binding.count() == points.count(), "one binding per point of the surface");
  POINTBASED_EXPECTS(
      std::all_of(binding.phyxels.indices.begin(), binding.phyxels.indices.end(), [&](Index j) { return j < phyxels; }),
      "points are bound to phyxels that there are");
  points_ = std::move(points);
  binding_ = std::move(binding);
  area_ = std::accumulate(points_.areas.begin(), points_.areas.end(), 0.0);
  touched_ = binding_.phyxels.indices;
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  indexOf_.assign(phyxels, 0);
  for (std::size_t k = 0; k < touched_.size(); ++k) indexOf_[touched_[k]] = static_cast<Index>(k);

  std::vector<std::vector<Index>> columns(touched_.size());
  forPairs([&](Index row, Index column, double, Index) { columns[row].push_back(column); });
  rows_ = Csr();
  for (std::vector<Index> &row : columns) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    rows_.indices.insert(rows_.indices.end(), row.begin(), row.end());
    rows_.offsets.push_back(static_cast<Index>(rows_.indices.size()));
  }
  couplings_.assign(rows_.indices.size(), 0.0);
  forPairs([&](Index row, Index column, double share, Index) { couplings_[entryOf(row, column)] += share; });
  normals_.clear();
  touchedDisplacements_.assign(touched_.size(), Vec3::Zero());
  set(settings_);
}

void ElasticFoundation::coupleNormals() {
  normals_.assign(rows_.indices.size(), Mat3::Zero());
  forPairs([&](Index row, Index column, double share, Index p) {
    const Vec3 &N = points_.normals[p];
    normals_[entryOf(row, column)] += share * N * N.transpose();
  });
}

Vec3 ElasticFoundation::times(Index e, const Vec3 &w) const {
  if (normals_.empty()) return settings_.tangential * couplings_[e] * w;
  return settings_.tangential * couplings_[e] * w + (settings_.stiffness - settings_.tangential) * (normals_[e] * w);
}

Mat3 ElasticFoundation::block(Index e) const {
  Mat3 out = settings_.tangential * couplings_[e] * Mat3::Identity();
  if (!normals_.empty()) out += (settings_.stiffness - settings_.tangential) * normals_[e];
  return out;
}

double ElasticFoundation::energy(std::span<const Vec3> u) const {
  if (!acts()) return 0.0;
  POINTBASED_EXPECTS(u.size() == indexOf_.size(), "one displacement per phyxel");
  double energy = 0.0;
  for (Index k = 0; k < touched_.size(); ++k) {
    Vec3 sum = Vec3::Zero();
    for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e) sum += times(e, u[touched_[rows_.indices[e]]]);
    energy += 0.5 * u[touched_[k]].dot(sum);
  }
  return energy;
}

// out += scale · K · touchedDisplacements_
void ElasticFoundation::apply(double scale, std::span<Vec3> out, const ParallelFor &parallelFor) const {
  const bool isotropic = normals_.empty();
  const auto range = [&](std::size_t begin, std::size_t end) {
    for (auto k = static_cast<Index>(begin); k < end; ++k) {
      Vec3 sum = Vec3::Zero();
      if (isotropic) {
        // Isotropic: one number per entry.
        for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e)
          sum += couplings_[e] * touchedDisplacements_[rows_.indices[e]];
        sum *= settings_.tangential;
      } else {
        for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e)
          sum += times(e, touchedDisplacements_[rows_.indices[e]]);
      }
      out[touched_[k]] += scale * sum;
    }
  };
  parallelFor(touched_.size(), kRowGrain, std::cref(range));
}

void ElasticFoundation::addForces(std::span<const Vec3> u, std::span<const Vec3> velocities, std::span<Vec3> forces,
                                  const ParallelFor &parallelFor) const {
  if (!acts()) return;
  POINTBASED_EXPECTS(u.size() == indexOf_.size() && forces.size() == indexOf_.size(),
                     "one displacement and one force per phyxel");
  POINTBASED_EXPECTS(velocities.empty() || velocities.size() == indexOf_.size(), "one velocity per phyxel, or none");
  const bool damps = settings_.retardationTime > 0.0 && !velocities.empty();
  for (std::size_t k = 0; k < touched_.size(); ++k) {
    touchedDisplacements_[k] = u[touched_[k]];
    if (damps) touchedDisplacements_[k] += settings_.retardationTime * velocities[touched_[k]];
  }
  apply(-1.0, forces, parallelFor);
}

void ElasticFoundation::addProduct(double scale, std::span<const Vec3> du, std::span<Vec3> out,
                                   const ParallelFor &parallelFor) const {
  if (!acts()) return;
  POINTBASED_EXPECTS(du.size() == indexOf_.size() && out.size() == indexOf_.size(), "one vector per phyxel");
  for (std::size_t k = 0; k < touched_.size(); ++k) touchedDisplacements_[k] = du[touched_[k]];
  apply(scale, out, parallelFor);
}

void ElasticFoundation::addBlocks(double scale, std::span<Mat3> blocks) const {
  if (!acts()) return;
  POINTBASED_EXPECTS(blocks.size() == indexOf_.size(), "one block per phyxel");
  for (Index k = 0; k < touched_.size(); ++k)
    for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e)
      if (rows_.indices[e] == k) blocks[touched_[k]] += scale * block(e);
}

void ElasticFoundation::addTriplets(double scale, std::vector<Eigen::Triplet<double>> &out) const {
  if (!acts()) return;
  const bool isotropic = normals_.empty();
  for (Index k = 0; k < touched_.size(); ++k)
    for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e) {
      const Mat3 K = scale * block(e);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (r == c || !isotropic)
            out.emplace_back(static_cast<int>(3 * touched_[k]) + r,
                             static_cast<int>(3 * touched_[rows_.indices[e]]) + c, K(r, c));
    }
}

double ElasticFoundation::squaredFrequencyBound(std::span<const double> masses) const {
  if (!acts()) return 0.0;
  double largest = 0.0;
  for (Index k = 0; k < touched_.size(); ++k) {
    double sum = 0.0;
    for (Index e = rows_.offsets[k]; e < rows_.offsets[k + 1]; ++e)
      sum += block(e).cwiseAbs().rowwise().sum().maxCoeff() /
             std::sqrt(masses[touched_[k]] * masses[touched_[rows_.indices[e]]]);
    largest = std::max(largest, sum);
  }
  return largest;
}

}  // namespace pointbased
