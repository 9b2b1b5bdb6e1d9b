// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/cell_history_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/kernels/cell_history_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "forces/kernels/cell_run-inl.h"
#include "forces/kernels/history-inl.h"
#include "forces/kernels/hourglass-inl.h"
#include "forces/kernels/plastic_flow-inl.h"
#include "forces/kernels/tangent-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

/// History of some lanes of a slice.
template <class D>
struct CellHistory {
  using V = hn::Vec<D>;
  const CellRun<D> &run;
  const HistoryJob &job;
  const MaterialHistory &material;
  const Index *points;
  std::size_t used;
  double *spare;  // [36]
  LatticeAxes<D> axes;

  HWY_INLINE CellHistory(const CellRun<D> &of, const HistoryJob &history, double *record)
      : run(of), job(history), material(history.materials[of.material()]),
        points(history.points.data() + of.slice * CellRun<D>::kSlice + of.lane),
        used(history.used[of.slice] > of.lane ? HWY_MIN(history.used[of.slice] - of.lane, hn::Lanes(of.d)) : 0),
        spare(record), axes{of.d, of.job.axes, of.job.turned} {}

  template <std::size_t kSize>
  HWY_INLINE PointRecords<D, kSize> records(double *base) const {
    return {run.d, base, points, used, spare};
  }

  /// F_p^-1 - 1
  HWY_INLINE Mat3Lanes<V> plasticInverse() const {
    const Mat3Lanes<V> world = records<9>(job.plasticInverse).loadMatrix(0);
    return plusDiagonal(HWY_UNLIKELY(axes.turned) ? axes.toLattice(world) : world, hn::Set(run.d, -1.0));
  }

  /// plasticFlow() for the lanes.
  /// @param plastic  F_p^-1 - 1, in and out
  /// @return whether any lane has flowed
  HWY_INLINE bool flow(const Strain<D> &elastic, const Mat3Lanes<V> &G, Mat3Lanes<V> &plastic) const {
    const D d = run.d;
    const auto beyond = hn::Gt(squaredNorm(elastic.E), hn::Set(d, material.elasticLimit2));
    if (job.flow == nullptr || HWY_LIKELY(hn::AllFalse(d, beyond))) return false;
    const FlowLanes<D> flow(d, material, beyond, elastic, plastic);
    if (hn::AllFalse(d, flow.flowing)) return false;
    const auto known = hn::AndNot(flow.stray, flow.flowing);
    const Mat3Lanes<V> next = plusDiagonal(flow.plastic, hn::Set(d, 1.0));
    if (HWY_LIKELY(hn::AllTrue(d, known)) && !axes.turned) {
      records<9>(job.plasticInverse).storeMatrix(0, next);
      plastic = plusDiagonal(next, hn::Set(d, -1.0));  // same value as after reloading
    } else {
      flowOfSome(known, HWY_UNLIKELY(axes.turned) ? axes.toWorld(next) : next, flow.stray, G);
      plastic = plasticInverse();
    }
    return true;
  }

 private:
  HWY_NOINLINE void flowOfSome(hn::Mask<D> known, const Mat3Lanes<V> &next, hn::Mask<D> stray,
                               const Mat3Lanes<V> &G) const {
    constexpr std::size_t kMost = hn::MaxLanes(D());
    const V one = hn::Set(run.d, 1.0);
    HWY_ALIGN double gradients[9][kMost];
    HWY_ALIGN double flowed[9][kMost];
    HWY_ALIGN double flags[kMost];
    storeNine(run.d, plusDiagonal(G, one), gradients);
    storeNine(run.d, next, flowed);
    hn::Store(hn::IfThenElse(stray, hn::Neg(one), hn::IfThenElseZero(known, one)), run.d, flags);
    for (std::size_t i = 0; i < used; ++i) {
      double F[9];
      for (std::size_t k = 0; k < 9; ++k) {
        F[k] = gradients[k][i];
        if (flags[i] > 0.0) job.plasticInverse[9 * points[i] + k] = flowed[k][i];
      }
      if (flags[i] < 0.0) job.flow(job.flowContext, run.material(), points[i], F);
    }
  }
};

/// F_e - 1 of F - 1 and F_p^-1 - 1
template <class V>
HWY_INLINE Mat3Lanes<V> elasticPart(const Mat3Lanes<V> &G, const Mat3Lanes<V> &plastic) {
  return G + plastic + times(G, plastic);
}

