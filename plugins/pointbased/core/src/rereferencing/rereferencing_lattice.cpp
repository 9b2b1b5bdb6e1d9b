// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "base/symmetric_eigen.h"
#include "discretisation/interpolation_at.h"
#include "rereferencing/rereferencing_parts.h"

namespace pointbased {

using namespace detail;

namespace {

Mat3 mapped(const Mat3 &symmetric, double (*f)(double)) {
  const SymmetricEigen eigen = symmetricEigen(symmetric);
  return eigen.with({f(eigen.values[0]), f(eigen.values[1]), f(eigen.values[2])});
}

double volumeOf(const Surface &surface) {
  double volume = 0.0;
  const Vec3 about = surface.positions.front();
  for (const auto &t : surface.triangles)
    volume += (surface.positions[t[0]] - about)
                  .dot((surface.positions[t[1]] - about).cross(surface.positions[t[2]] - about)) /
              6.0;
  return volume;
}

/// State of the evaluation points of a body, at their current positions.
struct OldPoints {
  std::vector<Vec3> centres;
  std::vector<Mat3> hencky;  ///< ln V
  std::vector<Mat3> flow;    ///< F_p^-1 of the total flow, in the frame of V
  std::vector<PronyPoint> prony;
  std::size_t relieved = 0;
};

OldPoints pointsOf(const Body &body, const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  const PointHistory &history = body.state().history;
  OldPoints out;
  const Interpolation centres = rest.bind(rest.pointCentres, {});
  out.centres.resize(rest.pointCount());
  interpolateDisplacements(centres, rest.positions, body.state().displacements, out.centres, parallelFor);
  out.prony = history.prony;
  for (std::size_t q = 0; q < rest.pointCount(); ++q) {
    out.centres[q] += rest.pointCentres[q];
    const auto [R, V, flat] = elasticPolar(body, q);
    out.relieved += flat ? 1 : 0;
    out.hencky.push_back(mapped(V, [](double s) { return std::log(s); }));
    out.flow.push_back(history.allFlow(q) * R.transpose());
    if (!out.prony.empty()) turn(R, out.prony[q]);
  }
  return out;
}

/// Strain of the new points: a linear fit to the old points around each.
void carryStrain(const OldPoints &old, std::span<const Vec3> centres, StencilSet &s, PointHistory &history,
                 const ParallelFor &parallelFor) {
  const Interpolation fit = bindToCloud(centres, old.centres, parallelFor);
  const std::size_t points = s.pointCount();
  expandRows(s);
  s.hanging = {};
  s.reference.resize(points);
  s.referenceInverse.resize(points);
  history.plasticInverse.assign(points, Mat3::Identity());
  history.plasticBefore.resize(points);
  history.prony.resize(old.prony.empty() ? 0 : points);
  for (std::size_t q = 0; q < points; ++q) {
    Mat3 hencky = Mat3::Zero();
    Index nearest = fit.phyxels.indices[fit.phyxels.offsets[q]];
    for (Index e = fit.phyxels.offsets[q]; e < fit.phyxels.offsets[q + 1]; ++e) {
      const Index j = fit.phyxels.indices[e];
      hencky += fit.weights[e] * old.hencky[j];
      if (!old.prony.empty()) {
        history.prony[q].previous += fit.weights[e] * old.prony[j].previous;
        for (std::size_t k = 0; k < 2; ++k) history.prony[q].internal[k] += fit.weights[e] * old.prony[j].internal[k];
      }
      if ((old.centres[j] - centres[q]).squaredNorm() < (old.centres[nearest] - centres[q]).squaredNorm()) nearest = j;
    }
    s.reference[q] = mapped(hencky, [](double h) { return std::exp(h); });
    s.referenceInverse[q] = s.reference[q].inverse();
    history.plasticBefore[q] = old.flow[nearest];
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
      s.gradients[e] = s.reference[q] * s.gradients[e];
    s.volumes[q] /= s.reference[q].determinant();  // volume without strain
  }
}

struct Motion {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};
Motion motionOf(std::span<const double> masses, std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  Motion out;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    out.linear += masses[i] * velocities[i];
    out.angular += positions[i].cross(masses[i] * velocities[i]);
  }
  return out;
}

/// Adds the rigid motion that changes both momenta to the given values. The unit of the masses is arbitrary, but has to
/// be the same for both.
void correctMomenta(const Motion &wanted, std::span<const double> masses, std::span<const Vec3> positions,
                    std::span<Vec3> velocities) {
  // Twice: the second pass corrects the rounding of the first.
  for (int pass = 0; pass < 2; ++pass) {
    double mass = 0.0;
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) {
      mass += masses[i];
      centre += masses[i] * positions[i];
    }
    centre /= mass;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) {
      const Vec3 r = positions[i] - centre;
      inertia += masses[i] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    const Motion now = motionOf(masses, positions, velocities);
    const Vec3 push = (wanted.linear - now.linear) / mass;
    const Vec3 turn = inertia.ldlt().solve(Vec3(wanted.angular - now.angular - centre.cross(mass * push)));
    for (std::size_t i = 0; i < masses.size(); ++i) velocities[i] += push + turn.cross(positions[i] - centre);
  }
}

}  // namespace

