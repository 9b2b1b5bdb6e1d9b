// SPDX-License-Identifier: Apache-2.0
#include "sensitivity/equilibrium_tangent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/expects.h"
#include "base/number_text.h"
#include "pointbased/step_composition.h"

namespace pointbased::detail {
namespace {

// Why the equilibrium of a body is not differentiated; empty: it is.
std::string obstacleTo(const Body &body, const Environment &environment) {
  const auto refused = [&](const std::string &what) { return "body '" + body.name() + "': " + what; };
  if (body.rigid()) return refused("it is rigid and has no sensitivities");
  if (stagesOf(body, environment).contact)
    return refused("contact with obstacles and walls is not differentiated; remove them from the solution");
  if (body.attached()) return refused("attachments are not differentiated");
  if (!body.grabs.empty()) return refused("grabs are not differentiated; use supports or forces");
  if (body.constitution().plastic())
    return refused("plastic flow depends on the path and is not differentiated; set plasticity to elastic");
  if (body.rereferenceCount() > 0) return refused("its reference has been renewed; reset it first");
  const std::vector<Load> &loads = body.rest().conditions.loads;
  for (std::size_t l = 0; l < loads.size(); ++l)
    if (loads[l].pressure != 0.0 && loads[l].follower)
      return refused("load " + std::to_string(l) +
                     " is a pressure that follows the surface, which is not differentiated; set follower to false");
  return {};
}

}  // namespace

void clearPrescribed(const IncrementalPotential &problem, std::span<Vec3> v) {
  const std::span<const std::uint8_t> mask = problem.prescribed();
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) v[i].setZero();
}

Result<void> EquilibriumTangent::linearise(Body &body, const Environment &environment, double loadFactor) {
  POINTBASED_EXPECTS(environment.parallelFor != nullptr, "a loop for the work");
  problem_.reset();
  if (std::string why = obstacleTo(body, environment); !why.empty()) return tl::unexpected(std::move(why));
  body_ = &body;
  environment_ = environment;
  stage_ = ImplicitStage();
  stage_.end = loadFactor;
  problem_.emplace(body, environment_, stage_);
  const std::vector<Vec3> u = body.state().displacements;
  const auto unusable = [&] {
    return tl::unexpected("body '" + body.name() + "': its displacements or forces are not finite");
  };
  const std::vector<Vec3> before(body.forces().begin(), body.forces().end());
  if (!problem_->setState(u)) return unusable();
  std::vector<Vec3> gradient(u.size());
  problem_->gradient(gradient);
  double scale = 0.0;
  for (const Vec3 &f : body.forces()) scale += f.squaredNorm();
  std::copy(before.begin(), before.end(), body.forces().begin());
  clearPrescribed(*problem_, gradient);
  const double rest = std::sqrt(dot(gradient, gradient));
  if (!std::isfinite(rest) || !std::isfinite(scale)) return unusable();
  residual_ = rest == 0.0 ? 0.0 : scale > 0.0 ? rest / std::sqrt(scale) : std::numeric_limits<double>::infinity();
  return {};
}

Result<void> EquilibriumTangent::solve(std::span<const Vec3> b, std::span<Vec3> x, double tolerance,
                                       int maxIterations) {
  POINTBASED_EXPECTS(problem_.has_value(), "a linearised equilibrium");
  auto done = solver_.solve(*problem_, b, x, tolerance, maxIterations, environment_.preconditioner, environment_.stop);
  if (!done) return tl::unexpected("body '" + body_->name() + "': " + done.error());
  return done;
}

Result<void> TangentSolver::solve(IncrementalPotential &problem, std::span<const Vec3> b, std::span<Vec3> x,
                                  double tolerance, int maxIterations, Preconditioner choice, const StopRequest *stop) {
  POINTBASED_EXPECTS(b.size() == problem.phyxels() && x.size() == b.size(), "one vector per phyxel");
  right_.assign(b.begin(), b.end());
  clearPrescribed(problem, right_);
  iterations_ = 0;
  if (std::all_of(right_.begin(), right_.end(), [](const Vec3 &v) { return v.isZero(0.0); })) {
    std::fill(x.begin(), x.end(), Vec3(Vec3::Zero()));
    return {};
  }
  const Apply product = [&](std::span<const Vec3> in, std::span<Vec3> out) {
    throwIfStopRequested(stop);
    problem.product(in, out);
    clearPrescribed(problem, out);
  };
  const Apply precondition = [this](std::span<const Vec3> in, std::span<Vec3> out) { keeper_.apply(in, out); };
  keeper_.prepare(problem, choice, stop);
  linear_.begin(right_, precondition);
  int before = 0;
  LinearEnd end = LinearEnd::iterations;
  for (;;) {
    const int left = maxIterations - linear_.iterations();
    const int budget = keeper_.iterationBudget(tolerance, maxIterations) - (linear_.iterations() - before);
    end = linear_.run(product, precondition, tolerance, std::max(0, std::min(left, budget)),
                      std::numeric_limits<double>::infinity());
    if (end != LinearEnd::iterations || budget >= left) break;
    keeper_.book(linear_.iterations() - before, tolerance, false);
    keeper_.renew(problem, stop);
    before = linear_.iterations();
    linear_.restart(product, precondition);
  }
  keeper_.book(linear_.iterations() - before, tolerance, end == LinearEnd::tolerance);
  iterations_ = linear_.iterations();
  if (end == LinearEnd::negativeCurvature)
    return tl::unexpected(
        std::string("the equilibrium is not stable (its tangent is not positive definite), or "
                    "nothing holds the body; add a support or a foundation"));
  if (end == LinearEnd::notFinite) return tl::unexpected(std::string("the linear solve is not finite"));
  if (end != LinearEnd::tolerance)
    return tl::unexpected("the linear solve has not converged to " + number(tolerance) + " in " +
                          std::to_string(iterations_) + " iterations; nothing may hold the body");
  std::copy(linear_.x().begin(), linear_.x().end(), x.begin());
  return {};
}

}  // namespace pointbased::detail
