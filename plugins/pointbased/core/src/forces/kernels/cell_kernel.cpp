// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/cell_kernel.h"

#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/kernels/cell_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "forces/kernels/cell_run-inl.h"
#include "forces/kernels/laminate-inl.h"
#include "forces/kernels/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

template <MaterialLaw kLaw, bool kModal, bool kMixed, class D>
HWY_INLINE void forcesOfLanes(const CellRun<D> &run, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  const D d = run.d;
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  LaminateLanes<kLaw, kMixed, D> laminate(run);
  const Mat3Lanes<V> G = laminate.strained(x, y, z);
  const Strain<D> strain(d, G);
  const V stretch2 = largestStretchSquared(d, strain.E, spreadOf(d, strain.E));
  V ratio;
  Mat3Lanes<V> S = stressOf<kLaw>(d, run.law, strain, stretch2, scalar, run.material(), ratio);
  const bool isViscous = run.fields.velocities != nullptr;
  SignSums<V> vx, vy, vz;
  Mat3Lanes<V> rate;
  if (isViscous) {
    run.gatherCorners(run.fields.velocities, vx, vy, vz);
    rate = laminate.change(vx, vy, vz).dG;
    S = S + viscousStress(d, hn::Set(d, run.law.twoEta), G, rate);
  }
  S = scaled(run.number(kVolume), S);
  V k[kCorners];
  if constexpr (!kModal) {
    run.stiffnesses(ratio, hn::Zero(d), k);
    laminate.scatter(S, k);
  } else {
    const Mat3Lanes<V> A = run.amplitudes(x, y, z);
    Mat3Lanes<V> pull;
    if constexpr (kLaw == MaterialLaw::linear) {
      pull = laminate.modes(A);
    } else {
      // B = Fᵀ A, S += A Dᵀ, pull = F D
      const Mat3Lanes<V> D3 = laminate.modes(A + transposeTimes(G, A));
      S = S + times(A, transposed(D3));
      pull = D3 + times(G, D3);
    }
    const Vec3Lanes<V> xyz{x.xyz, y.xyz, z.xyz};
    Vec3Lanes<V> twisted = scaled(run.twist(), xyz);
    if (isViscous)
      addViscousModes<kLaw == MaterialLaw::linear>(d, run.law, Real<D>(1), run.roots(), run.number(kTwist), {G, A, xyz},
                                                   {rate, run.amplitudes(vx, vy, vz), {vx.xyz, vy.xyz, vz.xyz}}, S,
                                                   pull, twisted);
    // The maximum of NaN and a number may be the number.
    run.stiffnesses(hn::IfThenElse(hn::Eq(ratio, ratio), hn::Max(ratio, stretch2), ratio),
                    kLaw == MaterialLaw::linear ? hn::Zero(d) : run.hourglassStiffness(A), k);
    laminate.scatter(S, k, pull, twisted);
  }
}

template <MaterialLaw kLaw, bool kModal, bool kMixed, class T>
HWY_NOINLINE void forcesOfSlice(const CellJob<T> &job, const ScalarLaw &scalar, const ChunkFields<T> &fields,
                                std::size_t slice) {
  using D = hn::CappedTag<T, kLanes<T>>;
  const D d;
  for (std::size_t lane = 0; lane < kLanes<T>; lane += hn::Lanes(d))
    forcesOfLanes<kLaw, kModal, kMixed>(CellRun<D>(d, job, fields, slice, lane), scalar);
}

template <class T>
void forcesOf(const CellJob<T> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  for (std::size_t chunk = begin; chunk < end; ++chunk)
    forChunk<Sums::perPhyxel>(job, chunk, [&](std::size_t slice, const ChunkFields<T> &fields) HWY_ATTR {
      withLaw(job.laws[job.cells->materials[slice]].law, [&](auto law) HWY_ATTR {
        constexpr MaterialLaw kLaw = decltype(law)::value;
        const bool isMixed = job.cells->laminates[slice] != kNoLaminate;
        if (job.hourglass) {
          (isMixed ? forcesOfSlice<kLaw, true, true, T> : forcesOfSlice<kLaw, true, false, T>)(job, scalar, fields,
                                                                                               slice);
        } else {
          (isMixed ? forcesOfSlice<kLaw, false, true, T> : forcesOfSlice<kLaw, false, false, T>)(job, scalar, fields,
                                                                                                 slice);
        }
      });
    });
}

// Sums the partials of each phyxel.
template <class T>
double collectOf(const CollectJob<T> &job, std::size_t begin, std::size_t end) {
  HWY_ALIGN T sum[4];
  double largest = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const Index *place = job.places.data() + job.offsets[i], *last = job.places.data() + job.offsets[i + 1];
    for (T &s : sum) s = T(0);
    for (; place != last; ++place) Records<T>::add(job.partials + 4 * std::size_t{*place}, sum);
    const double x = sum[0], y = sum[1], z = sum[2];
    if (job.masses) {
      const double stiffness = static_cast<double>(sum[3]) / job.masses[i];
      if (!(stiffness <= largest) && largest == largest) largest = stiffness;
    }
    double *out = job.forces + 3 * i;
    if (job.turned) {
      for (int r = 0; r < 3; ++r) out[r] = job.axes[r][0] * x + job.axes[r][1] * y + job.axes[r][2] * z;
    } else {
      out[0] = x;
      out[1] = y;
      out[2] = z;
    }
  }
  return largest;
}

double CollectFloat(const CollectJob<float> &job, std::size_t begin, std::size_t end) {
  return collectOf(job, begin, end);
}
double CollectDouble(const CollectJob<double> &job, std::size_t begin, std::size_t end) {
  return collectOf(job, begin, end);
}
void CellForcesFloat(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  forcesOf(job, scalar, begin, end);
}
void CellForcesDouble(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  forcesOf(job, scalar, begin, end);
}
const char *TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(CellForcesFloat);
HWY_EXPORT(CellForcesDouble);
HWY_EXPORT(CollectFloat);
HWY_EXPORT(CollectDouble);
HWY_EXPORT(TargetName);

void cellForces(const CellJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CellForcesFloat)(job, scalar, begin, end);
}
void cellForces(const CellJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CellForcesDouble)(job, scalar, begin, end);
}
double collectForces(const CollectJob<float> &job, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(CollectFloat)(job, begin, end);
}
double collectForces(const CollectJob<double> &job, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(CollectDouble)(job, begin, end);
}
const char *kernelTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace pointbased::kernels
#endif
