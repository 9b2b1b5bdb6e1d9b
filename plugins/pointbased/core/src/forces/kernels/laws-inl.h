// SPDX-License-Identifier: Apache-2.0
// Elastic laws of laws.h with one point per lane, written in G = F - 1, so that small strains keep their digits in
// single precision as well. Private to the kernels; compiled once per instruction set.
#if defined(POINTBASED_KERNELS_LAWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_LAWS_INL_H_
#undef POINTBASED_KERNELS_LAWS_INL_H_
#else
#define POINTBASED_KERNELS_LAWS_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <type_traits>

#include "forces/kernels/slices.h"
#include "forces/kernels/vectors-inl.h"
#include "pointbased/material.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// (FᵀF - 1)/2
template <class D, class V = hn::Vec<D>>
HWY_INLINE Sym3Lanes<V> greenStrain(D d, const Mat3Lanes<V> &G) {
  const V half = hn::Set(d, Real<D>(0.5));
  const Sym3Lanes<V> GG = gram(G);
  return {hn::MulAdd(half, GG.xx, G.c0.x),
          hn::MulAdd(half, GG.yy, G.c1.y),
          hn::MulAdd(half, GG.zz, G.c2.z),
          hn::Mul(half, hn::Add(GG.xy, hn::Add(G.c1.x, G.c0.y))),
          hn::Mul(half, hn::Add(GG.xz, hn::Add(G.c2.x, G.c0.z))),
          hn::Mul(half, hn::Add(GG.yz, hn::Add(G.c2.y, G.c1.z)))};
}

/// det(1 + G) - 1 = tr G + tr cof G + det G
template <class V>
HWY_INLINE V growthOf(const Mat3Lanes<V> &G, const Mat3Lanes<V> &cofG) {
  return hn::Add(trace(G), hn::Add(trace(cofG), dot(G.c0, cofG.c0)));
}

/// Quantities of one G that several laws and the bounds of the tangent need.
template <class D, class V = hn::Vec<D>>
struct Strain {
  Mat3Lanes<V> G;
  Sym3Lanes<V> E;       ///< Green strain
  Mat3Lanes<V> minors;  ///< cof G - Gᵀ
  V traceG;
  V growth;  ///< J - 1

  HWY_INLINE Strain(D d, const Mat3Lanes<V> &gradient) : G(gradient), E(greenStrain(d, gradient)) {
    const Mat3Lanes<V> cofG = cofactor(G);
    minors = cofG - transposed(G);
    traceG = trace(G);
    growth = growthOf(G, cofG);
  }
  /// cof F = (1 + tr G) 1 + minors
  HWY_INLINE Mat3Lanes<V> cofactorOfF(D d) const {
    return plusDiagonal(minors, hn::Add(traceG, hn::Set(d, Real<D>(1))));
  }
  /// F - cof F, without cancellation
  HWY_INLINE Mat3Lanes<V> lessCofactor() const { return plusDiagonal(G - minors, hn::Neg(traceG)); }
};

