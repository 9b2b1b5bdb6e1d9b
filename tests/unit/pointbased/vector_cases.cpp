// SPDX-License-Identifier: Apache-2.0
#include "vector_cases.h"

#include <hwy/targets.h>
#include <algorithm>
#include <stdexcept>

#include "support/catch.h"

namespace vector_cases {

std::shared_ptr<const RestState> latticeBody(const BodyShape &shape, LatticeSampling sampling) {
  return shapes::restState(shape, {.sampling = std::move(sampling)});
}

std::vector<Case> bodies() {
  const BodyShape ball = shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05);
  LatticeSampling plain, turned, refined, twice;
  plain.count = turned.count = 400;
  turned.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  refined.spacing = 0.02;
  refined.refinements.push_back({BoxRegion{Vec3(0.05, 0.1, -0.2), Vec3(0.1, 0.3, 0.0)}, 0.01});
  twice.spacing = 0.03;
  twice.refinements.push_back({SphereRegion{Vec3(0.13, 0.2, -0.1), 0.015}, 0.0075});
  return {{"cut cells", latticeBody(ball, plain)},
          {"turned lattice", latticeBody(ball, turned)},
          {"refined lattice", latticeBody(ball, refined)},
          {"two lobes", latticeBody(shapes::horseshoe(), plain)},
          {"refined twice", latticeBody(ball, twice)}};
}

std::vector<Case> clouds() {
  const BodyShape ball = shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05);
  // A tail one phyxel thick: stencils that span only a line or a plane.
  std::vector<Vec3> tailed;
  for (const Vec3 &x : shapes::filled(ball, 0.012).positions) tailed.push_back(x);
  for (int i = 0; i < 9; ++i) tailed.emplace_back(0.155 + 0.012 * i, 0.2, -0.1);
  return {{"ball", shapes::restState(ball, 0.012)},
          {"many neighbours", shapes::restState(ball, 0.012, NeighborChoice{26, 1.8})},
          {"tail", shapes::restState(tailed, 0.012)}};
}

Material materialOf(MaterialLaw law) { return Material{.law = law, .youngsModulus = 6000.0, .poissonRatio = 0.45}; }

void deform(Body &body, double size, double noise, std::uint64_t seed) {
  support::Random random(seed);
  Mat3 A;
  for (int c = 0; c < 3; ++c) A.col(c) = size * random.vector();
  const Mat3 R = Eigen::AngleAxisd(2.0 * size, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  const Mat3 H = R * (Mat3::Identity() + A) - Mat3::Identity();
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] =
        H * body.rest().positions[i] + noise * body.rest().spacing * random.vector() + Vec3(0.01, -0.02, 0.03);
}

double relativeDifference(std::span<const Vec3> of, std::span<const Vec3> other) {
  std::vector<Vec3> off;
  for (std::size_t i = 0; i < of.size(); ++i) off.push_back(of[i] - other[i]);
  return largest(off) / largest(of);
}

ParallelFor inPieces() {
  return [](std::size_t n, std::size_t, const std::function<void(std::size_t, std::size_t)> &body) {
    for (std::size_t end = n; end > 0;) {
      const std::size_t begin = end > 7 ? end - 7 : 0;
      body(begin, end);
      end = begin;
    }
  };
}

InstructionSets::InstructionSets() {
  for (const std::int64_t target : {HWY_AVX3, HWY_AVX2})
    if ((hwy::SupportedTargets() & target) != 0) fused_.push_back(target);
}

InstructionSets::~InstructionSets() {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

void InstructionSets::use(std::int64_t target) const {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  REQUIRE(kernelTarget() == hwy::TargetName(target));
}

}  // namespace vector_cases