/// Strains of the modes: columns xy, xz, yz of B, and Fᵀ a_xyz.
template <class V>
struct ModalStrain {
  Mat3Lanes<V> B;
  Vec3Lanes<V> xyz;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE ModalStrain<V> loadModes(const PointRecords<D, 36> &records, std::size_t k) {
  ModalStrain<V> m;
  records.load(k, m.B.c0.x, m.B.c0.y);
  records.load(k + 2, m.B.c0.z, m.B.c1.x);
  records.load(k + 4, m.B.c1.y, m.B.c1.z);
  records.load(k + 6, m.B.c2.x, m.B.c2.y);
  records.load(k + 8, m.B.c2.z, m.xyz.x);
  records.load(k + 10, m.xyz.y, m.xyz.z);
  return m;
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE void storeModes(const PointRecords<D, 36> &records, std::size_t k, const ModalStrain<V> &m) {
  records.store(k, m.B.c0.x, m.B.c0.y);
  records.store(k + 2, m.B.c0.z, m.B.c1.x);
  records.store(k + 4, m.B.c1.y, m.B.c1.z);
  records.store(k + 6, m.B.c2.x, m.B.c2.y);
  records.store(k + 8, m.B.c2.z, m.xyz.x);
  records.store(k + 10, m.xyz.y, m.xyz.z);
}
/// s a + b
template <class V>
HWY_INLINE ModalStrain<V> mulAdd(V s, const ModalStrain<V> &a, const ModalStrain<V> &b) {
  return {mulAdd(s, a.B, b.B), mulAdd(s, a.xyz, b.xyz)};
}
template <class V>
HWY_INLINE ModalStrain<V> scaled(V s, const ModalStrain<V> &a) {
  return {scaled(s, a.B), scaled(s, a.xyz)};
}

/// Relaxed part at the end of the step, as advance() in relaxing_hourglass.h; updates the history.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ModalStrain<V> relaxModes(D d, const MaterialHistory &m, const PointRecords<D, 36> &records,
                                     ModalStrain<V> deviator) {
  const ModalStrain<V> previous = loadModes(records, 0);
  ModalStrain<V> first = loadModes(records, 12), second = loadModes(records, 24);
  const V keep0 = hn::Set(d, m.keep[0]), keep1 = hn::Set(d, m.keep[1]);
  const V oldThird = hn::Set(d, m.acrossOfPast / 3.0), sumThird = hn::Set(d, (1.0 - m.acrossOfSum) / 3.0);
  const Mat3Lanes<V> past =
      mulAdd(keep0, first.B, mulAdd(keep1, second.B, scaled(hn::Set(d, m.old[0] + m.old[1]), previous.B)));
  // E_xx and E_yy in the plane perpendicular to an axis.
  const auto normal = [&](V &x, V &y, V pastX, V pastY) HWY_ATTR {
    const V mean = hn::NegMulAdd(oldThird, hn::Add(pastX, pastY), hn::Mul(sumThird, hn::Add(x, y)));
    x = hn::Sub(x, mean);
    y = hn::Sub(y, mean);
  };
  normal(deviator.B.c0.y, deviator.B.c1.z, past.c0.y, past.c1.z);
  normal(deviator.B.c0.x, deviator.B.c2.z, past.c0.x, past.c2.z);
  normal(deviator.B.c1.x, deviator.B.c2.y, past.c1.x, past.c2.y);
  storeModes(records, 0, deviator);
  first = mulAdd(hn::Set(d, m.fresh[0]), deviator, mulAdd(hn::Set(d, m.old[0]), previous, scaled(keep0, first)));
  second = mulAdd(hn::Set(d, m.fresh[1]), deviator, mulAdd(hn::Set(d, m.old[1]), previous, scaled(keep1, second)));
  if (m.keep[0] < 1.0) storeModes(records, 12, first);
  if (m.keep[1] < 1.0) storeModes(records, 24, second);
  return {first.B + second.B, first.xyz + second.xyz};
}

/// F_e of some lanes after plastic flow.
template <bool kFlows, class D, class V = hn::Vec<D>>
struct ElasticState {
  Mat3Lanes<V> plastic;  // F_p^-1 - 1
  Strain<D> strain;
  V stretch2;

