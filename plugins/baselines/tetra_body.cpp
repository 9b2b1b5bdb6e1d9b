// SPDX-License-Identifier: Apache-2.0
#include "tetra_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace baselines {
namespace {

// Corners of a cell, x fastest; the cells beside one with the first five have the second.
constexpr std::array<std::array<std::array<std::uint8_t, 4>, 5>, 2> kDivisions{
    {{{{0, 3, 5, 6}, {0, 1, 3, 5}, {0, 2, 6, 3}, {0, 4, 5, 6}, {3, 5, 6, 7}}},
     {{{1, 2, 4, 7}, {0, 1, 2, 4}, {1, 2, 7, 3}, {1, 4, 5, 7}, {2, 4, 7, 6}}}}};

/// Below this part of its volume the law of neo-Hooke goes on straight, so that there is a way back from the other
/// side; at rest nothing may be there.
constexpr double kMinVolume = 0.1;

/// ln J and its derivative, straight below kMinVolume.
std::pair<double, double> logarithm(double J) {
  if (J >= kMinVolume) return {std::log(J), 1.0 / J};
  return {std::log(kMinVolume) + (J - kMinVolume) / kMinVolume, 1.0 / kMinVolume};
}

/// dJ/dF
Mat3d cofactor(const Mat3d &F) {
  Mat3d out;
  out.col(0) = F.col(1).cross(F.col(2));
  out.col(1) = F.col(2).cross(F.col(0));
  out.col(2) = F.col(0).cross(F.col(1));
  return out;
}

/// First Piola-Kirchhoff stress, Pa.
Mat3d stress(TetraBody::Law law, const Mat3d &F, double lambda, double mu) {
  const Mat3d one = Mat3d::Identity();
  switch (law) {
    case TetraBody::Law::linear: {
      const Mat3d e = 0.5 * (F + F.transpose()) - one;
      return 2.0 * mu * e + lambda * e.trace() * one;
    }
    case TetraBody::Law::corotated: {
      const Mat3d R = rotationOf(F);
      return 2.0 * mu * (F - R) + lambda * (F.cwiseProduct(R).sum() - 3.0) * R;
    }
    case TetraBody::Law::stVenantKirchhoff: {
      const Mat3d E = 0.5 * (F.transpose() * F - one);
      return F * (2.0 * mu * E + lambda * E.trace() * one);
    }
    case TetraBody::Law::neoHookean: {
      const auto [log, slope] = logarithm(F.determinant());
      return mu * F + (lambda * log - mu) * slope * cofactor(F);
    }
  }
  return Mat3d::Zero();
}

/// J/m³
double energy(TetraBody::Law law, const Mat3d &F, double lambda, double mu) {
  const Mat3d one = Mat3d::Identity();
  const auto ofStrain = [&](const Mat3d &e) { return mu * e.squaredNorm() + 0.5 * lambda * e.trace() * e.trace(); };
  switch (law) {
    case TetraBody::Law::linear: return ofStrain(0.5 * (F + F.transpose()) - one);
    case TetraBody::Law::corotated: return ofStrain(rotationOf(F).transpose() * F - one);
    case TetraBody::Law::stVenantKirchhoff: return ofStrain(0.5 * (F.transpose() * F - one));
    case TetraBody::Law::neoHookean: {
      const double log = logarithm(F.determinant()).first;
      return 0.5 * mu * (F.squaredNorm() - 3.0) - mu * log + 0.5 * lambda * log * log;
    }
  }
  return 0.0;
}

/// Largest eigenvalue of the stiffness of an element at rest, N/m.
double stiffnessOf(const Mat3d &inverse, double volume_m3, double lambda, double mu) {
  Eigen::Matrix<double, 3, 4> gradients;
  gradients.rightCols<3>() = inverse.transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  Eigen::Matrix<double, 12, 12> K;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const Eigen::Vector3d ga = gradients.col(a), gb = gradients.col(b);
      K.block<3, 3>(3 * a, 3 * b) =
          volume_m3 * (lambda * ga * gb.transpose() + mu * gb * ga.transpose() + mu * ga.dot(gb) * Mat3d::Identity());
    }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>>(K, Eigen::EigenvaluesOnly).eigenvalues()[11];
}

Eigen::Vector3d vector(const Vec3 &v) { return {v[0], v[1], v[2]}; }

}  // namespace

