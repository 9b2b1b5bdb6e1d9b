// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/cell_tangent_kernel.h"

#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/kernels/cell_tangent_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "forces/kernels/cell_run-inl.h"
#include "forces/kernels/laminate-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

template <class D>
HWY_INLINE TangentRows<D> rowsOf(const CellRun<D> &run) {
  return {run.d, run.job.tangents + run.slice * kTangentNumbers * CellRun<D>::kSlice + run.lane};
}

template <MaterialLaw kLaw, bool kMixed, class D>
HWY_INLINE void tangentOfLanes(const CellRun<D> &run, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  const D d = run.d;
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  rowsOf(run).setMatrix(kTangentA, run.amplitudes(x, y, z));
  rowsOf(run).set(kTangentTwist, x.xyz);
  rowsOf(run).set(kTangentTwist + 1, y.xyz);
  rowsOf(run).set(kTangentTwist + 2, z.xyz);
  LaminateLanes<kLaw, kMixed, D> laminate(run);
  const Strain<D> strain(d, laminate.strained(x, y, z));
  prepareTangent<kLaw>(d, run.law, strain, rowsOf(run));
  if constexpr (kMixed) {
    const Mat3Lanes<V> A = rowsOf(run).getMatrix(kTangentA);
    V ratio;
    Mat3Lanes<V> S =
        scaled(run.number(kVolume),
               stressOf<kLaw>(d, run.law, strain, largestStretchSquared(d, strain.E, spreadOf(d, strain.E)), scalar,
                              run.material(), ratio));
    if (kLaw != MaterialLaw::linear && run.job.hourglass)
      S = S + times(A, transposed(laminate.modes(A + transposeTimes(strain.G, A))));
    laminate.keep(x, y, z, S);
  }
}

template <MaterialLaw kLaw, bool kMixed, class D>
HWY_INLINE void productOfLanes(const CellRun<D> &run, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  const D d = run.d;
  const TangentRows<D> at = rowsOf(run);
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  LaminateLanes<kLaw, kMixed, D> laminate(run);
  laminate.restore();
  const auto change = laminate.change(x, y, z);
  const Mat3Lanes<V> dG = change.dG;
  Mat3Lanes<V> dS = stressChange<kLaw>(d, run.law, at, dG, scalar, run.material());
  if (run.job.viscousScale > 0)
    dS = dS + viscousStress(d, hn::Set(d, run.law.twoEta * run.job.viscousScale), at.getMatrix(kTangentG), dG);
  dS = scaled(run.number(kVolume), dS);
  const V nothing[kCorners] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d),
                               hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  if (!run.job.hourglass) {
    laminate.scatterChange(change, dS, nothing);
    return;
  }
  const Mat3Lanes<V> dA = run.amplitudes(x, y, z);
  Mat3Lanes<V> dPull;
  if constexpr (kLaw == MaterialLaw::linear) {
    dPull = laminate.modes(dA);
  } else {
    // B = Fᵀ A, S += A Dᵀ, pull = F D
    const Mat3Lanes<V> G = at.getMatrix(kTangentG), A = at.getMatrix(kTangentA);
    const Mat3Lanes<V> D3 = laminate.modes(A + transposeTimes(G, A));
    const Mat3Lanes<V> dD = laminate.modes(dA + transposeTimes(G, dA) + transposeTimes(dG, A));
    dS = dS + times(dA, transposed(D3)) + times(A, transposed(dD));
    dPull = dD + times(G, dD) + times(dG, D3);
  }
  const Vec3Lanes<V> dXyz{x.xyz, y.xyz, z.xyz};
  Vec3Lanes<V> dTwisted = scaled(run.twist(), dXyz);
  if (run.job.viscousScale > 0)
    addViscousModes<kLaw == MaterialLaw::linear>(
        d, run.law, run.job.viscousScale, run.roots(), run.number(kTwist),
        {at.getMatrix(kTangentG),
         at.getMatrix(kTangentA),
         {at.get(kTangentTwist), at.get(kTangentTwist + 1), at.get(kTangentTwist + 2)}},
        {dG, dA, dXyz}, dS, dPull, dTwisted);
  laminate.scatterChange(change, dS, nothing, dPull, dTwisted);
}

