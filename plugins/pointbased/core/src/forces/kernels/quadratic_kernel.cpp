// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/quadratic_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/kernels/quadratic_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "forces/kernels/quadratic-inl.h"
#include "forces/kernels/tangent-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

template <class V>
HWY_INLINE Mat3Lanes<V> outerProduct(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {scaled(b.x, a), scaled(b.y, a), scaled(b.z, a)};
}

// Adds the viscous forces of the modes, times `scale` (addViscousSecond() in viscous_hourglass.h).
template <bool kLinear, class D, class V = hn::Vec<D>>
HWY_NOINLINE void addViscousSecond(const QuadraticRun<D> &run, Real<D> scale, const SecondOrderFit<V> &at,
                                   const SecondOrderFit<V> &rate, Mat3Lanes<V> &S, SecondLanes<V> &pull,
                                   Vec3Lanes<V> &twisted) {
  const LawNumbers<Real<D>> &m = run.cell.law;
  SecondLanes<V> dB = rate.H;
  Vec3Lanes<V> w = rate.xyz;
  if constexpr (!kLinear) {
    dB = dB + transposeTimes(at.G, rate.H) + transposeTimes(rate.G, at.H);
    w = w + transposeTimes(at.G, rate.xyz) + transposeTimes(rate.G, at.xyz);
  }
  const SecondLanes<V> conjugate = run.conjugate(scale * m.viscousMu, scale * m.viscousLambda, dB);
  w = scaled(hn::Mul(hn::Set(run.d, scale * m.viscousTwist), run.cell.number(kTwist)), w);
  pull = pull + conjugate;
  twisted = twisted + w;
  if constexpr (!kLinear) {
    S = S + timesTransposed(at.H, conjugate) + outerProduct(at.xyz, w);
    pull = pull + times(at.G, conjugate);
    twisted = twisted + times(at.G, w);
  }
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void clear(D d, SecondLanes<V> &pull, Vec3Lanes<V> &twisted) {
  const V zero = hn::Zero(d);
  twisted = {zero, zero, zero};
  pull = {twisted, twisted, twisted, twisted, twisted, twisted};
}

template <MaterialLaw kLaw, class D>
HWY_INLINE void forcesOfLanes(const QuadraticRun<D> &run, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  constexpr bool kLinear = kLaw == MaterialLaw::linear;
  const D d = run.d;
  const CellRun<D> &cell = run.cell;
  const SecondOrderFit<V> at = run.fit(cell.fields.displacements);
  const Strain<D> strain(d, at.G);
  const V stretch2 = largestStretchSquared(d, strain.E, spreadOf(d, strain.E));
  V ratio;
  Mat3Lanes<V> S = stressOf<kLaw>(d, cell.law, strain, stretch2, scalar, cell.material(), ratio);
  const bool isViscous = cell.fields.velocities != nullptr;
  SecondOrderFit<V> rate;
  if (isViscous) {
    rate = run.fit(cell.fields.velocities);
    S = S + viscousStress(d, hn::Set(d, cell.law.twoEta), at.G, rate.G);
  }
  S = scaled(cell.number(kVolume), S);
  SecondLanes<V> pull;
  Vec3Lanes<V> twisted;
  V k[kCorners];
  if (!cell.job.hourglass) {
    clear(d, pull, twisted);
    cell.stiffnesses(ratio, hn::Zero(d), k);
    return run.scatter(S, pull, twisted, k);
  }
  if constexpr (kLinear) {
    pull = run.conjugate(at.H);
  } else {
    // B = Fᵀ H, S += H Dᵀ, pull = F D
    const SecondLanes<V> conjugate = run.conjugate(at.H + transposeTimes(at.G, at.H));
    S = S + timesTransposed(at.H, conjugate);
    pull = conjugate + times(at.G, conjugate);
  }
  twisted = scaled(cell.twist(), at.xyz);
  if (isViscous) addViscousSecond<kLinear>(run, Real<D>(1), at, rate, S, pull, twisted);
  // The maximum of NaN and a number may be the number.
  cell.stiffnesses(hn::IfThenElse(hn::Eq(ratio, ratio), hn::Max(ratio, stretch2), ratio),
                   kLinear ? hn::Zero(d) : run.secondStiffness(at.H), k);
  run.scatter(S, pull, twisted, k);
}

template <class D>
HWY_INLINE TangentRows<D> rowsOf(const QuadraticRun<D> &run) {
  return {run.d,
          run.cell.job.tangents + run.cell.slice * kQuadraticTangentNumbers * CellRun<D>::kSlice + run.cell.lane};
}

template <MaterialLaw kLaw, class D>
HWY_INLINE void tangentOfLanes(const QuadraticRun<D> &run) {
  const auto at = run.fit(run.cell.fields.displacements);
  const TangentRows<D> rows = rowsOf(run);
  rows.setMatrix(kTangentH, {at.H.xx, at.H.yy, at.H.zz});
  rows.setMatrix(kTangentH + 9, {at.H.xy, at.H.xz, at.H.yz});
  rows.set(kTangentTwist, at.xyz.x);
  rows.set(kTangentTwist + 1, at.xyz.y);
  rows.set(kTangentTwist + 2, at.xyz.z);
  prepareTangent<kLaw>(run.d, run.cell.law, Strain<D>(run.d, at.G), rows);
}

template <MaterialLaw kLaw, class D>
HWY_INLINE void productOfLanes(const QuadraticRun<D> &run, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  constexpr bool kLinear = kLaw == MaterialLaw::linear;
  const D d = run.d;
  const CellRun<D> &cell = run.cell;
  const TangentRows<D> rows = rowsOf(run);
  const SecondOrderFit<V> change = run.fit(cell.fields.displacements);
  Mat3Lanes<V> dS = stressChange<kLaw>(d, cell.law, rows, change.G, scalar, cell.material());
  const Real<D> viscousScale = cell.job.viscousScale;
  if (viscousScale > 0)
    dS = dS + viscousStress(d, hn::Set(d, cell.law.twoEta * viscousScale), rows.getMatrix(kTangentG), change.G);
  dS = scaled(cell.number(kVolume), dS);
  const V zero = hn::Zero(d), nothing[kCorners] = {zero, zero, zero, zero, zero, zero, zero, zero};
  SecondLanes<V> dPull;
  Vec3Lanes<V> dTwisted;
  if (!cell.job.hourglass) {
    clear(d, dPull, dTwisted);
    return run.scatter(dS, dPull, dTwisted, nothing);
  }
  const Mat3Lanes<V> equal = rows.getMatrix(kTangentH), mixed = rows.getMatrix(kTangentH + 9);
  const SecondOrderFit<V> at = {rows.getMatrix(kTangentG),
                                {equal.c0, equal.c1, equal.c2, mixed.c0, mixed.c1, mixed.c2},
                                {rows.get(kTangentTwist), rows.get(kTangentTwist + 1), rows.get(kTangentTwist + 2)}};
  if constexpr (kLinear) {
    dPull = run.conjugate(change.H);
  } else {
    // B = Fᵀ H, S += H Dᵀ, pull = F D
    const SecondLanes<V> conjugate = run.conjugate(at.H + transposeTimes(at.G, at.H));
    const SecondLanes<V> dConjugate =
        run.conjugate(change.H + transposeTimes(at.G, change.H) + transposeTimes(change.G, at.H));
    dS = dS + timesTransposed(change.H, conjugate) + timesTransposed(at.H, dConjugate);
    dPull = dConjugate + times(at.G, dConjugate) + times(change.G, conjugate);
  }
  dTwisted = scaled(cell.twist(), change.xyz);
  if (viscousScale > 0) addViscousSecond<kLinear>(run, viscousScale, at, change, dS, dPull, dTwisted);
  run.scatter(dS, dPull, dTwisted, nothing);
}

// Strain and mode energies of some lanes, J.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE void energiesOfLanes(const QuadraticRun<D> &run, const ScalarLaw &scalar, V &strainEnergy, V &modesEnergy) {
  const D d = run.d;
  const CellRun<D> &cell = run.cell;
  const SecondOrderFit<V> at = run.fit(cell.fields.displacements);
  strainEnergy =
      hn::Mul(cell.number(kVolume), energyOf<kLaw>(d, cell.law, Strain<D>(d, at.G), scalar, cell.material()));
  modesEnergy = hn::Zero(d);
  if (!cell.job.hourglass) return;
  SecondLanes<V> B = at.H;
  if constexpr (kLaw != MaterialLaw::linear) B = B + transposeTimes(at.G, at.H);
  modesEnergy =
      hn::Mul(hn::Set(d, Real<D>(0.5)), hn::MulAdd(cell.twist(), dot(at.xyz, at.xyz), product(B, run.conjugate(B))));
}

