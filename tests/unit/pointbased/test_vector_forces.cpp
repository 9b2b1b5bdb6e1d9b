// SPDX-License-Identifier: Apache-2.0
// The vector kernels against the scalar engine, which remains the slower, plainer implementation of the same forces.
#include <algorithm>
#include <cmath>
#include <limits>

#include "forces/kernels/cell_layout.h"
#include "support/catch.h"
#include "vector_cases.h"

using namespace vector_cases;

namespace {

// Largest difference of the two implementations, over the largest force; and the relative gain of the stable step.
struct Difference {
  double forces, step;
};
Difference difference(Body &body) {
  REQUIRE(body.vectorised());
  body.evaluate(0.0, 0.0, serialFor());
  const std::vector<Vec3> fast(body.forces().begin(), body.forces().end());
  const double step = body.stableStep();
  shapes::evaluate(body);
  return {relativeDifference(body.forces(), fast), step / body.stableStep() - 1.0};
}

}  // namespace

TEST_CASE("vector kernels give the forces of the scalar engine in double precision", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const Case &c : lattice ? bodies() : clouds())
      for (const MaterialLaw law : kLaws)
        for (const bool stabilised : {true, false})
          for (const double volumeStiffness : {0.0, 1e4})
            for (const double size : {1e-6, 0.05, 0.4}) {
              Material m = materialOf(law);
              m.volumeStiffness = volumeStiffness;
              const double stabilisation = !stabilised ? 0.0 : lattice ? kLatticeStabilisation : kCloudStabilisation;
              Body body("b", c.rest, Constitution{{m}, stabilisation}, serialFor());
              deform(body, size, 0.2 * size, 7);
              INFO(c.name << ", law " << static_cast<int>(law) << ", strain " << size << ", k_v " << volumeStiffness);
              const Difference d = difference(body);
              // Round-off of displacements of centimetres over strains of 1e-6 (the smallest case), and of sums.
              CHECK(d.forces < (size < 1e-3 ? 1e-8 : 1e-11));
              // Clouds use the root of the largest ratio of all points; lattices weigh its effect on a phyxel's mass.
              CHECK(d.step > -0.01);
              if (!lattice) CHECK(d.step < 0.01);
            }
}

