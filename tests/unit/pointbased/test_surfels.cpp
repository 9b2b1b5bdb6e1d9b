// SPDX-License-Identifier: Apache-2.0
#include "lattice_cases.h"
#include "pointbased/surfels.h"
#include "support/catch.h"

using namespace pointbased;
using namespace lattice_cases;

namespace {

struct Skin {
  std::vector<Vec3> phyxels, points, normals, displacements;
  Interpolation binding;
};

std::vector<Vec3> bent(const std::vector<Vec3> &phyxels, const Vec3 &shift) {
  std::vector<Vec3> u(phyxels.size());
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vec3 &X = phyxels[i];
    u[i] = turn * Vec3(X[0] + 2.0 * X[1] * X[2], 1.2 * X[1] + 3.0 * X[0] * X[0], 0.9 * X[2] + X[0] * X[1]) + shift - X;
  }
  return u;
}

// A ball in a rotated lattice, refined at one side so that corners hang.
Skin ballSkin(bool refined) {
  Skin skin;
  LatticeSampling sampling = withSpacing(0.02);
  sampling.axes = rotation(2, 20.0) * rotation(0, 35.0);
  if (refined) {
    Refinement refinement;
    refinement.region = SphereRegion{Vec3(0.05, 0.0, 0.0), 0.03};
    refinement.spacing = 0.01;
    sampling.refinements.push_back(refinement);
  }
  const LatticeBody body = filled(ball(Vec3::Zero(), 0.05), sampling);
  skin.phyxels = body.positions;
  shapes::Random random(5);
  for (int p = 0; p < 500; ++p) {
    skin.normals.push_back(random.vector().normalized());
    skin.points.push_back(0.05 * skin.normals.back() - body.origin);
  }
  skin.binding = body.cells->bind(skin.points, skin.normals, serialFor());
  skin.displacements = bent(skin.phyxels, Vec3(0.3, -0.1, 0.2));
  return skin;
}

Skin cloudSkin(bool flat) {
  Skin skin;
  shapes::Random random(9);
  for (int i = 0; i < 300; ++i) {
    skin.phyxels.push_back(0.05 * random.vector());
    if (flat) skin.phyxels.back()[2] = 0.0;
  }
  for (int p = 0; p < 200; ++p) {
    skin.points.push_back(0.06 * random.vector());
    if (flat) skin.points.back()[2] *= 0.1;
    skin.normals.push_back(random.vector().normalized());
  }
  skin.binding = bindToCloud(skin.points, skin.phyxels, serialFor());
  skin.displacements = bent(skin.phyxels, Vec3(0.3, -0.1, 0.2));
  return skin;
}

struct Errors {
  double position = 0.0, normal = 0.0;  // m, rad
};

// Single precision at `origin` against the original binding.
Errors errorsOnScreen(const Skin &skin, const Vec3 &origin, const Vec3 &far) {
  std::vector<Vec3> u = skin.displacements;
  for (Vec3 &x : u) x += far;
  const std::size_t n = skin.points.size();
  std::vector<Vec3> x(n), N(n);
  updateSurfels(skin.binding, skin.normals, skin.phyxels, u, x, N, serialFor());
  std::vector<Vec3f> screen(n), normals(n);
  ScreenPhyxels scratch;
  updateSurfels(Surfels(skin.binding), skin.normals, origin, skin.phyxels, u, scratch, screen, normals, serialFor());
  Errors errors;
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3 at(screen[p][0], screen[p][1], screen[p][2]), normal(normals[p][0], normals[p][1], normals[p][2]);
    errors.position = std::max(errors.position, (at - x[p] - origin).norm());
    errors.normal = std::max(errors.normal, (normal - N[p]).norm());
  }
  return errors;
}

}  // namespace

TEST_CASE("A skin in cells takes 64 bytes a point and gives its functions back to rounding") {
  const Skin skin = ballSkin(false);
  const Surfels surfels(skin.binding);
  CHECK(surfels.inCells() == skin.points.size());
  // With a normal in double precision the size must stay below 96.
  CHECK(surfels.bytes() + 24 * skin.points.size() < 96 * skin.points.size());
  CHECK(surfels.frames().size() == 1);
  const Interpolation back = surfels.expanded(skin.phyxels);
  REQUIRE(back.phyxels.indices == skin.binding.phyxels.indices);
  double weights = 0.0, gradients = 0.0, positions = 0.0;
  for (std::size_t e = 0; e < back.weights.size(); ++e) {
    weights = std::max(weights, std::abs(back.weights[e] - skin.binding.weights[e]));
    gradients = std::max(gradients, 0.02 * (back.gradients[e] - skin.binding.gradients[e]).norm());
  }
  for (std::size_t p = 0; p < skin.points.size(); ++p)
    positions = std::max(positions, (back.positions[p] - skin.points[p]).norm());
  CHECK(weights < 1e-13);
  CHECK(gradients < 1e-13);
  CHECK(positions < 1e-15);
}

