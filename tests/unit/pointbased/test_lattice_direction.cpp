// SPDX-License-Identifier: Apache-2.0
// The orientation of a lattice in its body.
#include "discretisation/lattice/lattice_direction.h"

#include <numbers>

#include "lattice_cases.h"
#include "support/catch.h"

using namespace lattice_cases;
using lattice::latticeDirection;
using shapes::turned;

namespace {

Mat3 anyRotation(std::uint64_t seed) {
  support::Random random(seed);
  const double w = random(), x = random(), y = random(), z = random();
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

/// Angle between the axes of two lattices, apart from names and signs.
double between(const Mat3 &a, const Mat3 &b) {
  const Mat3 cosines = (a.transpose() * b).cwiseAbs();
  return (Vec3::Ones() - cosines.rowwise().maxCoeff()).cwiseMax(0.0).cwiseSqrt().maxCoeff();
}

/// The lateral surface of a prism over a polygon, without its ends: only the normals are used.
BodyShape prism(int sides, double length) {
  BodyShape shape;
  shape.volume = 1.0;
  Surface &s = shape.surface;
  for (int i = 0; i < sides; ++i)
    for (const double x : {0.0, length}) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.3) / sides;
      s.positions.emplace_back(x, std::cos(angle), std::sin(angle));
    }
  const auto at = [&](int i, int end) { return static_cast<Index>(2 * (i % sides) + end); };
  for (int i = 0; i < sides; ++i) {
    s.triangles.push_back({at(i, 0), at(i, 1), at(i + 1, 1)});
    s.triangles.push_back({at(i, 0), at(i + 1, 1), at(i + 1, 0)});
  }
  return shape;
}

}  // namespace

TEST_CASE("a lattice lies along the faces of its body however that is turned") {
  const BodyShape beam = box(Vec3(0, -0.02, -0.02), Vec3(0.2, 0.02, 0.02));
  CHECK(latticeDirection(beam, {}) == Mat3::Identity());
  const LatticeBody straight = filled(beam, withSpacing(0.01));
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    INFO("rotation " << seed);
    const Mat3 turn = anyRotation(seed);
    const BodyShape body = turned(beam, turn);
    const Mat3 axes = latticeDirection(body, {});
    CHECK((axes.transpose() * axes - Mat3::Identity()).norm() < 1e-12);
    CHECK(axes.determinant() > 0.0);
    CHECK(between(axes, turn) < 1e-6);
    if (seed > 5) continue;
    // Every cell is whole again, as for the aligned box.
    const LatticeBody oblique = filled(body, withSpacing(0.01));
    CHECK(oblique.positions.size() == straight.positions.size());
    CHECK(oblique.stencils.pointCount() == straight.stencils.pointCount());
    CHECK(patchError(oblique, body) < 1e-3);
  }
}

TEST_CASE("a lattice lies along a bar of any section, and of a body without faces along the world") {
  for (const int sides : {3, 5, 6, 96})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      INFO(sides << " sides, rotation " << seed);
      const Mat3 turn = anyRotation(seed);
      const Mat3 axes = latticeDirection(turned(prism(sides, 10.0), turn), {});
      CHECK((axes.transpose() * turn.col(0)).cwiseAbs().maxCoeff() > 1.0 - 1e-9);
    }
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    CHECK(latticeDirection(turned(ball(Vec3::Zero(), 0.05), anyRotation(seed)), {}) == Mat3::Identity());
}

TEST_CASE("a lattice lies along the half-space that holds a body without faces, not one that has them") {
  const Vec3 normal = Vec3(-0.2, 0.9, 0.5).normalized();
  const std::vector<Region> held = {SphereRegion{Vec3::Zero(), 0.01}, HalfSpaceRegion{Vec3(0, -0.02, 0), normal}};
  const Mat3 axes = latticeDirection(ball(Vec3::Zero(), 0.05), held);
  CHECK((axes.col(1) - normal).norm() < 1e-12);
  CHECK(axes(0, 0) > 0.5);
  CHECK(axes(2, 2) > 0.5);
  CHECK(latticeDirection(box(Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3)), held) == Mat3::Identity());
}

TEST_CASE("axes that are asked for are kept, and so are those of voxels") {
  const Mat3 turn = anyRotation(7);
  const BodyShape body = turned(box(Vec3(0, 0, 0), Vec3(0.1, 0.05, 0.04)), turn);
  LatticeSampling sampling = withSpacing(0.01);
  sampling.axes = Mat3::Identity();
  CHECK(filled(body, sampling).stencils.axes == Mat3::Identity());
  CHECK(between(filled(body, withSpacing(0.01)).stencils.axes, turn) < 1e-6);
  BodyShape voxels = body;
  voxels.shares = [](std::span<const Vec3>, const Mat3 &, double, std::span<double>, std::span<double>) {};
  CHECK(latticeDirection(voxels, {}) == Mat3::Identity());
}