TEST_CASE("cells beside larger ones are taken by the kernels", "[kernels]") {
  for (const std::size_t which : {2u, 4u}) {
    const Case one = bodies()[which];
    const auto &rest = one.rest;
    CAPTURE(one.name);
    const HangingCells &hanging = rest->stencils.hanging;
    REQUIRE(hanging.points.size() > 50);
    REQUIRE(hanging.phyxels.rows() > 30);
    const std::uint8_t suits = 1;
    std::size_t longest = 0;
    for (std::size_t q = 0; q < rest->pointCount(); ++q)
      longest = std::max(longest, rest->stencils.phyxels.row(q).size());
    CAPTURE(longest);
    CHECK(kernels::planCells(rest->stencils, 8, {&suits, 1}).others.empty());
    for (const HangingCells::Point &point : hanging.points) {
      // Hanging corners move with their phyxels: the corners are those of a cube.
      std::array<Vec3, 8> corners;
      for (std::size_t j = 0; j < 8; ++j) {
        corners[j] = Vec3::Zero();
        hanging.visit(point.corners[j],
                      [&](Index phyxel, double weight) { corners[j] += weight * rest->positions[phyxel]; });
      }
      const double edge = 0.25 / point.shape.gradient;
      for (std::size_t j = 0; j < 8; ++j) {
        const Vec3 expected = corners[0] + edge * Vec3(j & 1, j >> 1 & 1, j >> 2);
        CHECK((corners[j] - expected).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("viscous forces by kernels are those of the scalar engine", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const Case &c : lattice ? bodies() : clouds())
      for (const double size : {0.0, 0.1}) {
        Material m = materialOf(MaterialLaw::neoHookean);
        m.viscosity = 100.0;
        Body body("b", c.rest, Constitution{{m}, lattice ? kLatticeStabilisation : kCloudStabilisation}, serialFor());
        deform(body, size, 0.2 * size, 7);
        support::Random random(13);
        for (Vec3 &v : body.state().velocities) v = Vec3(1, 2, 3) + random.vector();
        INFO(c.name << ", strain " << size);
        CHECK(difference(body).forces < 1e-11);
      }
}

TEST_CASE("single precision errs by a millionth of the stress that its strain's round-off makes", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const Case &c : lattice ? bodies() : clouds())
      for (const MaterialLaw law : kLaws) {
        Body body("b", c.rest, Constitution{{materialOf(law)}, lattice ? kLatticeStabilisation : kCloudStabilisation},
                  serialFor());
        deform(body, 0.05, 0.02, 11);
        body.setPrecision(Precision::singlePrecision);
        INFO(c.name << ", law " << static_cast<int>(law));
        // 6e-8 of displacements of 0.05 m over a spacing of 0.01 m, a strain of 3e-7, compared with strains of 0.1;
        // stiffer in volume by K/mu = 10, some such errors in each sum.
        CHECK(difference(body).forces < 2e-5);
      }
}

TEST_CASE("collapsed and mirrored cells are answered as by the scalar engine", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const MaterialLaw law : kLaws) {
      const Case c = lattice ? bodies().front() : clouds().front();
      Body body("b", c.rest, Constitution{{materialOf(law)}, lattice ? kLatticeStabilisation : kCloudStabilisation},
                serialFor());
      support::Random random(5);
      // J between -1 and 1, smoothly along the body.
      for (std::size_t i = 0; i < c.rest->phyxelCount(); ++i) {
        const Vec3 &X = c.rest->positions[i];
        body.state().displacements[i] = Vec3(-20.0 * X.x() * X.x(), 0.1 * X.z(), 0.0) + 1e-4 * random.vector();
      }
      INFO("law " << static_cast<int>(law) << (lattice ? ", lattice" : ", cloud"));
      const Difference d = difference(body);
      CHECK(d.forces < 1e-9);  // near a singular F the rotation of the corotated law is accurate to fewer digits
      CHECK(d.step > -0.05);
      if (!lattice) CHECK(d.step < 0.05);
    }
}

namespace {

// At the current displacements, by power iteration.
double largestSquaredFrequency(Body &body, const Constitution &constitution, support::Random &random) {
  const RestState &rest = body.rest();
  body.computeGradients(serialFor());
  std::vector<Vec3> mode(rest.phyxelCount()), force(mode.size());
  for (Vec3 &x : mode) x = random.vector();
  TangentScratch scratch;
  double squared = 0.0;
  for (int k = 0; k < 200; ++k) {
    forceDifferential(constitution, rest.stencils, rest.positions, body.state().displacements, body.gradients(),
                      PointHistory(), 0.0, 0.0, mode, scratch, force, serialFor());
    double top = 0.0, bottom = 0.0, most = 0.0;
    for (std::size_t i = 0; i < mode.size(); ++i) {
      top -= mode[i].dot(force[i]);
      bottom += body.masses()[i] * mode[i].squaredNorm();
      force[i] /= -body.masses()[i];
      most = std::max(most, force[i].norm());
    }
    squared = top / bottom;
    for (std::size_t i = 0; i < mode.size(); ++i) mode[i] = force[i] / most;
  }
  return squared;
}

}  // namespace

TEST_CASE("cells that are bent far out of shape take the steps that their modes need", "[kernels]") {
  const LatticeSampling one{.spacing = 0.02};
  for (const double amplitude : {0.5, 2.0, 5.0, 20.0}) {
    const Constitution constitution{{materialOf(MaterialLaw::neoHookean)}, kLatticeStabilisation};
    Body body("cell", latticeBody(shapes::box(Vec3::Zero(), Vec3(0.02, 0.02, 0.02)), one), constitution, serialFor());
    REQUIRE(body.vectorised());
    // A mode of the cell alone: F is unchanged.
    for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
      const Vec3 &X = body.rest().positions[i];
      body.state().displacements[i] = Vec3(amplitude * X[1] * X[2] / 0.01, 0.0, 0.0);
    }
    body.evaluate(0.0, 0.0, serialFor());
    support::Random random(3);
    const double squared = largestSquaredFrequency(body, constitution, random);
    INFO("amplitude " << amplitude << ": " << body.stableStep() * std::sqrt(squared) / 2.0);
    CHECK(body.stableStep() * std::sqrt(squared) / 2.0 < 1.07);
  }
}

TEST_CASE("the stable step of strained lattices is stable, and little shorter than it has to be", "[kernels]") {
  for (const Case &c : bodies())
    for (const MaterialLaw law : {MaterialLaw::neoHookean, MaterialLaw::stVenantKirchhoff})
      for (const double crushed : {0.0, 0.3, 0.6}) {
        const Constitution constitution{{materialOf(law)}, kLatticeStabilisation};
        Body body("b", c.rest, constitution, serialFor());
        // Compressed towards one end, increasingly; bulging laterally or not.
        const Vec3 low = c.rest->positions.front();
        support::Random random(21);
        for (std::size_t i = 0; i < c.rest->phyxelCount(); ++i) {
          const Vec3 X = c.rest->positions[i] - low;
          body.state().displacements[i] =
              Vec3(0.2 * crushed * X.x(), -crushed * X.y() * std::exp(-std::abs(X.y()) / 0.02), 0.0) +
              0.02 * crushed * c.rest->spacing * random.vector();
        }
        body.evaluate(0.0, 0.0, serialFor());
        const double step = body.stableStep();
        const double squared = largestSquaredFrequency(body, constitution, random);
        INFO(c.name << ", law " << static_cast<int>(law) << ", crushed " << crushed << ": "
                    << step * std::sqrt(squared) / 2.0);
        // Steps use up to 0.92 of it: 8 % are left for the error of the weighting.
        CHECK(step * std::sqrt(squared) / 2.0 < 1.07);
        CHECK(step * std::sqrt(squared) / 2.0 > 0.5);
      }
}

TEST_CASE("a number that is none reaches the bound of the step", "[kernels]") {
  for (const bool lattice : {true, false}) {
    const Case c = lattice ? bodies().front() : clouds().front();
    Body body("b", c.rest, Constitution{{materialOf(MaterialLaw::neoHookean)}, 0.1}, serialFor());
    for (const std::size_t phyxel : {std::size_t{0}, c.rest->phyxelCount() / 2, c.rest->phyxelCount() - 1}) {
      body.state().displacements[phyxel][1] = std::numeric_limits<double>::quiet_NaN();
      body.evaluate(0.0, 0.0, serialFor());
      CHECK(std::isnan(body.stableStep()));
      body.state().displacements[phyxel][1] = 0.0;
    }
  }
}

TEST_CASE("products with the tangent are those of the scalar engine", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const Case &c : lattice ? bodies() : clouds())
      for (const MaterialLaw law : kLaws)
        for (const double volumeStiffness : {0.0, 1e4})
          for (const double size : {0.0, 0.05, 0.4}) {
            Material m = materialOf(law);
            m.volumeStiffness = volumeStiffness;
            const double viscousScale = volumeStiffness > 0.0 ? 60.0 : 0.0;
            m.viscosity = volumeStiffness > 0.0 ? 40.0 : 0.0;
            const Constitution constitution{{m}, lattice ? kLatticeStabilisation : kCloudStabilisation};
            Body body("b", c.rest, constitution, serialFor());
            deform(body, size, 0.2 * size, 7);
            support::Random random(9);
            std::vector<Vec3> du(c.rest->phyxelCount()), fast(du.size()), plain(du.size());
            for (Vec3 &d : du) d = random.vector();
            body.linearise(serialFor());
            body.forceDifferential(du, viscousScale, fast, serialFor());
            body.computeGradients(serialFor());
            TangentScratch scratch;
            forceDifferential(constitution, c.rest->stencils, c.rest->positions, body.state().displacements,
                              body.gradients(), PointHistory(), 0.0, viscousScale, du, scratch, plain, serialFor());
            INFO(c.name << ", law " << static_cast<int>(law) << ", strain " << size << ", k_v " << volumeStiffness);
            CHECK(relativeDifference(plain, fast) < 1e-10);  // round-off, and that of the rotation of the corotated law
          }
}

