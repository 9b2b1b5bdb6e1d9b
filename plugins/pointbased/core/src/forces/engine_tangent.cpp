// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include "base/expects.h"
#include "forces/custom_batches.h"
#include "forces/entry_forces.h"
#include "forces/point_response.h"
#include "forces/relaxing_hourglass.h"
#include "forces/viscous_hourglass.h"

namespace pointbased {

using namespace detail;

namespace {

struct Field {
  std::span<const Vec3> positions, displacements;
  std::span<const Mat3> gradients;
  std::span<const Vec3> change;
};

// spreadChange() of a point with functions of second order.
void spreadQuadraticChange(const Material &material, double stabilisation, const StencilSet &s, std::size_t q,
                           const QuadraticPoints::Point &at, const Field &field, const Mat3 &turning,
                           double viscousScale, const Mat3 &dFit, Mat3 dP, const Amplitudes &dA,
                           std::span<Vec3> entries) {
  const HourglassEnergy modal(material, stabilisation);
  const QuadraticEnergy law(modal);
  const bool linear = material.law == MaterialLaw::linear;
  const Amplitudes modes = amplitudes(s, q, field.displacements);
  const QuadraticPoint point(law, s, q, at, turning, secondGradient(bendsOf(s, q, at, field.displacements), modes));
  const SecondGradient dH = secondGradient(bendsOf(s, q, at, field.change), dA),
                       dD = point.conjugateChange(law, s, linear, dFit, dH);
  SecondGradient dPull = point.FQ * dD;
  if (!linear) {
    dPull += dFit * point.QD;
    dP += dH * point.QD.transpose() + point.H * (s.axes * dD).transpose();
  }
  Vec3 dTwisted = modal.twist(s.volumes[q], s.variances[q]) * dA.topRightCorner<3, 1>();
  if (viscousScale > 0.0 && material.viscosity > 0.0)
    addViscousSecond(viscousHourglass(material, stabilisation), linear, s, q, point, turning, modes,
                     viscousScale * dFit, viscousScale * dH, viscousScale * dA, dP, dPull, dTwisted);
  spread(ModalConjugates(dP, dPull.rightCols<3>(), dTwisted), s, q, entries);
  spreadBends(s, q, at, dPull.leftCols<3>(), entries);
}

// Change of the forces of a point on its phyxels; dP is v dP of its stress.
template <Stabilisation control>
void spreadChange(const Material &material, double stabilisation, const HourglassEnergy &hourglass, const StencilSet &s,
                  std::size_t q, const Field &field, double viscousScale, const Mat3 &dFit, Mat3 dP,
                  const Amplitudes &dA, std::span<Vec3> entries) {
  const Mat3 &F = field.gradients[q];
  if constexpr (control == Stabilisation::hourglass) {
    const bool linear = material.law == MaterialLaw::linear;
    const Mat3 turning = linear ? Mat3(Mat3::Identity()) : F;
    if (const QuadraticPoints::Point *quadratic = s.quadratic.find(q)) {
      spreadQuadraticChange(material, stabilisation, s, q, *quadratic, field, turning, viscousScale, dFit, dP, dA,
                            entries);
      return;
    }
    const Amplitudes modes = amplitudes(s, q, field.displacements);
    const HourglassPoint point(hourglass, s, q, turning, modes);
    const Mat3 dModes = dA.topLeftCorner<3, 3>();
    Mat3 dB = point.FQ.transpose() * dModes;
    if (!linear) dB += (dFit * s.axes).transpose() * point.A;
    const Mat3 dD = hourglass.conjugate(dB, point.vs);
    Mat3 dC = point.FQ * dD;
    if (!linear) {
      dC += dFit * point.QD;
      dP += dModes * point.QD.transpose() + point.A * (s.axes * dD).transpose();
    }
    Vec3 dTwisted = point.twistStiffness * dA.topRightCorner<3, 1>();
    if (viscousScale > 0.0 && material.viscosity > 0.0)
      addViscousModes(viscousHourglass(material, stabilisation), linear, s, q, turning, modes, viscousScale * dFit,
                      viscousScale * dA, dP, dC, dTwisted);
    spread(ModalConjugates(dP, dC, dTwisted), s, q, entries);
  } else if constexpr (control == Stabilisation::isotropic) {
    const double scale = s.rank[q] > 0 ? residualScale(material, stabilisation, s.volumes[q]) : 0.0;
    const StabilisationPoint residual(s, q, F);
    Mat3 dF = dFit;
    if (s.rank[q] < 3) {
      dF = completedWithoutTwist(F, dFit, s.rank[q], frameOfPoint(s, q));
      dP += scale * residual.stressDifferential(field.positions, field.displacements, field.change, dF);
    }
    const Index anchor = s.phyxels.indices[s.phyxels.offsets[q]];
    spread(s, q, entries, [&](Index e) -> Vec3 {
      const Index k = s.phyxels.indices[e];
      const Offset offset(s, q, field.positions, field.displacements, k, anchor);
      const Vec3 dnow = field.change[k] - field.change[anchor];
      return dP * s.gradients[e] + scale * s.weights[e] * residual.directionDifferential(offset, dnow, dF);
    });
  } else {
    const GradientRows rows(s, q);
    spread(s, q, entries, [&](Index e) -> Vec3 { return dP * rows[e]; });
  }
}

template <Stabilisation control>
void fittedChange(const StencilSet &s, std::size_t q, std::span<const Vec3> du, Mat3 &dFit, Amplitudes &dA) {
  if constexpr (control == Stabilisation::hourglass) {
    fittedModes(s, q, du, dFit, dA);
  } else {
    const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
    const Vec3 anchor = du[s.phyxels.indices[first]];
    const GradientRows gradients(s, q);
    dFit.setZero();
    for (Index e = first + 1; e < last; ++e) dFit += (du[s.phyxels.indices[e]] - anchor) * gradients[e].transpose();
  }
}

template <Stabilisation control>
void runCustomChange(const PointResponse &response, double stabilisation, const Field &field, double viscousScale,
                     std::span<Vec3> entries, std::size_t from, std::size_t to) {
  const Material &material = response.material;
  const StencilSet &s = response.stencils;
  const HourglassEnergy hourglass(material, stabilisation);
  const Law<MaterialLaw::custom> law;
  const Moduli moduli(material);
  std::array<Mat3, kLawBatch> dFits, dFs, dPs;
  std::array<Amplitudes, kLawBatch> dAs;
  forBatches(from, to, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      fittedChange<control>(s, first + i, field.change, dFits[i], dAs[i]);
      dFs[i] = lawGradientDifferential(law, s, first + i, field.gradients[first + i], dFits[i]);
    }
    moduli.custom->differentials(field.gradients.subspan(first, count), std::span(dFs).first(count),
                                 std::span(dPs).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t q = first + i;
      const Mat3 &F = field.gradients[q];
      VolumeTerm::addDifferential(moduli, law.tangent(moduli, F), dFs[i], dPs[i]);
      if (response.viscous) dPs[i] += response.viscousStress(q, F, viscousScale * dFits[i]);
      spreadChange<control>(material, stabilisation, hourglass, s, q, field, viscousScale, dFits[i],
                            s.volumes[q] * dPs[i], dAs[i], entries);
    }
  });
}

