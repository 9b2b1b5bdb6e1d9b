// SPDX-License-Identifier: Apache-2.0
#include "matching/warped_response.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "matching/factor_kernel.h"
#include "pointbased/engine.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kGrain = 64;
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
  const auto &L = solver_.matrixL().nestedExpression();
  factor_.assign(L.valuePtr(), L.valuePtr() + L.nonZeros());
}

void WarpedResponse::deform(std::span<const Vec3> v, std::span<Vec3> u, const ParallelFor &parallelFor) {
  const StencilSet &s = rest_.stencils;
  const std::size_t n = rest_.phyxelCount();
  std::vector<Mat3> gradients(rest_.pointCount());
  deformationGradients(s, v, gradients, parallelFor);
  points_.resize(rest_.pointCount());
  std::vector<Vec3> turnAt(rest_.pointCount());
  parallelFor(points_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Mat3 H = (gradients[q] - Mat3::Identity()) * startInverse_[q];
      turnAt[q] = turnOf(H);
      points_[q] = {rotationBy(turnAt[q]), stretchOf(H), rightJacobian(turnAt[q])};
    }
  });
  std::vector<Vec3> turns(n, Vec3::Zero());
  std::vector<double> volumes(n, 0.0);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), 3);
  for (std::size_t q = 0; q < points_.size(); ++q) {
    const Mat3 A = points_[q].rotation * points_[q].stretch - Mat3::Identity();
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      const Index k = s.phyxels.indices[e];
      turns[k] += s.volumes[q] * turnAt[q];
      volumes[k] += s.volumes[q];
      right.row(k) += (A * arms_[e]).transpose();
    }
  }
  rotations_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    rotations_[i] = volumes[i] > 0.0 ? rotationBy(turns[i] / volumes[i]) : Mat3(Mat3::Identity());
    right.row(static_cast<Eigen::Index>(i)) += holding_[i] * v[i].transpose();
  }
  const Eigen::MatrixXd x = solver_.solve(right);
  for (std::size_t i = 0; i < n; ++i) u[i] = start_[i] + x.row(static_cast<Eigen::Index>(i)).transpose();
}

void WarpedResponse::setResponses(const ResponseMatrix &responses, const ParallelFor &parallelFor) {
  const Eigen::Index count = responses.cols() / 3, padded = (count + kBlock - 1) / kBlock * kBlock;
  count_ = static_cast<std::size_t>(count);
  responses_.setZero(responses.rows(), 3 * padded);
  for (Eigen::Index c = 0; c < 3; ++c)
    responses_.middleCols(c * padded, count) = responses.middleCols(c * count, count);
  gradients_.setZero(static_cast<Eigen::Index>(9 * rest_.pointCount()), padded);
  parallelFor(static_cast<std::size_t>(count), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> v(rest_.phyxelCount());
    std::vector<Mat3> gradients(rest_.pointCount());
    for (auto p = static_cast<Eigen::Index>(begin); p < static_cast<Eigen::Index>(end); ++p) {
      for (std::size_t i = 0; i < v.size(); ++i)
        for (Eigen::Index c = 0; c < 3; ++c) v[i][c] = responses(static_cast<Eigen::Index>(i), c * count + p);
      deformationGradients(rest_.stencils, v, gradients, serialFor());
      for (std::size_t q = 0; q < gradients.size(); ++q) {
        const Mat3 H = (gradients[q] - Mat3::Identity()) * startInverse_[q], strain = strainOf(H);
        Eigen::Matrix<double, 9, 1> both;
        both << turnOf(H), strain.diagonal(), strain(0, 1), strain(0, 2), strain(1, 2);
        gradients_.block<9, 1>(static_cast<Eigen::Index>(9 * q), p) = both.cast<float>();
      }
    }
  });
}

WarpedResponse::Change WarpedResponse::changeAt(const Point &point) {
  constexpr std::array<std::array<Eigen::Index, 2>, 6> kEntries{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  Change out;
  const auto set = [&](Eigen::Index column, const Mat3 &A) {
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index c = 0; c < 3; ++c) out(3 * row + c, column) = static_cast<float>(A(row, c));
  };
  for (Eigen::Index a = 0; a < 3; ++a) set(a, point.rotation * crossMatrix(point.turn.col(a)) * point.stretch);
  for (std::size_t k = 0; k < kEntries.size(); ++k) {
    Mat3 strain = Mat3::Zero();
    strain(kEntries[k][0], kEntries[k][1]) = strain(kEntries[k][1], kEntries[k][0]) = 1.0;
    // Exact where the change of the strain commutes with it.
    set(3 + static_cast<Eigen::Index>(k), 0.5 * point.rotation * (strain * point.stretch + point.stretch * strain));
  }
  return out;
}

void WarpedResponse::differentiate(ResponseMatrix &out, const ParallelFor &parallelFor) const {
  using Values = Eigen::Array<float, kBlock, 1>;
  const Csr &phyxels = rest_.stencils.phyxels;
  std::vector<Change> changes(points_.size());
  parallelFor(points_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) changes[q] = changeAt(points_[q]);
  });
  const Eigen::Index padded = gradients_.cols();
  out.resize(responses_.rows(), responses_.cols());
  parallelFor(static_cast<std::size_t>(padded / kBlock), 1, [&](std::size_t begin, std::size_t end) {
    Block right(responses_.rows(), 3 * kBlock);
    for (std::size_t block = begin; block < end; ++block) {
      const Eigen::Index first = kBlock * static_cast<Eigen::Index>(block);
      for (Eigen::Index i = 0; i < right.rows(); ++i)
        for (Eigen::Index c = 0; c < 3; ++c)
          right.row(i).segment<kBlock>(c * kBlock) = static_cast<float>(holding_[static_cast<std::size_t>(i)]) *
                                                     responses_.row(i).segment<kBlock>(c * padded + first);
      for (std::size_t q = 0; q < changes.size(); ++q) {
        std::array<Values, 9> A;
        for (Eigen::Index row = 0; row < 9; ++row) {
          Values sum = Values::Zero();
          for (Eigen::Index k = 0; k < 9; ++k)
            sum += changes[q](row, k) *
                   gradients_.row(static_cast<Eigen::Index>(9 * q) + k).segment<kBlock>(first).transpose().array();
          A[static_cast<std::size_t>(row)] = sum;
        }
        for (Index e = phyxels.offsets[q]; e < phyxels.offsets[q + 1]; ++e) {
          const Eigen::Vector3f arm = arms_[e].cast<float>();
          for (std::size_t c = 0; c < 3; ++c)
            right.row(phyxels.indices[e]).segment<kBlock>(static_cast<Eigen::Index>(c) * kBlock).array() +=
                (arm[0] * A[3 * c] + arm[1] * A[3 * c + 1] + arm[2] * A[3 * c + 2]).transpose();
        }
      }
      solve(right);
      for (Eigen::Index c = 0; c < 3; ++c)
        out.middleCols<kBlock>(c * padded + first) = right.middleCols<kBlock>(c * kBlock);
    }
  });
}

void WarpedResponse::solve(Block &b) const {
  const auto &L = solver_.matrixL().nestedExpression();
  Block x = solver_.permutationP() * b;
  kernels::solveFactor({static_cast<std::size_t>(x.rows()), L.outerIndexPtr(), L.innerIndexPtr(), factor_.data()},
                       x.data());
  b = solver_.permutationPinv() * x;
}

}  // namespace pointbased::detail
