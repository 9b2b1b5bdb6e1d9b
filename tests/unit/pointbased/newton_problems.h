// SPDX-License-Identifier: Apache-2.0
// Energies with assembled Hessians, as problems of the Newton solver.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pointbased/newton.h"
#include "shapes.h"

namespace newton_problems {

using namespace pointbased;

using Matrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

inline void addBlock(Triplets &out, std::size_t i, std::size_t j, const Mat3 &m) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out.emplace_back(static_cast<int>(3 * i) + r, static_cast<int>(3 * j) + c, m(r, c));
}

inline Mat3 outer(const Vec3 &v) { return v * v.transpose(); }

/// Common base of the problems below: an assembled Hessian, and counters.
class Assembled : public IncrementalPotential {
 public:
  [[nodiscard]] std::size_t phyxels() const override { return u_.size(); }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return held; }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override {
    ++moves;
    u_.assign(u.begin(), u.end());
    current_ = false;
    return allowed(u_);
  }
  void product(std::span<const Vec3> du, std::span<Vec3> out) override {
    if (!current_) exact_ = hessian(false);
    current_ = true;
    const Eigen::Map<const Eigen::VectorXd> x(du.front().data(), exact_.cols());
    Eigen::Map<Eigen::VectorXd>(out.front().data(), exact_.rows()) = exact_ * x;
  }
  void diagonalBlocks(std::span<Mat3> out) override {
    const Matrix h = hessian(true);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      out[i] = Mat3(h.block(at, at, 3, 3));
    }
  }
  [[nodiscard]] bool assemble(Matrix &out) override {
    ++assemblies;
    if (!canAssemble) return false;
    out = hessian(true);
    return true;
  }

  std::vector<std::uint8_t> held;
  int moves = 0, assemblies = 0;
  bool canAssemble = true;

 protected:
  explicit Assembled(std::size_t n) : u_(n, Vec3::Zero()) {}
  [[nodiscard]] virtual bool allowed(const std::vector<Vec3> &) const { return true; }
  [[nodiscard]] virtual Matrix hessian(bool positive) const = 0;
  [[nodiscard]] Matrix from(const Triplets &t) const {
    Matrix m(3 * static_cast<Eigen::Index>(u_.size()), 3 * static_cast<Eigen::Index>(u_.size()));
    m.setFromTriplets(t.begin(), t.end());
    return m;
  }
  std::vector<Vec3> u_;

 private:
  Matrix exact_;  // of the current state, if `current_`
  bool current_ = false;
};

/// 1/2 u·A u - b·u on a grid: springs along the edges, stiffer along than across, and a weak ground.
class GridProblem : public Assembled {
 public:
  explicit GridProblem(int n, double stiffness = 100.0) : Assembled(static_cast<std::size_t>(n * n * n)) {
    Triplets t;
    const auto id = [n](int x, int y, int z) { return static_cast<std::size_t>((z * n + y) * n + x); };
    const auto couple = [&](std::size_t i, std::size_t j, const Vec3 &along) {
      const Mat3 k = stiffness * (outer(along) + 0.3 * Mat3::Identity());
      addBlock(t, i, i, k);
      addBlock(t, j, j, k);
      addBlock(t, i, j, -k);
      addBlock(t, j, i, -k);
    };
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          if (x + 1 < n) couple(id(x, y, z), id(x + 1, y, z), Vec3::UnitX());
          if (y + 1 < n) couple(id(x, y, z), id(x, y + 1, z), Vec3(0, 0.8, 0.6));
          if (z + 1 < n) couple(id(x, y, z), id(x, y, z + 1), Vec3::UnitZ());
          addBlock(t, id(x, y, z), id(x, y, z), 0.1 * Mat3::Identity());
        }
    matrix = from(t);
    shapes::Random random(3);
    load.resize(matrix.rows());
    for (Eigen::Index i = 0; i < load.size(); ++i) load[i] = random();
  }
  [[nodiscard]] double energy() override { return flat().dot(0.5 * (matrix * flat()) - load); }
  void gradient(std::span<Vec3> out) override {
    Eigen::Map<Eigen::VectorXd>(out.front().data(), load.size()) = matrix * flat() - load;
  }
  Matrix matrix;
  Eigen::VectorXd load;

 protected:
  [[nodiscard]] Matrix hessian(bool) const override { return matrix; }
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> flat() const { return {u_.front().data(), load.size()}; }
};

/// A column of springs along x whose ends are pushed together, with bending stiffness and a guide that is softer in y
/// than in z: the straight state is a saddle, the column buckles in y.
class Column : public Assembled {
 public:
  explicit Column(std::size_t n) : Assembled(n) {
    held.assign(n, 0);
    held[0] = held[1] = held[n - 2] = held[n - 1] = 1;
  }
  static constexpr double kSpring = 1000.0, kBending = 2.0, kLength = 0.1;
  static constexpr double kGuide[3] = {0.0, 0.01, 2.0};

