// SPDX-License-Identifier: Apache-2.0
#include "kernels/cell_kernel.h"

#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cell_kernel.cpp"
// Vectors of a length that is known only at run time cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/corners-inl.h"
#include "kernels/modes-inl.h"
#include "kernels/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

template <class D>
struct CellRun {
  using T = Real<D>;
  using V = hn::Vec<D>;
  static constexpr std::size_t kSlice = kLanes<T>;

  D d;
  const CellJob<T> &job;
  const LawNumbers<T> &law;
  std::size_t slice, lane;
  const T *numbers;

  HWY_INLINE CellRun(D tag, const CellJob<T> &of, std::size_t s, std::size_t l)
      : d(tag), job(of), law(of.laws[of.cells->materials[s]]), slice(s), lane(l),
        numbers(of.cells->numbers.data() + s * kCellNumbers * kSlice + l) {}

  HWY_INLINE V number(CellNumber which) const { return hn::Load(d, numbers + which * kSlice); }

  HWY_INLINE void gatherCorners(const T *field, SignSums<V> &x, SignSums<V> &y, SignSums<V> &z) const {
    const Index *corners = job.cells->corners.data() + slice * kCorners * kSlice + lane;
    V ux[kCorners], uy[kCorners], uz[kCorners];
    for (std::size_t j = 0; j < kCorners; ++j) {
      const Vec3Lanes<V> u = loadVectors(d, field, corners + j * kSlice);
      ux[j] = u.x;
      uy[j] = u.y;
      uz[j] = u.z;
    }
    x = signSums(ux);
    y = signSums(uy);
    z = signSums(uz);
  }

  // One row of G (and of the amplitudes) per component.
  HWY_INLINE void fit(const SignSums<V> &c, V &gx, V &gy, V &gz) const {
    const V g = number(kGradient);
    const V px = number(kFirstX), py = number(kFirstY), pz = number(kFirstZ);
    gx = hn::MulAdd(g, c.x, hn::MulAdd(py, c.xy, hn::MulAdd(pz, c.xz, hn::Mul(number(kMixedX), c.xyz))));
    gy = hn::MulAdd(g, c.y, hn::MulAdd(px, c.xy, hn::MulAdd(pz, c.yz, hn::Mul(number(kMixedY), c.xyz))));
    gz = hn::MulAdd(g, c.z, hn::MulAdd(px, c.xz, hn::MulAdd(py, c.yz, hn::Mul(number(kMixedZ), c.xyz))));
  }

  // What one component of the stress and of the pulls of the modes does to the signs.
  HWY_INLINE SignSums<V> unfit(V sx, V sy, V sz, V mxy, V mxz, V myz, V mxyz) const {
    const V g = number(kGradient);
    const V px = number(kFirstX), py = number(kFirstY), pz = number(kFirstZ);
    SignSums<V> t;
    t.x = hn::Mul(g, sx);
    t.y = hn::Mul(g, sy);
    t.z = hn::Mul(g, sz);
    t.xy = hn::MulAdd(py, sx, hn::MulAdd(px, sy, mxy));
    t.xz = hn::MulAdd(pz, sx, hn::MulAdd(px, sz, mxz));
    t.yz = hn::MulAdd(pz, sy, hn::MulAdd(py, sz, myz));
    t.xyz = hn::MulAdd(number(kMixedX), sx, hn::MulAdd(number(kMixedY), sy, hn::MulAdd(number(kMixedZ), sz, mxyz)));
    return t;
  }

  HWY_INLINE void scatter(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z) const {
    V fx[kCorners], fy[kCorners], fz[kCorners];
    spreadSigns(x, fx);
    spreadSigns(y, fy);
    spreadSigns(z, fz);
    T *out = job.entries + 4 * (slice * kCorners * kSlice + lane);
    const V zero = hn::Zero(d);
    for (std::size_t j = 0; j < kCorners; ++j)
      hn::StoreInterleaved4(fx[j], fy[j], fz[j], zero, d, out + 4 * j * kSlice);
  }
};

