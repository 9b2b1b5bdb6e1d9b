// SPDX-License-Identifier: Apache-2.0
// Laminates (forces/laminate.h) with one point per lane. Private to the kernels.
#if defined(POINTBASED_KERNELS_LAMINATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_LAMINATE_INL_H_
#undef POINTBASED_KERNELS_LAMINATE_INL_H_
#else
#define POINTBASED_KERNELS_LAMINATE_INL_H_
#endif

#include "forces/kernels/cell_run-inl.h"
#include "forces/kernels/hourglass-inl.h"
#include "forces/kernels/tangent-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

template <class V>
HWY_INLINE Mat3Lanes<V> outer(const Vec3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {scaled(b.x, a), scaled(b.y, a), scaled(b.z, a)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> times(const Sym3Lanes<V> &a, const Vec3Lanes<V> &b) {
  return {hn::MulAdd(a.xx, b.x, hn::MulAdd(a.xy, b.y, hn::Mul(a.xz, b.z))),
          hn::MulAdd(a.xy, b.x, hn::MulAdd(a.yy, b.y, hn::Mul(a.yz, b.z))),
          hn::MulAdd(a.xz, b.x, hn::MulAdd(a.yz, b.y, hn::Mul(a.zz, b.z)))};
}

/// Strain of one material from the corners of its cell (G = F - 1), the forces of its stress on them, and the energy of
/// its modes. Without lanes of two materials these are the results of CellRun.
template <MaterialLaw kLaw, bool kMixed, class D>
struct LaminateLanes {
  using V = hn::Vec<D>;
  using M = Mat3Lanes<V>;
  struct Change {
    M dG;
  };

  const CellRun<D> &run;

  HWY_INLINE explicit LaminateLanes(const CellRun<D> &of) : run(of) {}
  HWY_INLINE M strained(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z) {
    return run.gradient(x, y, z);
  }
  HWY_INLINE void restore() const {}
  HWY_INLINE Change change(const SignSums<V> &x, const SignSums<V> &y, const SignSums<V> &z) const {
    return {run.gradient(x, y, z)};
  }
  template <class... Modes>
  HWY_INLINE void scatter(const M &S, const V (&k)[kCorners], const Modes &...modes) const {
    run.scatterStress(S, modes..., k);
  }
  template <class... Modes>
  HWY_INLINE void scatterChange(const Change &, const M &dS, const V (&k)[kCorners], const Modes &...modes) const {
    run.scatterStress(dS, modes..., k);
  }
  HWY_INLINE M modes(const M &B) const { return hourglassConjugate(run.d, run.law, B, run.roots()); }
};

template <MaterialLaw kLaw, class D>
struct LaminateLanes<kLaw, true, D> {
  using T = Real<D>;
  using V = hn::Vec<D>;
  using M = Mat3Lanes<V>;
  static constexpr bool kLinear = kLaw == MaterialLaw::linear;

  D d;
  const CellRun<D> &run;
  const T *numbers;
  Vec3Lanes<V> n;
  V c, ofOther, limit2;
  M own, other, mean;  // F of both layers and of the cell; G for the linear law, which needs no more
  Vec3Lanes<V> y;
  V inverse;  // 1/√(1 + k² b²)

  HWY_INLINE explicit LaminateLanes(const CellRun<D> &of) : d(of.d), run(of), numbers(of.laminate()) {
    n = {number(kNormalX), number(kNormalY), number(kNormalZ)};
    c = number(kShare);
    ofOther = hn::Abs(c);
    limit2 = number(kLimitSquared);
  }
  HWY_INLINE M strained(const SignSums<V> &ux, const SignSums<V> &uy, const SignSums<V> &uz) {
    const M G = run.gradient(ux, uy, uz);
    share(G, run.gradient(otherRows(), ux, uy, uz));
    return G + outer(scaled(c, kLinear ? y : times(mean, y)), n);
  }
  /// Stores the data of scatterChange(), with the stress passed to scatter().
  HWY_INLINE void keep(const SignSums<V> &ux, const SignSums<V> &uy, const SignSums<V> &uz, const M &stress) const {
    kept().setMatrix(kLayerG, run.gradient(ux, uy, uz));
    kept().setMatrix(kLayerG + 9, run.gradient(otherRows(), ux, uy, uz));
    kept().setMatrix(kMaterialStress, stress);
  }
  HWY_INLINE void restore() { share(kept().getMatrix(kLayerG), kept().getMatrix(kLayerG + 9)); }

  template <class... Modes>
  HWY_INLINE void scatter(const M &S, const V (&k)[kCorners], const Modes &...modes) const {
    const Vec3Lanes<V> t = scaled(c, times(S, n));
    if constexpr (kLinear) {
      run.scatterStress(S + spread(kOwnModuli, t), modes..., k, FitStress<V>{otherRows(), spread(kOtherModuli, t)});
    } else {
      const Vec3Lanes<V> v = fromJump(transposeTimes(mean, t));
      const M ty = outer(t, y), ofMean = scaled(ofOther, ty);
      run.scatterStress(S + (ty - ofMean) + times(own, spread(kOwnModuli, v)), modes..., k,
                        FitStress<V>{otherRows(), ofMean + times(other, spread(kOtherModuli, v))});
    }
  }

  /// Changes of the layers, of the jump and of the material.
  struct Change {
    M dOwn, dOther, dMean;
    Vec3Lanes<V> dy;
    M dG;
  };
  HWY_INLINE Change change(const SignSums<V> &ux, const SignSums<V> &uy, const SignSums<V> &uz) const {
    Change of;
    of.dOwn = run.gradient(ux, uy, uz);
    of.dOther = run.gradient(otherRows(), ux, uy, uz);
    if constexpr (kLinear) {
      of.dy = jump(smallStrain(d, of.dOwn), smallStrain(d, of.dOther));
      of.dG = of.dOwn + outer(scaled(c, of.dy), n);
    } else {
      of.dMean = of.dOwn + scaled(ofOther, of.dOther - of.dOwn);
      of.dy = fromJump(
          jump(smallStrain(d, transposeTimes(own, of.dOwn)), smallStrain(d, transposeTimes(other, of.dOther))));
      of.dG = of.dOwn + outer(scaled(c, times(of.dMean, y) + times(mean, of.dy)), n);
    }
    return of;
  }
  template <class... Modes>
  HWY_INLINE void scatterChange(const Change &of, const M &dS, const V (&k)[kCorners], const Modes &...modes) const {
    const Vec3Lanes<V> dt = scaled(c, times(dS, n));
    if constexpr (kLinear) {
      run.scatterStress(dS + spread(kOwnModuli, dt), modes..., k, FitStress<V>{otherRows(), spread(kOtherModuli, dt)});
    } else {
      const Vec3Lanes<V> t = scaled(c, times(kept().getMatrix(kMaterialStress), n));
      const Vec3Lanes<V> w = transposeTimes(mean, t), v = fromJump(w);
      const Vec3Lanes<V> dw = transposeTimes(of.dMean, t) + transposeTimes(mean, dt);
      // v = (w - k² (w·y) y)/g with g = √(1 + k² b²): dg/g = k² (y·db)/g; from dy = (db - k² y (y·db))/g follows
      // (y·db)/g = y·dy/(1 - k² y²).
      const V wy = dot(w, y);
      const V rest = hn::NegMulAdd(limit2, dot(y, y), hn::Set(d, T(1)));
      const V dgOverG = hn::Div(hn::Mul(limit2, dot(y, of.dy)), rest);
      const Vec3Lanes<V> inner =
          dw - scaled(hn::Mul(limit2, hn::Add(dot(dw, y), dot(w, of.dy))), y) - scaled(hn::Mul(limit2, wy), of.dy);
      const Vec3Lanes<V> dv = mulAdd(hn::Neg(dgOverG), v, scaled(inverse, inner));
      const M dty = outer(dt, y) + outer(t, of.dy), ofMean = scaled(ofOther, dty);
      run.scatterStress(
          dS + (dty - ofMean) + times(of.dOwn, spread(kOwnModuli, v)) + times(own, spread(kOwnModuli, dv)), modes..., k,
          FitStress<V>{otherRows(),
                       ofMean + times(of.dOther, spread(kOtherModuli, v)) + times(other, spread(kOtherModuli, dv))});
    }
  }

  /// dU/dB of detail::ModeForm.
  HWY_INLINE M modes(const M &B) const {
    const V e[6] = {B.c0.y, B.c1.z, B.c0.x, B.c2.z, B.c1.x, B.c2.y};
    const V g[3] = {hn::Add(B.c0.z, B.c1.y), hn::Add(B.c0.z, B.c2.x), hn::Add(B.c1.y, B.c2.x)};
    V fe[6], fg[3];
    std::size_t at = kModeForm;
    for (std::size_t i = 0; i < 6; i += 2, at += 3) {
      fe[i] = hn::MulAdd(number(at), e[i], hn::Mul(number(at + 1), e[i + 1]));
      fe[i + 1] = hn::MulAdd(number(at + 1), e[i], hn::Mul(number(at + 2), e[i + 1]));
    }
    for (V &f : fg) f = hn::Zero(d);
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 3; ++j, ++at) {
        fe[i] = hn::MulAdd(number(at), g[j], fe[i]);
        fg[j] = hn::MulAdd(number(at), e[i], fg[j]);
      }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j, ++at) {
        fg[i] = hn::MulAdd(number(at), g[j], fg[i]);
        fg[j] = hn::MulAdd(number(at), g[i], fg[j]);
      }
      fg[i] = hn::MulAdd(number(at++), g[i], fg[i]);
    }
    return {{fe[2], fe[0], hn::Add(fg[0], fg[1])},
            {fe[4], hn::Add(fg[0], fg[2]), fe[1]},
            {hn::Add(fg[1], fg[2]), fe[5], fe[3]}};
  }

 private:
  HWY_INLINE V number(std::size_t k) const { return hn::Load(d, numbers + k * CellRun<D>::kSlice); }
  HWY_INLINE FitRows<V> otherRows() const {
    return {run.number(kGradient),   number(kOtherFirst),     number(kOtherFirst + 1), number(kOtherFirst + 2),
            number(kOtherFirst + 3), number(kOtherFirst + 4), number(kOtherFirst + 5)};
  }
  HWY_INLINE TangentRows<D> kept() const {
    return {d, run.job.laminateTangents +
                   run.job.cells->laminates[run.slice] * kLaminateTangentNumbers * CellRun<D>::kSlice + run.lane};
  }
  HWY_INLINE void share(const M &ownG, const M &otherG) {
    const V one = hn::Set(d, T(1));
    if constexpr (kLinear) {
      y = jump(smallStrain(d, ownG), smallStrain(d, otherG));
    } else {
      own = plusDiagonal(ownG, one);
      other = plusDiagonal(otherG, one);
      mean = own + scaled(ofOther, otherG - ownG);
      const Vec3Lanes<V> b = jump(greenStrain(d, ownG), greenStrain(d, otherG));
      inverse = hn::Div(one, hn::Sqrt(hn::MulAdd(limit2, dot(b, b), one)));
      y = scaled(inverse, b);
    }
  }
  // b from the strains of the layers, or its change.
  HWY_INLINE Vec3Lanes<V> jump(const Sym3Lanes<V> &ofOwn, const Sym3Lanes<V> &ofOthers) const {
    return jumpOf(kOwnModuli, ofOwn) + jumpOf(kOtherModuli, ofOthers);
  }
  HWY_INLINE Vec3Lanes<V> jumpOf(LaminateNumber moduli, const Sym3Lanes<V> &E) const {
    const Vec3Lanes<V> En = times(E, n);
    const V nEn = dot(n, En);
    const V along = hn::MulAdd(number(moduli + 1), trace(E), hn::Mul(number(moduli + 2), nEn));
    return mulAdd(hn::Neg(number(moduli)), mulAdd(hn::Neg(nEn), n, En), scaled(hn::Neg(along), n));
  }
  // Its transpose: jumpOf(moduli, E)·v = S : E.
  HWY_INLINE M spread(LaminateNumber moduli, const Vec3Lanes<V> &v) const {
    const V vn = dot(v, n);
    const Vec3Lanes<V> vt = mulAdd(hn::Neg(vn), n, v), half = scaled(hn::Mul(hn::Set(d, T(-0.5)), number(moduli)), vt);
    const M S = outer(half, n) + outer(n, half) + scaled(hn::Neg(hn::Mul(vn, number(moduli + 2))), outer(n, n));
    return plusDiagonal(S, hn::Neg(hn::Mul(vn, number(moduli + 1))));
  }
  // Transposed derivative of y with respect to b.
  HWY_INLINE Vec3Lanes<V> fromJump(const Vec3Lanes<V> &w) const {
    return scaled(inverse, mulAdd(hn::Neg(hn::Mul(limit2, dot(w, y))), y, w));
  }
};

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