TEST_CASE("What is no trilinear row of one cell is kept as it is") {
  for (const Skin &skin : {ballSkin(true), cloudSkin(false), cloudSkin(true)}) {
    const Surfels surfels(skin.binding);
    CHECK(surfels.inCells() < surfels.count());
    const Interpolation back = surfels.expanded(skin.phyxels);
    CHECK(back.phyxels.offsets == skin.binding.phyxels.offsets);
    CHECK(back.phyxels.indices == skin.binding.phyxels.indices);
    CHECK(back.rank == skin.binding.rank);
    REQUIRE(back.offsets.size() == skin.binding.offsets.size());
    for (std::size_t p = 0; p < surfels.count(); ++p) {
      if (surfels.cellPoints()[p].frame != Surfels::kRow) continue;
      for (Index e = back.phyxels.offsets[p]; e < back.phyxels.offsets[p + 1]; ++e) {
        CHECK(back.weights[e] == skin.binding.weights[e]);
        CHECK(back.gradients[e] == skin.binding.gradients[e]);
      }
    }
  }
}

TEST_CASE("Packed skins move in double precision as their bindings do") {
  for (const Skin &skin : {ballSkin(false), ballSkin(true), cloudSkin(false), cloudSkin(true)}) {
    const std::size_t n = skin.points.size();
    std::vector<Vec3> x(n), N(n), packed(n), packedN(n);
    updateSurfels(skin.binding, skin.normals, skin.phyxels, skin.displacements, x, N, serialFor());
    updateSurfels(Surfels(skin.binding), skin.normals, skin.phyxels, skin.displacements, packed, packedN, serialFor());
    double positions = 0.0, normals = 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      positions = std::max(positions, (x[p] - packed[p]).norm());
      normals = std::max(normals, (N[p] - packedN[p]).norm());
    }
    CHECK(positions < 1e-15);
    CHECK(normals < 1e-12);
  }
}

TEST_CASE("On a screen skins are right to single precision of the body's own size") {
  // Coordinates relative to a phyxel are up to 0.2 m: 1e-8 m each; the normal is off by that over the spacing, 5 mm and
  // more in the clouds, the absolute sum of whose functions is some times 1 outside of them.
  for (const Skin &skin : {ballSkin(false), ballSkin(true)}) {
    const Errors errors = errorsOnScreen(skin, Vec3::Zero(), Vec3::Zero());
    CHECK(errors.position < 6e-8);
    CHECK(errors.normal < 1e-5);
  }
  const Errors cloud = errorsOnScreen(cloudSkin(false), Vec3::Zero(), Vec3::Zero());
  CHECK(cloud.position < 3e-7);
  CHECK(cloud.normal < 1e-4);
  const Errors flat = errorsOnScreen(cloudSkin(true), Vec3::Zero(), Vec3::Zero());
  CHECK(flat.position < 1e-7);
  CHECK(flat.normal < 1e-6);
}

TEST_CASE("A body far away keeps its shape on a screen but for the rounding of world coordinates") {
  const Skin skin = ballSkin(false);
  const Errors near = errorsOnScreen(skin, Vec3::Zero(), Vec3::Zero());
  const Errors moved = errorsOnScreen(skin, Vec3(100.0, -50.0, 20.0), Vec3(900.0, 0.0, 0.0));
  CHECK(moved.position < 1e-4);  // half a digit of 1000 m, twice: the reference, and the sum
  CHECK(moved.normal < 2.0 * near.normal + 1e-7);
}

TEST_CASE("A skin on a screen is the same for any division of the loop") {
  for (const Skin &skin : {ballSkin(true), cloudSkin(false)}) {
    const Surfels surfels(skin.binding);
    const std::size_t n = skin.points.size();
    ScreenPhyxels scratch;
    std::vector<Vec3f> x(n), N(n), others(n), otherN(n);
    updateSurfels(surfels, skin.normals, Vec3::Zero(), skin.phyxels, skin.displacements, scratch, x, N, serialFor());
    updateSurfels(surfels, skin.normals, Vec3::Zero(), skin.phyxels, skin.displacements, scratch, others, otherN,
                  threadedFor(3));
    CHECK(x == others);
    CHECK(N == otherN);
    updateSurfels(surfels, {}, Vec3::Zero(), skin.phyxels, skin.displacements, scratch, others, {}, serialFor());
    CHECK(x == others);
  }
}

TEST_CASE("A collapsed skin keeps the normals it had at rest") {
  const Skin skin = ballSkin(true);
  std::vector<Vec3> u;
  for (const Vec3 &X : skin.phyxels) u.push_back(-X);
  std::vector<Vec3f> x(skin.points.size()), N(skin.points.size());
  ScreenPhyxels scratch;
  updateSurfels(Surfels(skin.binding), skin.normals, Vec3::Zero(), skin.phyxels, u, scratch, x, N, serialFor());
  for (std::size_t p = 0; p < x.size(); ++p) CHECK((Vec3(N[p][0], N[p][1], N[p][2]) - skin.normals[p]).norm() < 1e-6);
}
