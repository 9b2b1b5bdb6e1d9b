// SPDX-License-Identifier: Apache-2.0
// The neo-Hookean law of the core, written as an external law; for tests and benchmarks.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "pointbased/elastic_law.h"

namespace support {

/// W = mu/2 (tr F^T F - 3) - mu ln J + lambda/2 (ln J)^2, for J > 0.
class OutsideNeoHookean : public pointbased::ElasticLaw {
 public:
  using Mat3 = pointbased::Mat3;

  OutsideNeoHookean(double lambda, double mu, bool bounds) : lambda_(lambda), mu_(mu), bounds_(bounds) {}

  [[nodiscard]] std::string name() const override { return "law 'neo-Hookean' of 'outside'"; }
  [[nodiscard]] pointbased::Result<void> energies(std::span<const Mat3> F, std::span<double> W) const override {
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double l = std::log(F[i].determinant());
      W[i] = 0.5 * mu_ * (F[i].squaredNorm() - 3.0) - mu_ * l + 0.5 * lambda_ * l * l;
    }
    return {};
  }
  [[nodiscard]] pointbased::Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const override {
    for (std::size_t i = 0; i < F.size(); ++i) {
      const Mat3 c = cofactor(F[i]);
      const double J = F[i].col(0).dot(c.col(0));
      P[i] = mu_ * (F[i] - c) + (mu_ + slope(J)) * c;
    }
    return {};
  }
  [[nodiscard]] pointbased::Result<void> differentials(std::span<const Mat3> F, std::span<const Mat3> dF,
                                                       std::span<Mat3> dP) const override {
    for (std::size_t i = 0; i < F.size(); ++i) {
      const Mat3 c = cofactor(F[i]);
      const double J = F[i].col(0).dot(c.col(0));
      Mat3 dc;
      for (int k = 0; k < 3; ++k)
        dc.col(k) =
            dF[i].col((k + 1) % 3).cross(F[i].col((k + 2) % 3)) + F[i].col((k + 1) % 3).cross(dF[i].col((k + 2) % 3));
      dP[i] = mu_ * dF[i] + curvature(J) * c.cwiseProduct(dF[i]).sum() * c + slope(J) * dc;
    }
    return {};
  }
  [[nodiscard]] bool hasBounds() const override { return bounds_; }
  [[nodiscard]] pointbased::Result<void> bounds(std::span<const Mat3> F,
                                                std::span<pointbased::TangentBound> out) const override {
    if (!bounds_) return ElasticLaw::bounds(F, out);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const Mat3 c = cofactor(F[i]);
      const double J = F[i].col(0).dot(c.col(0));
      Eigen::SelfAdjointEigenSolver<Mat3> solver;
      const double area2 = solver.computeDirect(c.transpose() * c, Eigen::EigenvaluesOnly).eigenvalues()[2];
      const double r = slope(J) / J;
      const double along = std::max(0.0, curvature(J) + r) * c.squaredNorm() + std::max(0.0, -r) * area2;
      out[i] = {mu_ + std::max(0.0, curvature(J)) * area2, mu_ + std::max(along, std::abs(slope(J)) * F[i].norm())};
    }
    return {};
  }

 protected:
  static Mat3 cofactor(const Mat3 &F) {
    Mat3 c;
    for (int k = 0; k < 3; ++k) c.col(k) = F.col((k + 1) % 3).cross(F.col((k + 2) % 3));
    return c;
  }
  [[nodiscard]] double slope(double J) const { return (lambda_ * std::log(J) - mu_) / J; }
  [[nodiscard]] double curvature(double J) const { return (lambda_ + mu_ - lambda_ * std::log(J)) / (J * J); }

  double lambda_, mu_;
  bool bounds_;
};

}  // namespace support
