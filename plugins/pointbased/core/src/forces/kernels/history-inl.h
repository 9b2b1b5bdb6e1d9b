// SPDX-License-Identifier: Apache-2.0
// History of points in lanes, and the Prony terms of viscoelasticity.cpp. Private to the kernels.
#if defined(POINTBASED_KERNELS_HISTORY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTBASED_KERNELS_HISTORY_INL_H_
#undef POINTBASED_KERNELS_HISTORY_INL_H_
#else
#define POINTBASED_KERNELS_HISTORY_INL_H_
#endif

#include <cstring>

#include "forces/kernels/corners-inl.h"
#include "forces/kernels/stress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// Records of the points of some lanes: `kSize` doubles each, point after point.
template <class D, std::size_t kSize>
class PointRecords {
  using V = hn::Vec<D>;
  static constexpr std::size_t kMost = hn::MaxLanes(D());

 public:
  /// @param used  lanes that represent a point; the others repeat one, which must not be advanced twice
  /// @param spare  [kSize] a scratch record for those
  HWY_INLINE PointRecords(D d, double *base, const Index *points, std::size_t used, double *spare) : d_(d) {
    for (std::size_t i = 0; i < kMost; ++i) at_[i] = base + kSize * points[i];
    if (HWY_LIKELY(used == kMost)) return;
    std::memcpy(spare, at_[kMost - 1], kSize * sizeof(double));
    for (std::size_t i = used; i < kMost; ++i) at_[i] = spare;
  }

  /// Numbers k and k + 1.
  HWY_INLINE void load(std::size_t k, V &a, V &b) const {
#if HWY_TARGET == HWY_SCALAR
    a = hn::Set(d_, at_[0][k]);
    b = hn::Set(d_, at_[0][k + 1]);
#else
    const hn::FixedTag<double, 2> d2;
    const V even = fromBlocks(d_, [&](std::size_t block) HWY_ATTR { return hn::LoadU(d2, at_[2 * block] + k); });
    const V odd = fromBlocks(d_, [&](std::size_t block) HWY_ATTR { return hn::LoadU(d2, at_[2 * block + 1] + k); });
    a = hn::InterleaveLower(d_, even, odd);
    b = hn::InterleaveUpper(d_, even, odd);
#endif
  }
  HWY_INLINE void store(std::size_t k, V a, V b) const {
#if HWY_TARGET == HWY_SCALAR
    at_[0][k] = hn::GetLane(a);
    at_[0][k + 1] = hn::GetLane(b);
#else
    storeBlocks(d_, hn::InterleaveLower(d_, a, b), 0, k);
    storeBlocks(d_, hn::InterleaveUpper(d_, a, b), 1, k);
#endif
  }

  /// Nine numbers from k on, column-major.
  HWY_INLINE Mat3Lanes<V> loadMatrix(std::size_t k) const {
    Mat3Lanes<V> m;
    V again;
    load(k, m.c0.x, m.c0.y);
    load(k + 2, m.c0.z, m.c1.x);
    load(k + 4, m.c1.y, m.c1.z);
    load(k + 6, m.c2.x, m.c2.y);
    load(k + 7, again, m.c2.z);
    return m;
  }
  HWY_INLINE void storeMatrix(std::size_t k, const Mat3Lanes<V> &m) const {
    store(k, m.c0.x, m.c0.y);
    store(k + 2, m.c0.z, m.c1.x);
    store(k + 4, m.c1.y, m.c1.z);
    store(k + 6, m.c2.x, m.c2.y);
    store(k + 7, m.c2.y, m.c2.z);
  }

 private:
#if HWY_TARGET != HWY_SCALAR
  // 128-bit blocks, which belong to the lanes first, first + 2, …
  template <class D2>
  HWY_INLINE void storeBlocks(D2 d, hn::Vec<D2> v, std::size_t first, std::size_t k) const {
    if constexpr (hn::MaxLanes(D2()) == 2) {
      hn::StoreU(v, d, at_[first] + k);
    } else {
      const hn::Half<D2> half;
      storeBlocks(half, hn::LowerHalf(half, v), first, k);
      storeBlocks(half, hn::UpperHalf(half, v), first + hn::MaxLanes(half), k);
    }
  }
#endif