template <MaterialLaw kLaw, class T>
HWY_NOINLINE void forcesOfSlice(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar,
                                const ChunkFields<T> &fields, std::size_t slice) {
  forLanes(job, fields, slice,
           [&](const auto &run) HWY_ATTR { forcesOfLanes<kLaw>(QuadraticRun(run, second), scalar); });
}
template <MaterialLaw kLaw, class T>
HWY_NOINLINE void tangentsOfSlice(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &,
                                  const ChunkFields<T> &fields, std::size_t slice) {
  forLanes(job, fields, slice, [&](const auto &run) HWY_ATTR { tangentOfLanes<kLaw>(QuadraticRun(run, second)); });
}
template <MaterialLaw kLaw, class T>
HWY_NOINLINE void productsOfSlice(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar,
                                  const ChunkFields<T> &fields, std::size_t slice) {
  forLanes(job, fields, slice,
           [&](const auto &run) HWY_ATTR { productOfLanes<kLaw>(QuadraticRun(run, second), scalar); });
}
template <MaterialLaw kLaw, class T>
HWY_NOINLINE void energiesOfSlice(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar,
                                  const ChunkFields<T> &fields, std::size_t slice) {
  storeEnergies(job, fields, slice, [&](const auto &run, auto &strain, auto &modes) HWY_ATTR {
    energiesOfLanes<kLaw>(QuadraticRun(run, second), scalar, strain, modes);
  });
}

