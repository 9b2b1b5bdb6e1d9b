// SPDX-License-Identifier: Apache-2.0
#include "matching/warped_response.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "pointbased/engine.h"

namespace pointbased::detail {
namespace {

constexpr double kHeld = 1e3, kFree = 1e-5;  // weight of v, over that of the points around a phyxel

Mat3 crossMatrix(const Vec3 &v) {
  Mat3 out;
  out << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return out;
}

Mat3 rotationBy(const Vec3 &turn) {
  const double angle = turn.norm();
  return angle > 0.0 ? Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()) : Mat3(Mat3::Identity());
}

// exp(ω + dω) = exp(ω) exp(J dω) to first order.
Mat3 rightJacobian(const Vec3 &turn) {
  constexpr double kSmall = 1e-4;  // rad: below, the first terms of both series are exact in double
  const double t = turn.norm();
  const double a = t > kSmall ? (1.0 - std::cos(t)) / (t * t) : 0.5;
  const double b = t > kSmall ? (t - std::sin(t)) / (t * t * t) : 1.0 / 6.0;
  const Mat3 cross = crossMatrix(turn);
  return Mat3::Identity() - a * cross + b * cross * cross;
}

Vec3 turnOf(const Mat3 &H) { return 0.5 * Vec3(H(2, 1) - H(1, 2), H(0, 2) - H(2, 0), H(1, 0) - H(0, 1)); }

Mat3 strainOf(const Mat3 &H) { return 0.5 * (H + H.transpose()); }

Mat3 stretchOf(const Mat3 &H) {
  const Eigen::SelfAdjointEigenSolver<Mat3> strain(strainOf(H));
  return strain.eigenvectors() * strain.eigenvalues().array().exp().matrix().asDiagonal() *
         strain.eigenvectors().transpose();
}

}  // namespace

WarpedResponse::WarpedResponse(const Body &body)
    : rest_(body.rest()), start_(body.state().displacements), holding_(rest_.phyxelCount(), kFree) {
  const StencilSet &s = rest_.stencils;
  const std::size_t n = rest_.phyxelCount();
  std::vector<Mat3> gradients(rest_.pointCount());
  deformationGradients(s, start_, gradients, serialFor());
  for (const Mat3 &F : gradients) startInverse_.push_back(F.inverse());
  std::vector<Eigen::Triplet<double>> triplets;
  std::vector<double> diagonal(n, 0.0);
  for (std::size_t q = 0; q < rest_.pointCount(); ++q) {
    const auto row = s.phyxels.row(q);
    const double share = s.volumes[q] / static_cast<double>(row.size());
    Vec3 centre = Vec3::Zero();
    for (const Index k : row) centre += (rest_.positions[k] + start_[k]) / static_cast<double>(row.size());
    for (const Index k : row) arms_.emplace_back(s.volumes[q] * (rest_.positions[k] + start_[k] - centre));
    for (const Index a : row) {
      diagonal[a] += s.volumes[q] - share;
      triplets.emplace_back(a, a, s.volumes[q]);
      for (const Index b : row) triplets.emplace_back(a, b, -share);
    }
  }
  for (const ConstrainedRegion &held : rest_.conditions.held) {
    for (const Index i : held.phyxels) holding_[i] = kHeld;
    for (const Index i : held.rows.indices) holding_[i] = kHeld;
  }
  for (std::size_t i = 0; i < n; ++i) {
    holding_[i] *= diagonal[i] > 0.0 ? diagonal[i] : rest_.volumes[i];
    triplets.emplace_back(i, i, holding_[i]);
  }
  Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  solver_.compute(matrix);
}

template <class Matrix, class Gradient>
void WarpedResponse::gather(const Gradient &gradientOf, Matrix &&out) const {
  using Scalar = typename std::decay_t<Matrix>::Scalar;
  const Csr &phyxels = rest_.stencils.phyxels;
  for (std::size_t q = 0; q < rest_.pointCount(); ++q) {
    const Mat3 A = gradientOf(q);
    for (Index e = phyxels.offsets[q]; e < phyxels.offsets[q + 1]; ++e)
      out.row(phyxels.indices[e]) += (A * arms_[e]).transpose().template cast<Scalar>();
  }
}

