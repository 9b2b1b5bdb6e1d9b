// SPDX-License-Identifier: Apache-2.0
#include "stepping/guard.h"

#include <algorithm>
#include <cmath>

#include "base/kernels/field_kernel.h"
#include "base/number_text.h"

namespace pointbased {
namespace {

using detail::number;

// Beyond this squares, and energies made of them, are no numbers any more.
constexpr double kHuge = 1e150;

double sumOfSquares(std::span<const Vec3> field) {
  return field.empty() ? 0.0 : kernels::roughSumOfSquares(field.front().data(), 3 * field.size());
}

// Potential of the dead loads and of gravity, relative to the start, J.
double potential(const Body &body, const Vec3 &gravity) {
  double energy = 0.0;
  for (std::size_t i = 0; i < body.masses().size(); ++i)
    energy -= body.weights()[i] * gravity.dot(body.state().displacements[i]);
  const BoundaryConditions &conditions = body.rest().conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l) {
    const Interpolation &points = conditions.loaded[l].points;
    for (std::size_t p = 0; p < points.count(); ++p) {
      Vec3 u = Vec3::Zero();
      for (Index e = points.phyxels.offsets[p]; e < points.phyxels.offsets[p + 1]; ++e)
        u += points.weights[e] * body.state().displacements[points.phyxels.indices[e]];
      energy -= conditions.loaded[l].shares[p] * conditions.loads[l].force.dot(u) -
                conditions.loads[l].pressure * conditions.loaded[l].areaVectors[p].dot(u);
    }
  }
  return energy;
}

}  // namespace

bool isFinite(std::span<const Vec3> field) { return std::isfinite(sumOfSquares(field)); }

QuickCheckResult quickCheck(const Body &body) {
  const std::span<const Vec3> v = body.state().velocities;
  if (v.empty()) return {};
  const kernels::FieldBounds bounds = kernels::boundsOf(v.front().data(), v.size());
  // The mean lies within the bounds of all.
  const Vec3 low(bounds.low), high(bounds.high);
  const bool finite = std::isfinite(bounds.sum) && high.maxCoeff() < kHuge && low.minCoeff() > -kHuge;
  return {finite && std::isfinite(sumOfSquares(body.state().displacements)), (high - low).norm()};
}

GuardView fullCheck(const Body &body) {
  GuardView view;
  const State &state = body.state();
  view.finite = quickCheck(body).finite;
  if (!view.finite || state.velocities.empty()) return view;
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : state.velocities) sum += v;
  const Vec3 mean = sum / static_cast<double>(state.velocities.size());
  double largest = 0.0;
  const std::span<const float> maxInfluence = body.rest().maxInfluence;
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const double part = maxInfluence.empty() ? 1.0 : static_cast<double>(maxInfluence[i]);
    const double squared = (state.velocities[i] - mean).squaredNorm() * part * part;
    if (squared > largest) {
      largest = squared;
      view.fastestPhyxel = static_cast<Index>(i);
    }
  }
  view.fastest = std::sqrt(largest);
  view.meanSpeed = mean.norm();
  return view;
}

GuardFinding firstNonFinite(const Body &body) {
  const State &state = body.state();
  // The bound of the glance. Where only a sum of squares has run over, one of them is beyond it, too.
  const auto finite = [](const Vec3 &x) { return (x.array().abs() < kHuge).all(); };
  GuardFinding finding;
  finding.quantity = "the state is not finite";
  finding.help = "a smaller solver.dt, solver.integrator = \"implicit\", more solver.damping or material.viscosity";
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const bool velocity = finite(state.velocities[i]);
    if (velocity && finite(state.displacements[i])) continue;
    finding.phyxel = static_cast<Index>(i);
    finding.quantity = std::string("the ") + (velocity ? "displacement" : "velocity") + " is not finite";
    break;
  }
  return finding;
}

std::optional<GuardFinding> EnergyWatch::look(const Body &body, const Vec3 &gravity, bool driven) {
  const ElasticEnergy elastic = body.elasticEnergy(serialFor());
  const double stored = elastic.strain + elastic.stabilisation, kinetic = body.kineticEnergy();
  double total = kinetic + stored + potential(body, gravity) +
                 body.patches().energy(body.lastPatchTargets(), body.state().displacements) +
                 body.foundation().energy(body.state().displacements);
  const double scale = std::max(kinetic, stored);
  const bool comparable = known_ && !driven;
  const double before = total_;
  // What is led out of an obstacle is lifted by it.
  const double lifted = std::max(0.0, -gravity.dot(body.contact.ledOut));
  const double growth = total - total_, allowed = kGrowth * std::max(scale, scale_) + lifted * (1.0 + 1e-9);
  known_ = true;
  total_ = total;
  scale_ = scale;
  if (!comparable || growth <= allowed || growth <= 1e-12 * (std::abs(total) + std::abs(before))) return std::nullopt;
  known_ = false;
  const GuardView view = fullCheck(body);
  return GuardFinding{view.fastestPhyxel,
                      "the energy has grown by " + number(growth) + " J with nothing driving it (kinetic " +
                          number(kinetic) + " J, elastic " + number(stored) + " J)",
                      "a smaller solver.dt, solver.integrator = \"implicit\" or more material.viscosity"};
}

}  // namespace pointbased