  [[nodiscard]] Vec3 at(std::size_t i) const { return Vec3(kLength * static_cast<double>(i), 0, 0) + u_[i]; }
  [[nodiscard]] Vec3 bend(std::size_t i) const { return at(i - 1) - 2.0 * at(i) + at(i + 1); }

  // Straight, `shortening` along, and out of line by `disturbance`.
  [[nodiscard]] std::vector<Vec3> start(double shortening, double disturbance) const {
    const std::size_t n = u_.size();
    std::vector<Vec3> u(n);
    shapes::Random random(5);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] = Vec3(-shortening * kLength * static_cast<double>(i), 0, 0);
      if (held[i] == 0) u[i] += disturbance * random.vector();
    }
    return u;
  }

  [[nodiscard]] double energy() override {
    double e = 0.0;
    const Vec3 guide(kGuide[0], kGuide[1], kGuide[2]);
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const double d = (at(i + 1) - at(i)).norm() - kLength;
      e += 0.5 * kSpring * d * d;
      if (i > 0) e += 0.5 * kBending * bend(i).squaredNorm();
      e += 0.5 * guide.dot(u_[i].cwiseAbs2());
    }
    return e;
  }
  void gradient(std::span<Vec3> out) override {
    const Vec3 guide(kGuide[0], kGuide[1], kGuide[2]);
    for (Vec3 &g : out) g.setZero();
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const Vec3 e = at(i + 1) - at(i);
      const Vec3 f = kSpring * (e.norm() - kLength) * e.normalized();
      out[i + 1] += f;
      out[i] -= f;
      if (i > 0) {
        const Vec3 b = kBending * bend(i);
        out[i - 1] += b;
        out[i] -= 2.0 * b;
        out[i + 1] += b;
      }
      out[i] += guide.cwiseProduct(u_[i]);
    }
  }

 protected:
  [[nodiscard]] Matrix hessian(bool positive) const override {
    Triplets t;
    const Mat3 guide = Vec3(kGuide[0], kGuide[1], kGuide[2]).asDiagonal();
    for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
      const Vec3 e = at(i + 1) - at(i);
      const Mat3 along = outer(e.normalized());
      const double across = 1.0 - kLength / e.norm();
      const Mat3 k = kSpring * (along + (positive ? std::max(0.0, across) : across) * (Mat3::Identity() - along));
      addBlock(t, i, i, k);
      addBlock(t, i + 1, i + 1, k);
      addBlock(t, i, i + 1, -k);
      addBlock(t, i + 1, i, -k);
      if (i > 0) {
        const double c[3] = {1.0, -2.0, 1.0};
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b < 3; ++b)
            addBlock(t, i + a - 1, i + b - 1, kBending * c[a] * c[b] * Mat3::Identity());
      }
      addBlock(t, i, i, guide);
    }
    addBlock(t, u_.size() - 1, u_.size() - 1, Mat3::Identity());
    return from(t);
  }
};

/// Σ 1/2 |u - a|² - log(1 - |u|²) per phyxel with a far outside of the unit ball; undefined outside it.
class Walled : public Assembled {
 public:
  explicit Walled(std::size_t n) : Assembled(n) {}
  Vec3 target = Vec3(30, 40, 0);
  bool silent = false;  // returns an energy that is not finite instead of an error
  double largest = 1.0;

  [[nodiscard]] double energy() override {
    double e = 0.0;
    for (const Vec3 &u : u_) e += 0.5 * (u - target).squaredNorm() - std::log(1.0 - u.squaredNorm());
    return e;
  }
  void gradient(std::span<Vec3> out) override {
    for (std::size_t i = 0; i < u_.size(); ++i) out[i] = u_[i] - target + 2.0 / (1.0 - u_[i].squaredNorm()) * u_[i];
  }
  [[nodiscard]] double largestStep(std::span<const Vec3> direction) override {
    asked = std::max(asked, direction[0].norm());
    return largest;
  }
  double asked = 0.0;

 protected:
  [[nodiscard]] bool allowed(const std::vector<Vec3> &u) const override {
    return silent || std::all_of(u.begin(), u.end(), [](const Vec3 &v) { return v.squaredNorm() < 1.0; });
  }
  [[nodiscard]] Matrix hessian(bool) const override {
    Triplets t;
    for (std::size_t i = 0; i < u_.size(); ++i) {
      const double g = 1.0 - u_[i].squaredNorm();
      addBlock(t, i, i, (1.0 + 2.0 / g) * Mat3::Identity() + 4.0 / (g * g) * outer(u_[i]));
    }
    return from(t);
  }
};

/// An energy that is inconsistent with its gradient: it cannot decrease along it.
class Deceitful : public GridProblem {
 public:
  Deceitful() : GridProblem(3) {}
  [[nodiscard]] double energy() override { return -GridProblem::energy(); }
};

}  // namespace newton_problems
