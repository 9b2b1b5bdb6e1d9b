// SPDX-License-Identifier: Apache-2.0
#include "truth_problems.h"

#include <numbers>
#include <stdexcept>

#include "../unit/pointbased/shapes.h"
#include "solid_shapes.h"

namespace validation {

using namespace pointbased;
using enum MaterialLaw;

namespace {

Problem counted(const BodyShape &shape, std::size_t count, MaterialLaw law) {
  Problem problem = Problem::rubber(shape, 0.0, law);
  problem.recipe.sampling.count = count;
  return problem;
}

}  // namespace

const char *nameOf(MaterialLaw law) {
  return law == stVenantKirchhoff ? "stvk"
         : law == corotated       ? "corotated"
         : law == neoHookean      ? "neo_hookean"
                                  : "linear";
}

BodyShape beam(double length) {
  return solids::box(Vec3(0, -0.5 * kWidth, -0.5 * kWidth), Vec3(length, 0.5 * kWidth, 0.5 * kWidth));
}
BodyShape cube() { return solids::box(Vec3(-0.05, -0.05, 0), Vec3(0.05, 0.05, 0.1)); }

Problem cantilever(double spacing, MaterialLaw law, double shear, double length) {
  Problem problem = Problem::rubber(beam(length), spacing, law);
  problem.hold(face(0, 0.0));
  if (shear != 0.0) problem.pull(face(0, length), Vec3(0, 0, shear));
  return problem;
}

Problem twisted(double spacing, MaterialLaw law) {
  Problem problem = Problem::rubber(beam(), spacing, law);
  return problem.hold(face(0, 0.0)).turn(face(0, kLength), Vec3(90, 0, 0), Vec3(kLength, 0, 0));
}

Problem sagging(double spacing, MaterialLaw law, double gravity) {
  Problem problem = cantilever(spacing, law, 0.0);
  problem.world.gravity = Vec3(0, 0, -gravity);
  return problem;
}

Problem bondedCube(double spacing, MaterialLaw law, const Vec3 &move, double nu) {
  Problem problem = Problem::rubber(cube(), spacing, law);
  problem.material.poissonRatio = nu;
  return problem.hold(face(2, 0.0)).move(face(2, 0.1), move);
}

Problem halfBall(std::size_t count, MaterialLaw law) {
  Problem problem = counted(solids::halfBall(0.05), count, law).hold(face(2, 0.0));
  problem.world.gravity = Vec3(18, 0, 0);
  return problem;
}

Problem ringQuarter(std::size_t count, MaterialLaw law, const Vec3 &force) {
  return counted(solids::ringQuarter(0.1, 0.04), count, law).hold(face(1, 0.0)).pull(face(0, 0.0), force);
}

Problem hangingEllipsoid(std::size_t count, MaterialLaw law, double gravity) {
  Problem problem = counted(solids::ellipsoid(Vec3(0.06, 0.04, 0.03)), count, law).hold(slab(2, 0.024, 1.0));
  problem.world.gravity = Vec3(0, 0, gravity);
  return problem;
}

Problem bentTube(double spacing, MaterialLaw law) {
  return Problem::rubber(solids::tube(0.01, 0.02, kLength), spacing, law)
      .hold(face(0, 0.0))
      .pull(face(0, kLength), Vec3(0, 0, -1e-3));
}

Problem slantedBar(double spacing, MaterialLaw law) {
  const Vec3 half(0.0, 0.5 * kWidth, 0.5 * kWidth);
  return Problem::rubber(solids::slantedBox(-half, Vec3(kLength, 0, 0) + half, std::numbers::inv_sqrt3), spacing, law)
      .hold(face(0, 0.0))
      .pull(face(0, kLength), Vec3(0, 0, -1.6e-3));
}

Problem indentation(double spacing, MaterialLaw law, double nu, double depth, bool isByHand) {
  const Region patch = BoxRegion{Vec3(-0.015, -0.015, 0.05 - 1e-7), Vec3(0.015, 0.015, 0.05 + 1e-7)};
  Problem problem = Problem::rubber(solids::box(Vec3(-0.05, -0.05, 0), Vec3(0.05, 0.05, 0.05)), spacing, law);
  problem.material.poissonRatio = nu;
  problem.hold(face(2, 0.0));
  return isByHand ? problem.moveByHand(patch, Vec3(0, 0, -depth)) : problem.move(patch, Vec3(0, 0, -depth));
}

Problem pressedBeam(double spacing, bool follows) {
  Problem problem = Problem::rubber(solids::box(Vec3(0, -0.02, -0.01), Vec3(0.2, 0.02, 0.01)), spacing, neoHookean);
  problem.hold(face(0, 0.0));
  Load load{.region = face(2, 0.01)};
  if (follows)
    load.pressure = 5.0;
  else
    load.force = Vec3(0, 0, -5.0 * 0.2 * 0.04);
  problem.recipe.loads.push_back(load);
  return problem;
}

double quantityOf(SolvedBody &body, const std::string &quantity, double length) {
  if (quantity == "tip_mean_u_z") return body.meanOver(face(0, length))[2];
  if (quantity == "tip_mean_u_x") return body.meanOver(face(0, length))[0];
  if (quantity == "torque") return body.torqueAboutOrigin(1)[0];
  if (quantity == "axial_force") return body.reaction(1).force[0];
  if (quantity == "force_x") return body.reaction(1).force[0];
  if (quantity == "force_z") return body.reaction(1).force[2];
  if (quantity == "bulge")
    return body.meanOver(Region(BoxRegion{Vec3(0.049, -0.06, 0.0499), Vec3(0.051, 0.06, 0.0501)}))[0];
  if (quantity == "tip_mean_u_y") return body.meanOver(face(0, 0.0))[1];
  if (quantity == "top_u_x") return body.displacementAt(Vec3(0, 0, 0.05))[0];
  if (quantity == "mean_u_x") return body.meanWithin(Region())[0];
  if (quantity == "bottom_u_z") return body.displacementAt(Vec3(0, 0, -0.03))[2];
  if (quantity == "mean_u_z") return body.meanWithin(slab(2, -1.0, 0.024))[2];
  throw std::runtime_error("no such quantity: " + quantity);
}

std::vector<Mat3> randomDirections(std::size_t count) {
  shapes::Random random(2026);
  std::vector<Mat3> out;
  while (out.size() < count) {
    const Eigen::Quaterniond q(random(), random(), random(), random());
    if (q.norm() < 1.0 && q.norm() > 0.1) out.push_back(q.normalized().toRotationMatrix());
  }
  return out;
}

}  // namespace validation