template <Stabilisation control>
void runChange(const Material &material, double stabilisation, const StencilSet &s, const Field &field,
               const PointHistory &history, double dt, double viscousScale, std::span<Vec3> entries, std::size_t from,
               std::size_t to) {
  const HourglassEnergy hourglass(material, stabilisation);
  const PointResponse response(material, s, history, dt, viscousScale > 0.0);
  if (material.law == MaterialLaw::custom)
    return runCustomChange<control>(response, stabilisation, field, viscousScale, entries, from, to);
  const auto loop = [&](auto &&stressChange) {
    for (std::size_t q = from; q < to; ++q) {
      Mat3 dFit;
      Amplitudes dA;
      fittedChange<control>(s, q, field.change, dFit, dA);
      const Mat3 dP = s.volumes[q] * stressChange(q, dFit);
      spreadChange<control>(material, stabilisation, hourglass, s, q, field, viscousScale, dFit, dP, dA, entries);
    }
  };
  if (response.elastic()) {
    withLaw(material.law, [&](auto law) {
      const Moduli moduli(material);
      loop([&](std::size_t q, const Mat3 &dFit) -> Mat3 {
        const Mat3 &F = field.gradients[q];
        return law.differential(moduli, law.tangent(moduli, lawGradient(law, s, q, F)),
                                lawGradientDifferential(law, s, q, F, dFit));
      });
    });
  } else {
    loop([&](std::size_t q, const Mat3 &dFit) -> Mat3 {
      return response.differential(q, field.gradients[q], dFit, viscousScale);
    });
  }
}

