// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "accuracy/trial_solution.h"
#include "pointbased/integrators.h"
#include "pointbased/interpolation.h"
#include "shape/surface_area.h"

namespace pointbased {
namespace {

constexpr double kSmall = 1e-3;  // part of loads and motions that is applied, so that rotations remain small
constexpr double kSkinPart = 0.95;

Constitution linearOf(const Constitution &constitution) {
  Constitution out = constitution;
  for (Material &m : out.materials) {
    m.law = MaterialLaw::linear;
    m.prony = {};
    m.plastic = {};
    m.custom.reset();
  }
  return out;
}

BodyRecipe scaled(BodyRecipe out) {
  for (Fix &fix : out.fixes) {
    fix.displacement *= kSmall;
    fix.rotation_deg *= kSmall;
    if (fix.rotationVector) *fix.rotationVector *= kSmall;
  }
  for (Load &load : out.loads) {
    load.force *= kSmall;
    load.pressure *= kSmall;
  }
  return out;
}

/// Equilibrium under all loads, to a ten-thousandth of the largest displacement.
Result<void> solveLinear(Body &body, const Vec3 &gravity, const ParallelFor &parallelFor, const StopRequest *stop) {
  constexpr double kAnything = 1e9;  // m
  constexpr double kGood = 1e-4;
  NewtonSolver solver;
  StageClock clock(stageNames());
  Environment environment;
  environment.gravity = gravity;
  environment.parallelFor = &parallelFor;
  environment.clock = &clock;
  environment.stop = stop;
  // The displacement is unknown in advance: the first correction provides its scale.
  environment.tolerance = kAnything;
  if (const auto first = quasiStaticStep(body, solver, environment, 0.0, 1.0); !first.failure.empty())
    return tl::unexpected(first.failure);
  double largest = 0.0;
  for (const Vec3 &u : body.state().displacements) largest = std::max(largest, u.norm());
  environment.tolerance = std::max(kGood * largest, std::numeric_limits<double>::min());
  const ImplicitResult solved = quasiStaticStep(body, solver, environment, 1.0, 1.0);
  if (!solved.failure.empty()) return tl::unexpected(solved.failure);
  return {};
}

}  // namespace

SurfacePoints skinSamples(const Surface &surface, std::span<const Fix> fixes, std::size_t count) {
  const double area = detail::areaOf(surface);
  const SurfacePoints all =
      sampleSurface(surface, std::sqrt(2.0 * area / static_cast<double>(count)), EverywhereRegion{});
  // Small triangles produce more points than requested: one per `share` of the area is used.
  const double share = area / static_cast<double>(count);
  SurfacePoints out;
  double since = 0.5 * share;
  for (std::size_t i = 0; i < all.count(); ++i) {
    since += all.areas[i];
    const Vec3 &x = all.positions[i];
    if (since < share ||
        std::any_of(fixes.begin(), fixes.end(), [&](const Fix &fix) { return signedDistance(fix.region, x) <= 0.0; }))
      continue;
    since = std::fmod(since, share);
    out.positions.push_back(x);
    out.normals.push_back(all.normals[i]);
    out.areas.push_back(share);
  }
  return out;
}

std::vector<Vec3> displacementsAt(const RestState &rest, std::span<const Vec3> displacements,
                                  const SurfacePoints &samples, const ParallelFor &parallelFor) {
  std::vector<Vec3> local = samples.positions;
  for (Vec3 &x : local) x -= rest.origin;
  std::vector<Vec3> out(local.size());
  interpolateDisplacements(rest.bind(local, samples.normals), rest.positions, displacements, out, parallelFor);
  return out;
}

namespace detail {

Result<std::unique_ptr<Body>> solvedTrial(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                          const StopRequest *stop) {
  auto rest = buildRestState(problem.shape, scaled(problem.recipe), {}, parallelFor);
  if (!rest) return tl::unexpected(rest.error());
  auto body = std::make_unique<Body>("trial", *rest, linearOf(problem.constitution), parallelFor);
  if (const auto held = body->setFoundation(problem.foundation); !held) return tl::unexpected(held.error());
  if (const auto solved = solveLinear(*body, kSmall * problem.gravity, parallelFor, stop); !solved)
    return tl::unexpected(solved.error());
  return body;
}

}  // namespace detail

Result<TrialSolution> solveTrial(const AccuracyProblem &problem, const SurfacePoints &samples,
                                 const ParallelFor &parallelFor, const StopRequest *stop) {
  const auto solved = detail::solvedTrial(problem, parallelFor, stop);
  if (!solved) return tl::unexpected(solved.error());
  const Body &body = **solved;
  const RestState &rest = body.rest();
  TrialSolution out;
  out.spacing = rest.spacing;
  out.phyxels = rest.phyxelCount();
  out.points = rest.pointCount();
  out.quadraticPoints = rest.stencils.quadratic.points.size();
  out.contacts = rest.contact.count();
  out.stableStep = body.stableStepAtRest();
  out.displacements = displacementsAt(rest, body.state().displacements, samples, parallelFor);
  for (Vec3 &u : out.displacements) {
    u /= kSmall;
    out.largest = std::max(out.largest, u.norm());
  }
  return out;
}

Result<TrialSolution> solveTrial(const AccuracyProblem &problem, std::size_t count, const SurfacePoints &samples,
                                 const ParallelFor &parallelFor, const StopRequest *stop) {
  BodyRecipe recipe = problem.recipe;
  recipe.sampling.spacing = 0.0;
  recipe.sampling.count = count;
  recipe.sampling.refinements.clear();
  recipe.sampling.surfaceSpacing = 0.0;
  return solveTrial({problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity}, samples,
                    parallelFor, stop);
}

double skinDifference(const TrialSolution &a, const TrialSolution &b) {
  if (a.displacements.empty() || a.displacements.size() != b.displacements.size()) return 0.0;
  std::vector<double> differences(a.displacements.size());
  for (std::size_t i = 0; i < a.displacements.size(); ++i)
    differences[i] = (a.displacements[i] - b.displacements[i]).norm();
  const auto at =
      differences.begin() + static_cast<std::ptrdiff_t>(kSkinPart * static_cast<double>(differences.size() - 1));
  std::nth_element(differences.begin(), at, differences.end());
  return *at;
}

}  // namespace pointbased
