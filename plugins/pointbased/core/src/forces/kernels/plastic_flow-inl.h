// SPDX-License-Identifier: Apache-2.0
// Plastic flow of plasticity.cpp with one point per lane. Private to the kernels.
#if defined(POINTBASED_KERNELS_PLASTIC_FLOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_PLASTIC_FLOW_INL_H_
#undef POINTBASED_KERNELS_PLASTIC_FLOW_INL_H_
#else
#define POINTBASED_KERNELS_PLASTIC_FLOW_INL_H_
#endif

#include "forces/kernels/laws-inl.h"
#include "pointbased/plasticity.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// Principal values of a symmetric E = m 1 + p S, tr S = 0, |S|² = 6. Those of S are y_1, the separate one, and y_2,
/// y_3 = -y_1/2 ± w. The sign of p is such that √3 <= y_1 <= 2.
///
/// y³ - 3 y - det S = 0 is solved by two steps of Halley's method; it is well conditioned for every E. If y_2 and y_3
/// coincide, w has only half of the digits, which does not affect functions of S that are even in w.
template <class D, class V = hn::Vec<D>>
struct PrincipalStrains {
  Sym3Lanes<V> S;
  V p, y1, w;
  V values[3];  // of E

  HWY_INLINE PrincipalStrains(D d, const Sym3Lanes<V> &E) {
    const V one = hn::Set(d, 1.0), three = hn::Set(d, 3.0);
    const V mean = hn::Mul(hn::Set(d, 1.0 / 3.0), trace(E));
    S = E;
    S.xx = hn::Sub(S.xx, mean);
    S.yy = hn::Sub(S.yy, mean);
    S.zz = hn::Sub(S.zz, mean);
    // For a pure change of volume the directions are arbitrary.
    const V size = hn::Max(hn::Sqrt(hn::Mul(hn::Set(d, 1.0 / 6.0), squaredNorm(S))), hn::Set(d, 1e-150));
    S = scaled(hn::Div(one, size), S);
    const V minorX = hn::MulSub(S.yy, S.zz, hn::Mul(S.yz, S.yz));
    const V minorY = hn::MulSub(S.xy, S.zz, hn::Mul(S.yz, S.xz));
    const V minorZ = hn::MulSub(S.xy, S.yz, hn::Mul(S.yy, S.xz));
    const V determinant = hn::MulAdd(S.xz, minorZ, hn::MulSub(S.xx, minorX, hn::Mul(S.xy, minorY)));
    const V sign = hn::CopySign(one, determinant);
    S = scaled(sign, S);
    p = hn::Mul(sign, size);
    const V det = hn::Min(hn::Abs(determinant), hn::Set(d, 2.0));
    // Start: the chord of the curve between det = 0 and 2, which is almost straight.
    y1 = hn::MulAdd(det, hn::Set(d, 0.5 * (2.0 - 1.7320508075688772)), hn::Set(d, 1.7320508075688772));
    for (int k = 0; k < 2; ++k) {
      const V y2 = hn::Mul(y1, y1);
      const V value = hn::MulSub(hn::Sub(y2, three), y1, det), slope = hn::MulSub(three, y2, three);
      const V below = hn::NegMulAdd(hn::Mul(three, y1), value, hn::Mul(slope, slope));
      y1 = hn::Sub(y1, hn::Div(hn::Mul(value, slope), below));
    }
    const V half = hn::Mul(hn::Set(d, -0.5), y1);
    w = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(hn::Set(d, 0.75), hn::Mul(y1, y1), three)));
    values[0] = hn::MulAdd(p, y1, mean);
    values[1] = hn::MulAdd(p, hn::Add(half, w), mean);
    values[2] = hn::MulAdd(p, hn::Sub(half, w), mean);
  }

  /// f(E) from its three principal values; slope() = f' where two of them coincide.
  template <class Slope>
  HWY_INLINE Sym3Lanes<V> function(D d, const V (&f)[3], const Slope &slope) const {
    const V half = hn::Set(d, 0.5), w2 = hn::Mul(w, w), far = hn::Mul(hn::Set(d, 1.5), y1);
    const V close = hn::Set(d, 1e-6);
    const V a = hn::Mul(half, hn::Add(f[1], f[2]));
    V b = hn::Div(hn::Mul(half, hn::Sub(f[1], f[2])), hn::Max(w, close));
    const auto meet = hn::Lt(w, close);
    if (HWY_UNLIKELY(!hn::AllFalse(d, meet))) b = hn::IfThenElse(meet, hn::Mul(p, slope()), b);
    const V c = hn::Div(hn::NegMulAdd(b, far, hn::Sub(f[0], a)), hn::NegMulAdd(w, w, hn::Mul(far, far)));
    // a + b Y + c (Y² - w²), Y = S + y_1/2
    Sym3Lanes<V> Y = S;
    Y.xx = hn::MulAdd(half, y1, Y.xx);
    Y.yy = hn::MulAdd(half, y1, Y.yy);
    Y.zz = hn::MulAdd(half, y1, Y.zz);
    Sym3Lanes<V> out = mulAdd(c, gram(full(Y)), scaled(b, Y));
    const V diagonal = hn::NegMulAdd(c, w2, a);
    out.xx = hn::Add(out.xx, diagonal);
    out.yy = hn::Add(out.yy, diagonal);
    out.zz = hn::Add(out.zz, diagonal);
    return out;
  }
};