// Same for lattice cells whose modes relax.
void runRelaxingChange(const Material &material, double stabilisation, const StencilSet &s, const Field &field,
                       const PointHistory &history, double dt, double viscousScale, std::span<Vec3> entries,
                       std::size_t from, std::size_t to) {
  const PointResponse response(material, s, history, dt, viscousScale > 0.0);
  const PronyStep step = response.hourglassStep();
  const RelaxingHourglass modes(material, stabilisation, step.freshSum);
  const bool linear = material.law == MaterialLaw::linear;
  for (std::size_t q = from; q < to; ++q) {
    Mat3 dFit;
    Amplitudes dA;
    fittedChange<Stabilisation::hourglass>(s, q, field.change, dFit, dA);
    const Mat3 &F = field.gradients[q];
    const Mat3 turning = linear ? Mat3(Mat3::Identity()) : F;
    const Amplitudes amplitude = amplitudes(s, q, field.displacements);
    const RelaxingHourglassPoint point(modes, s, q, turning, amplitude, response.hourglassPast(q));
    const HourglassStrain dModes = dA.topRows<3>();
    HourglassStrain dStrain = point.FQ.transpose() * dModes;
    if (!linear) dStrain += (dFit * s.axes).transpose() * point.A;
    const HourglassStrain dD = modes.conjugate(dStrain, s.volumes[q], s.variances[q]);
    HourglassStrain dC = point.FQ * dD;
    Mat3 dP = s.volumes[q] * response.differential(q, F, dFit, viscousScale);
    if (!linear) {
      dC += dFit * point.QD;
      dP += dModes * point.QD.transpose() + point.A * (s.axes * dD).transpose();
    }
    Mat3 dPull = dC.leftCols<3>();
    Vec3 dTwisted = dC.col(3);
    if (viscousScale > 0.0 && material.viscosity > 0.0)
      addViscousModes(viscousHourglass(material, stabilisation), linear, s, q, turning, amplitude, viscousScale * dFit,
                      viscousScale * dA, dP, dPull, dTwisted);
    spread(ModalConjugates(dP, dPull, dTwisted), s, q, entries);
  }
}

}  // namespace

namespace detail {

void entryDifferentialsOf(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                          std::span<const Vec3> u, std::span<const Mat3> gradients, const PointHistory &history,
                          double dt, double viscousScale, std::span<const Vec3> du, std::span<Vec3> entries,
                          const ParallelFor &parallelFor) {
  const Field field{X, u, gradients, du};
  const Stabilisation control = stabilisationOf(constitution, s);
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      if (control == Stabilisation::hourglass && material.relaxes())
        return runRelaxingChange(material, constitution.stabilisation, s, field, history, dt, viscousScale, entries,
                                 from, to);
      const auto run = control == Stabilisation::hourglass   ? runChange<Stabilisation::hourglass>
                       : control == Stabilisation::isotropic ? runChange<Stabilisation::isotropic>
                                                             : runChange<Stabilisation::none>;
      run(material, constitution.stabilisation, s, field, history, dt, viscousScale, entries, from, to);
    });
  });
}

}  // namespace detail

void forceDifferential(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                       std::span<const Vec3> u, std::span<const Mat3> gradients, const PointHistory &history, double dt,
                       double viscousScale, std::span<const Vec3> du, TangentScratch &scratch, std::span<Vec3> df,
                       const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && u.size() == X.size(),
                     "one position and one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(du.size() == X.size() && df.size() == X.size(), "one change of place and of force per phyxel");
  scratch.entries.resize(s.phyxels.indices.size());
  entryDifferentialsOf(constitution, s, X, u, gradients, history, dt, viscousScale, du, scratch.entries, parallelFor);
  gather<Vec3>(s, scratch.entries, df, parallelFor);
}

}  // namespace pointbased
