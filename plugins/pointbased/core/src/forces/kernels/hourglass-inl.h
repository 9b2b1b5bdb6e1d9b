// SPDX-License-Identifier: Apache-2.0
// Energy of hourglass_energy.h with one cell per lane, in lattice axes. Private to the kernels.
#if defined(POINTBASED_KERNELS_MODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_MODES_INL_H_
#undef POINTBASED_KERNELS_MODES_INL_H_
#else
#define POINTBASED_KERNELS_MODES_INL_H_
#endif

#include "forces/hourglass_energy.h"
#include "forces/kernels/laws-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// dU/dB of HourglassEnergy::conjugate() for moduli μ and λ*, Pa.
/// @param B  columns xy, xz, yz
template <class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> hourglassConjugate(D d, Real<D> ofMu, Real<D> ofLambda, const Mat3Lanes<V> &B,
                                           const Vec3Lanes<V> &root) {
  using T = Real<D>;
  const V mu = hn::Set(d, ofMu), lambda = hn::Set(d, ofLambda), two = hn::Set(d, 2 * ofMu);
  const V theta = hn::Set(d, T(detail::kWarping)), rest = hn::Set(d, T((1.0 - detail::kWarping) / 3.0));
  const V tx = hn::Mul(root.x, hn::Add(B.c0.z, B.c1.y));
  const V ty = hn::Mul(root.y, hn::Add(B.c0.z, B.c2.x));
  const V tz = hn::Mul(root.z, hn::Add(B.c1.y, B.c2.x));
  const V common = hn::Mul(rest, hn::Add(tx, hn::Add(ty, tz)));
  const V sx = hn::Mul(hn::Mul(mu, root.x), hn::MulAdd(theta, tx, common));
  const V sy = hn::Mul(hn::Mul(mu, root.y), hn::MulAdd(theta, ty, common));
  const V sz = hn::Mul(hn::Mul(mu, root.z), hn::MulAdd(theta, tz, common));
  const V px = hn::Mul(lambda, hn::Add(B.c0.y, B.c1.z));
  const V py = hn::Mul(lambda, hn::Add(B.c0.x, B.c2.z));
  const V pz = hn::Mul(lambda, hn::Add(B.c1.x, B.c2.y));
  const V vx = hn::Mul(root.x, root.x), vy = hn::Mul(root.y, root.y), vz = hn::Mul(root.z, root.z);
  Mat3Lanes<V> D3;
  D3.c0 = {hn::Mul(vy, hn::MulAdd(two, B.c0.x, py)), hn::Mul(vx, hn::MulAdd(two, B.c0.y, px)), hn::Add(sx, sy)};
  D3.c1 = {hn::Mul(vz, hn::MulAdd(two, B.c1.x, pz)), hn::Add(sx, sz), hn::Mul(vx, hn::MulAdd(two, B.c1.z, px))};
  D3.c2 = {hn::Add(sy, sz), hn::Mul(vz, hn::MulAdd(two, B.c2.y, pz)), hn::Mul(vy, hn::MulAdd(two, B.c2.z, py))};
  return D3;
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> hourglassConjugate(D d, const LawNumbers<Real<D>> &m, const Mat3Lanes<V> &B,
                                           const Vec3Lanes<V> &root) {
  return hourglassConjugate(d, m.hourglassMu, m.hourglassLambda, B, root);
}

/// State of some lanes, G = F - 1: amplitudes of the modes xy, xz, yz and Σ s u of xyz.
template <class V>
struct ModalState {
  Mat3Lanes<V> G, A;
  Vec3Lanes<V> xyz;
};

/// Adds the viscous forces of the modes (addViscousModes() in viscous_hourglass.h), times `scale`.
/// @param twist  kTwist of the lanes
template <bool kLinear, class D, class V = hn::Vec<D>>
HWY_INLINE void addViscousModes(D d, const LawNumbers<Real<D>> &m, Real<D> scale, const Vec3Lanes<V> &root, V twist,
                                const ModalState<V> &at, const ModalState<V> &rate, Mat3Lanes<V> &S, Mat3Lanes<V> &pull,
                                Vec3Lanes<V> &twisted) {
  Mat3Lanes<V> dB = rate.A;
  Vec3Lanes<V> w = rate.xyz;
  if constexpr (!kLinear) {
    dB = dB + transposeTimes(at.G, rate.A) + transposeTimes(rate.G, at.A);
    w = w + transposeTimes(at.G, rate.xyz) + transposeTimes(rate.G, at.xyz);
  }
  const Mat3Lanes<V> D3 = hourglassConjugate(d, scale * m.viscousMu, scale * m.viscousLambda, dB, root);
  w = scaled(hn::Mul(hn::Set(d, scale * m.viscousTwist), twist), w);
  if constexpr (kLinear) {
    pull = pull + D3;
    twisted = twisted + w;
  } else {
    S = S + times(at.A, transposed(D3)) + Mat3Lanes<V>{scaled(w.x, at.xyz), scaled(w.y, at.xyz), scaled(w.z, at.xyz)};
    pull = pull + D3 + times(at.G, D3);
    twisted = twisted + w + times(at.G, w);
  }
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
