// SPDX-License-Identifier: Apache-2.0
#include "reference/body.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numeric>
#include <utility>

namespace reference {
namespace {

void massesFromDensity(Body &body) {
  const Neighborhoods &n = body.neighborhoods;
  const std::size_t count = body.X.size();
  const auto cube = [&](std::size_t i) { return n.meanDistances[i] * n.meanDistances[i] * n.meanDistances[i]; };

  // s is the mean over the phyxels of what would give each the density of the material.
  double s = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = cube(i) * n.selfWeights[i];
    for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) sum += cube(n.neighbors[k]) * n.weights[k];
    s += 1.0 / sum / static_cast<double>(count);
  }
  for (std::size_t i = 0; i < count; ++i) body.mass[i] = s * cube(i) * body.material.density;
  for (std::size_t i = 0; i < count; ++i) {
    body.density[i] = body.mass[i] * n.selfWeights[i];
    for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k)
      body.density[i] += body.mass[n.neighbors[k]] * n.weights[k];
    body.volume[i] = body.mass[i] / body.density[i];
  }
}

void massesFromVolume(Body &body, std::span<const double> cellVolumes, double bodyVolume) {
  const double sum = std::accumulate(cellVolumes.begin(), cellVolumes.end(), 0.0);
  for (std::size_t i = 0; i < body.X.size(); ++i) {
    body.volume[i] = cellVolumes[i] * bodyVolume / sum;
    body.density[i] = body.material.density;
    body.mass[i] = body.density[i] * body.volume[i];
  }
}

// A = sum_j w X_ij X_ij^T, its pseudo-inverse without small singular values, and d_j = A^-1 X_ij w.
void momentMatrix(Body &body, std::size_t i) {
  const Neighborhoods &n = body.neighborhoods;
  Mat3 A = Mat3::Zero();
  for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) {
    const Vec3 Xij = body.X[n.neighbors[k]] - body.X[i];
    A += n.weights[k] * Xij * Xij.transpose();
  }

  const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 values = svd.singularValues();  // descending
  const double cutOff = body.errata.absoluteCutOff ? kAbsoluteCutOff : kRelativeCutOff * values[0];
  Mat3 inverse = Mat3::Zero();
  int rank = 0;
  while (rank < 3 && values[rank] > 0.0 && values[rank] >= cutOff) {
    inverse += svd.matrixV().col(rank) * svd.matrixU().col(rank).transpose() / values[rank];
    ++rank;
  }
  body.singularValues[i] = values;
  body.rank[i] = rank;
  body.frame[i] = svd.matrixV();

  body.dSelf[i].setZero();
  for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) {
    body.d[k] = n.weights[k] * (inverse * (body.X[n.neighbors[k]] - body.X[i]));
    body.dSelf[i] -= body.d[k];
  }
}

// What a flat neighbourhood cannot see turns with what it sees.
Mat3 completed(const Mat3 &J, int rank, const Mat3 &frame) {
  if (rank == 0) return Mat3::Identity();
  const Vec3 t1 = frame.col(0), t2 = frame.col(1);
  const Vec3 a = J * t1;
  if (rank == 1) {
    const Mat3 R = Eigen::Quaterniond::FromTwoVectors(t1, a).toRotationMatrix();
    return a * t1.transpose() + R * (Mat3::Identity() - t1 * t1.transpose());
  }
  const Vec3 b = J * t2;
  return a * t1.transpose() + b * t2.transpose() + a.cross(b).normalized() * t1.cross(t2).transpose();
}

// The rows are the cross products of the rows of J: d|J|/dJ.
Mat3 cofactor(const Mat3 &J) {
  Mat3 out;
  out.row(0) = J.row(1).cross(J.row(2));
  out.row(1) = J.row(2).cross(J.row(0));
  out.row(2) = J.row(0).cross(J.row(1));
  return out;
}

}  // namespace

Mat3 stress(const Material &material, const Mat3 &e) {
  const double nu = material.poissonRatio;
  const double c = material.youngsModulus / ((1.0 + nu) * (1.0 - 2.0 * nu));
  Mat3 s = c * (1.0 - 2.0 * nu) * e;
  s.diagonal().array() += c * nu * e.trace();
  return s;
}

Mat3 strain(const Mat3 &J, const Errata &errata) {
  Mat3 e;
  if (errata.printedStrain) {
    e.noalias() = J * J.transpose();
  } else {
    e.noalias() = J.transpose() * J;
  }
  e -= Mat3::Identity();
  return errata.factorFour ? e : Mat3(0.5 * e);
}