void WarpedResponse::deform(std::span<const Vec3> v, std::span<Vec3> u, const ParallelFor &parallelFor) {
  const StencilSet &s = rest_.stencils;
  const std::size_t n = rest_.phyxelCount();
  std::vector<Mat3> gradients(rest_.pointCount());
  deformationGradients(s, v, gradients, parallelFor);
  points_.resize(rest_.pointCount());
  std::vector<Vec3> turns(n, Vec3::Zero());
  std::vector<double> volumes(n, 0.0);
  for (std::size_t q = 0; q < points_.size(); ++q) {
    const Mat3 H = (gradients[q] - Mat3::Identity()) * startInverse_[q];
    const Vec3 turn = turnOf(H);
    points_[q] = {rotationBy(turn), stretchOf(H), rightJacobian(turn)};
    for (const Index k : s.phyxels.row(q)) {
      turns[k] += s.volumes[q] * turn;
      volumes[k] += s.volumes[q];
    }
  }
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), 3);
  gather([&](std::size_t q) { return Mat3(points_[q].rotation * points_[q].stretch - Mat3::Identity()); }, right);
  rotations_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    rotations_[i] = volumes[i] > 0.0 ? rotationBy(turns[i] / volumes[i]) : Mat3(Mat3::Identity());
    right.row(static_cast<Eigen::Index>(i)) += holding_[i] * v[i].transpose();
  }
  const Eigen::MatrixXd x = solver_.solve(right);
  for (std::size_t i = 0; i < n; ++i) u[i] = start_[i] + x.row(static_cast<Eigen::Index>(i)).transpose();
}

void WarpedResponse::solve(Columns &b) const {
  const auto &L = solver_.matrixL().nestedExpression();
  Columns x = solver_.permutationP() * b;
  for (Eigen::Index j = 0; j < x.rows(); ++j) {
    const double *value = L.valuePtr() + L.outerIndexPtr()[j];
    const int *row = L.innerIndexPtr() + L.outerIndexPtr()[j], *end = L.innerIndexPtr() + L.outerIndexPtr()[j + 1];
    x.row(j) /= *value;
    for (++row, ++value; row != end; ++row, ++value) x.row(*row) -= *value * x.row(j);
  }
  for (Eigen::Index j = x.rows() - 1; j >= 0; --j) {
    const double *diagonal = L.valuePtr() + L.outerIndexPtr()[j], *value = diagonal;
    const int *row = L.innerIndexPtr() + L.outerIndexPtr()[j], *end = L.innerIndexPtr() + L.outerIndexPtr()[j + 1];
    for (++row, ++value; row != end; ++row, ++value) x.row(j) -= *value * x.row(*row);
    x.row(j) /= *diagonal;
  }
  b = solver_.permutationPinv() * x;
}

void WarpedResponse::addDerivative(std::span<const Vec3> dv, Eigen::Ref<Eigen::MatrixXf> out) const {
  std::vector<Mat3> gradients(rest_.pointCount());
  deformationGradients(rest_.stencils, dv, gradients, serialFor());
  gather(
      [&](std::size_t q) {
        const Mat3 H = (gradients[q] - Mat3::Identity()) * startInverse_[q];
        const Point &at = points_[q];
        const Mat3 strain = strainOf(H);
        // Exact where the change of the strain commutes with it.
        return Mat3(at.rotation * (crossMatrix(at.turn * turnOf(H)) * at.stretch +
                                   0.5 * (strain * at.stretch + at.stretch * strain)));
      },
      out);
  for (std::size_t i = 0; i < dv.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) += (holding_[i] * dv[i]).transpose().cast<float>();
}

}  // namespace pointbased::detail
