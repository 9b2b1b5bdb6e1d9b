// SPDX-License-Identifier: Apache-2.0
// Tangents and energies of the laws with one point per lane. Private to the kernels.
#if defined(POINTBASED_KERNELS_TANGENT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_TANGENT_INL_H_
#undef POINTBASED_KERNELS_TANGENT_INL_H_
#else
#define POINTBASED_KERNELS_TANGENT_INL_H_
#endif

#include "forces/kernels/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// The numbers of TangentNumber of some lanes.
template <class D, class V = hn::Vec<D>>
struct TangentRows {
  static constexpr std::size_t kRow = kLanes<Real<D>>;
  D d;
  Real<D> *at;

  HWY_INLINE void set(std::size_t row, V value) const { hn::Store(value, d, at + row * kRow); }
  HWY_INLINE V get(std::size_t row) const { return hn::Load(d, at + row * kRow); }
  HWY_INLINE void setMatrix(std::size_t row, const Mat3Lanes<V> &m) const {
    set(row, m.c0.x);
    set(row + 1, m.c0.y);
    set(row + 2, m.c0.z);
    set(row + 3, m.c1.x);
    set(row + 4, m.c1.y);
    set(row + 5, m.c1.z);
    set(row + 6, m.c2.x);
    set(row + 7, m.c2.y);
    set(row + 8, m.c2.z);
  }
  HWY_INLINE Mat3Lanes<V> getMatrix(std::size_t row) const {
    return {{get(row), get(row + 1), get(row + 2)},
            {get(row + 3), get(row + 4), get(row + 5)},
            {get(row + 6), get(row + 7), get(row + 8)}};
  }
};

template <class V>
HWY_INLINE Sym3Lanes<V> cofactor(const Sym3Lanes<V> &a) {
  return {hn::MulSub(a.yy, a.zz, hn::Mul(a.yz, a.yz)), hn::MulSub(a.xx, a.zz, hn::Mul(a.xz, a.xz)),
          hn::MulSub(a.xx, a.yy, hn::Mul(a.xy, a.xy)), hn::MulSub(a.xz, a.yz, hn::Mul(a.xy, a.zz)),
          hn::MulSub(a.xy, a.yz, hn::Mul(a.xz, a.yy)), hn::MulSub(a.xy, a.xz, hn::Mul(a.yz, a.xx))};
}

/// Sets everything except the amplitudes.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE void prepareTangent(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, const TangentRows<D> &out) {
  using T = Real<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, T(1)), kv = hn::Set(d, m.volume);
  out.setMatrix(kTangentG, s.G);
  hn::Mask<D> stray = hn::Lt(zero, zero);
  const V volumeFirst = hn::Mul(kv, s.growth);
  if constexpr (kLaw == MaterialLaw::neoHookean) {
    const V J = hn::Add(one, s.growth), inverse = hn::Div(one, J);
    const V lambda = hn::Set(d, m.lambda), mu = hn::Set(d, m.mu);
    const V lambdaLog = hn::Mul(lambda, hn::Log1p(d, s.growth));
    out.set(kTangentFirst, hn::MulAdd(hn::Sub(lambdaLog, mu), inverse, volumeFirst));
    out.set(kTangentSecond, hn::MulAdd(hn::Sub(hn::Add(lambda, mu), lambdaLog), hn::Mul(inverse, inverse), kv));
    stray = hn::Lt(J, hn::Set(d, T(kNeoHookeanSwitch)));
  } else if constexpr (kLaw == MaterialLaw::corotated) {
    const PolarLanes<D> p(d, s);
    const Mat3Lanes<V> F = plusDiagonal(s.G, one), U = transposeTimes(p.R, F);
    const V half = hn::Set(d, T(0.5));
    const Sym3Lanes<V> sums = {hn::Sub(p.trace, U.c0.x),
                               hn::Sub(p.trace, U.c1.y),
                               hn::Sub(p.trace, U.c2.z),
                               hn::Neg(hn::Mul(half, hn::Add(U.c1.x, U.c0.y))),
                               hn::Neg(hn::Mul(half, hn::Add(U.c2.x, U.c0.z))),
                               hn::Neg(hn::Mul(half, hn::Add(U.c2.y, U.c1.z)))};
    const Sym3Lanes<V> c = cofactor(sums);
    const V inverse = hn::Div(one, hn::MulAdd(sums.xx, c.xx, hn::MulAdd(sums.xy, c.xy, hn::Mul(sums.xz, c.xz))));
    out.setMatrix(kTangentR, p.R);
    const V turn[6] = {c.xx, c.yy, c.zz, c.xy, c.xz, c.yz};
    for (std::size_t k = 0; k < 6; ++k) out.set(kTangentTurn + k, hn::Mul(inverse, turn[k]));
    out.set(kTangentFirst,
            hn::NegMulAdd(hn::Set(d, m.lambda), hn::Sub(p.trace, hn::Set(d, T(3))), hn::Set(d, 2 * m.mu)));
    out.set(kTangentSecond, volumeFirst);
    // Valid as long as the two smaller stretches do not both vanish; there the scalar law bounds the rotation matrix.
    const V largest = hn::Sqrt(largestStretchSquared(d, s.E, spreadOf(d, s.E)));
    stray = hn::Or(hn::Not(p.found), hn::Not(hn::Gt(hn::Sub(p.trace, largest), hn::Set(d, T(2.0 * kCorotatedFloor)))));
  } else {
    out.set(kTangentFirst, volumeFirst);
    out.set(kTangentSecond, kv);
  }
  out.set(kTangentStray, hn::IfThenElseZero(stray, one));
}