template <MaterialLaw kLaw, bool kModal, class D>
HWY_INLINE hn::Vec<D> forcesOfLanes(const CellRun<D> &run, StrayLaw stray, const void *context) {
  using V = hn::Vec<D>;
  const D d = run.d;
  SignSums<V> x, y, z;
  run.gatherCorners(run.job.displacements, x, y, z);
  Mat3Lanes<V> G;
  run.fit(x, G.c0.x, G.c1.x, G.c2.x);
  run.fit(y, G.c0.y, G.c1.y, G.c2.y);
  run.fit(z, G.c0.z, G.c1.z, G.c2.z);
  const Strain<D> strain(d, G);
  const V stretch2 = largestStretchSquared(d, strain.E, spreadOf(d, strain.E));
  V ratio;
  const std::size_t material = run.job.cells->materials[run.slice];
  Mat3Lanes<V> S = stressOf<kLaw>(d, run.law, strain, stretch2, stray, context, material, ratio);
  S = scaled(run.number(kVolume), S);
  const V zero = hn::Zero(d);
  if constexpr (!kModal) {
    run.scatter(run.unfit(S.c0.x, S.c1.x, S.c2.x, zero, zero, zero, zero),
                run.unfit(S.c0.y, S.c1.y, S.c2.y, zero, zero, zero, zero),
                run.unfit(S.c0.z, S.c1.z, S.c2.z, zero, zero, zero, zero));
    return ratio;
  } else {
    const V kxy = run.number(kModeXY), kxz = run.number(kModeXZ), kyz = run.number(kModeYZ);
    const Mat3Lanes<V> A = {{hn::Mul(kxy, x.xy), hn::Mul(kxy, y.xy), hn::Mul(kxy, z.xy)},
                            {hn::Mul(kxz, x.xz), hn::Mul(kxz, y.xz), hn::Mul(kxz, z.xz)},
                            {hn::Mul(kyz, x.yz), hn::Mul(kyz, y.yz), hn::Mul(kyz, z.yz)}};
    const Vec3Lanes<V> root = {run.number(kRootX), run.number(kRootY), run.number(kRootZ)};
    Mat3Lanes<V> pull;
    if constexpr (kLaw == MaterialLaw::linear) {
      pull = modalConjugate(d, run.law, A, root);
    } else {
      // B = Fᵀ A, S += A Dᵀ, pull = F D
      const Mat3Lanes<V> D3 = modalConjugate(d, run.law, A + transposeTimes(G, A), root);
      S = S + times(A, transposed(D3));
      pull = D3 + times(G, D3);
    }
    const V twist = hn::Mul(hn::Set(d, run.law.modalTwist), run.number(kTwist));
    run.scatter(run.unfit(S.c0.x, S.c1.x, S.c2.x, hn::Mul(kxy, pull.c0.x), hn::Mul(kxz, pull.c1.x), hn::Mul(kyz, pull.c2.x),
                          hn::Mul(twist, x.xyz)),
                run.unfit(S.c0.y, S.c1.y, S.c2.y, hn::Mul(kxy, pull.c0.y), hn::Mul(kxz, pull.c1.y), hn::Mul(kyz, pull.c2.y),
                          hn::Mul(twist, y.xyz)),
                run.unfit(S.c0.z, S.c1.z, S.c2.z, hn::Mul(kxy, pull.c0.z), hn::Mul(kxz, pull.c1.z), hn::Mul(kyz, pull.c2.z),
                          hn::Mul(twist, z.xyz)));
    return hn::Max(ratio, stretch2);
  }
}

template <MaterialLaw kLaw, bool kModal, class T>
HWY_NOINLINE void forcesOfSlice(const CellJob<T> &job, StrayLaw stray, const void *context, std::size_t slice) {
  using D = hn::CappedTag<T, kLanes<T>>;
  const D d;
  const std::size_t step = hn::Lanes(d);
  LargestRatio<D> largest(d);
  for (std::size_t lane = 0; lane < kLanes<T>; lane += step) {
    const CellRun<D> run(d, job, slice, lane);
    largest.add(forcesOfLanes<kLaw, kModal>(run, stray, context));
  }
  job.ratios[slice] = largest.value(d);
}

template <class T>
void forcesOf(const CellJob<T> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end) {
  for (std::size_t slice = begin; slice < end; ++slice)
    withLaw(job.laws[job.cells->materials[slice]].law, [&](auto law) HWY_ATTR {
      if (job.modal) {
        forcesOfSlice<decltype(law)::value, true>(job, stray, context, slice);
      } else {
        forcesOfSlice<decltype(law)::value, false>(job, stray, context, slice);
      }
    });
}

void CellForcesFloat(const CellJob<float> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end) {
  forcesOf(job, stray, context, begin, end);
}
void CellForcesDouble(const CellJob<double> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end) {
  forcesOf(job, stray, context, begin, end);
}
const char *TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(CellForcesFloat);
HWY_EXPORT(CellForcesDouble);
HWY_EXPORT(TargetName);

void cellForces(const CellJob<float> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CellForcesFloat)(job, stray, context, begin, end);
}
void cellForces(const CellJob<double> &job, StrayLaw stray, const void *context, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CellForcesDouble)(job, stray, context, begin, end);
}
const char *kernelTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace pointbased::kernels
#endif
