// SPDX-License-Identifier: Apache-2.0
// Selects the law, and the lanes that need the scalar law. Private to the kernels.
#if defined(POINTBASED_KERNELS_STRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_STRESS_INL_H_
#undef POINTBASED_KERNELS_STRESS_INL_H_
#else
#define POINTBASED_KERNELS_STRESS_INL_H_
#endif

#include <limits>
#include <type_traits>

#include "forces/kernels/laws-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// Stores nine rows, column-major.
template <class D, std::size_t kRow, class V = hn::Vec<D>>
HWY_INLINE void storeNine(D d, const Mat3Lanes<V> &m, Real<D> (&to)[9][kRow]) {
  hn::Store(m.c0.x, d, to[0]);
  hn::Store(m.c0.y, d, to[1]);
  hn::Store(m.c0.z, d, to[2]);
  hn::Store(m.c1.x, d, to[3]);
  hn::Store(m.c1.y, d, to[4]);
  hn::Store(m.c1.z, d, to[5]);
  hn::Store(m.c2.x, d, to[6]);
  hn::Store(m.c2.y, d, to[7]);
  hn::Store(m.c2.z, d, to[8]);
}
template <class D, std::size_t kRow>
HWY_INLINE Mat3Lanes<hn::Vec<D>> loadNine(D d, const Real<D> (&from)[9][kRow]) {
  return {{hn::Load(d, from[0]), hn::Load(d, from[1]), hn::Load(d, from[2])},
          {hn::Load(d, from[3]), hn::Load(d, from[4]), hn::Load(d, from[5])},
          {hn::Load(d, from[6]), hn::Load(d, from[7]), hn::Load(d, from[8])}};
}

template <class D, class V = hn::Vec<D>>
HWY_NOINLINE void evaluateScalarLanes(D d, hn::Mask<D> stray, const Strain<D> &s, const ScalarLaw &scalar,
                                      std::size_t material, Mat3Lanes<V> &stress, V &ratio) {
  using T = Real<D>;
  constexpr std::size_t kMost = hn::MaxLanes(D());
  HWY_ALIGN T G[9][kMost];
  HWY_ALIGN T P[9][kMost];
  HWY_ALIGN T ratios[kMost];
  HWY_ALIGN T flags[kMost];
  storeNine(d, s.G, G);
  storeNine(d, stress, P);
  hn::Store(ratio, d, ratios);
  hn::Store(hn::IfThenElseZero(stray, hn::Set(d, T(1))), d, flags);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    if (flags[i] == T(0)) continue;
    double F[9], answer[9];
    for (int k = 0; k < 9; ++k) F[k] = static_cast<double>(G[k][i]) + (k % 4 == 0 ? 1.0 : 0.0);
    ratios[i] = static_cast<T>(scalar.stress(scalar.context, material, F, answer));
    for (int k = 0; k < 9; ++k) P[k][i] = static_cast<T>(answer[k]);
  }
  stress = loadNine(d, P);
  ratio = hn::Load(d, ratios);
}

// P, and the stiffness of the point relative to rest, as tangentRatio(): at least 1, NaN if anything is NaN.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> stressOf(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, const FrameOf<kLaw, D> &frame,
                                 V stretch2, const ScalarLaw &scalar, std::size_t material, V &ratio) {
  using T = Real<D>;
  Answer<V> a;
  hn::Mask<D> stray = hn::Lt(hn::Zero(d), hn::Zero(d));
  if constexpr (kLaw == MaterialLaw::linear) {
    a = linear(d, m, s, stretch2);
  } else if constexpr (kLaw == MaterialLaw::stVenantKirchhoff) {
    a = stVenantKirchhoff(d, m, s, stretch2);
  } else if constexpr (kLaw == MaterialLaw::corotated) {
    a = corotated(d, m, s, frame, stretch2, stray);
  } else {
    a = neoHookean(d, m, s, stretch2);
  }
  const V J = hn::Add(s.growth, hn::Set(d, T(1)));
  // The bounds of terms in J are valid for J > 0.
  if (kLaw == MaterialLaw::neoHookean || m.volume > 0)
    stray = hn::Or(stray, hn::Lt(J, hn::Set(d, kLaw == MaterialLaw::neoHookean ? T(kNeoHookeanSwitch) : T(1e-9))));
  const V one = hn::Set(d, T(1));
  const V larger = hn::Max(hn::Mul(a.wave, hn::Set(d, 1 / m.waveAtRest)), hn::Mul(a.all, hn::Set(d, 1 / m.allAtRest)));
  ratio = hn::Max(larger, one);
  if (HWY_UNLIKELY(!hn::AllFalse(d, stray))) evaluateScalarLanes(d, stray, s, scalar, material, a.stress, ratio);
  // NaN must not get lost in a maximum.
  ratio = hn::Add(ratio, hn::Mul(hn::Zero(d), s.growth));
  return a.stress;
}

template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> stressOf(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, V stretch2,
                                 const ScalarLaw &scalar, std::size_t material, V &ratio) {
  return stressOf<kLaw>(d, m, s, FrameOf<kLaw, D>(d, s), stretch2, scalar, material, ratio);
}

/// Calls body(std::integral_constant of the law).
template <class Body>
HWY_INLINE void withLaw(int law, const Body &body) {
  switch (static_cast<MaterialLaw>(law)) {
    case MaterialLaw::linear: return body(std::integral_constant<MaterialLaw, MaterialLaw::linear>());
    case MaterialLaw::stVenantKirchhoff:
      return body(std::integral_constant<MaterialLaw, MaterialLaw::stVenantKirchhoff>());
    case MaterialLaw::corotated: return body(std::integral_constant<MaterialLaw, MaterialLaw::corotated>());
    case MaterialLaw::custom:  // handled by the scalar engine
    case MaterialLaw::neoHookean: break;
  }
  body(std::integral_constant<MaterialLaw, MaterialLaw::neoHookean>());
}

/// Largest ratio of all lanes, at least 1; NaN if any is NaN.
template <class D>
class LargestRatio {
 public:
  HWY_INLINE explicit LargestRatio(D d) : largest_(hn::Set(d, Real<D>(1))) {}
  HWY_INLINE void add(hn::Vec<D> ratio) {
    // The sum of NaN and a number is NaN, whatever the maximum of an instruction set returns.
    largest_ = hn::IfThenElse(hn::Eq(ratio, ratio), hn::Max(largest_, ratio), hn::Add(largest_, ratio));
  }
  HWY_INLINE Real<D> value(D d) const {
    if (!hn::AllTrue(d, hn::Eq(largest_, largest_))) return std::numeric_limits<Real<D>>::quiet_NaN();
    return hn::GetLane(hn::MaxOfLanes(d, largest_));
  }

 private:
  hn::Vec<D> largest_;
};

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