/// Mean of the eigenvalues of FᵀF minus 1, and a bound of the distance of the largest and the smallest from the mean.
template <class V>
struct Spread {
  V mean, width;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE Spread<V> spreadOf(D d, const Sym3Lanes<V> &E) {
  const V mean = hn::Mul(hn::Set(d, Real<D>(2.0 / 3.0)), trace(E));  // of C - 1 = 2 E
  const auto off = [&](V e) HWY_ATTR { return hn::Sub(hn::Add(e, e), mean); };
  const V xx = off(E.xx), yy = off(E.yy), zz = off(E.zz);
  const V diagonal = hn::MulAdd(xx, xx, hn::MulAdd(yy, yy, hn::Mul(zz, zz)));
  const V across = hn::MulAdd(E.xy, E.xy, hn::MulAdd(E.xz, E.xz, hn::Mul(E.yz, E.yz)));
  const V scatter = hn::MulAdd(hn::Set(d, Real<D>(8)), across, diagonal);
  return {mean, hn::Sqrt(hn::Mul(hn::Set(d, Real<D>(2.0 / 3.0)), scatter))};
}

/// Upper bound of the largest eigenvalue of C = 1 + 2 E, as largestEigenvalueBound(): by mean and variance, followed by
/// one step of Laguerre's method where this may be more than 5 % too large.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V largestStretchSquared(D d, const Sym3Lanes<V> &E, const Spread<V> &s) {
  const V one = hn::Set(d, Real<D>(1)), mean = hn::Add(one, s.mean);
  const V first = hn::Add(mean, s.width);
  const auto wide = hn::Gt(s.width, hn::Mul(hn::Set(d, Real<D>(0.1)), mean));
  if (HWY_LIKELY(hn::AllFalse(d, wide))) return first;
  // Characteristic polynomial of C - mean: x³ - scatter/2 x - determinant, scatter = 3/2 width².
  const V two = hn::Set(d, Real<D>(2));
  const auto off = [&](V e) HWY_ATTR { return hn::MulSub(two, e, s.mean); };
  const V a = off(E.xx), b = off(E.yy), c = off(E.zz);
  const V xy = hn::Mul(two, E.xy), xz = hn::Mul(two, E.xz), yz = hn::Mul(two, E.yz);
  const V minorA = hn::MulSub(b, c, hn::Mul(yz, yz));
  const V minorB = hn::MulSub(xy, c, hn::Mul(yz, xz));
  const V minorC = hn::MulSub(xy, yz, hn::Mul(b, xz));
  const V determinant = hn::MulAdd(xz, minorC, hn::MulSub(a, minorA, hn::Mul(xy, minorB)));
  const V width2 = hn::Mul(s.width, s.width);
  const V p = hn::MulSub(hn::Mul(hn::Set(d, Real<D>(0.25)), width2), s.width, determinant);
  const V p1 = hn::Mul(hn::Set(d, Real<D>(2.25)), width2);
  const V under =
      hn::MulSub(hn::Mul(hn::Set(d, Real<D>(4)), p1), p1, hn::Mul(hn::Set(d, Real<D>(36)), hn::Mul(p, s.width)));
  const V root = hn::Sqrt(hn::Max(hn::Zero(d), under));
  const V down = hn::Div(hn::Mul(hn::Set(d, Real<D>(3)), p), hn::Add(p1, root));
  const auto use = hn::And(wide, hn::Gt(p, hn::Zero(d)));
  return hn::Sub(first, hn::IfThenElseZero(use, down));
}

/// Upper bound of the largest eigenvalue of cof(F)ᵀcof(F) = J² C^-1.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V largestAreaSquared(D d, const Mat3Lanes<V> &cof) {
  const Sym3Lanes<V> gramOfCof = gram(cof);
  const V half = hn::Set(d, Real<D>(0.5)), one = hn::Set(d, Real<D>(1));
  Sym3Lanes<V> e;  // (cofᵀcof - 1)/2, so that the bound above applies
  e.xx = hn::Mul(half, hn::Sub(gramOfCof.xx, one));
  e.yy = hn::Mul(half, hn::Sub(gramOfCof.yy, one));
  e.zz = hn::Mul(half, hn::Sub(gramOfCof.zz, one));
  e.xy = hn::Mul(half, gramOfCof.xy);
  e.xz = hn::Mul(half, gramOfCof.xz);
  e.yz = hn::Mul(half, gramOfCof.yz);
  return largestStretchSquared(d, e, spreadOf(d, e));
}

/// Output of a law: P and bounds of its tangent.
template <class V>
struct Answer {
  Mat3Lanes<V> stress;  ///< first Piola-Kirchhoff, Pa
  V wave, all;          ///< Pa, as Stiffness in material.cpp
};