TEST_CASE("energies by kernels are those of the scalar engine", "[kernels]") {
  for (const Case &c : bodies())
    for (const MaterialLaw law : kLaws)
      for (const double size : {0.02, 0.4}) {
        Material m = materialOf(law);
        m.volumeStiffness = 1e3;
        Body body("b", c.rest, Constitution{{m}, kLatticeStabilisation}, serialFor());
        deform(body, size, 0.2 * size, 7);
        const ElasticEnergy fast = body.elasticEnergy(serialFor());
        body.computeGradients(serialFor());
        const ElasticEnergy plain = body.elasticEnergy();
        INFO(c.name << ", law " << static_cast<int>(law) << ", strain " << size);
        CHECK(fast.strain == Approx(plain.strain).epsilon(1e-11));
        CHECK(fast.stabilisation == Approx(plain.stabilisation).epsilon(1e-11));
      }
}

namespace {

// A ball with a part of another material cut off by a plane.
std::shared_ptr<const RestState> ballOfTwo(LatticeSampling sampling) {
  sampling.materials = {{HalfSpaceRegion{Vec3(0.112, 0.2, -0.1), -Vec3(1.0, 0.3, 0.2).normalized()}, 1}};
  return latticeBody(shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05), sampling);
}

// Cells next to larger ones, that contain both.
std::shared_ptr<const RestState> refinedBallOfTwo() {
  return ballOfTwo({.spacing = 0.02, .refinements = {{BoxRegion{Vec3(0.05, 0.1, -0.2), Vec3(0.2, 0.2, 0.0)}, 0.01}}});
}