/// Deviatoric Hencky strains ln(1 + 2 E)/2 and their norm.
template <class D, class V = hn::Vec<D>>
struct HenckyStrains {
  V h[3], mean, norm;
  HWY_INLINE HenckyStrains(D d, const PrincipalStrains<D> &E) {
    const V half = hn::Set(d, 0.5);
    // Accurate to 1e-16, which is enough: it is compared with yield, not with zero.
    for (int i = 0; i < 3; ++i)
      h[i] = hn::Mul(half, hn::Log(d, hn::MulAdd(hn::Set(d, 2.0), E.values[i], hn::Set(d, 1.0))));
    mean = hn::Mul(hn::Set(d, 1.0 / 3.0), hn::Add(h[0], hn::Add(h[1], h[2])));
    for (V &x : h) x = hn::Sub(x, mean);
    norm = hn::Sqrt(hn::MulAdd(h[0], h[0], hn::MulAdd(h[1], h[1], hn::Mul(h[2], h[2]))));
  }
};

/// Plastic flow of some lanes.
template <class D, class V = hn::Vec<D>>
struct FlowLanes {
  hn::Mask<D> flowing, stray;  ///< stray: those of them that need the scalar law
  Mat3Lanes<V> plastic;        ///< F_p^-1 - 1 of the others

  /// @param beyond   lanes that may be above yield
  /// @param before   F_p^-1 - 1
  HWY_INLINE FlowLanes(D d, const MaterialHistory &m, hn::Mask<D> beyond, const Strain<D> &elastic,
                       const Mat3Lanes<V> &before) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
    const PrincipalStrains<D> principal(d, elastic.E);
    const HenckyStrains<D> hencky(d, principal);
    const V least = hn::Min(principal.values[0], hn::Min(principal.values[1], principal.values[2]));
    flowing = hn::And(beyond, hn::Gt(hencky.norm, hn::Set(d, m.yield)));
    flowing = hn::And(flowing, hn::Gt(hn::MulAdd(two, least, one), zero));
    flowing = hn::And(flowing, hn::Gt(hn::Add(elastic.growth, one), hn::Set(d, kSmallestFlowRatio)));
    // exp(-α h), α h is the flow along h
    const V alpha = hn::Mul(hn::Set(d, m.flowShare),
                            hn::Sub(one, hn::Div(hn::Set(d, m.yield), hn::Max(hencky.norm, hn::Set(d, 1e-150)))));
    V change[3];
    for (int i = 0; i < 3; ++i) change[i] = hn::Sub(hn::Exp(d, hn::Neg(hn::Mul(alpha, hencky.h[i]))), one);
    const Mat3Lanes<V> M = full(principal.function(d, change, [&]() HWY_ATTR {
      return hn::Neg(hn::Div(hn::Mul(alpha, hn::Add(one, change[1])), hn::MulAdd(two, principal.values[1], one)));
    }));
    const Mat3Lanes<V> next = before + M + times(before, M);
    // Cube root of a determinant that differs from one by round-off.
    const V growth = growthOf(next, cofactor(next)), third = hn::Mul(hn::Set(d, 1.0 / 3.0), growth);
    const V scale = hn::Sub(hn::Mul(hn::Mul(two, third), third), third);
    plastic = mulAdd(scale, next, plusDiagonal(next, scale));
    stray = hn::AndNot(hn::Lt(hn::Abs(growth), hn::Set(d, 1e-5)), flowing);
    if (!(m.plasticMax < Plasticity::kNever)) return;
    // |ln C|/2 <= -ln(1 - 2 |E|)/2, which is below the cap for |E| <= max/(1 + 2 max).
    const Sym3Lanes<V> left = greenStrain(d, transposed(plastic));
    const double sure = m.plasticMax / (1.0 + 2.0 * m.plasticMax);
    const auto large = hn::And(flowing, hn::Not(hn::Lt(squaredNorm(left), hn::Set(d, sure * sure))));
    if (HWY_LIKELY(hn::AllFalse(d, large))) return;
    const HenckyStrains<D> all(d, PrincipalStrains<D>(d, left));
    stray = hn::Or(stray, hn::And(large, hn::Not(hn::Lt(all.norm, hn::Set(d, (1.0 - 1e-9) * m.plasticMax)))));
  }
};

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
