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

/// The strain of one material from that of its cell (G = F - 1), what a stress of it does to the cell, and the energy of
/// its modes. Where no lane has two materials: the identity.
template <MaterialLaw kLaw, bool kMixed, class D>
struct LaminateLanes {
  using V = hn::Vec<D>;
  using M = Mat3Lanes<V>;
  struct Change {};

  const CellRun<D> &run;

  HWY_INLINE LaminateLanes(const CellRun<D> &of, const SignSums<V> &, const SignSums<V> &, const SignSums<V> &)
      : run(of) {}
  HWY_INLINE explicit LaminateLanes(const CellRun<D> &of) : run(of) {}
  HWY_INLINE M strained(const M &G) const { return G; }
  HWY_INLINE Change change(const SignSums<V> &, const SignSums<V> &, const SignSums<V> &) const { return {}; }
  HWY_INLINE M strained(const Change &, const M &dG) const { return dG; }
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
  V c, limit2;
  V shares[2], shear[2], ofTrace[2], across[2];
  FitRows<V> rows[2];
  M G[2], F[2], mean;  // of the layers and of the cell
  Vec3Lanes<V> y;
  V inverse;  // 1/√(1 + k² b²)

  HWY_INLINE LaminateLanes(const CellRun<D> &of, const SignSums<V> &ux, const SignSums<V> &uy, const SignSums<V> &uz)
      : d(of.d), run(of) {
    load();
    for (int l = 0; l < 2; ++l) G[l] = run.gradient(rows[l], ux, uy, uz);
    share();
  }
  /// As keep() left it.
  HWY_INLINE explicit LaminateLanes(const CellRun<D> &of) : d(of.d), run(of) {
    load();
    for (std::size_t l = 0; l < 2; ++l) G[l] = kept().getMatrix(kLayerG + 9 * l);
    share();
  }
  HWY_INLINE void keep(const M &stress) const {
    for (std::size_t l = 0; l < 2; ++l) kept().setMatrix(kLayerG + 9 * l, G[l]);
    kept().setMatrix(kMaterialStress, stress);
  }

  HWY_INLINE M strained(const M &of) const { return of + outer(scaled(c, kLinear ? y : times(mean, y)), n); }
  template <class... Modes>
  HWY_INLINE void scatter(const M &S, const V (&k)[kCorners], const Modes &...modes) const {
    const Vec3Lanes<V> t = scaled(c, times(S, n)), v = kLinear ? t : fromJump(transposeTimes(mean, t));
    const auto pulled = [&](int l) HWY_ATTR -> FitStress<V> {
      if constexpr (kLinear) return {rows[l], spread(l, v)};
      return {rows[l], scaled(shares[l], outer(t, y)) + times(F[l], spread(l, v))};
    };
    run.scatterStress(S, modes..., k, pulled(0), pulled(1));
  }

  /// Changes of the layers and of the jump.
  struct Change {
    M dF[2], dMean;
    Vec3Lanes<V> dy;
  };
  HWY_INLINE Change change(const SignSums<V> &ux, const SignSums<V> &uy, const SignSums<V> &uz) const {
    Change of;
    for (int l = 0; l < 2; ++l) of.dF[l] = run.gradient(rows[l], ux, uy, uz);
    of.dMean = scaled(shares[0], of.dF[0]) + scaled(shares[1], of.dF[1]);
    if constexpr (kLinear) {
      of.dy = jump(smallStrain(d, of.dF[0]), smallStrain(d, of.dF[1]));
    } else {
      of.dy = fromJump(
          jump(smallStrain(d, transposeTimes(F[0], of.dF[0])), smallStrain(d, transposeTimes(F[1], of.dF[1]))));
    }
    return of;
  }
  HWY_INLINE M strained(const Change &of, const M &dG) const {
    if constexpr (kLinear) return dG + outer(scaled(c, of.dy), n);
    return dG + outer(scaled(c, times(of.dMean, y) + times(mean, of.dy)), n);
  }
  /// The change of scatter() of the stress that keep() got.
  template <class... Modes>
  HWY_INLINE void scatterChange(const Change &of, const M &dS, const V (&k)[kCorners], const Modes &...modes) const {
    const Vec3Lanes<V> dt = scaled(c, times(dS, n));
    if constexpr (kLinear) {
      run.scatterStress(dS, modes..., k, FitStress<V>{rows[0], spread(0, dt)}, FitStress<V>{rows[1], spread(1, dt)});
    } else {
      const Vec3Lanes<V> t = scaled(c, times(kept().getMatrix(kMaterialStress), n));
      const Vec3Lanes<V> w = transposeTimes(mean, t), v = fromJump(w);
      const Vec3Lanes<V> dw = transposeTimes(of.dMean, t) + transposeTimes(mean, dt);
      // v = (w - k² (w·y) y)/g with g = √(1 + k² b²): dg/g = k² (y·db)/g, and from dy = (db - k² y (y·db))/g follows
      // (y·db)/g = y·dy/(1 - k² y²).
      const V wy = dot(w, y);
      const V rest = hn::NegMulAdd(limit2, dot(y, y), hn::Set(d, T(1)));
      const V dgOverG = hn::Div(hn::Mul(limit2, dot(y, of.dy)), rest);
      const Vec3Lanes<V> inner =
          dw - scaled(hn::Mul(limit2, hn::Add(dot(dw, y), dot(w, of.dy))), y) - scaled(hn::Mul(limit2, wy), of.dy);
      const Vec3Lanes<V> dv = mulAdd(hn::Neg(dgOverG), v, scaled(inverse, inner));
      const auto pulled = [&](int l) HWY_ATTR -> FitStress<V> {
        return {rows[l], scaled(shares[l], outer(dt, y) + outer(t, of.dy)) + times(of.dF[l], spread(l, v)) +
                             times(F[l], spread(l, dv))};
      };
      run.scatterStress(dS, modes..., k, pulled(0), pulled(1));
    }
  }