// A cube of one cell; what lies beyond each plane is of another material.
std::shared_ptr<const RestState> cellOf(const std::vector<HalfSpaceRegion> &parts) {
  LatticeSampling sampling{.spacing = 0.02, .axes = Mat3(Mat3::Identity())};
  for (const HalfSpaceRegion &part : parts)
    sampling.materials.emplace_back(part, static_cast<std::uint16_t>(sampling.materials.size() + 1));
  const auto rest = latticeBody(shapes::box(Vec3::Zero(), Vec3::Constant(0.02)), sampling);
  REQUIRE(rest->pointCount() == parts.size() + 1);
  return rest;
}

Constitution softAndStiff(MaterialLaw one, MaterialLaw other, double ratio) {
  Material soft = materialOf(one), stiff = materialOf(other);
  stiff.youngsModulus = ratio * soft.youngsModulus;
  stiff.poissonRatio = 0.2;
  return Constitution{{soft, stiff}, kLatticeStabilisation};
}

}  // namespace

TEST_CASE("several materials of a body are each answered by their own law", "[kernels]") {
  const BodyShape ball = shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05);
  const LatticeSampling sampling{.count = 400,
                                 .materials = {{BoxRegion{Vec3(0.115, 0.1, -0.2), Vec3(0.2, 0.3, 0.0)}, 1}}};
  // Auxetic: no kernel implements its neo-Hookean energy, the scalar engine computes it, and cells of both materials
  // have one strain.
  Material soft = materialOf(MaterialLaw::neoHookean), auxetic = soft;
  auxetic.poissonRatio = -0.3;
  Body body("b", latticeBody(ball, sampling), Constitution{{soft, auxetic}, kLatticeStabilisation}, serialFor());
  deform(body, 0.2, 0.05, 3);
  CHECK(difference(body).forces < 1e-11);
}