Result<Rereferencing> detail::renewedLattice(const Body &body, const ParallelFor &parallelFor) {
  const auto refuse = [](const std::string &text) { return tl::unexpected<std::string>(text); };
  const RestState &old = body.rest();
  if (!old.reshape || old.skin.empty()) return refuse("there is no way to fill its present skin");
  if (!old.conditions.fixes.empty() || !old.conditions.loads.empty() || !body.liveSupports().empty())
    return refuse("its supports and loads are given in its first shape");
  if (body.constitution().materials.size() > 1)
    return refuse("its parts of other materials are given in its first shape");
  if (!old.sampling.refinements.empty() || old.sampling.surfaceSpacing > 0.0 || !old.sampling.finer.places.empty())
    return refuse("its refinement is given in its first shape");
  for (const Vec3 &u : body.state().displacements)
    if (!u.allFinite()) return refuse("its state is not finite");

  PresentSkin skin = presentSkin(body, parallelFor);
  for (Vec3 &x : skin.surface.positions) x += old.origin;
  double unstrained = 0.0, present = 0.0;
  for (std::size_t q = 0; q < old.pointCount(); ++q) {
    const double v = old.stencils.volumes[q];
    unstrained += v;
    present += v * (body.gradients()[q] * body.state().history.plasticInverse[q]).determinant();
  }
  const double held = volumeOf(skin.surface);
  if (!(std::abs(held - present) <= kSkinMismatch * present)) {
    char text[120];
    std::snprintf(text, sizeof text, "its skin holds %.1f %% of the volume of its points: it is folded",
                  100.0 * held / present);
    return refuse(text);
  }
  auto shape = old.reshape(skin.surface);
  if (!shape) return refuse(shape.error());
  shape->volume = held;
  BodyRecipe recipe;
  recipe.sampling = old.sampling;
  recipe.sampling.spacing = old.spacing;
  recipe.sampling.axes = old.stencils.axes;  // the mode history refers to these axes
  recipe.reshape = old.reshape;
  auto filled = buildRestState(*shape, recipe, skin.normals, parallelFor);
  if (!filled) return refuse(filled.error());
  if ((*filled)->components > old.components) return refuse("its present skin falls into parts at this spacing");
  auto rest = std::make_shared<RestState>(**filled);
  rest->shapeVolume = old.shapeVolume;
  rest->sampling = old.sampling;

  // Origin of the old phyxels; the new ones may have another origin.
  const Vec3 shift = rest->origin - old.origin;
  const auto shifted = [&](std::vector<Vec3> points) {
    for (Vec3 &x : points) x += shift;
    return points;
  };
  const OldPoints points = pointsOf(body, parallelFor);
  Rereferencing out;
  out.relieved = points.relieved;
  carryStrain(points, shifted(rest->pointCentres), rest->stencils, out.state.history, parallelFor);
  double sum = 0.0, whole = 0.0, oldWhole = 0.0;
  for (const double v : rest->stencils.volumes) sum += v;
  for (const double v : rest->volumes) whole += v;
  for (const double v : old.volumes) oldWhole += v;
  for (double &v : rest->stencils.volumes) v *= unstrained / sum;
  for (auto *volumes : {&rest->volumes, &rest->weightVolumes})
    for (double &v : *volumes) v *= oldWhole / whole;

  std::vector<Vec3> now = old.positions;
  for (std::size_t i = 0; i < now.size(); ++i) now[i] += body.state().displacements[i];
  const std::size_t n = rest->phyxelCount();
  const std::vector<Vec3> positions = shifted(rest->positions);
  out.state.displacements.assign(n, Vec3::Zero());
  out.state.velocities.resize(n);
  interpolateField(bindToCloud(positions, now, parallelFor), body.state().velocities, out.state.velocities,
                   parallelFor);
  const double density = body.material().restDensity;
  std::vector<double> masses;
  for (const double v : rest->volumes) masses.push_back(density * v);
  correctMomenta(motionOf(body.restMasses(), now, body.state().velocities), masses, positions, out.state.velocities);
  out.rest = std::move(rest);
  return out;
}

}  // namespace pointbased