  D d_;
  double *at_[kMost];
};

/// Transforms tensors from world axes to lattice axes, and back.
template <class D>
struct LatticeAxes {
  using V = hn::Vec<D>;
  D d;
  const double (&axes)[3][3];
  bool turned;

  HWY_INLINE Mat3Lanes<V> toLattice(const Mat3Lanes<V> &m) const {
    const Mat3Lanes<V> Q = columns();
    return transposeTimes(Q, times(m, Q));
  }
  HWY_INLINE Mat3Lanes<V> toWorld(const Mat3Lanes<V> &m) const {
    const Mat3Lanes<V> Q = columns();
    return times(Q, times(m, transposed(Q)));
  }

 private:
  HWY_INLINE Mat3Lanes<V> columns() const { return {column(0), column(1), column(2)}; }
  HWY_INLINE Vec3Lanes<V> column(int c) const {
    return {hn::Set(d, axes[0][c]), hn::Set(d, axes[1][c]), hn::Set(d, axes[2][c])};
  }
};

template <class V>
HWY_INLINE Sym3Lanes<V> lower(const Mat3Lanes<V> &m) {
  return {m.c0.x, m.c1.y, m.c2.z, m.c0.y, m.c0.z, m.c1.z};
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE Sym3Lanes<V> deviator(D d, Sym3Lanes<V> s) {
  const V mean = hn::Mul(hn::Set(d, Real<D>(1.0 / 3.0)), trace(s));
  s.xx = hn::Sub(s.xx, mean);
  s.yy = hn::Sub(s.yy, mean);
  s.zz = hn::Sub(s.zz, mean);
  return s;
}

/// D(F) and d/dF (Q : e(F)) of each law, as Relaxation in viscoelasticity.cpp; stray(): lanes that need the scalar law.
template <MaterialLaw kLaw, class D>
struct RelaxationLanes;

template <class D>
struct RelaxationLanes<MaterialLaw::linear, D> {
  using V = hn::Vec<D>;
  D d;
  const Strain<D> &s;
  HWY_INLINE RelaxationLanes(D tag, const Strain<D> &strain, const NoFrame<D> &) : d(tag), s(strain) {}

  HWY_INLINE hn::Mask<D> stray() const { return hn::Lt(hn::Zero(d), hn::Zero(d)); }
  HWY_INLINE Sym3Lanes<V> drive(V mu) const { return scaled(hn::Add(mu, mu), deviator(d, smallStrain(d, s.G))); }
  HWY_INLINE Mat3Lanes<V> pushed(const Sym3Lanes<V> &Q) const { return full(Q); }
};

template <class D>
struct RelaxationLanes<MaterialLaw::stVenantKirchhoff, D> {
  using V = hn::Vec<D>;
  D d;
  const Strain<D> &s;
  HWY_INLINE RelaxationLanes(D tag, const Strain<D> &strain, const NoFrame<D> &) : d(tag), s(strain) {}

  HWY_INLINE hn::Mask<D> stray() const { return hn::Lt(hn::Zero(d), hn::Zero(d)); }
  HWY_INLINE Sym3Lanes<V> drive(V mu) const { return scaled(hn::Add(mu, mu), deviator(d, s.E)); }
  HWY_INLINE Mat3Lanes<V> pushed(const Sym3Lanes<V> &Q) const { return full(Q) + times(s.G, full(Q)); }
};

template <class D>
struct RelaxationLanes<MaterialLaw::corotated, D> {
  using V = hn::Vec<D>;
  D d;
  const PolarLanes<D> &p;
  Sym3Lanes<V> U;
  HWY_INLINE RelaxationLanes(D tag, const Strain<D> &strain, const PolarLanes<D> &polar) : d(tag), p(polar) {
    const V half = hn::Set(d, Real<D>(0.5)), one = hn::Set(d, Real<D>(1));
    const Mat3Lanes<V> RF = transposeTimes(p.R, plusDiagonal(strain.G, one));
    U = {RF.c0.x,
         RF.c1.y,
         RF.c2.z,
         hn::Mul(half, hn::Add(RF.c1.x, RF.c0.y)),
         hn::Mul(half, hn::Add(RF.c2.x, RF.c0.z)),
         hn::Mul(half, hn::Add(RF.c2.y, RF.c1.z))};
  }

  HWY_INLINE hn::Mask<D> stray() const { return hn::Not(p.found); }
  HWY_INLINE Sym3Lanes<V> drive(V mu) const { return scaled(hn::Add(mu, mu), deviator(d, U)); }
  // R (Q + [a]x), (tr(U) 1 - U) a = axial of U Q - Q U
  HWY_INLINE Mat3Lanes<V> pushed(const Sym3Lanes<V> &Q) const {
    const Mat3Lanes<V> Q3 = full(Q), UQ = times(full(U), Q3);
    const Vec3Lanes<V> w = {hn::Sub(UQ.c1.z, UQ.c2.y), hn::Sub(UQ.c2.x, UQ.c0.z), hn::Sub(UQ.c0.y, UQ.c1.x)};
    const V zero = hn::Zero(d);
    const Mat3Lanes<V> sums = plusDiagonal(full(scaled(hn::Set(d, Real<D>(-1)), U)), p.trace);
    const Mat3Lanes<V> c = cofactor(sums);
    const Vec3Lanes<V> a = scaled(hn::Div(hn::Set(d, Real<D>(1)), dot(sums.c0, c.c0)), times(c, w));
    const Mat3Lanes<V> spin = {{zero, a.z, hn::Neg(a.y)}, {hn::Neg(a.z), zero, a.x}, {a.y, hn::Neg(a.x), zero}};
    return times(p.R, Q3 + spin);
  }
};

template <class D>
struct RelaxationLanes<MaterialLaw::neoHookean, D> {
  using V = hn::Vec<D>;
  D d;
  const Strain<D> &s;
  Mat3Lanes<V> cof;
  V J, inverse, root2;  // 1/J, J^(2/3)
  HWY_INLINE RelaxationLanes(D tag, const Strain<D> &strain, const NoFrame<D> &)
      : d(tag), s(strain), cof(strain.cofactorOfF(tag)), J(hn::Add(strain.growth, hn::Set(tag, Real<D>(1)))),
        inverse(hn::Div(hn::Set(tag, Real<D>(1)), J)),
        root2(hn::Exp(tag, hn::Mul(hn::Set(tag, Real<D>(2.0 / 3.0)), hn::Log1p(tag, strain.growth)))) {}

  HWY_INLINE hn::Mask<D> stray() const { return hn::Lt(J, hn::Set(d, Real<D>(kNeoHookeanSwitch))); }
  HWY_INLINE Sym3Lanes<V> drive(V mu) const {
    using T = Real<D>;
    const V size = hn::MulAdd(hn::Set(d, T(2.0 / 3.0)), trace(s.E), hn::Set(d, T(1)));  // tr C / 3
    const V scale = hn::Mul(mu, root2);
    Sym3Lanes<V> D3 = scaled(hn::Neg(hn::Mul(hn::Mul(scale, size), hn::Mul(inverse, inverse))), gram(cof));
    D3.xx = hn::Add(D3.xx, scale);
    D3.yy = hn::Add(D3.yy, scale);
    D3.zz = hn::Add(D3.zz, scale);
    return D3;
  }
  HWY_INLINE Mat3Lanes<V> pushed(const Sym3Lanes<V> &Q) const {
    const Mat3Lanes<V> Q3 = full(Q), FQ = Q3 + times(s.G, Q3);
    const V value = hn::Div(hn::Set(d, Real<D>(1)), root2);
    const V QC = hn::Add(trace(FQ), product(FQ, s.G));
    const V along = hn::Mul(hn::Mul(hn::Set(d, Real<D>(-1.0 / 3.0)), QC), hn::Mul(value, inverse));
    return mulAdd(value, FQ, scaled(along, cof));
  }
};

/// Replaces single lanes by answer(F, Q, out).
template <class D, class Answer, class V = hn::Vec<D>>
HWY_NOINLINE void answerRelaxation(D d, hn::Mask<D> stray, const Strain<D> &s, const Sym3Lanes<V> &Q, Mat3Lanes<V> &out,
                                   const Answer &answer) {
  using T = Real<D>;
  constexpr std::size_t kMost = hn::MaxLanes(D());
  HWY_ALIGN T G[9][kMost];
  HWY_ALIGN T relaxed[9][kMost];
  HWY_ALIGN T answers[9][kMost];
  HWY_ALIGN T flags[kMost];
  storeNine(d, s.G, G);
  storeNine(d, full(Q), relaxed);
  storeNine(d, out, answers);
  hn::Store(hn::IfThenElseZero(stray, hn::Set(d, T(1))), d, flags);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    if (flags[i] == T(0)) continue;
    double F[9], Qi[9], one[9];
    for (int k = 0; k < 9; ++k) {
      F[k] = static_cast<double>(G[k][i]) + (k % 4 == 0 ? 1.0 : 0.0);
      Qi[k] = static_cast<double>(relaxed[k][i]);
    }
    answer(F, Qi, one);
    for (int k = 0; k < 9; ++k) answers[k][i] = static_cast<T>(one[k]);
  }
  out = loadNine(d, answers);
}