/// M [w]x
template <class V>
HWY_INLINE Mat3Lanes<V> timesCross(const Mat3Lanes<V> &M, const Vec3Lanes<V> &w) {
  return {scaled(w.z, M.c1) - scaled(w.y, M.c2), scaled(w.x, M.c2) - scaled(w.z, M.c0),
          scaled(w.y, M.c0) - scaled(w.x, M.c1)};
}

template <class D, class V = hn::Vec<D>>
HWY_NOINLINE void answerStrayChanges(D d, V stray, const Mat3Lanes<V> &G, const Mat3Lanes<V> &dG,
                                     const ScalarLaw &scalar, std::size_t material, Mat3Lanes<V> &dP) {
  using T = Real<D>;
  constexpr std::size_t kMost = hn::MaxLanes(D());
  HWY_ALIGN T at[9][kMost];
  HWY_ALIGN T change[9][kMost];
  HWY_ALIGN T answers[9][kMost];
  HWY_ALIGN T flags[kMost];
  storeNine(d, G, at);
  storeNine(d, dG, change);
  storeNine(d, dP, answers);
  hn::Store(stray, d, flags);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    if (flags[i] == T(0)) continue;
    double F[9], dF[9], answer[9];
    for (int k = 0; k < 9; ++k) {
      F[k] = static_cast<double>(at[k][i]) + (k % 4 == 0 ? 1.0 : 0.0);
      dF[k] = static_cast<double>(change[k][i]);
    }
    scalar.differential(scalar.context, material, F, dF, answer);
    for (int k = 0; k < 9; ++k) answers[k][i] = static_cast<T>(answer[k]);
  }
  dP = loadNine(d, answers);
}