Body buildBody(std::span<const Vec3> positions, Neighborhoods neighborhoods, const Material &material,
               std::span<const double> cellVolumes, double bodyVolume, const Errata &errata) {
  const std::size_t n = positions.size();
  Body body;
  body.errata = errata;
  body.material = material;
  body.neighborhoods = std::move(neighborhoods);
  body.X.assign(positions.begin(), positions.end());
  body.u.assign(n, Vec3::Zero());
  body.velocity.assign(n, Vec3::Zero());
  body.force.assign(n, Vec3::Zero());
  body.mass.resize(n);
  body.density.resize(n);
  body.volume.resize(n);
  body.singularValues.resize(n);
  body.rank.resize(n);
  body.frame.resize(n);
  body.d.resize(body.neighborhoods.neighbors.size());
  body.dSelf.resize(n);
  body.J.assign(n, Mat3::Identity());
  body.plasticStrain.assign(n, Mat3::Zero());

  if (errata.densityVolumes) {
    massesFromDensity(body);
  } else {
    massesFromVolume(body, cellVolumes, bodyVolume);
  }
  for (std::size_t i = 0; i < n; ++i) momentMatrix(body, i);
  return body;
}

Mat3 deformation(const Body &body, std::size_t i) {
  const Neighborhoods &n = body.neighborhoods;
  Mat3 J = Mat3::Identity();
  for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k)
    J += (body.u[n.neighbors[k]] - body.u[i]) * body.d[k].transpose();
  if (body.rank[i] < 3 && !body.errata.truncatedFit) J = completed(J, body.rank[i], body.frame[i]);
  return J;
}

void computeForces(Body &body) {
  const Neighborhoods &n = body.neighborhoods;
  const double factor = body.errata.factorFour ? 2.0 : 1.0;
  const double kv = body.material.volumeStiffness;
  for (Vec3 &f : body.force) f.setZero();

  for (std::size_t i = 0; i < body.X.size(); ++i) {
    const Mat3 J = deformation(body, i);
    Mat3 e = strain(J, body.errata);
    if (body.material.plasticity) e -= body.plasticStrain[i];
    const Mat3 sigma = stress(body.material, e);

    Mat3 Q = -factor * body.volume[i] * (J * sigma);
    if (kv > 0.0) Q -= body.volume[i] * kv * (J.determinant() - 1.0) * cofactor(J);
    for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k) body.force[n.neighbors[k]] += Q * body.d[k];
    body.force[i] += Q * body.dSelf[i];
    body.J[i] = J;
  }
}

double elasticEnergy(const Body &body) {
  double sum = 0.0;
  for (std::size_t i = 0; i < body.X.size(); ++i) {
    const Mat3 J = deformation(body, i);
    const Mat3 e = strain(J, body.errata) - body.plasticStrain[i];
    const double dilation = J.determinant() - 1.0;
    sum += 0.5 * body.volume[i] *
           (e.cwiseProduct(stress(body.material, e)).sum() + body.material.volumeStiffness * dilation * dilation);
  }
  return sum;
}

double kineticEnergy(const Body &body) {
  double sum = 0.0;
  for (std::size_t i = 0; i < body.X.size(); ++i) sum += 0.5 * body.mass[i] * body.velocity[i].squaredNorm();
  return sum;
}

void flow(Body &body, double dt) {
  if (!body.material.plasticity) return;
  const Plasticity &p = *body.material.plasticity;
  const double part = body.errata.creepPerStep ? p.creep : 1.0 - std::exp(-dt / p.creepTime);
  for (std::size_t i = 0; i < body.X.size(); ++i) {
    const Mat3 total = strain(body.J[i], body.errata);
    const Mat3 elastic = total - body.plasticStrain[i];
    if (elastic.norm() <= p.yield) continue;
    Mat3 growth = part * (body.errata.creepOfTotalStrain ? total : elastic);
    if (!body.errata.plasticVolume) growth -= growth.trace() / 3.0 * Mat3::Identity();
    body.plasticStrain[i] += growth;
    const double norm = body.plasticStrain[i].norm();
    if (norm > p.maximum) body.plasticStrain[i] *= p.maximum / norm;
  }
}

void step(Body &body, double dt) {
  const std::size_t n = body.X.size();
  if (body.errata.forwardEuler) {
    // (6.9) as printed: the velocity on the right is that of t - dt/2.
    for (std::size_t i = 0; i < n; ++i) {
      body.u[i] += dt * body.velocity[i];
      body.velocity[i] += dt / body.mass[i] * body.force[i];
    }
    computeForces(body);
  } else {
    // (6.10)
    for (std::size_t i = 0; i < n; ++i) {
      body.velocity[i] += 0.5 * dt / body.mass[i] * body.force[i];
      body.u[i] += dt * body.velocity[i];
    }
    computeForces(body);
    for (std::size_t i = 0; i < n; ++i) body.velocity[i] += 0.5 * dt / body.mass[i] * body.force[i];
  }
  flow(body, dt);
}

}  // namespace reference
