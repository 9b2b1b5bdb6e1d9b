// SPDX-License-Identifier: Apache-2.0
#include "newton.h"

#include "element.h"
#include "multifrontal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace truth {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

// A residual of this part of the largest force counts as equilibrium; round-off of the sums is near 1e-13.
constexpr double kTolerance = 1e-9;
constexpr int kMaxIterations = 40;
constexpr double kSmallestIncrement = 1e-3;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

class Newton {
 public:
  explicit Newton(const Model &model) : model_(model), solver_(model, numberFreedoms()) {
    deadForces_.assign(model.nodes.size(), Eigen::Vector3d::Zero());
    addGravity(model, deadForces_);
    for (const NodalForce &force : model.forces) deadForces_[at(force.node)] += force.force;
    displacements_.assign(model.nodes.size(), Eigen::Vector3d::Zero());
    tangents_.resize(model.elements.size());
    pressures_.resize(model.elements.size());
    facesOf_.resize(model.elements.size());
    for (std::size_t f = 0; f < model.pressures.size(); ++f) {
      facesOf_[at(model.pressures[f].element)].push_back(static_cast<int>(f));
    }
  }

  Solution run() {
    const int stages = static_cast<int>(model_.loadFactors.size());
    double time = 0.0;  // stage number plus the completed fraction of the stage
    double increment = 1.0 / model_.increments;
    while (time < stages - 1e-12) {
      const double stageEnd = std::floor(time + 1e-12) + 1.0;
      const double next = std::min(time + increment, stageEnd);
      const Vectors before = displacements_;
      const std::vector<PressureState> pressuresBefore = pressures_;
      if (converge(time, next)) {
        time = next;
        increment = std::min(increment * 1.5, 1.0 / model_.increments);
      } else {
        displacements_ = before;
        pressures_ = pressuresBefore;
        increment *= 0.5;
        if (increment < kSmallestIncrement) throw std::runtime_error("Newton does not converge");
      }
    }
    Solution out;
    out.displacements = displacements_;
    out.internalForces = internalForces_;
    out.freedoms = freedoms_;
    out.iterations = iterations_;
    out.negativePivots = solver_.negativePivots();
    out.smallestJacobian = smallestJacobian_;
    return out;
  }

 private:
  /// Free degrees of freedom get numbers from zero, held ones -1 - index in model.held.
  const std::vector<int> &numberFreedoms() {
    number_.assign(3 * model_.nodes.size(), 0);
    for (std::size_t h = 0; h < model_.held.size(); ++h) {
      number_[at(3 * model_.held[h].node + model_.held[h].axis)] = -1 - static_cast<int>(h);
    }
    for (int &number : number_) {
      if (number >= 0) number = freedoms_++;
    }
    return number_;
  }

  double interpolate(const std::vector<double> &values, double time) const {
    const int stages = static_cast<int>(values.size());
    const int stage = std::clamp(static_cast<int>(std::ceil(time - 1e-12)) - 1, 0, stages - 1);
    const double before = stage > 0 ? values[at(stage - 1)] : 0.0;
    return before + (values[at(stage)] - before) * (time - stage);
  }