TEST_CASE("forces of cells of two materials are the gradient of their energy, and products its second one",
          "[kernels]") {
  for (const auto &[one, other] : {std::pair(MaterialLaw::neoHookean, MaterialLaw::neoHookean),
                                   std::pair(MaterialLaw::corotated, MaterialLaw::stVenantKirchhoff),
                                   std::pair(MaterialLaw::linear, MaterialLaw::linear)})
    for (const double ratio : {3.0, 100.0})
      for (const double stabilisation : {0.0, kLatticeStabilisation})
        for (const auto &[size, rest] :
             {std::pair(1e-3, ballOfTwo({.count = 150})), std::pair(0.15, ballOfTwo({.count = 150})),
              std::pair(0.15, refinedBallOfTwo())}) {
          Constitution constitution = softAndStiff(one, other, ratio);
          constitution.stabilisation = stabilisation;
          Body body("b", rest, constitution, serialFor());
          REQUIRE(body.vectorised());
          CAPTURE(static_cast<int>(one), ratio, stabilisation, size);
          deform(body, size, 0.1 * size, 7);
          std::vector<Mat3> ofCells(rest->pointCount());
          deformationGradients(rest->stencils, body.state().displacements, ofCells, serialFor());
          std::size_t mixed = 0;
          for (std::size_t q = 0; q < ofCells.size(); ++q)
            mixed += (body.gradients()[q] - ofCells[q]).norm() > 1e-3 * size ? 1 : 0;
          REQUIRE(mixed > 20);
          const std::vector<Vec3> at = body.state().displacements;
          support::Random random(5);
          std::vector<Vec3> du(at.size()), product(at.size());
          for (Vec3 &d : du) d = random.vector();
          const auto moved = [&](double by) {
            for (std::size_t i = 0; i < at.size(); ++i) body.state().displacements[i] = at[i] + by * du[i];
            body.invalidatePointValues();
          };
          const auto energyAt = [&](double by) {
            moved(by);
            return body.elasticEnergy(serialFor()).strain + body.elasticEnergy(serialFor()).stabilisation;
          };
          const auto forcesAt = [&](double by) {
            moved(by);
            body.evaluateInternal(false, serialFor());
            return std::vector<Vec3>(body.forces().begin(), body.forces().end());
          };
          // Central differences of fourth order: the remaining error is their round-off.
          const double h = 1e-3 * size * rest->spacing;
          const double slope =
              (8.0 * (energyAt(h) - energyAt(-h)) - energyAt(2.0 * h) + energyAt(-2.0 * h)) / (12.0 * h);
          const std::vector<Vec3> forces = forcesAt(0.0);
          double work = 0.0, size2 = 0.0;
          for (std::size_t i = 0; i < at.size(); ++i) {
            work -= forces[i].dot(du[i]);
            size2 += std::abs(forces[i].dot(du[i]));
          }
          CHECK(std::abs(work - slope) < 1e-6 * size2);
          Vec3 sum = Vec3::Zero();
          for (const Vec3 &f : forces) sum += f;
          CHECK(sum.norm() < 1e-10 * largest(forces));
          moved(0.0);
          body.linearise(serialFor());
          body.forceDifferential(du, 0.0, product, serialFor());
          const auto one1 = forcesAt(h), one2 = forcesAt(-h), two1 = forcesAt(2.0 * h), two2 = forcesAt(-2.0 * h);
          std::vector<Vec3> numeric(at.size());
          for (std::size_t i = 0; i < at.size(); ++i)
            numeric[i] = (8.0 * (one1[i] - one2[i]) - two1[i] + two2[i]) / (12.0 * h);
          CHECK(relativeDifference(numeric, product) < 1e-6);
        }
}

