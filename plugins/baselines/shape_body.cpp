// SPDX-License-Identifier: Apache-2.0
#include "shape_body.h"

#include <Eigen/LU>
#include <limits>

#include "tetra_body.h"

namespace baselines {
namespace {

Eigen::Vector3d vector(const Vec3 &v) { return {v[0], v[1], v[2]}; }

}  // namespace

ShapeBody::ShapeBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, int reach, double linear)
    : PointBody(std::move(lattice), std::move(skin)), linear_(linear) {
  const auto &cells = this->lattice().cells();
  const double h = this->lattice().spacing();
  const Vec3 origin = cells.front().low;
  const auto placeOf = [&](const Lattice::Cell &cell) {
    std::array<long, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = std::lround((cell.low[a] - origin[a]) / h);
    return at;
  };
  std::map<std::array<long, 3>, std::uint32_t> cellAt;
  for (std::uint32_t c = 0; c < cells.size(); ++c) cellAt.emplace(placeOf(cells[c]), c);
  for (const Lattice::Cell &cell : cells) {
    const auto at = placeOf(cell);
    auto &own = cells_.emplace_back();
    for (long k = -reach; k <= reach; ++k)
      for (long j = -reach; j <= reach; ++j)
        for (long i = -reach; i <= reach; ++i)
          if (const auto found = cellAt.find({at[0] + i, at[1] + j, at[2] + k}); found != cellAt.end())
            own.push_back(found->second);
  }
  setMaterials(std::move(materials));
  bindSkin();
}

void ShapeBody::setMaterials(std::vector<Elasticity> materials) {
  keepMaterials(std::move(materials));
  addMassesOfCells();
  clusters_.clear();
  const auto &cells = lattice().cells();
  const double cell_m3 = lattice().spacing() * lattice().spacing() * lattice().spacing();
  std::vector<double> shares(cells.size(), 0.0), bounds(points().size(), 0.0), clustersAt = bounds;
  for (const auto &own : cells_)
    for (const std::uint32_t c : own) shares[c] += 1.0;
  for (const auto &own : cells_) {
    Cluster cluster;
    double stiffness = 0.0;
    for (const std::uint32_t c : own) {
      cluster.nodes.insert(cluster.nodes.end(), cells[c].nodes.begin(), cells[c].nodes.end());
      stiffness += this->materials()[c].youngsModulus_Pa * cells[c].filled * cell_m3 / shares[c];
    }
    std::sort(cluster.nodes.begin(), cluster.nodes.end());
    cluster.nodes.erase(std::unique(cluster.nodes.begin(), cluster.nodes.end()), cluster.nodes.end());
    const double count = static_cast<double>(cluster.nodes.size());
    for (const std::uint32_t n : cluster.nodes) cluster.middle += (1.0 / count) * points()[n];
    Eigen::Matrix3d secondMoment = Eigen::Matrix3d::Zero();
    for (const std::uint32_t n : cluster.nodes) {
      const Eigen::Vector3d r = vector(points()[n] - cluster.middle);
      secondMoment += r * r.transpose();
      clustersAt[n] += 1.0;
    }
    cluster.inverse = secondMoment.inverse();
    cluster.stiffness_N_m = stiffness / (secondMoment.trace() / 3.0);
    for (const std::uint32_t n : cluster.nodes) bounds[n] += cluster.stiffness_N_m;
    clusters_.push_back(std::move(cluster));
  }
  double fastest = 0.0;
  for (std::size_t i = 0; i < bounds.size(); ++i) fastest = std::max(fastest, bounds[i] / masses()[i]);
  for (Cluster &cluster : clusters_) {
    cluster.cap_kg = std::numeric_limits<double>::infinity();
    for (const std::uint32_t n : cluster.nodes) cluster.cap_kg = std::min(cluster.cap_kg, masses()[n] / clustersAt[n]);
  }
  // The step that is chosen where none is asked for reaches no cap.
  setStiffness(std::move(bounds), 1.1 * fastest, 0.0);
}

double ShapeBody::stiffnessOf(const Cluster &cluster) const {
  return step_s_ > 0.0 ? std::min(cluster.stiffness_N_m, cluster.cap_kg / (step_s_ * step_s_)) : cluster.stiffness_N_m;
}

template <class Each>
void ShapeBody::forGoals(const Cluster &cluster, const Each &each) const {
  const auto &x = state().positions;
  const double count = static_cast<double>(cluster.nodes.size());
  Vec3 middle{};
  for (const std::uint32_t n : cluster.nodes) middle += x[n];
  middle = (1.0 / count) * middle;
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  for (const std::uint32_t n : cluster.nodes)
    A.noalias() += vector(x[n] - middle) * vector(points()[n] - cluster.middle).transpose();
  Eigen::Matrix3d goal = rotationOf(A);
  if (linear_ > 0.0) {
    Eigen::Matrix3d F = A * cluster.inverse;
    const double J = F.determinant();
    if (J > 0.0) F /= std::cbrt(J);  // the volume is kept
    goal = linear_ * F + (1.0 - linear_) * goal;
  }
  for (const std::uint32_t n : cluster.nodes) {
    const Eigen::Vector3d to = goal * vector(points()[n] - cluster.middle);
    each(n, Vec3{to[0], to[1], to[2]} + middle - x[n]);
  }
}

void ShapeBody::addInternalForces(double dt_s) {
  step_s_ = dt_s;
  for (const Cluster &cluster : clusters_) {
    const double k = stiffnessOf(cluster);
    forGoals(cluster, [&](std::uint32_t n, const Vec3 &way) { addForce(n, k * way); });
  }
}

double ShapeBody::elasticEnergy_J() const {
  double sum = 0.0;
  for (const Cluster &cluster : clusters_) {
    const double k = stiffnessOf(cluster);
    forGoals(cluster, [&](std::uint32_t, const Vec3 &way) { sum += 0.5 * k * dot(way, way); });
  }
  return sum;
}

}  // namespace baselines
