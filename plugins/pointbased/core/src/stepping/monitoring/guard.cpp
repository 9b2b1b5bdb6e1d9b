// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/guard.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/kernels/field_kernel.h"
#include "base/number_text.h"

namespace pointbased {
namespace {

using detail::number;

// Above this, squares and energies overflow.
constexpr double kOverflow = 1e150;
// Units in the last place of what strain energies are differences of. A body that has come to rest keeps that much.
constexpr double kRoundOffs = 8.0;

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
  // The mean is within the bounds of all.
  const Vec3 low(bounds.low), high(bounds.high);
  const bool finite = std::isfinite(bounds.sum) && high.maxCoeff() < kOverflow && low.minCoeff() > -kOverflow;
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
  // Same bound as in quickCheck(). If only a sum of squares has overflowed, one of its values exceeds it as well.
  const auto finite = [](const Vec3 &x) { return (x.array().abs() < kOverflow).all(); };
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

void EnergyLevel::add(const EnergyLevel &other) {
  total += other.total;
  kinetic += other.kinetic;
  stored += other.stored;
  depenetrationWork += other.depenetrationWork;
  roundOff += other.roundOff;
}

EnergyLevel energyLevel(const Body &body, const Vec3 &gravity) {
  const ElasticEnergy elastic = body.elasticEnergy(serialFor());
  EnergyLevel level;
  level.stored = elastic.strain + elastic.stabilisation;
  level.kinetic = body.kineticEnergy();
  level.total = level.kinetic + level.stored + potential(body, gravity) +
                body.patches().energy(body.lastPatchTargets(), body.state().displacements) +
                body.foundation().energy(body.state().displacements);
  level.depenetrationWork = std::max(0.0, -gravity.dot(body.contact.depenetrationMoment));
  // The energy density of neo-Hooke is a difference of terms of the size of its moduli.
  double squaredSpeed = 0.0;  // of pressure waves
  for (const Material &m : body.constitution().materials)
    squaredSpeed = std::max(squaredSpeed, m.waveModulus() / m.restDensity);
  level.roundOff = kRoundOffs * std::numeric_limits<double>::epsilon() * squaredSpeed * body.totalMass();
  return level;
}

std::string energyGrowth(const EnergyLevel &before, const EnergyLevel &now) {
  const auto scaleOf = [](const EnergyLevel &level) { return std::max(level.kinetic, level.stored); };
  const double growth = now.total - before.total, allowed = kEnergyGrowth * std::max(scaleOf(before), scaleOf(now)) +
                                                            now.depenetrationWork * (1.0 + 1e-9) + before.roundOff +
                                                            now.roundOff;
  if (growth <= allowed || growth <= 1e-12 * (std::abs(now.total) + std::abs(before.total))) return {};
  return "the energy has grown by " + number(growth) + " J without external work (kinetic " + number(now.kinetic) +
         " J, elastic " + number(now.stored) + " J)";
}

}  // namespace pointbased
