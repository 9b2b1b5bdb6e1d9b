// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include "base/expects.h"
#include "forces/entry_forces.h"
#include "forces/point_response.h"
#include "forces/quadratic_energy.h"
#include "forces/relaxing_hourglass.h"
#include "forces/viscous_hourglass.h"

namespace pointbased {

using namespace detail;

namespace {

// Adds the viscous part of the conjugates of the modes of a point; nothing without velocities.
void addViscous(const Material &material, double stabilisation, const StencilSet &s, std::size_t q, const Mat3 &F,
                const Amplitudes &modes, std::span<const Vec3> velocities, Mat3 &stress, Mat3 &pull, Vec3 &twisted) {
  if (velocities.empty() || !(material.viscosity > 0.0)) return;
  Mat3 rateOfF;
  Amplitudes rateOfModes;
  fittedModes(s, q, velocities, rateOfF, rateOfModes);
  addViscousModes(viscousHourglass(material, stabilisation), material.law == MaterialLaw::linear, s, q, F, modes,
                  rateOfF, rateOfModes, stress, pull, twisted);
}

// Forces of a point with functions of second order.
void quadraticForces(const Material &material, double stabilisation, const StencilSet &s, std::size_t q,
                     const QuadraticPoints::Point &at, std::span<const Vec3> u, const Mat3 &F, Mat3 stress,
                     std::span<const Vec3> velocities, std::span<Vec3> entryForces) {
  const HourglassEnergy modal(material, stabilisation);
  const bool linear = material.law == MaterialLaw::linear;
  const Amplitudes modes = amplitudes(s, q, u);
  const QuadraticPoint point(QuadraticEnergy(modal), s, q, at, F, secondGradient(bendsOf(s, q, at, u), modes));
  SecondGradient pull = point.FQ * point.D;
  Vec3 twisted = modal.twist(s.volumes[q], s.variances[q]) * modes.topRightCorner<3, 1>();
  if (!linear) stress += point.H * point.QD.transpose();
  if (!velocities.empty() && material.viscosity > 0.0) {
    Mat3 rateOfF;
    Amplitudes rateOfModes;
    fittedModes(s, q, velocities, rateOfF, rateOfModes);
    addViscousSecond(viscousHourglass(material, stabilisation), linear, s, q, point, F, modes, rateOfF,
                     secondGradient(bendsOf(s, q, at, velocities), rateOfModes), rateOfModes, stress, pull, twisted);
  }
  spread(ModalConjugates(stress, pull.rightCols<3>(), twisted), s, q, entryForces);
  spreadBends(s, q, at, pull.leftCols<3>(), entryForces);
}

// Forces of every point of a run on the phyxels of its stencil; the anchor gets the negative sum.
template <Stabilisation control>
void pointForces(const Material &material, double stabilisation, const StencilSet &s, std::span<const Vec3> X,
                 std::span<const Vec3> u, std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                 std::span<const Vec3> velocities, std::span<Vec3> entryForces, std::size_t from, std::size_t to) {
  const HourglassEnergy hourglass(material, stabilisation);
  const bool linear = material.law == MaterialLaw::linear;
  for (std::size_t q = from; q < to; ++q) {
    if constexpr (control == Stabilisation::hourglass) {
      const Mat3 F = linear ? Mat3(Mat3::Identity()) : gradients[q];
      if (const QuadraticPoints::Point *quadratic = s.quadratic.find(q)) {
        quadraticForces(material, stabilisation, s, q, *quadratic, u, F, stresses[q], velocities, entryForces);
        continue;
      }
      const Amplitudes modes = amplitudes(s, q, u);
      const HourglassPoint point(hourglass, s, q, F, modes);
      Mat3 stress = stresses[q], pull = point.FQ * point.D;
      Vec3 twisted = point.twistStiffness * point.twist;
      if (!linear) stress += point.A * point.QD.transpose();
      addViscous(material, stabilisation, s, q, F, modes, velocities, stress, pull, twisted);
      spread(ModalConjugates(stress, pull, twisted), s, q, entryForces);
    } else if constexpr (control == Stabilisation::isotropic) {
      Mat3 stress = stresses[q];
      const double scale = s.rank[q] > 0 ? residualScale(material, stabilisation, s.volumes[q]) : 0.0;
      const StabilisationPoint residual(s, q, gradients[q]);
      if (s.rank[q] < 3) stress += scale * residual.stress(X, u);
      const Index anchor = s.phyxels.indices[s.phyxels.offsets[q]];
      spread(s, q, entryForces, [&](Index e) -> Vec3 {
        const Offset offset(s, q, X, u, s.phyxels.indices[e], anchor);
        return stress * s.gradients[e] + scale * s.weights[e] * residual.direction(offset);
      });
    } else {
      const GradientRows rows(s, q);
      spread(s, q, entryForces, [&](Index e) -> Vec3 { return stresses[q] * rows[e]; });
    }
  }
}

// Same for lattice cells whose modes relax.
void relaxingForces(const Material &material, double stabilisation, const StencilSet &s, std::span<const Vec3> u,
                    std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                    std::span<const HourglassStrain> relaxed, std::span<const Vec3> velocities,
                    std::span<Vec3> entryForces, std::size_t from, std::size_t to) {
  const RelaxingHourglass modes(material, stabilisation, 0.0);
  const bool linear = material.law == MaterialLaw::linear;
  for (std::size_t q = from; q < to; ++q) {
    const Mat3 F = linear ? Mat3(Mat3::Identity()) : gradients[q];
    const Amplitudes amplitude = amplitudes(s, q, u);
    const RelaxingHourglassPoint point(modes, s, q, F, amplitude,
                                       relaxed.empty() ? HourglassStrain(HourglassStrain::Zero()) : relaxed[q]);
    Mat3 stress = stresses[q];
    if (!linear) stress += point.A * point.QD.transpose();
    Mat3 pull = point.FQ * point.D.leftCols<3>();
    Vec3 twisted = point.FQ * point.D.col(3);
    addViscous(material, stabilisation, s, q, F, amplitude, velocities, stress, pull, twisted);
    spread(ModalConjugates(stress, pull, twisted), s, q, entryForces);
  }
}

}  // namespace

namespace detail {

void entryForcesOf(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                   std::span<const Vec3> u, std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                   std::span<const HourglassStrain> relaxed, std::span<const Vec3> velocities,
                   std::span<Vec3> entryForces, const ParallelFor &parallelFor) {
  const Stabilisation control = stabilisationOf(constitution, s);
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      if (control == Stabilisation::hourglass && material.relaxes())
        return relaxingForces(material, constitution.stabilisation, s, u, gradients, stresses, relaxed, velocities,
                              entryForces, from, to);
      const auto run = control == Stabilisation::hourglass   ? pointForces<Stabilisation::hourglass>
                       : control == Stabilisation::isotropic ? pointForces<Stabilisation::isotropic>
                                                             : pointForces<Stabilisation::none>;
      run(material, constitution.stabilisation, s, X, u, gradients, stresses, velocities, entryForces, from, to);
    });
  });
}

void internalForcesOf(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                      std::span<const Vec3> u, std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                      std::span<const HourglassStrain> relaxed, std::span<const Vec3> velocities,
                      std::span<Vec3> entryForces, std::span<Vec3> forces, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && u.size() == X.size(),
                     "one position and one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(stresses.size() == s.pointCount(), "one stress per evaluation point");
  POINTBASED_EXPECTS(entryForces.size() == s.phyxels.indices.size() && forces.size() == X.size(),
                     "room for every entry and every phyxel");
  entryForcesOf(constitution, s, X, u, gradients, stresses, relaxed, velocities, entryForces, parallelFor);
  gather<Vec3>(s, entryForces, forces, parallelFor);
}

}  // namespace detail

void internalForces(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                    std::span<const Vec3> u, std::span<const Mat3> gradients, std::span<const Mat3> stresses,
                    std::span<Vec3> entryForces, std::span<Vec3> forces, const ParallelFor &parallelFor,
                    std::span<const HourglassStrain> relaxed) {
  internalForcesOf(constitution, s, X, u, gradients, stresses, relaxed, {}, entryForces, forces, parallelFor);
}

}  // namespace pointbased
