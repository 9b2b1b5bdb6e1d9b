// SPDX-License-Identifier: Apache-2.0
// Laminates (forces/laminate.h) with one point per lane. Private to the kernels.
#if defined(POINTBASED_KERNELS_LAMINATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_LAMINATE_INL_H_
#undef POINTBASED_KERNELS_LAMINATE_INL_H_
#else
#define POINTBASED_KERNELS_LAMINATE_INL_H_
#endif

#include "forces/kernels/cell_run-inl.h"

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

/// The strain of one material from that of its cell (G = F - 1), and what a stress of it does to the cell.
template <MaterialLaw kLaw, class D>
struct LaminateLanes {
  using T = Real<D>;
  using V = hn::Vec<D>;
  static constexpr bool kLinear = kLaw == MaterialLaw::linear;

  D d;
  Vec3Lanes<V> n;
  V c, shear, ofTrace, across, limit2;
  Mat3Lanes<V> F;  // of the cell
  Vec3Lanes<V> y;
  V inverse;  // 1/√(1 + k² b²)

  HWY_INLINE LaminateLanes(const CellRun<D> &run, const Mat3Lanes<V> &G) : d(run.d) {
    const T *at = run.laminate();
    const auto number = [&](LaminateNumber k) HWY_ATTR { return hn::Load(d, at + k * CellRun<D>::kSlice); };
    n = {number(kNormalX), number(kNormalY), number(kNormalZ)};
    c = number(kShare);
    shear = number(kShear);
    ofTrace = number(kTrace);
    across = number(kAcross);
    limit2 = number(kLimitSquared);
    F = plusDiagonal(G, hn::Set(d, T(1)));
    const Vec3Lanes<V> b = jump(kLinear ? smallStrain(d, G) : greenStrain(d, G));
    inverse = kLinear ? hn::Set(d, T(1))
                      : hn::Div(hn::Set(d, T(1)), hn::Sqrt(hn::MulAdd(limit2, dot(b, b), hn::Set(d, T(1)))));
    y = scaled(inverse, b);
  }

  /// b of a strain, or its change.
  HWY_INLINE Vec3Lanes<V> jump(const Sym3Lanes<V> &E) const {
    const Vec3Lanes<V> En = times(E, n);
    const V nEn = dot(n, En);
    const V along = hn::MulAdd(ofTrace, trace(E), hn::Mul(across, nEn));
    return mulAdd(hn::Neg(shear), mulAdd(hn::Neg(nEn), n, En), scaled(hn::Neg(along), n));
  }
  /// Its transpose: jump(E)·v = S : E.
  HWY_INLINE Mat3Lanes<V> spread(const Vec3Lanes<V> &v) const {
    const V vn = dot(v, n);
    const Vec3Lanes<V> vt = mulAdd(hn::Neg(vn), n, v), half = scaled(hn::Mul(hn::Set(d, T(-0.5)), shear), vt);
    const Mat3Lanes<V> S = outer(half, n) + outer(n, half) + scaled(hn::Neg(hn::Mul(vn, across)), outer(n, n));
    return plusDiagonal(S, hn::Neg(hn::Mul(vn, ofTrace)));
  }
  HWY_INLINE Mat3Lanes<V> strained(const Mat3Lanes<V> &G) const {
    return G + outer(scaled(c, kLinear ? y : times(F, y)), n);
  }
  // What dy does, seen from db.
  HWY_INLINE Vec3Lanes<V> fromJump(const Vec3Lanes<V> &w) const {
    return scaled(inverse, mulAdd(hn::Neg(hn::Mul(limit2, dot(w, y))), y, w));
  }
  HWY_INLINE Mat3Lanes<V> pulled(const Mat3Lanes<V> &stress) const {
    const Vec3Lanes<V> t = scaled(c, times(stress, n));
    if constexpr (kLinear) return stress + spread(t);
    return stress + outer(t, y) + times(F, spread(fromJump(transposeTimes(F, t))));
  }

  /// The changes of both for a change of the cell.
  struct Change {
    Mat3Lanes<V> dF;
    Vec3Lanes<V> dy;
  };
  HWY_INLINE Change change(const Mat3Lanes<V> &dF) const {
    if constexpr (kLinear) return {dF, jump(smallStrain(d, dF))};
    return {dF, fromJump(jump(smallStrain(d, transposeTimes(F, dF))))};
  }
  HWY_INLINE Mat3Lanes<V> strained(const Change &of) const {
    if constexpr (kLinear) return of.dF + outer(scaled(c, of.dy), n);
    return of.dF + outer(scaled(c, times(of.dF, y) + times(F, of.dy)), n);
  }
  /// @param stress  that was pulled at F
  HWY_INLINE Mat3Lanes<V> pulledChange(const Change &of, const Mat3Lanes<V> &stress,
                                       const Mat3Lanes<V> &dStress) const {
    const Vec3Lanes<V> dt = scaled(c, times(dStress, n));
    if constexpr (kLinear) return dStress + spread(dt);
    const Vec3Lanes<V> t = scaled(c, times(stress, n));
    const Vec3Lanes<V> w = transposeTimes(F, t), v = fromJump(w);
    const Vec3Lanes<V> dw = transposeTimes(of.dF, t) + transposeTimes(F, dt);
    // v = (w - k² (w·y) y)/g with g = √(1 + k² b²): dg/g = k² (y·db)/g, and from dy = (db - k² y (y·db))/g follows
    // (y·db)/g = y·dy/(1 - k² y²).
    const V wy = dot(w, y);
    const V rest = hn::NegMulAdd(limit2, dot(y, y), hn::Set(d, T(1)));
    const V dgOverG = hn::Div(hn::Mul(limit2, dot(y, of.dy)), rest);
    const Vec3Lanes<V> inner =
        dw - scaled(hn::Mul(limit2, hn::Add(dot(dw, y), dot(w, of.dy))), y) - scaled(hn::Mul(limit2, wy), of.dy);
    const Vec3Lanes<V> dv = mulAdd(hn::Neg(dgOverG), v, scaled(inverse, inner));
    return dStress + outer(dt, y) + outer(t, of.dy) + times(of.dF, spread(v)) + times(F, spread(dv));
  }
};

/// G of the materials of the lanes, from that of their cells; where none has two it is that.
template <MaterialLaw kLaw, bool kMixed, class D, class M = Mat3Lanes<hn::Vec<D>>>
HWY_INLINE M strainedOf(const CellRun<D> &run, const M &G) {
  if constexpr (kMixed) return LaminateLanes<kLaw, D>(run, G).strained(G);
  return G;
}
/// Likewise of a change of G, or of velocities.
template <MaterialLaw kLaw, bool kMixed, class D, class M = Mat3Lanes<hn::Vec<D>>>
HWY_INLINE M strainedChangeOf(const CellRun<D> &run, const M &G, const M &dG) {
  if constexpr (kMixed) {
    const LaminateLanes<kLaw, D> laminate(run, G);
    return laminate.strained(laminate.change(dG));
  }
  return dG;
}
/// The way back of the stress.
template <MaterialLaw kLaw, bool kMixed, class D, class M = Mat3Lanes<hn::Vec<D>>>
HWY_INLINE M pulledOf(const CellRun<D> &run, const M &G, const M &stress) {
  if constexpr (kMixed) return LaminateLanes<kLaw, D>(run, G).pulled(stress);
  return stress;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
