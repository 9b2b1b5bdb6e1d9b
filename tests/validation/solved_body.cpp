// SPDX-License-Identifier: Apache-2.0
#include "solved_body.h"

#include <cmath>
#include <stdexcept>

#include "../unit/pointbased/shapes.h"
#include "validation_table.h"

namespace validation {

using namespace pointbased;

namespace {

constexpr double kFar = 1e3;        // m, beyond every body here
constexpr double kFaceHalf = 1e-7;  // m

}  // namespace

Region slab(int axis, double low, double high) {
  BoxRegion region{Vec3::Constant(-kFar), Vec3::Constant(kFar)};
  region.min[axis] = low;
  region.max[axis] = high;
  return region;
}

Region face(int axis, double at) { return slab(axis, at - kFaceHalf, at + kFaceHalf); }

Problem Problem::rubber(const BodyShape &shape, double spacing, MaterialLaw law) {
  return {.shape = shape,
          .material = {.law = law, .youngsModulus = 1e4, .poissonRatio = 0.3, .restDensity = 1000.0},
          .recipe = {.sampling = {.spacing = spacing}},
          .world = {.integrator = Integrator::quasiStatic}};
}

Problem &Problem::move(const Region &region, const Vec3 &displacement) {
  recipe.fixes.push_back({.region = region, .displacement = displacement});
  return *this;
}

Problem &Problem::turn(const Region &region, const Vec3 &rotation_deg, const Vec3 &centre) {
  recipe.fixes.push_back({.region = region, .rotation_deg = rotation_deg, .centre = centre});
  return *this;
}

Problem &Problem::moveByHand(const Region &region, const Vec3 &displacement) {
  supportsByHand.push_back({.region = region, .displacement = displacement});
  return *this;
}

Problem &Problem::pull(const Region &region, const Vec3 &force) {
  recipe.loads.push_back({.region = region, .force = force});
  return *this;
}

Problem &Problem::atPhyxels() {
  recipe.evaluation = Evaluation::phyxels;
  return *this;
}

SolvedBody::SolvedBody(const Problem &problem) : shape_(problem.shape) {
  const Stopwatch watch;
  const auto rest = shapes::restState(problem.shape, problem.recipe);
  rest_ = rest;
  Constitution constitution{{problem.material},
                            rest_->evaluation == Evaluation::phyxels ? kCloudStabilisation : kLatticeStabilisation};
  simulator_.setWorld(problem.world);
  id_ = simulator_.addBody(std::make_unique<Body>("body", rest_, constitution, serialFor()));
  for (const Obstacle &obstacle : problem.obstacles) simulator_.addObstacle(obstacle);
  std::vector<LiveSupport> supports;
  for (const Fix &fix : problem.supportsByHand) {
    SurfacePoints samples = sampleSurface(shape_.surface, 0.25 * rest_->spacing, fix.region);
    for (Vec3 &x : samples.positions) x -= rest_->origin;
    supports.push_back(liveSupport(*rest_, samples.positions, samples.normals, samples.areas,
                                   std::vector<Vec3>(samples.count(), Vec3::Zero()), body().heldMask()));
    supports.back().to = fix.displacement;
  }
  if (!supports.empty()) body().setLiveSupports(std::move(supports));
  if (simulator_.quasiStatic())
    while (!simulator_.finished())
      if (const auto done = simulator_.step(); !done) throw std::runtime_error(done.error().text);
  if (body().stopped) throw std::runtime_error(body().stopMessage());
  milliseconds_ = watch.milliseconds();
}

SolvedBody::SolvedBody(const Problem &problem, const Verification &verification)
    : shape_(problem.shape), rest_(verification.fineReferenceRest), reactions_(verification.fineReferenceReactions) {
  id_ = simulator_.addBody(
      std::make_unique<Body>("shadow", rest_, Constitution{{problem.material}, kLatticeStabilisation}, serialFor()));
  body().state().displacements = verification.fineReferenceDisplacements;
}

Verification SolvedBody::verify(const Problem &problem) {
  auto verified = pointbased::verify(verificationTarget(simulator_, id_), problem.shape, problem.recipe, serialFor());
  if (!verified) throw std::runtime_error(verified.error());
  return std::move(*verified);
}

void SolvedBody::run(double until) {
  const Stopwatch watch;
  while (simulator_.time() < until)
    if (const auto done = simulator_.step(); !done) throw std::runtime_error(done.error().text);
  if (body().stopped) throw std::runtime_error(body().stopMessage());
  milliseconds_ += watch.milliseconds();
}

std::vector<Vec3> SolvedBody::displacementsOf(const std::vector<Vec3> &points, const std::vector<Vec3> &normals) {
  std::vector<Vec3> local;
  for (const Vec3 &X : points) local.push_back(X - rest_->origin);
  const Interpolation binding = rest_->bind(local, normals);
  std::vector<Vec3> out(points.size());
  interpolateDisplacements(binding, rest_->positions, body().state().displacements, out, serialFor());
  return out;
}

Vec3 SolvedBody::meanOver(const Region &border) {
  const SurfacePoints points = sampleSurface(shape_.surface, 0.25 * rest_->spacing, border);
  if (points.count() == 0) throw std::runtime_error("no part of the border is in the region");
  const std::vector<Vec3> u = displacementsOf(points.positions, points.normals);
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    sum += points.areas[i] * u[i];
    area += points.areas[i];
  }
  return sum / area;
}

Vec3 SolvedBody::meanWithin(const Region &region) {
  // Points of a regular grid, finer than the cells; its own error is far below the measured ones.
  constexpr int n = 32;
  std::vector<Vec3> points;
  const Vec3 extent = shape_.max - shape_.min;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 x = shape_.min + extent.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5)) / n;
        if (contains(region, x)) points.push_back(x);
      }
  std::vector<double> inside(points.size());
  shape_.inside(points, inside);
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (inside[i] > 0.5) kept.push_back(points[i]);
  const std::vector<Vec3> u = displacementsOf(kept, {});
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : u) sum += v;
  return sum / static_cast<double>(u.size());
}

Vec3 SolvedBody::displacementAt(const Vec3 &X) { return displacementsOf({X}, {}).front(); }

Reaction SolvedBody::reaction(std::size_t fix) {
  return reactions_ ? reactions_->at(fix) : simulator_.diagnostics().reactions(id_).at(fix);
}

Vec3 SolvedBody::torqueAboutOrigin(std::size_t fix) {
  const Reaction r = reaction(fix);
  return r.torque + r.centre.cross(r.force);
}

Vec3 SolvedBody::momentum() {
  Vec3 sum = Vec3::Zero();
  const Body &b = body();
  for (std::size_t i = 0; i < rest_->phyxelCount(); ++i) sum += b.masses()[i] * b.state().velocities[i];
  return sum;
}

Vec3 SolvedBody::angularMomentum() {
  Vec3 sum = Vec3::Zero();
  const Body &b = body();
  for (std::size_t i = 0; i < rest_->phyxelCount(); ++i)
    sum += (rest_->positions[i] + b.state().displacements[i]).cross(b.masses()[i] * b.state().velocities[i]);
  return sum;
}

}  // namespace validation