TEST_CASE("a turn strains no cell of two materials, and turns the forces of a strained one with it", "[kernels]") {
  const auto rest = ballOfTwo({.count = 150});
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision}) {
    Body body("b", rest, softAndStiff(MaterialLaw::neoHookean, MaterialLaw::neoHookean, 100.0), serialFor());
    body.setPrecision(precision);
    const double allowed = precision == Precision::doublePrecision ? 1e-9 : 2e-4;
    deform(body, 0.1, 0.02, 3);
    const std::vector<Vec3> strained = body.state().displacements;
    body.evaluate(0.0, 0.0, serialFor());
    const std::vector<Vec3> before(body.forces().begin(), body.forces().end());
    const auto turned = [&](std::span<const Vec3> u) {
      for (std::size_t i = 0; i < u.size(); ++i)
        body.state().displacements[i] = R * (rest->positions[i] + u[i]) - rest->positions[i];
      body.evaluate(0.0, 0.0, serialFor());
      std::vector<Vec3> back;
      for (const Vec3 &f : body.forces()) back.push_back(R.transpose() * f);
      return back;
    };
    CHECK(relativeDifference(before, turned(strained)) < allowed);
    CHECK(largest(turned(std::vector<Vec3>(strained.size(), Vec3::Zero()))) < allowed * largest(before));
  }
}

TEST_CASE("a laminate shares a strain across its border as both press alike, and none along it", "[kernels]") {
  // A cube of one cell in two layers, compressed by a thousandth.
  const auto rest = cellOf({{Vec3(0.006, 0.0, 0.0), Vec3::UnitX()}});
  const Constitution constitution = softAndStiff(MaterialLaw::neoHookean, MaterialLaw::neoHookean, 20.0);
  Body body("b", rest, constitution, serialFor());
  for (const Vec3 &strain : {Vec3(-1e-6, 0, 0), Vec3(0, 1e-6, 0), Vec3(1e-6, 2e-6, 0)}) {
    for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
      body.state().displacements[i] = strain.cwiseProduct(rest->positions[i]);
    body.invalidatePointValues();
    const Mat3 F0 = body.gradients()[0], F1 = body.gradients()[1];
    const double v0 = rest->stencils.volumes[0], v1 = rest->stencils.volumes[1];
    CHECK(((v0 * F0 + v1 * F1) / (v0 + v1) - Mat3(Vec3(strain + Vec3::Ones()).asDiagonal())).norm() < 1e-11);
    const auto traction = [&](std::size_t q, const Mat3 &F) {
      return firstPiolaStress(constitution.materials[rest->stencils.materials[q]], F)(0, 0);
    };
    CHECK(traction(0, F0) == Approx(traction(1, F1)).epsilon(1e-5));
    CHECK((F0 - F1).col(1).norm() + (F0 - F1).col(2).norm() < 1e-12);
  }
}