/// λ tr(e) 1 + 2 μ e
template <class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> hooke(D d, const LawNumbers<Real<D>> &m, const Sym3Lanes<V> &e) {
  const V twoMu = hn::Set(d, 2 * m.mu);
  const V pressure = hn::Mul(hn::Set(d, m.lambda), trace(e));
  Sym3Lanes<V> s;
  s.xx = hn::MulAdd(twoMu, e.xx, pressure);
  s.yy = hn::MulAdd(twoMu, e.yy, pressure);
  s.zz = hn::MulAdd(twoMu, e.zz, pressure);
  s.xy = hn::Mul(twoMu, e.xy);
  s.xz = hn::Mul(twoMu, e.xz);
  s.yz = hn::Mul(twoMu, e.yz);
  return full(s);
}

/// sym G
template <class D, class V = hn::Vec<D>>
HWY_INLINE Sym3Lanes<V> smallStrain(D d, const Mat3Lanes<V> &G) {
  const V half = hn::Set(d, Real<D>(0.5));
  return {G.c0.x,
          G.c1.y,
          G.c2.z,
          hn::Mul(half, hn::Add(G.c1.x, G.c0.y)),
          hn::Mul(half, hn::Add(G.c2.x, G.c0.z)),
          hn::Mul(half, hn::Add(G.c2.y, G.c1.z))};
}

/// Bounds of d²g(J)/dF² with derivatives g1, g2, as VolumeBounds in material.cpp; for J > 0.
template <class D, class V = hn::Vec<D>>
struct VolumeBoundsLanes {
  V areas2, area2, size, largest2;

  HWY_INLINE VolumeBoundsLanes(D d, const Strain<D> &strain, const Mat3Lanes<V> &cof, V stretch2)
      : areas2(squaredNorm(cof)), area2(largestAreaSquared(d, cof)),
        size(hn::Sqrt(hn::MulAdd(hn::Set(d, Real<D>(2)), trace(strain.E), hn::Set(d, Real<D>(3))))),
        largest2(stretch2) {}