/// dP for dG.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> stressChange(D d, const LawNumbers<Real<D>> &m, const TangentRows<D> &t, const Mat3Lanes<V> &dG,
                                     const ScalarLaw &scalar, std::size_t material) {
  using T = Real<D>;
  const V one = hn::Set(d, T(1));
  const Mat3Lanes<V> G = t.getMatrix(kTangentG);
  Mat3Lanes<V> dP;
  V first = t.get(kTangentFirst);
  if constexpr (kLaw == MaterialLaw::neoHookean) {
    const Mat3Lanes<V> F = plusDiagonal(G, one), c = cofactor(F);
    dP = scaled(hn::Set(d, m.mu), dG);
    dP = mulAdd(hn::Mul(t.get(kTangentSecond), product(c, dG)), c, dP);
    dP = mulAdd(first, cofactorDifferential(F, dG), dP);
  } else {
    if constexpr (kLaw == MaterialLaw::linear) {
      dP = hooke(d, m, smallStrain(d, dG));
    } else if constexpr (kLaw == MaterialLaw::stVenantKirchhoff) {
      const Strain<D> s(d, G);
      const Mat3Lanes<V> F = plusDiagonal(G, one);
      dP = times(dG, hooke(d, m, s.E)) + times(F, hooke(d, m, smallStrain(d, transposeTimes(F, dG))));
    } else {
      const Mat3Lanes<V> R = t.getMatrix(kTangentR), A = transposeTimes(R, dG);
      const Vec3Lanes<V> axial = {hn::Sub(A.c1.z, A.c2.y), hn::Sub(A.c2.x, A.c0.z), hn::Sub(A.c0.y, A.c1.x)};
      const Sym3Lanes<V> turn = {t.get(kTangentTurn),     t.get(kTangentTurn + 1), t.get(kTangentTurn + 2),
                                 t.get(kTangentTurn + 3), t.get(kTangentTurn + 4), t.get(kTangentTurn + 5)};
      const Mat3Lanes<V> dR = timesCross(R, times(full(turn), axial));
      dP = mulAdd(hn::Neg(first), dR, scaled(hn::Set(d, 2 * m.mu), dG));
      dP = mulAdd(hn::Mul(hn::Set(d, m.lambda), trace(A)), R, dP);
      first = t.get(kTangentSecond);
    }
    if (m.volume > 0) {
      const Mat3Lanes<V> F = plusDiagonal(G, one), c = cofactor(F);
      dP = mulAdd(hn::Mul(hn::Set(d, m.volume), product(c, dG)), c, dP);
      dP = mulAdd(first, cofactorDifferential(F, dG), dP);
    }
  }
  if constexpr (kLaw == MaterialLaw::neoHookean || kLaw == MaterialLaw::corotated) {
    const V stray = t.get(kTangentStray);
    if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Gt(stray, hn::Zero(d)))))
      answerStrayChanges(d, stray, G, dG, scalar, material, dP);
  }
  return dP;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V doubleDot(D d, const Sym3Lanes<V> &e) {
  const V across = hn::MulAdd(e.xy, e.xy, hn::MulAdd(e.xz, e.xz, hn::Mul(e.yz, e.yz)));
  return hn::MulAdd(hn::Set(d, Real<D>(2)), across,
                    hn::MulAdd(e.xx, e.xx, hn::MulAdd(e.yy, e.yy, hn::Mul(e.zz, e.zz))));
}

/// W, J/m³.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE V energyOf(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, const ScalarLaw &scalar,
                      std::size_t material) {
  using T = Real<D>;
  const V one = hn::Set(d, T(1)), mu = hn::Set(d, m.mu), halfLambda = hn::Set(d, m.lambda / 2);
  hn::Mask<D> stray = hn::Lt(one, hn::Zero(d));
  V W;
  if constexpr (kLaw == MaterialLaw::neoHookean) {
    const V log = hn::Log1p(d, s.growth);
    W = hn::MulAdd(mu, hn::Sub(trace(s.E), log), hn::Mul(halfLambda, hn::Mul(log, log)));
    stray = hn::Lt(hn::Add(one, s.growth), hn::Set(d, T(kNeoHookeanSwitch)));
  } else if constexpr (kLaw == MaterialLaw::corotated) {
    const PolarLanes<D> p(d, s);
    const V growth = hn::Sub(p.trace, hn::Set(d, T(3)));
    W = hn::MulAdd(mu, squaredNorm(plusDiagonal(s.G - p.R, one)), hn::Mul(halfLambda, hn::Mul(growth, growth)));
    stray = hn::Not(p.found);
  } else {
    const Sym3Lanes<V> e = kLaw == MaterialLaw::linear ? smallStrain(d, s.G) : s.E;
    const V tr = trace(e);
    W = hn::MulAdd(mu, doubleDot(d, e), hn::Mul(halfLambda, hn::Mul(tr, tr)));
  }
  W = hn::MulAdd(hn::Set(d, m.volume / 2), hn::Mul(s.growth, s.growth), W);
  if (HWY_UNLIKELY(!hn::AllFalse(d, stray))) {
    constexpr std::size_t kMost = hn::MaxLanes(D());
    HWY_ALIGN T at[9][kMost];
    HWY_ALIGN T answers[kMost];
    HWY_ALIGN T flags[kMost];
    storeNine(d, s.G, at);
    hn::Store(W, d, answers);
    hn::Store(hn::IfThenElseZero(stray, one), d, flags);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      if (flags[i] == T(0)) continue;
      double F[9];
      for (int k = 0; k < 9; ++k) F[k] = static_cast<double>(at[k][i]) + (k % 4 == 0 ? 1.0 : 0.0);
      answers[i] = static_cast<T>(scalar.energy(scalar.context, material, F));
    }
    W = hn::Load(d, answers);
  }
  return W;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
