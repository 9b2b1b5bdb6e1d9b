// SPDX-License-Identifier: Apache-2.0
#include "matching/match_springs.h"

#include <algorithm>

namespace pointbased::detail {

void MatchSprings::clear() { *this = MatchSprings(); }

void MatchSprings::add(Index phyxel, double weight) {
  for (Index e = rows_.offsets.back(); e < rows_.indices.size(); ++e)
    if (rows_.indices[e] == phyxel) {
      weights_[e] += weight;
      return;
    }
  rows_.indices.push_back(phyxel);
  weights_.push_back(weight);
}

void MatchSprings::finish(const Mat3 &A, const Vec3 &r, const Columns &C) {
  rows_.offsets.push_back(static_cast<Index>(rows_.indices.size()));
  stiffness_.push_back(A);
  residuals_.push_back(r);
  columns_.push_back(C);
}

Vec3 MatchSprings::residual(std::size_t i, std::span<const Vec3> v) const {
  Vec3 r = residuals_[i];
  for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e) r -= weights_[e] * v[rows_.indices[e]];
  return r;
}

double MatchSprings::energy(std::span<const Vec3> v) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < count(); ++i) {
    const Vec3 r = residual(i, v);
    sum += 0.5 * r.dot(stiffness_[i] * r);
  }
  return sum;
}

void MatchSprings::addForces(std::span<const Vec3> v, std::span<Vec3> out) const {
  for (std::size_t i = 0; i < count(); ++i) {
    const Vec3 force = stiffness_[i] * residual(i, v);
    for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e) out[rows_.indices[e]] += weights_[e] * force;
  }
}

void MatchSprings::addProduct(std::span<const Vec3> dv, std::span<Vec3> out) const {
  for (std::size_t i = 0; i < count(); ++i) {
    Vec3 d = Vec3::Zero();
    for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e) d += weights_[e] * dv[rows_.indices[e]];
    d = stiffness_[i] * d;
    for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e) out[rows_.indices[e]] += weights_[e] * d;
  }
}

void MatchSprings::addBlocks(std::span<Mat3> blocks) const {
  for (std::size_t i = 0; i < count(); ++i)
    for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e)
      blocks[rows_.indices[e]] += weights_[e] * weights_[e] * stiffness_[i];
}

void MatchSprings::addTriplets(std::vector<Eigen::Triplet<double>> &out) const {
  for (std::size_t i = 0; i < count(); ++i)
    for (Index e = rows_.offsets[i]; e < rows_.offsets[i + 1]; ++e)
      for (Index f = rows_.offsets[i]; f < rows_.offsets[i + 1]; ++f)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            out.emplace_back(static_cast<int>(3 * rows_.indices[e]) + a, static_cast<int>(3 * rows_.indices[f]) + b,
                             weights_[e] * weights_[f] * stiffness_[i](a, b));
}

void MatchSprings::ofMotion(Motion &gradient, Eigen::Matrix<double, 6, 6> &hessian) const {
  gradient.setZero();
  hessian.setZero();
  for (std::size_t i = 0; i < count(); ++i) {
    const Columns AC = stiffness_[i] * columns_[i];
    gradient -= AC.transpose() * residuals_[i];
    hessian += columns_[i].transpose() * AC;
  }
}

MatchPotential::MatchPotential(Body &body, const Environment &env, const ImplicitStage &stage,
                               const MatchSprings &springs, std::span<const Vec3> from)
    : stage_(body, env, stage), springs_(springs), from_(from), since_(from.size()), scratch_(from.size()),
      blocks_(from.size(), Mat3::Zero()) {
  springs.addBlocks(blocks_);
  stage_.setCoupling(blocks_);
}

bool MatchPotential::setState(std::span<const Vec3> u) {
  for (std::size_t i = 0; i < since_.size(); ++i) since_[i] = u[i] - from_[i];
  return stage_.setState(u);
}

void MatchPotential::gradient(std::span<Vec3> out) {
  stage_.gradient(out);
  std::fill(scratch_.begin(), scratch_.end(), Vec3(Vec3::Zero()));
  springs_.addForces(since_, scratch_);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] -= scratch_[i];
}

void MatchPotential::product(std::span<const Vec3> du, std::span<Vec3> out) {
  stage_.product(du, out);
  springs_.addProduct(du, out);
}

bool MatchPotential::assemble(Eigen::SparseMatrix<double> &out) {
  if (!stage_.assemble(out)) return false;
  std::vector<Eigen::Triplet<double>> triplets;
  springs_.addTriplets(triplets);
  Eigen::SparseMatrix<double> own(out.rows(), out.cols());
  own.setFromTriplets(triplets.begin(), triplets.end());
  out += own;
  return true;
}

}  // namespace pointbased::detail