  /// Residual (external minus internal) at the free degrees of freedom. With `heldChange` the tangents are filled too,
  /// and the first-order effect of the prescribed displacement `heldChange` is subtracted from the residual.
  bool assemble(double time, const Eigen::VectorXd *heldChange, Eigen::VectorXd &residual) {
    const double factor = interpolate(model_.loadFactors, time);
    residual.setZero(freedoms_);
    internalForces_.assign(model_.nodes.size(), Eigen::Vector3d::Zero());
    Vectors external(model_.nodes.size()), x(model_.nodes.size());
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] = model_.nodes[n] + displacements_[n];
      external[n] = factor * deadForces_[n];
    }
    smallestJacobian_ = 1e300;
    forceScale_ = 0.0;
    for (std::size_t e = 0; e < model_.elements.size(); ++e) {
      const Hex27 &element = model_.elements[e];
      ElementResult result = evaluateElement(model_, element, x, pressures_[e].value);
      if (!result.valid) return false;
      smallestJacobian_ = std::min(smallestJacobian_, result.smallestJacobian);
      for (int a = 0; a < kNodesPerElement; ++a) {
        internalForces_[at(element.nodes[at(a)])] += result.force.segment<3>(3 * a);
      }
      for (const int face : facesOf_[e]) addPressure(model_, face, factor, x, external, result.tangent);
      if (heldChange == nullptr) continue;
      moveHeld(element, result.tangent, *heldChange, residual);
      tangents_[e] = result.tangent;
      pressures_[e] = result.pressure;
    }
    for (std::size_t n = 0; n < external.size(); ++n) {
      for (int i = 0; i < 3; ++i) {
        const int row = number_[3 * n + at(i)];
        if (row >= 0) residual(row) += external[n](i) - internalForces_[n](i);
        forceScale_ = std::max({forceScale_, std::abs(internalForces_[n](i)), std::abs(external[n](i))});
      }
    }
    return true;
  }

  void moveHeld(const Hex27 &element, const Multifrontal::ElementMatrix &tangent, const Eigen::VectorXd &heldChange,
                Eigen::VectorXd &residual) const {
    for (int c = 0; c < kElementDofs; ++c) {
      const int column = number_[at(3 * element.nodes[at(c / 3)] + c % 3)];
      if (column >= 0) continue;
      for (int r = 0; r < kElementDofs; ++r) {
        const int row = number_[at(3 * element.nodes[at(r / 3)] + r % 3)];
        if (row >= 0) residual(row) -= tangent(r, c) * heldChange(-1 - column);
      }
    }
  }

  /// Displacements by scale * step, and the pressures of mixed elements along with them to first order.
  void move(const Eigen::VectorXd &step, const Eigen::VectorXd &heldStep, double scale) {
    const auto change = [&](int number) { return scale * (number >= 0 ? step(number) : heldStep(-1 - number)); };
    for (std::size_t n = 0; n < displacements_.size(); ++n) {
      for (int i = 0; i < 3; ++i) {
        const int number = number_[3 * n + at(i)];
        displacements_[n](i) += change(number);
      }
    }
    for (std::size_t e = 0; e < model_.elements.size(); ++e) {
      const Hex27 &element = model_.elements[e];
      if (model_.laws[at(element.law)].kind != LawKind::neoHookeanMixed) continue;
      for (int d = 0; d < kElementDofs; ++d) {
        const int number = number_[at(3 * element.nodes[at(d / 3)] + d % 3)];
        pressures_[e].value += pressures_[e].rate.col(d) * change(number);
      }
    }
  }

  bool converge(double from, double to) {
    Eigen::VectorXd heldChange(static_cast<Eigen::Index>(model_.held.size()));
    for (std::size_t h = 0; h < model_.held.size(); ++h) {
      heldChange(static_cast<Eigen::Index>(h)) =
          interpolate(model_.held[h].values, to) - interpolate(model_.held[h].values, from);
    }
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(heldChange.size());
    Eigen::VectorXd residual, step, trial;
    double previous = 1e300;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      if (!assemble(to, iteration == 0 ? &heldChange : &none, residual)) return false;
      const double size = residual.lpNorm<Eigen::Infinity>();
      if (iteration > 0 && size <= kTolerance * forceScale_) {
        std::fprintf(stderr, "time %.4f: %d iterations, residual %.1e of %.1e N, smallest J %.3f, %d negative pivots\n",
                     to, iteration, size, forceScale_, smallestJacobian_, solver_.negativePivots());
        return true;
      }
      // Far above the last residual for several iterations: the increment is too large.
      if (iteration > 8 && size > 10.0 * previous) return false;
      previous = size;
      ++iterations_;
      if (!solver_.factorize([this](int e) -> const auto & { return tangents_[at(e)]; })) return false;
      step = solver_.solve(residual);
      if (!step.allFinite()) return false;
      move(step, iteration == 0 ? heldChange : none, 1.0);
      // A step that inverts a point is shortened (the first one, which applies the prescribed displacements, is not).
      double scale = 1.0;
      while (!assemble(to, nullptr, trial)) {
        if (iteration == 0 || scale < 0.05) return false;
        move(step, none, -0.5 * scale);
        scale *= 0.5;
      }
    }
    return false;
  }

  const Model &model_;
  int freedoms_ = 0;
  int iterations_ = 0;
  double smallestJacobian_ = 1.0;
  double forceScale_ = 0.0;
  std::vector<int> number_;  ///< [3 node + axis]
  Multifrontal solver_;      ///< after number_ and freedoms_, which its constructor fills
  std::vector<Multifrontal::ElementMatrix> tangents_;
  std::vector<PressureState> pressures_;   ///< [element] as predicted by Newton's method
  std::vector<std::vector<int>> facesOf_;  ///< [element] indices into model.pressures
  Vectors deadForces_, displacements_, internalForces_;
};

}  // namespace

Solution solve(const Model &model) { return Newton(model).run(); }

}  // namespace truth
