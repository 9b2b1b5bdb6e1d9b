// SPDX-License-Identifier: Apache-2.0
#include "analysis/fine_reference_forces.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

namespace pointbased::detail {
namespace {

constexpr double kTouching = 0.5;  // of the weights of a skin point in contact that belong to phyxels in contact

bool presses(const Contact &contact) {
  return contact.normalImpulse > 0.0 || contact.projectionImpulse > 0.0 || contact.normalForce > 0.0;
}

// 1 for phyxels that carry a point in contact.
std::vector<std::uint8_t> touching(const Body &body) {
  std::vector<std::uint8_t> mask(body.rest().phyxelCount(), 0);
  const Csr &rows = body.rest().contact.binding.phyxels;
  for (const Contact &contact : body.contact.active)
    if (presses(contact))
      for (const Index j : rows.row(contact.point)) mask[j] = 1;
  return mask;
}

std::vector<Vec3> inFrameOf(const RestState &to, const RestState &from, std::span<const Vec3> points) {
  std::vector<Vec3> out(points.begin(), points.end());
  for (Vec3 &x : out) x += from.origin - to.origin;
  return out;
}

// Transfers forces as tractions on the contact points of the fine reference.
void carryOverSkin(const Body &body, std::span<const Vec3> forces, std::span<const std::uint8_t> touched,
                   const Body &fineReference, std::span<Vec3> out) {
  const ContactPoints &skin = fineReference.rest().contact;
  if (skin.count() == 0) return;
  const Interpolation at =
      body.rest().bind(inFrameOf(body.rest(), fineReference.rest(), skin.binding.positions), skin.normals);
  std::vector<double> shares(forces.size(), 0.0);
  const auto forShares = [&](const auto &visit) {
    for (Index p = 0; p < at.count(); ++p)
      for (Index e = at.phyxels.offsets[p]; e < at.phyxels.offsets[p + 1]; ++e)
        if (const Index i = at.phyxels.indices[e]; touched[i] && at.weights[e] > 0.0)
          visit(p, i, skin.areas[p] * at.weights[e]);
  };
  forShares([&](Index, Index i, double share) { shares[i] += share; });
  std::vector<Vec3> onPoints(at.count(), Vec3::Zero());
  forShares([&](Index p, Index i, double share) { onPoints[p] += share / shares[i] * forces[i]; });
  spreadForces(skin.binding, onPoints, out);
}

Vec3 placeOf(const Body &body, std::size_t j) { return body.rest().positions[j] + body.state().displacements[j]; }

struct MassMoments {
  double mass = 0.0;            // kg
  Vec3 centre = Vec3::Zero();   // m
  Mat3 inertia = Mat3::Zero();  // kg m², about the centre
};

MassMoments momentsOf(const Body &body) {
  MassMoments out;
  const std::size_t n = body.rest().phyxelCount();
  for (std::size_t j = 0; j < n; ++j) {
    out.centre += body.masses()[j] * placeOf(body, j);
    out.mass += body.masses()[j];
  }
  out.centre /= out.mass;
  for (std::size_t j = 0; j < n; ++j) {
    const Vec3 arm = placeOf(body, j) - out.centre;
    out.inertia += body.masses()[j] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  return out;
}

}  // namespace

std::vector<Vec3> knownForces(Body &body, const Vec3 &gravity, double clock, const ParallelFor &parallelFor) {
  body.computeGradients(parallelFor);
  body.computeElasticStresses(parallelFor);
  body.computeInternalForces(parallelFor);
  const std::span<const Vec3> u = body.state().displacements;
  body.foundation().addForces(u, {}, body.forces(), parallelFor);
  const BoundaryConditions &conditions = body.rest().conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l)
    addLoadForces(conditions.loads[l], conditions.loaded[l], body.factor(conditions.loads[l].ramp, clock), u,
                  body.forces());
  std::vector<Vec3> all(body.forces().begin(), body.forces().end());
  if (body.patches().rows() > 0) {
    body.patches().updateForces(body.patchTargets(clock), u);
    body.patches().addForces(all);
  }
  for (std::size_t i = 0; i < all.size(); ++i) all[i] += body.weights()[i] * gravity;
  return all;
}

std::vector<Vec3> carriedOver(const Body &body, std::span<const Vec3> forces, bool withContact,
                              const Body &fineReference, const ParallelFor &parallelFor) {
  const std::vector<std::uint8_t> touched = touching(body);
  std::vector<Vec3> accelerations(forces.size(), Vec3::Zero());
  for (std::size_t i = 0; i < forces.size(); ++i)
    if (!touched[i] && !body.heldMask()[i]) accelerations[i] = forces[i] / body.masses()[i];
  const RestState &fine = fineReference.rest();
  const Interpolation at = body.rest().bind(inFrameOf(body.rest(), fine, fine.positions), {});
  std::vector<Vec3> out(fine.phyxelCount());
  interpolateField(at, accelerations, out, parallelFor);
  for (std::size_t j = 0; j < out.size(); ++j) out[j] *= fineReference.masses()[j];
  if (withContact) carryOverSkin(body, forces, touched, fineReference, out);
  return out;
}

SurfacePoints touchingPoints(const Body &body, const RestState &fineReference) {
  const std::vector<std::uint8_t> touched = touching(body);
  const ContactPoints &skin = fineReference.contact;
  const Interpolation at =
      body.rest().bind(inFrameOf(body.rest(), fineReference, skin.binding.positions), skin.normals);
  SurfacePoints out;
  for (Index p = 0; p < at.count(); ++p) {
    double share = 0.0;
    for (Index e = at.phyxels.offsets[p]; e < at.phyxels.offsets[p + 1]; ++e)
      share += touched[at.phyxels.indices[e]] != 0 ? at.weights[e] : 0.0;
    if (share < kTouching) continue;
    out.positions.push_back(skin.binding.positions[p]);
    out.normals.push_back(skin.normals[p]);
    out.areas.push_back(skin.areas[p]);
  }
  return out;
}

void balance(const Body &fineReference, std::span<const Vec3> others, std::span<Vec3> forces) {
  const MassMoments moments = momentsOf(fineReference);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t j = 0; j < forces.size(); ++j) {
    const Vec3 f = forces[j] + others[j];
    force += f;
    torque += (placeOf(fineReference, j) - moments.centre).cross(f);
  }
  const Vec3 linear = force / moments.mass, angular = moments.inertia.fullPivLu().solve(torque);
  for (std::size_t j = 0; j < forces.size(); ++j)
    forces[j] -= fineReference.masses()[j] * (linear + angular.cross(placeOf(fineReference, j) - moments.centre));
}

double holdingAgainstTurns(const Body &fineReference, std::span<const Vec3> forces) {
  const MassMoments moments = momentsOf(fineReference);
  // -Σ f · R x to second order in the rotation vector: ½ θ · [Σ (f · x) I - sym Σ f x^T] θ.
  Mat3 virial = Mat3::Zero();
  for (std::size_t j = 0; j < forces.size(); ++j)
    virial += forces[j] * (placeOf(fineReference, j) - moments.centre).transpose();
  const Mat3 stiffness = virial.trace() * Mat3::Identity() - 0.5 * (virial + virial.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> eigen(-stiffness, moments.inertia, Eigen::EigenvaluesOnly);
  return std::max(0.0, eigen.eigenvalues()[2]);
}

}  // namespace pointbased::detail