TEST_CASE("layers of a bent cell have its mean strain, and press on each other alike", "[kernels]") {
  // The border cuts a corner off: the strains at the middles of the layers differ.
  const Vec3 n = Vec3(1, 1, 0).normalized();
  const auto rest = cellOf({{Vec3(0.007, 0.007, 0.0), n}});
  const Constitution constitution = softAndStiff(MaterialLaw::neoHookean, MaterialLaw::neoHookean, 20.0);
  Body body("b", rest, constitution, serialFor());
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i) {
    const Vec3 x = rest->positions[i];
    body.state().displacements[i] = 1e-4 * x[0] * x[1] * Vec3(1, 0.5, 0.2) + 1e-6 * x[1] * Vec3(0.3, 1, 0);
  }
  std::vector<Mat3> ofCells(2);
  deformationGradients(rest->stencils, body.state().displacements, ofCells, serialFor());
  REQUIRE((ofCells[0] - ofCells[1]).norm() > 1e-7);
  body.invalidatePointValues();
  const std::vector<Mat3> F(body.gradients().begin(), body.gradients().end());
  const double v0 = rest->stencils.volumes[0], v1 = rest->stencils.volumes[1];
  CHECK((v0 * (F[0] - ofCells[0]) + v1 * (F[1] - ofCells[1])).norm() < 1e-6 * v0 * (F[0] - ofCells[0]).norm());
  const auto traction = [&](std::size_t q) {
    return Vec3(firstPiolaStress(constitution.materials[rest->stencils.materials[q]], F[q]) * n);
  };
  CHECK((traction(0) - traction(1)).norm() < 1e-4 * traction(0).norm());
  // The kernels use the same strains; larger ones, whose energy is more than round-off.
  for (Vec3 &u : body.state().displacements) u *= 1e4;
  body.invalidatePointValues();
  double energy = 0.0;
  for (std::size_t q = 0; q < 2; ++q)
    energy += rest->stencils.volumes[q] *
              energyDensity(constitution.materials[rest->stencils.materials[q]], body.gradients()[q]);
  CHECK(std::abs(body.elasticEnergy(serialFor()).strain - energy) < 1e-9 * energy);
}

// Voxels that fill one plane of samples: a brain with fluid around it could not make its first step.
TEST_CASE("layers of a cell that are flat along an axis give finite forces", "[kernels]") {
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    RestState flat = *cellOf({{Vec3(0.008, 0.0, 0.0), Vec3::UnitX()}});
    for (Vec3 &variance : flat.stencils.variances) variance[axis] = 0.0;
    const auto rest = std::make_shared<const RestState>(std::move(flat));
    Body body("b", rest, softAndStiff(MaterialLaw::neoHookean, MaterialLaw::neoHookean, 20.0), serialFor());
    for (std::size_t i = 0; i < rest->phyxelCount(); ++i) {
      const Vec3 x = rest->positions[i];
      body.state().displacements[i] = x[0] * x[1] * Vec3(0.4, 0.2, 0.1) + x[1] * x[2] * Vec3(0.1, 0.0, 0.3);
    }
    body.invalidatePointValues();
    body.evaluateInternal(false, serialFor());
    for (const Vec3 &f : body.forces()) REQUIRE(f.allFinite());
    CHECK(std::isfinite(body.elasticEnergy(serialFor()).strain));
    CHECK(std::isfinite(body.elasticEnergy(serialFor()).stabilisation));
  }
}

TEST_CASE("bending of a cell of two materials is in a row across their border, and side by side along it",
          "[kernels]") {
  // u_x = a x z: a strain xx that varies along z.
  for (const int axis : {0, 2})
    for (const double ratio : {2.0, 100.0}) {
      CAPTURE(axis, ratio);
      const auto rest = cellOf({{0.005 * Vec3::Unit(axis), Vec3::Unit(axis)}});
      Constitution constitution = softAndStiff(MaterialLaw::linear, MaterialLaw::linear, ratio);
      for (Material &material : constitution.materials) material.poissonRatio = 0.0;
      Body body("b", rest, constitution, serialFor());
      const double a = 0.1;
      for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
        body.state().displacements[i] = a * rest->positions[i][0] * rest->positions[i][2] * Vec3::UnitX();
      body.invalidatePointValues();
      double inRow = 0.0, sideBySide = 0.0, volume = 0.0;
      for (std::size_t q = 0; q < 2; ++q) {
        const double modulus = constitution.materials[rest->stencils.materials[q]].youngsModulus;
        const double v = rest->stencils.volumes[q];
        inRow += v / modulus;
        sideBySide += modulus * v * rest->stencils.variances[q][2];
        volume += v;
      }
      const double expected = axis == 2 ? sideBySide : volume * volume / inRow * 0.02 * 0.02 / 12.0;
      CHECK(body.elasticEnergy(serialFor()).stabilisation ==
            Approx(kLatticeStabilisation * 0.5 * a * a * expected).epsilon(1e-6));
    }
}