/// Advances the history of the Prony terms by one step.
/// @return d/dF (Q : e) at its end: the relaxed part of P
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE Mat3Lanes<V> relaxedStress(D d, const LawNumbers<double> &m, const MaterialHistory &history,
                                      const Strain<D> &s, const FrameOf<kLaw, D> &frame,
                                      const PointRecords<D, 27> &records, const LatticeAxes<D> &axes,
                                      const ScalarLaw &scalar, std::size_t material) {
  const RelaxationLanes<kLaw, D> relaxation(d, s, frame);
  Sym3Lanes<V> drive = relaxation.drive(hn::Set(d, m.mu));
  const hn::Mask<D> stray = relaxation.stray();
  const bool strays = !hn::AllFalse(d, stray);
  if (HWY_UNLIKELY(strays)) {
    Mat3Lanes<V> answers = full(drive);
    answerRelaxation(d, stray, s, drive, answers, [&](const double *F, const double *, double *out) {
      scalar.drive(scalar.context, material, F, out);
    });
    drive = lower(answers);
  }
  Mat3Lanes<V> memory[3] = {records.loadMatrix(0), records.loadMatrix(9), records.loadMatrix(18)};
  if (HWY_UNLIKELY(axes.turned))
    for (Mat3Lanes<V> &tensor : memory) tensor = axes.toLattice(tensor);
  const Sym3Lanes<V> previous = lower(memory[0]);
  Sym3Lanes<V> first = lower(memory[1]), second = lower(memory[2]);
  first = mulAdd(hn::Set(d, history.fresh[0]), drive,
                 mulAdd(hn::Set(d, history.old[0]), previous, scaled(hn::Set(d, history.keep[0]), first)));
  second = mulAdd(hn::Set(d, history.fresh[1]), drive,
                  mulAdd(hn::Set(d, history.old[1]), previous, scaled(hn::Set(d, history.keep[1]), second)));
  const Sym3Lanes<V> Q = first + second;
  Mat3Lanes<V> P = relaxation.pushed(Q);
  if (HWY_UNLIKELY(strays))
    answerRelaxation(d, stray, s, Q, P, [&](const double *F, const double *Qi, double *out) {
      scalar.pushed(scalar.context, material, F, Qi, out);
    });
  memory[0] = full(drive);
  memory[1] = full(first);
  memory[2] = full(second);
  if (HWY_UNLIKELY(axes.turned))
    for (Mat3Lanes<V> &tensor : memory) tensor = axes.toWorld(tensor);
  records.storeMatrix(0, memory[0]);
  if (history.keep[0] < 1.0) records.storeMatrix(9, memory[1]);
  if (history.keep[1] < 1.0) records.storeMatrix(18, memory[2]);
  return P;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