  HWY_INLINE ElasticState(const CellHistory<D> &memory, const Mat3Lanes<V> &G, V)
      : plastic(memory.plasticInverse()), strain(memory.run.d, elasticPart(G, plastic)) {
    const D d = memory.run.d;
    if (memory.flow(strain, G, plastic)) strain = Strain<D>(d, elasticPart(G, plastic));
    stretch2 = largestStretchSquared(d, strain.E, spreadOf(d, strain.E));
  }
  HWY_INLINE void pullBack(D d, Mat3Lanes<V> &P, V &ratio) const {
    P = P + times(P, transposed(plastic));
    const Sym3Lanes<V> left = greenStrain(d, transposed(plastic));  // (F_p^-1 F_p^-ᵀ - 1)/2
    ratio = hn::Mul(ratio, largestStretchSquared(d, left, spreadOf(d, left)));
  }
};
template <class D, class V>
struct ElasticState<false, D, V> {
  Strain<D> strain;
  V stretch2;

  HWY_INLINE ElasticState(const CellHistory<D> &memory, const Mat3Lanes<V> &G, V totalStretch2)
      : strain(memory.run.d, G), stretch2(totalStretch2) {}
  HWY_INLINE void pullBack(D, Mat3Lanes<V> &, V &) const {}
};

template <MaterialLaw kLaw, bool kFlows, bool kRelaxes, class D>
HWY_INLINE void forcesOfLanes(const CellRun<D> &run, const HistoryJob &history, const ScalarLaw &scalar) {
  using V = hn::Vec<D>;
  const D d = run.d;
  HWY_ALIGN double spare[36];
  const CellHistory<D> memory(run, history, spare);
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  const Mat3Lanes<V> G = run.gradient(x, y, z);
  const Sym3Lanes<V> E = greenStrain(d, G);
  const V stretch2 = largestStretchSquared(d, E, spreadOf(d, E));
  const ElasticState<kFlows, D> elastic(memory, G, stretch2);
  const FrameOf<kLaw, D> frame(d, elastic.strain);
  V ratio;
  Mat3Lanes<V> S = stressOf<kLaw>(d, run.law, elastic.strain, frame, elastic.stretch2, scalar, run.material(), ratio);
  if constexpr (kRelaxes)
    S = S - relaxedStress<kLaw>(d, run.law, memory.material, elastic.strain, frame,
                                memory.template records<27>(history.prony), memory.axes, scalar, run.material());
  elastic.pullBack(d, S, ratio);
  const bool isViscous = run.fields.velocities != nullptr;
  SignSums<V> vx, vy, vz;
  Mat3Lanes<V> rate;
  if (isViscous) {
    run.gatherCorners(run.fields.velocities, vx, vy, vz);
    rate = run.gradient(vx, vy, vz);
    S = S + viscousStress(d, hn::Set(d, run.law.twoEta), G, rate);
  }
  S = scaled(run.number(kVolume), S);
  V k[kCorners];
  if (!run.job.hourglass) {
    run.stiffnesses(ratio, hn::Zero(d), k);
    run.scatterStress(S, k);
    return;
  }
  constexpr bool kLinear = kLaw == MaterialLaw::linear;
  const Mat3Lanes<V> A = run.amplitudes(x, y, z);
  const Vec3Lanes<V> C = {x.xyz, y.xyz, z.xyz};
  Mat3Lanes<V> B = A;
  if constexpr (!kLinear) B = A + transposeTimes(G, A);
  Vec3Lanes<V> twisted = scaled(run.twist(), C);
  V modes = kLinear ? hn::Zero(d) : run.hourglassStiffness(A);
  if constexpr (kRelaxes) {
    const V kxyz = run.number(kModeXYZ);
    const Vec3Lanes<V> a = scaled(kxyz, C);
    ModalStrain<V> strains = {B, a};
    if constexpr (!kLinear) strains.xyz = a + transposeTimes(G, a);
    if (history.modes) {
      const PointRecords<D, 36> records = memory.template records<36>(history.modes);
      const ModalStrain<V> relaxed = relaxModes(d, memory.material, records, strains);
      B = B - relaxed.B;
      strains.xyz = strains.xyz - relaxed.xyz;
    }
    Vec3Lanes<V> pull = scaled(hn::Div(run.twist(), hn::Mul(kxyz, kxyz)), strains.xyz);
    if constexpr (!kLinear) {
      S = S + Mat3Lanes<V>{scaled(pull.x, a), scaled(pull.y, a), scaled(pull.z, a)};
      pull = pull + times(G, pull);
      // Unlike in the elastic energy, F rotates this mode as well.
      modes = hn::MulAdd(run.twist(), dot(C, C), modes);
    }
    twisted = scaled(kxyz, pull);
  }
  const Mat3Lanes<V> D3 = hourglassConjugate(d, run.law, B, run.roots());
  Mat3Lanes<V> pull = D3;
  if constexpr (!kLinear) {
    S = S + times(A, transposed(D3));
    pull = D3 + times(G, D3);
  }
  if (isViscous)
    addViscousModes<kLinear>(d, run.law, 1.0, run.roots(), run.number(kTwist), {G, A, C},
                             {rate, run.amplitudes(vx, vy, vz), {vx.xyz, vy.xyz, vz.xyz}}, S, pull, twisted);
  // The maximum of NaN and a number may be the number.
  run.stiffnesses(hn::IfThenElse(hn::Eq(ratio, ratio), hn::Max(ratio, stretch2), ratio), modes, k);
  run.scatterStress(S, pull, twisted, k);
}

// Strain and mode energies of some lanes, J.
template <MaterialLaw kLaw, class D, class V = hn::Vec<D>>
HWY_INLINE void energiesOfLanes(const CellRun<D> &run, const HistoryJob &history, const ScalarLaw &scalar,
                                V &strainEnergy, V &hourglassEnergy) {
  const D d = run.d;
  HWY_ALIGN double spare[36];
  const CellHistory<D> memory(run, history, spare);
  SignSums<V> x, y, z;
  run.gatherCorners(run.fields.displacements, x, y, z);
  const Mat3Lanes<V> G = run.gradient(x, y, z);
  const Strain<D> strain(d, memory.material.flows ? elasticPart(G, memory.plasticInverse()) : G);
  strainEnergy = hn::Mul(run.number(kVolume), energyOf<kLaw>(d, run.law, strain, scalar, run.material()));
  hourglassEnergy = hn::Zero(d);
  if (!run.job.hourglass) return;
  Mat3Lanes<V> B = run.amplitudes(x, y, z);
  Vec3Lanes<V> xyz = {x.xyz, y.xyz, z.xyz};
  if constexpr (kLaw != MaterialLaw::linear) {
    B = B + transposeTimes(G, B);
    if (memory.material.relaxes) xyz = xyz + transposeTimes(G, xyz);
  }
  hourglassEnergy = hn::Mul(hn::Set(d, 0.5), hn::MulAdd(run.twist(), dot(xyz, xyz),
                                                        product(B, hourglassConjugate(d, run.law, B, run.roots()))));
}

template <MaterialLaw kLaw, bool kFlows, bool kRelaxes>
HWY_NOINLINE void forcesOfSlice(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                                const ChunkFields<double> &fields, std::size_t slice) {
  forLanes(job, fields, slice,
           [&](const auto &run) HWY_ATTR { forcesOfLanes<kLaw, kFlows, kRelaxes>(run, history, scalar); });
}

template <MaterialLaw kLaw>
HWY_NOINLINE void energiesOfSlice(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                                  const ChunkFields<double> &fields, std::size_t slice) {
  storeEnergies(job, fields, slice, [&](const auto &run, auto &strain, auto &modes) HWY_ATTR {
    energiesOfLanes<kLaw>(run, history, scalar, strain, modes);
  });
}

void HistoryForces(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar, std::size_t begin,
                   std::size_t end) {
  forSlices<Sums::perPhyxel>(
      job, begin, end, [&](auto law, std::size_t slice, const ChunkFields<double> &fields) HWY_ATTR {
        constexpr MaterialLaw kLaw = decltype(law)::value;
        const MaterialHistory &material = history.materials[job.cells->materials[slice]];
        // Registers are scarce: each kind of material has a separate function.
        const auto run = material.flows
                             ? material.relaxes ? forcesOfSlice<kLaw, true, true> : forcesOfSlice<kLaw, true, false>
                         : material.relaxes ? forcesOfSlice<kLaw, false, true>
                                            : forcesOfSlice<kLaw, false, false>;
        run(job, history, scalar, fields, slice);
      });
}
void HistoryEnergies(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar, std::size_t begin,
                     std::size_t end) {
  forSlices<Sums::none>(job, begin, end, [&](auto law, std::size_t slice, const ChunkFields<double> &fields) HWY_ATTR {
    energiesOfSlice<decltype(law)::value>(job, history, scalar, fields, slice);
  });
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(HistoryForces);
HWY_EXPORT(HistoryEnergies);

void cellHistoryForces(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(HistoryForces)(job, history, scalar, begin, end);
}
void cellHistoryEnergies(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(HistoryEnergies)(job, history, scalar, begin, end);
}

}  // namespace pointbased::kernels
#endif