TEST_CASE("three materials of a cell are two layers", "[kernels]") {
  // Across a cube of one cell: two that are nearly alike, and a soft one.
  const auto rest = cellOf({{Vec3(0.006, 0.0, 0.0), Vec3::UnitX()}, {Vec3(0.003, 0.0, 0.0), Vec3::UnitX()}});
  Constitution constitution = softAndStiff(MaterialLaw::neoHookean, MaterialLaw::neoHookean, 50.0);
  constitution.materials.push_back(constitution.materials[1]);  // as stiff as the second
  constitution.materials[2].youngsModulus *= 1.01;
  Body body("b", rest, constitution, serialFor());
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
    body.state().displacements[i] = Vec3(1e-6, 0, 0).cwiseProduct(rest->positions[i]);
  body.invalidatePointValues();
  Mat3 mean = Mat3::Zero();
  double volume = 0.0;
  std::array<Mat3, 3> F;
  for (std::size_t q = 0; q < 3; ++q) {
    F[rest->stencils.materials[q]] = body.gradients()[q];
    mean += rest->stencils.volumes[q] * body.gradients()[q];
    volume += rest->stencils.volumes[q];
  }
  CHECK((mean / volume - Mat3(Vec3(1.0 + 1e-6, 1.0, 1.0).asDiagonal())).norm() < 1e-11);
  CHECK((F[1] - F[2]).norm() < 1e-12);
  // Layers in series carry the same traction: the soft one is strained some fifty times as much.
  const auto traction = [&](std::size_t m) { return firstPiolaStress(constitution.materials[m], F[m])(0, 0); };
  CHECK(traction(1) == Approx(traction(0)).epsilon(0.02));
  CHECK(traction(2) == Approx(traction(0)).epsilon(0.02));
}

TEST_CASE("evaluation by kernels gives the same bits however its loops are cut", "[kernels]") {
  for (const bool lattice : {true, false})
    for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision}) {
      const Case c = lattice ? bodies()[2] : clouds()[2];
      Body body("b", c.rest, Constitution{{materialOf(MaterialLaw::neoHookean)}, 0.5}, serialFor());
      body.setPrecision(precision);
      deform(body, 0.1, 0.05, 3);
      body.evaluate(0.0, 0.0, serialFor());
      const std::vector<Vec3> whole(body.forces().begin(), body.forces().end());
      const double step = body.stableStep();
      body.evaluate(0.0, 0.0, inPieces());
      CHECK(body.stableStep() == step);
      CHECK(std::equal(whole.begin(), whole.end(), body.forces().begin()));
    }
}

TEST_CASE("evaluation by kernels gives the same bits on every instruction set with a fused multiply-add", "[kernels]") {
  const InstructionSets sets;
  if (sets.fused().size() < 2) {
    c3de::test::skip("this machine has one such instruction set only");
    return;
  }
  for (const bool lattice : {true, false})
    for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision})
      for (const MaterialLaw law : kLaws) {
        const Case c = lattice ? bodies()[1] : clouds()[0];
        Material m = materialOf(law);
        m.viscosity = 10.0;
        Body body("b", c.rest, Constitution{{m}, 0.5}, serialFor());
        body.setPrecision(precision);
        deform(body, 0.3, 0.1, 3);
        std::vector<std::vector<Vec3>> forces;
        std::vector<double> steps, energies;
        for (const std::int64_t target : sets.fused()) {
          sets.use(target);
          body.evaluate(0.0, 0.0, serialFor());
          forces.emplace_back(body.forces().begin(), body.forces().end());
          steps.push_back(body.stableStep());
          energies.push_back(body.elasticEnergy(serialFor()).strain);
        }
        INFO(c.name << ", law " << static_cast<int>(law) << ", precision " << static_cast<int>(precision));
        CHECK(forces[0] == forces[1]);
        CHECK(steps[0] == steps[1]);
        CHECK(energies[0] == energies[1]);
      }
}