// Strain and mode energies of some lanes, J.
template <MaterialLaw kLaw, bool kMixed, class D, class V = hn::Vec<D>>
HWY_INLINE void energiesOfLanes(const CellRun<D> &run, const ScalarLaw &scalar, V &strainEnergy, V &hourglassEnergy) {
  const D d = run.d;
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  LaminateLanes<kLaw, kMixed, D> laminate(run);
  const Mat3Lanes<V> G = laminate.strained(x, y, z);
  strainEnergy = hn::Mul(run.number(kVolume), energyOf<kLaw>(d, run.law, Strain<D>(d, G), scalar, run.material()));
  hourglassEnergy = hn::Zero(d);
  if (!run.job.hourglass) return;
  const Mat3Lanes<V> A = run.amplitudes(x, y, z);
  Mat3Lanes<V> B = A;
  if constexpr (kLaw != MaterialLaw::linear) B = A + transposeTimes(G, A);
  const V twisted = hn::MulAdd(x.xyz, x.xyz, hn::MulAdd(y.xyz, y.xyz, hn::Mul(z.xyz, z.xyz)));
  hourglassEnergy = hn::Mul(hn::Set(d, Real<D>(0.5)), hn::MulAdd(run.twist(), twisted, product(B, laminate.modes(B))));
}

template <MaterialLaw kLaw, bool kMixed, class T>
HWY_NOINLINE void tangentsOfSlice(const CellJob<T> &job, const ScalarLaw &scalar, const ChunkFields<T> &fields,
                                  std::size_t slice) {
  forLanes(job, fields, slice, [&](const auto &run) HWY_ATTR { tangentOfLanes<kLaw, kMixed>(run, scalar); });
}
template <MaterialLaw kLaw, bool kMixed, class T>
HWY_NOINLINE void productsOfSlice(const CellJob<T> &job, const ScalarLaw &scalar, const ChunkFields<T> &fields,
                                  std::size_t slice) {
  forLanes(job, fields, slice, [&](const auto &run) HWY_ATTR { productOfLanes<kLaw, kMixed>(run, scalar); });
}
template <MaterialLaw kLaw, bool kMixed, class T>
HWY_NOINLINE void energiesOfSlice(const CellJob<T> &job, const ScalarLaw &scalar, const ChunkFields<T> &fields,
                                  std::size_t slice) {
  storeEnergies(job, fields, slice, [&](const auto &run, auto &strain, auto &modes) HWY_ATTR {
    energiesOfLanes<kLaw, kMixed>(run, scalar, strain, modes);
  });
}

/// Calls of(law, whether a slice has laminates, slice, fields), the first two as integral constants.
template <Sums kSums, class T, class Of>
HWY_INLINE void forKinds(const CellJob<T> &job, std::size_t begin, std::size_t end, const Of &of) {
  forSlices<kSums>(job, begin, end, [&](auto law, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
    if (job.cells->laminates[slice] != kNoLaminate) {
      of(law, std::true_type(), slice, fields);
    } else {
      of(law, std::false_type(), slice, fields);
    }
  });
}

template <class T>
void tangentsOf(const CellJob<T> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  forKinds<Sums::none>(job, begin, end,
                       [&](auto law, auto mixed, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                         tangentsOfSlice<decltype(law)::value, decltype(mixed)::value>(job, scalar, fields, slice);
                       });
}
template <class T>
void productsOf(const CellJob<T> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  forKinds<Sums::perPhyxel>(job, begin, end,
                            [&](auto law, auto mixed, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                              productsOfSlice<decltype(law)::value, decltype(mixed)::value>(job, scalar, fields, slice);
                            });
}
template <class T>
void energiesOf(const CellJob<T> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  forKinds<Sums::none>(job, begin, end,
                       [&](auto law, auto mixed, std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
                         energiesOfSlice<decltype(law)::value, decltype(mixed)::value>(job, scalar, fields, slice);
                       });
}

void TangentsFloat(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  tangentsOf(job, scalar, begin, end);
}
void TangentsDouble(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  tangentsOf(job, scalar, begin, end);
}
void ProductsFloat(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  productsOf(job, scalar, begin, end);
}
void ProductsDouble(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  productsOf(job, scalar, begin, end);
}
void EnergiesFloat(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  energiesOf(job, scalar, begin, end);
}
void EnergiesDouble(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  energiesOf(job, scalar, begin, end);
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(TangentsFloat);
HWY_EXPORT(TangentsDouble);
HWY_EXPORT(ProductsFloat);
HWY_EXPORT(ProductsDouble);
HWY_EXPORT(EnergiesFloat);
HWY_EXPORT(EnergiesDouble);

void cellTangents(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(TangentsFloat)(job, scalar, begin, end);
}
void cellTangents(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(TangentsDouble)(job, scalar, begin, end);
}
void cellProducts(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(ProductsFloat)(job, scalar, begin, end);
}
void cellProducts(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(ProductsDouble)(job, scalar, begin, end);
}
void cellEnergies(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(EnergiesFloat)(job, scalar, begin, end);
}
void cellEnergies(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(EnergiesDouble)(job, scalar, begin, end);
}

}  // namespace pointbased::kernels
#endif