  HWY_INLINE V wave(D d, V g2) const { return hn::Mul(hn::Max(hn::Zero(d), g2), area2); }
  HWY_INLINE V along(D d, V g1, V g2, V J) const {
    const V zero = hn::Zero(d), none = hn::Set(d, Real<D>(1)), full = hn::Set(d, Real<D>(1.1548));
    const V factor = hn::IfThenElse(hn::Lt(g1, zero), none, full);
    const V coarse = hn::MulAdd(hn::Max(zero, g2), areas2, hn::Mul(hn::Mul(hn::Abs(g1), size), factor));
    const V r = hn::Div(g1, J);
    const V fine = hn::MulAdd(hn::Max(zero, hn::Add(g2, r)), areas2, hn::Mul(hn::Max(zero, hn::Neg(r)), area2));
    return hn::Min(coarse, fine);
  }
  HWY_INLINE V across(V g1) const { return hn::Mul(hn::Abs(g1), hn::Sqrt(largest2)); }
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Answer<V> neoHookean(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, V stretch2) {
  using T = Real<D>;
  const V mu = hn::Set(d, m.mu), lambda = hn::Set(d, m.lambda), kv = hn::Set(d, m.volume), one = hn::Set(d, T(1));
  const V J = hn::Add(one, s.growth);
  const V log = hn::Log1p(d, s.growth);
  const V inverse = hn::Div(one, J);
  const V lambdaLog = hn::Mul(lambda, log);
  // mu + dW/dJ, which vanishes at rest
  const V push = hn::MulAdd(kv, s.growth, hn::Mul(hn::MulAdd(mu, s.growth, lambdaLog), inverse));
  const Mat3Lanes<V> cof = s.cofactorOfF(d);
  Answer<V> a;
  a.stress = mulAdd(push, cof, scaled(mu, s.lessCofactor()));
  const V g1 = hn::Sub(push, mu);
  const V g2 = hn::MulAdd(hn::Sub(hn::Add(lambda, mu), lambdaLog), hn::Mul(inverse, inverse), kv);
  const VolumeBoundsLanes<D> bounds(d, s, cof, stretch2);
  a.wave = hn::Add(mu, bounds.wave(d, g2));
  a.all = hn::Add(mu, hn::Max(bounds.along(d, g1, g2, J), bounds.across(g1)));
  return a;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void addVolumeTerm(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, V stretch2, Answer<V> &a) {
  if (!(m.volume > 0)) return;
  const V kv = hn::Set(d, m.volume), g1 = hn::Mul(kv, s.growth), J = hn::Add(s.growth, hn::Set(d, Real<D>(1)));
  const Mat3Lanes<V> cof = s.cofactorOfF(d);
  a.stress = mulAdd(g1, cof, a.stress);
  const VolumeBoundsLanes<D> bounds(d, s, cof, stretch2);
  a.wave = hn::Add(a.wave, bounds.wave(d, kv));
  a.all = hn::Add(a.all, hn::Max(bounds.along(d, g1, kv, J), bounds.across(g1)));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Answer<V> linear(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, V stretch2) {
  Answer<V> a;
  a.stress = hooke(d, m, smallStrain(d, s.G));
  a.wave = hn::Set(d, m.lambda + 2 * m.mu);
  a.all = hn::Set(d, HWY_MAX(3 * m.lambda, Real<D>(0)) + 2 * m.mu);
  addVolumeTerm(d, m, s, stretch2, a);
  return a;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Answer<V> stVenantKirchhoff(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, V stretch2) {
  using T = Real<D>;
  const Mat3Lanes<V> S = hooke(d, m, s.E);
  Answer<V> a;
  a.stress = times(s.G, S) + S;
  const V trE = trace(s.E), one = hn::Set(d, T(1));
  const V stress = hn::MulAdd(hn::Set(d, m.lambda), trE, hn::Mul(hn::Set(d, m.mu), hn::Sub(stretch2, one)));
  a.wave = hn::MulAdd(hn::Set(d, m.lambda + 2 * m.mu), stretch2, stress);
  const V trC = hn::MulAdd(hn::Set(d, T(2)), trE, hn::Set(d, T(3)));
  a.all =
      hn::Add(stress, hn::MulAdd(hn::Set(d, HWY_MAX(m.lambda, T(0))), trC, hn::Mul(hn::Set(d, 2 * m.mu), stretch2)));
  addVolumeTerm(d, m, s, stretch2, a);
  return a;
}

/// F S_v, S_v = 2 η dE/dt, of a rate of F.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> viscousStress(D d, V twoEta, const Mat3Lanes<V> &G, const Mat3Lanes<V> &rate) {
  const Sym3Lanes<V> e = smallStrain(d, rate + transposeTimes(G, rate));
  const Sym3Lanes<V> s = {hn::Mul(twoEta, e.xx), hn::Mul(twoEta, e.yy), hn::Mul(twoEta, e.zz),
                          hn::Mul(twoEta, e.xy), hn::Mul(twoEta, e.xz), hn::Mul(twoEta, e.yz)};
  const Mat3Lanes<V> S = full(s);
  return S + times(G, S);
}

/// tr(RᵀF) and R of F = R U, as polar(); `found` is false where two roots coincide, which needs the decomposition.
template <class D, class V = hn::Vec<D>>
struct PolarLanes {
  Mat3Lanes<V> R;
  V trace;
  hn::Mask<D> found;

  HWY_INLINE PolarLanes(D d, const Strain<D> &s) {
    using T = Real<D>;
    const V one = hn::Set(d, T(1)), two = hn::Set(d, T(2)), four = hn::Set(d, T(4));
    const Mat3Lanes<V> F = plusDiagonal(s.G, one), cof = s.cofactorOfF(d);
    const V a = hn::MulAdd(two, kernels::HWY_NAMESPACE::trace(s.E), hn::Set(d, T(3)));
    const V b = hn::Add(s.growth, one);
    const V constant = hn::MulSub(a, a, hn::Mul(four, squaredNorm(cof)));
    V t = hn::Sqrt(hn::Mul(hn::Set(d, T(3)), a));
    // The next change is of the order of the cube of the last one.
    const V enough = hn::Set(d, sizeof(T) == 8 ? T(1e-6) : T(1e-3));
    found = hn::Lt(one, hn::Zero(d));
    for (int k = 0; k < 8; ++k) {
      const V t2 = hn::Mul(t, t), b8 = hn::Mul(hn::Set(d, T(8)), b);
      const V value = hn::MulAdd(hn::MulSub(hn::NegMulAdd(two, a, t2), t, b8), t, constant);
      const V p1 = hn::Mul(four, hn::MulSub(hn::Sub(t2, a), t, hn::Add(b, b)));
      const V p2 = hn::MulSub(hn::Set(d, T(12)), t2, hn::Mul(four, a));
      const V under = hn::MulSub(hn::Mul(hn::Set(d, T(9)), p1), p1, hn::Mul(hn::Set(d, T(12)), hn::Mul(value, p2)));
      const V change = hn::Div(hn::Mul(four, value), hn::Add(p1, hn::Sqrt(hn::Max(hn::Zero(d), under))));
      t = hn::Sub(t, hn::IfThenZeroElse(found, change));
      found = hn::Or(found, hn::Lt(hn::Abs(change), hn::Mul(enough, t)));
      if (hn::AllTrue(d, found)) break;
    }
    const V slope = hn::MulSub(hn::MulSub(t, t, a), t, hn::Add(b, b));
    found = hn::And(found, hn::Gt(slope, hn::Mul(hn::Set(d, T(0.01)), hn::Mul(t, hn::Mul(t, t)))));
    found = hn::And(found, hn::Gt(a, hn::Set(d, T(1e-18))));
    const V inverse = hn::Div(one, slope);
    const Mat3Lanes<V> CF = transposeTimes(F, F);
    Mat3Lanes<V> r = mulAdd(hn::MulAdd(t, t, a), F, scaled(hn::Add(t, t), cof));
    r = scaled(inverse, r - scaled(two, times(F, CF)));
    // One Newton-Schulz step removes residual stretch from round-off.
    R = scaled(hn::Set(d, T(1.5)), r) - scaled(hn::Set(d, T(0.5)), times(r, transposeTimes(r, r)));
    trace = t;
  }
};

template <class D>
struct NoFrame {
  HWY_INLINE NoFrame(D, const Strain<D> &) {}
};
/// Data of the rotation that a law needs.
template <MaterialLaw kLaw, class D>
using FrameOf = std::conditional_t<kLaw == MaterialLaw::corotated, PolarLanes<D>, NoFrame<D>>;

/// @param stray  out: lanes that need the scalar law
template <class D, class V = hn::Vec<D>>
HWY_INLINE Answer<V> corotated(D d, const LawNumbers<Real<D>> &m, const Strain<D> &s, const PolarLanes<D> &p,
                               V stretch2, hn::Mask<D> &stray) {
  using T = Real<D>;
  const V three = hn::Set(d, T(3)), lambda = hn::Set(d, m.lambda), twoMu = hn::Set(d, 2 * m.mu);
  Answer<V> a;
  const Mat3Lanes<V> off = plusDiagonal(s.G - p.R, hn::Set(d, T(1)));
  a.stress = mulAdd(hn::Mul(lambda, hn::Sub(p.trace, three)), p.R, scaled(twoMu, off));
  a.wave = hn::Set(d, m.lambda + 2 * m.mu);
  a.all = hn::Set(d, HWY_MAX(3 * m.lambda, T(0)) + 2 * m.mu);
  // Tension beyond 2 mu rotates with the frame: the bound is different there.
  const V bound =
      hn::Mul(lambda, hn::Sub(hn::Sqrt(hn::Mul(three, hn::MulAdd(hn::Set(d, T(2)), trace(s.E), three))), three));
  stray = hn::Or(hn::Not(p.found), hn::Gt(bound, twoMu));
  if (m.lambda < 0) stray = hn::Or(stray, hn::Not(stray));
  addVolumeTerm(d, m, s, stretch2, a);
  return a;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