Mat3d rotationOf(const Mat3d &F) {
  // Newton's iteration, N. Higham, SIAM J. Sci. Stat. Comput. 7 (1986).
  if (F.determinant() > 1e-3 * std::pow(F.norm(), 3) / 5.2) {
    Mat3d R = F;
    for (int n = 0; n < 30; ++n) {
      const Mat3d next = 0.5 * (R + cofactor(R) / R.determinant());
      const double change = (next - R).squaredNorm();
      R = next;
      if (change < 1e-24) break;
    }
    return R;
  }
  const Eigen::JacobiSVD<Mat3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  return U * svd.matrixV().transpose();
}

TetraBody::TetraBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials, Law law)
    : PointBody(std::move(lattice), std::move(skin)), law_(law) {
  setMaterials(std::move(materials));
  bindSkin();
}

void TetraBody::setMaterials(std::vector<Elasticity> materials) {
  keepMaterials(std::move(materials));
  addMassesOfCells();
  tetrahedra_.clear();
  std::vector<double> bounds(points().size(), 0.0);
  const double h = lattice().spacing();
  const Vec3 origin = lattice().cells().front().low;
  // Of an element with Young's modulus 1 in a cell of edge 1, by what it depends on.
  std::map<std::pair<int, double>, double> known;
  for (std::size_t c = 0; c < lattice().cells().size(); ++c) {
    const Lattice::Cell &cell = lattice().cells()[c];
    const Elasticity &m = this->materials()[c];
    const double nu = m.poissonRatio, lambda = nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu = 0.5 / (1.0 + nu);
    long sum = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += std::lround((cell.low[a] - origin[a]) / h);
    const std::size_t parity = sum & 1;
    for (int n = 0; n < 5; ++n) {
      const auto &corners = kDivisions[parity][static_cast<std::size_t>(n)];
      Tetrahedron t;
      for (std::size_t k = 0; k < 4; ++k) t.nodes[k] = cell.nodes[corners[k]];
      Mat3d edges;
      const auto measure = [&] {
        for (int k = 0; k < 3; ++k)
          edges.col(k) = vector(points()[t.nodes[static_cast<std::size_t>(k) + 1]] - points()[t.nodes[0]]);
        return edges.determinant() / 6.0;
      };
      if (measure() < 0.0) std::swap(t.nodes[2], t.nodes[3]);
      const double whole_m3 = measure();
      t.inverse = edges.inverse();
      t.volume_m3 = cell.filled * whole_m3;
      t.lambda = m.youngsModulus_Pa * lambda;
      t.mu = m.youngsModulus_Pa * mu;
      const auto [found, isNew] = known.try_emplace({5 * static_cast<int>(parity) + n, nu}, 0.0);
      if (isNew) found->second = stiffnessOf(t.inverse * h, whole_m3 / (h * h * h), lambda, mu);
      for (const std::uint32_t node : t.nodes) bounds[node] += cell.filled * m.youngsModulus_Pa * h * found->second;
      tetrahedra_.push_back(t);
    }
  }
  double fastest = 0.0;
  for (std::size_t i = 0; i < bounds.size(); ++i) fastest = std::max(fastest, bounds[i] / masses()[i]);
  setStiffness(std::move(bounds), fastest, 0.0);
}

Mat3d TetraBody::gradient(const Tetrahedron &t) const {
  const auto &x = state().positions;
  Mat3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = vector(x[t.nodes[static_cast<std::size_t>(k) + 1]] - x[t.nodes[0]]);
  return edges * t.inverse;
}

void TetraBody::addInternalForces(double) {
  for (const Tetrahedron &t : tetrahedra_) {
    const Mat3d forces = -t.volume_m3 * stress(law_, gradient(t), t.lambda, t.mu) * t.inverse.transpose();
    Vec3 sum{};
    for (int k = 0; k < 3; ++k) {
      const Vec3 f{forces(0, k), forces(1, k), forces(2, k)};
      addForce(t.nodes[static_cast<std::size_t>(k) + 1], f);
      sum -= f;
    }
    addForce(t.nodes[0], sum);
  }
}

double TetraBody::elasticEnergy_J() const {
  double sum = 0.0;
  for (const Tetrahedron &t : tetrahedra_) sum += t.volume_m3 * energy(law_, gradient(t), t.lambda, t.mu);
  return sum;
}

std::string TetraBody::trouble() const {
  if (law_ != Law::neoHookean) return {};
  const auto flat = std::count_if(tetrahedra_.begin(), tetrahedra_.end(),
                                  [&](const Tetrahedron &t) { return gradient(t).determinant() < kMinVolume; });
  return flat == 0 ? "" : std::to_string(flat) + " tetrahedra are pressed flat or turned inside out";
}

}  // namespace baselines