  /// dU/dB of the modes, detail::ModeMatrix.
  HWY_INLINE M modes(const M &B) const {
    const V b[9] = {B.c0.x, B.c0.y, B.c0.z, B.c1.x, B.c1.y, B.c1.z, B.c2.x, B.c2.y, B.c2.z};
    V out[9];
    for (std::size_t i = 0, at = kMatrix; i < 9; ++i) {
      out[i] = hn::Zero(d);
      for (std::size_t j = 0; j < i; ++j, ++at) {
        const V K = number(at);
        out[i] = hn::MulAdd(K, b[j], out[i]);
        out[j] = hn::MulAdd(K, b[i], out[j]);
      }
      out[i] = hn::MulAdd(number(at++), b[i], out[i]);
    }
    return {{out[0], out[1], out[2]}, {out[3], out[4], out[5]}, {out[6], out[7], out[8]}};
  }

 private:
  HWY_INLINE V number(std::size_t k) const { return hn::Load(d, numbers + k * CellRun<D>::kSlice); }
  HWY_INLINE TangentRows<D> kept() const {
    return {d, run.job.laminateTangents +
                   run.job.cells->laminates[run.slice] * kLaminateTangentNumbers * CellRun<D>::kSlice + run.lane};
  }
  HWY_INLINE void load() {
    numbers = run.laminate();
    n = {number(kNormalX), number(kNormalY), number(kNormalZ)};
    c = number(kShare);
    limit2 = number(kLimitSquared);
    for (std::size_t l = 0; l < 2; ++l) {
      const auto of = [&](std::size_t k) HWY_ATTR { return number(kLayer + l * kNextLayer + k); };
      shares[l] = of(kLayerShare);
      shear[l] = of(kShear);
      ofTrace[l] = of(kTrace);
      across[l] = of(kAcross);
      rows[l] = {run.number(kGradient), of(kLayerFirst),     of(kLayerFirst + 1), of(kLayerFirst + 2),
                 of(kLayerMixed),       of(kLayerMixed + 1), of(kLayerMixed + 2)};
    }
  }
  HWY_INLINE void share() {
    const V one = hn::Set(d, T(1));
    for (int l = 0; l < 2; ++l) F[l] = plusDiagonal(G[l], one);
    mean = scaled(shares[0], F[0]) + scaled(shares[1], F[1]);
    const Vec3Lanes<V> b =
        kLinear ? jump(smallStrain(d, G[0]), smallStrain(d, G[1])) : jump(greenStrain(d, G[0]), greenStrain(d, G[1]));
    inverse = kLinear ? one : hn::Div(one, hn::Sqrt(hn::MulAdd(limit2, dot(b, b), one)));
    y = scaled(inverse, b);
  }
  // b of the strains of the layers, or its change.
  HWY_INLINE Vec3Lanes<V> jump(const Sym3Lanes<V> &one, const Sym3Lanes<V> &two) const {
    return jump(0, one) + jump(1, two);
  }
  HWY_INLINE Vec3Lanes<V> jump(int l, const Sym3Lanes<V> &E) const {
    const Vec3Lanes<V> En = times(E, n);
    const V nEn = dot(n, En);
    const V along = hn::MulAdd(ofTrace[l], trace(E), hn::Mul(across[l], nEn));
    return mulAdd(hn::Neg(shear[l]), mulAdd(hn::Neg(nEn), n, En), scaled(hn::Neg(along), n));
  }
  // Its transpose: jump(l, E)·v = S : E.
  HWY_INLINE M spread(int l, const Vec3Lanes<V> &v) const {
    const V vn = dot(v, n);
    const Vec3Lanes<V> vt = mulAdd(hn::Neg(vn), n, v), half = scaled(hn::Mul(hn::Set(d, T(-0.5)), shear[l]), vt);
    const M S = outer(half, n) + outer(n, half) + scaled(hn::Neg(hn::Mul(vn, across[l])), outer(n, n));
    return plusDiagonal(S, hn::Neg(hn::Mul(vn, ofTrace[l])));
  }
  // What dy does, seen from db.
  HWY_INLINE Vec3Lanes<V> fromJump(const Vec3Lanes<V> &w) const {
    return scaled(inverse, mulAdd(hn::Neg(hn::Mul(limit2, dot(w, y))), y, w));
  }
};

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