template <class T>
void forcesOf(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar, std::size_t begin,
              std::size_t end) {
  forQuadraticSlices<Sums::perPhyxel>(job, second, begin, end,
                                      [&](auto law, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                                        forcesOfSlice<decltype(law)::value>(job, second, scalar, fields, slice);
                                      });
}
template <class T>
void tangentsOf(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar, std::size_t begin,
                std::size_t end) {
  forQuadraticSlices<Sums::none>(job, second, begin, end,
                                 [&](auto law, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                                   tangentsOfSlice<decltype(law)::value>(job, second, scalar, fields, slice);
                                 });
}
template <class T>
void productsOf(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar, std::size_t begin,
                std::size_t end) {
  forQuadraticSlices<Sums::perPhyxel>(job, second, begin, end,
                                      [&](auto law, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                                        productsOfSlice<decltype(law)::value>(job, second, scalar, fields, slice);
                                      });
}
template <class T>
void energiesOf(const CellJob<T> &job, const QuadraticSlices<T> &second, const ScalarLaw &scalar, std::size_t begin,
                std::size_t end) {
  forQuadraticSlices<Sums::none>(job, second, begin, end,
                                 [&](auto law, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                                   energiesOfSlice<decltype(law)::value>(job, second, scalar, fields, slice);
                                 });
}

void SecondForcesFloat(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  forcesOf(job, second, scalar, begin, end);
}
void SecondForcesDouble(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                        std::size_t begin, std::size_t end) {
  forcesOf(job, second, scalar, begin, end);
}
void SecondTangentsFloat(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end) {
  tangentsOf(job, second, scalar, begin, end);
}
void SecondTangentsDouble(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                          std::size_t begin, std::size_t end) {
  tangentsOf(job, second, scalar, begin, end);
}
void SecondProductsFloat(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end) {
  productsOf(job, second, scalar, begin, end);
}
void SecondProductsDouble(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                          std::size_t begin, std::size_t end) {
  productsOf(job, second, scalar, begin, end);
}
void SecondEnergiesFloat(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end) {
  energiesOf(job, second, scalar, begin, end);
}
void SecondEnergiesDouble(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                          std::size_t begin, std::size_t end) {
  energiesOf(job, second, scalar, begin, end);
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(SecondForcesFloat);
HWY_EXPORT(SecondForcesDouble);
HWY_EXPORT(SecondTangentsFloat);
HWY_EXPORT(SecondTangentsDouble);
HWY_EXPORT(SecondProductsFloat);
HWY_EXPORT(SecondProductsDouble);
HWY_EXPORT(SecondEnergiesFloat);
HWY_EXPORT(SecondEnergiesDouble);

void quadraticForces(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                     std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondForcesFloat)(job, second, scalar, begin, end);
}
void quadraticForces(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                     std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondForcesDouble)(job, second, scalar, begin, end);
}
void quadraticTangents(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondTangentsFloat)(job, second, scalar, begin, end);
}
void quadraticTangents(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondTangentsDouble)(job, second, scalar, begin, end);
}
void quadraticProducts(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondProductsFloat)(job, second, scalar, begin, end);
}
void quadraticProducts(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondProductsDouble)(job, second, scalar, begin, end);
}
void quadraticEnergies(const CellJob<float> &job, const QuadraticSlices<float> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondEnergiesFloat)(job, second, scalar, begin, end);
}
void quadraticEnergies(const CellJob<double> &job, const QuadraticSlices<double> &second, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(SecondEnergiesDouble)(job, second, scalar, begin, end);
}

}  // namespace pointbased::kernels
#endif
