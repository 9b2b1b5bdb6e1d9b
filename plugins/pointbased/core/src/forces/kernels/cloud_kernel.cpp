// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/cloud_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/kernels/cloud_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "forces/kernels/tangent-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

// Four blocks of four numbers: [a b c d] times (x, y, z, 0), summed over pairs.
template <class T, std::size_t kMost = hn::MaxLanes(hn::CappedTag<T, 16>())>
class Blocks;

#if HWY_TARGET != HWY_SCALAR
// Registers of at least four numbers: a row of 16 / lanes of them.
template <class T, std::size_t kMost>
requires(kMost >= 4) class Blocks<T, kMost> {
 public:
  using D = hn::CappedTag<T, kMost>;
  using V = hn::Vec<D>;
  using D4 = hn::FixedTag<T, 4>;
  using V4 = hn::Vec<D4>;
  using TI = hwy::MakeSigned<T>;
  static constexpr std::size_t kRow = 16 / kMost;

  HWY_INLINE Blocks() {
    const D d;
    HWY_ALIGN TI same[kMost];
    for (std::size_t i = 0; i < kMost; ++i) same[i] = static_cast<TI>(i % 4);
    repeat_ = hn::SetTableIndices(d, same);
    for (std::size_t r = 0; r < kRow; ++r) {
      HWY_ALIGN TI block[kMost];
      for (std::size_t i = 0; i < kMost; ++i) block[i] = static_cast<TI>((r * kMost + i) / 4);
      spread_[r] = hn::SetTableIndices(d, block);
    }
  }

  HWY_INLINE void clear() {
    for (std::size_t r = 0; r < kRow; ++r) sum_[0][r] = sum_[1][r] = sum_[2][r] = sum_[3][r] = hn::Zero(D());
  }
  static HWY_INLINE V4 load(const T *four) { return hn::Load(D4(), four); }
  static HWY_INLINE V4 less(V4 a, V4 b) { return hn::Sub(a, b); }
  /// w (X_k - X_j, a_k + a_j)
  static HWY_INLINE V4 pair(T w, const T *place, V4 from) {
    return hn::Mul(hn::Set(D4(), w), hn::Add(hn::Load(D4(), place), from));
  }
  static HWY_INLINE V4 turned(const T *place) {
    HWY_ALIGN T four[4] = {-place[0], -place[1], -place[2], place[3]};
    return hn::Load(D4(), four);
  }

  /// Adds to every block of the sum its coefficient times `four`.
  HWY_INLINE void addOuter(std::size_t chain, V4 coefficients, V4 four) {
    const V repeated = hn::TableLookupLanes(widened(four), repeat_);
    const V wide = widened(coefficients);
    for (std::size_t r = 0; r < kRow; ++r)
      sum_[chain][r] = hn::MulAdd(hn::TableLookupLanes(wide, spread_[r]), repeated, sum_[chain][r]);
  }
  /// Adds to every block of the sum its coefficient times the block of a record.
  HWY_INLINE void addBlocks(std::size_t chain, V4 coefficients, const T *record) {
    const V wide = widened(coefficients);
    for (std::size_t r = 0; r < kRow; ++r)
      sum_[chain][r] =
          hn::MulAdd(hn::TableLookupLanes(wide, spread_[r]), hn::Load(D(), record + r * kMost), sum_[chain][r]);
  }
  HWY_INLINE void store(T *sixteen) const {
    for (std::size_t r = 0; r < kRow; ++r)
      hn::Store(hn::Add(hn::Add(sum_[0][r], sum_[1][r]), hn::Add(sum_[2][r], sum_[3][r])), D(), sixteen + r * kMost);
  }

 private:
  static HWY_INLINE V widened(V4 v) {
    if constexpr (kMost == 4) {
      return v;
    } else if constexpr (kMost == 8) {
      return hn::ZeroExtendVector(D(), v);
    } else {
      return hn::ZeroExtendVector(D(), hn::ZeroExtendVector(hn::Half<D>(), v));
    }
  }

  decltype(hn::SetTableIndices(D(), static_cast<const TI *>(nullptr))) repeat_, spread_[kRow];
  V sum_[4][kRow];
};

#endif

// Narrower registers: number by number, with the same order and rounding.
template <class T, std::size_t kMost>
requires(kMost < 4) class Blocks<T, kMost> {
 public:
  struct V4 {
    T at[4];
  };
  HWY_INLINE void clear() {
    for (auto &chain : sum_)
      for (T &s : chain) s = T(0);
  }
  static HWY_INLINE V4 load(const T *four) { return {{four[0], four[1], four[2], four[3]}}; }
  static HWY_INLINE V4 less(const V4 &a, const V4 &b) {
    V4 r;
    for (int c = 0; c < 4; ++c) r.at[c] = a.at[c] - b.at[c];
    return r;
  }
  static HWY_INLINE V4 pair(T w, const T *place, const V4 &from) {
    V4 r;
    for (int c = 0; c < 4; ++c) r.at[c] = w * (place[c] + from.at[c]);
    return r;
  }
  static HWY_INLINE V4 turned(const T *place) { return {{-place[0], -place[1], -place[2], place[3]}}; }
  HWY_INLINE void addOuter(std::size_t chain, const V4 &coefficients, const V4 &four) {
    for (int b = 0; b < 4; ++b)
      for (int c = 0; c < 4; ++c) add(sum_[chain][4 * b + c], coefficients.at[b], four.at[c]);
  }
  HWY_INLINE void addBlocks(std::size_t chain, const V4 &coefficients, const T *record) {
    for (int b = 0; b < 4; ++b)
      for (int c = 0; c < 4; ++c) add(sum_[chain][4 * b + c], coefficients.at[b], record[4 * b + c]);
  }
  HWY_INLINE void store(T *sixteen) const {
    for (int k = 0; k < 16; ++k) sixteen[k] = (sum_[0][k] + sum_[1][k]) + (sum_[2][k] + sum_[3][k]);
  }

 private:
  static HWY_INLINE void add(T &sum, T a, T b) {
    const hn::CappedTag<T, 1> d;
    sum = hn::GetLane(hn::MulAdd(hn::Set(d, a), hn::Set(d, b), hn::Set(d, sum)));
  }
  T sum_[4][16];
};

// Sums over the pairs of one phyxel in four chains, in an order that does not depend on the machine.
template <class Pair>
HWY_INLINE void forPairs(std::size_t begin, std::size_t end, const Pair &pair) {
  std::size_t p = begin;
  for (; p + 4 <= end; p += 4) {
    pair(p, 0);
    pair(p + 1, 1);
    pair(p + 2, 2);
    pair(p + 3, 3);
  }
  // Unrolled: a chain with a constant index stays in its registers.
  if (p < end) pair(p++, 0);
  if (p < end) pair(p++, 1);
  if (p < end) pair(p, 2);
}

// Quantity to compute for a slice.
enum class Task {
  kForces,    // M and ratios at the displacements
  kTangents,  // data for products, at the displacements
  kProducts   // dM for changes of the displacements
};

// Columns of N and Σ w (a_j + a_k) Δu of every lane.
template <class T>
HWY_INLINE void fitLanes(const CloudJob<T> &job, const T *field, const Index *points, T (&fitted)[12][kLanes<T>]) {
  HWY_ALIGN T sixteen[16];
  Blocks<T> sum;
  for (std::size_t lane = 0; lane < kLanes<T>; ++lane) {
    const Index j = points[lane];
    if (j == kNoPoint) {
      for (auto &row : fitted) row[lane] = T(0);
      continue;
    }
    sum.clear();
    const auto here = sum.load(field + 4 * std::size_t{j});
    const auto from = sum.turned(job.places + 4 * std::size_t{j});
    forPairs(job.offsets[j], job.offsets[j + 1], [&](std::size_t p, std::size_t chain) HWY_ATTR {
      const std::size_t k = job.neighbours[p];
      sum.addOuter(chain, sum.pair(job.weights[p], job.places + 4 * k, from), sum.less(sum.load(field + 4 * k), here));
    });
    sum.store(sixteen);
    for (std::size_t b = 0; b < 4; ++b)
      for (std::size_t c = 0; c < 3; ++c) fitted[3 * b + c][lane] = sixteen[4 * b + c];
  }
}

template <MaterialLaw kLaw, Task kTask, class T>
HWY_NOINLINE void solveSlice(const CloudJob<T> &job, const ScalarLaw &scalar, std::size_t slice) {
  constexpr std::size_t kSlice = kLanes<T>;
  HWY_ALIGN T fitted[12][kSlice];
  HWY_ALIGN T answers[12][kSlice];
  const Index *points = job.points.data() + slice * kSlice;
  fitLanes(job, job.displacements, points, fitted);
  HWY_ALIGN T rates[12][kSlice];
  const bool viscous = kTask == Task::kForces && job.velocities;
  if (viscous) fitLanes(job, job.velocities, points, rates);

  using D = hn::CappedTag<T, kSlice>;
  using V = hn::Vec<D>;
  const D d;
  const std::size_t step = hn::Lanes(d);
  const std::size_t material = job.materials[slice];
  const LawNumbers<T> &law = job.laws[material];
  LargestRatio<D> largest(d);
  for (std::size_t lane = 0; lane < kSlice; lane += step) {
    const T *numbers = job.numbers + slice * kCloudNumbers * kSlice + lane;
    const auto number = [&](CloudNumber which) HWY_ATTR { return hn::Load(d, numbers + which * kSlice); };
    const auto column = [&](const T(&from)[12][kSlice], std::size_t b) HWY_ATTR {
      return Vec3Lanes<V>{hn::Load(d, from[3 * b] + lane), hn::Load(d, from[3 * b + 1] + lane),
                          hn::Load(d, from[3 * b + 2] + lane)};
    };
    const auto columns3 = [&](const T(&from)[12][kSlice]) HWY_ATTR {
      return Mat3Lanes<V>{column(from, 0), column(from, 1), column(from, 2)};
    };
    const TangentRows<D> tangent{d, job.tangents + slice * kTangentNumbers * kSlice + lane};
    const Sym3Lanes<V> inverse = {number(kInverseXX), number(kInverseYY), number(kInverseZZ),
                                  number(kInverseXY), number(kInverseXZ), number(kInverseYZ)};
    const Mat3Lanes<V> inverseMoment = full(inverse);
    const Mat3Lanes<V> G = times(columns3(fitted), inverseMoment);
    Mat3Lanes<V> P;
    if constexpr (kTask == Task::kTangents) {
      prepareTangent<kLaw>(d, law, Strain<D>(d, G), tangent);
      continue;
    } else if constexpr (kTask == Task::kProducts) {
      P = stressChange<kLaw>(d, law, tangent, G, scalar, material);
      if (job.viscousScale > 0)
        P = P + viscousStress(d, hn::Set(d, law.twoEta * job.viscousScale), tangent.getMatrix(kTangentG), G);
    } else {
      const Strain<D> strain(d, G);
      const V stretch2 = largestStretchSquared(d, strain.E, spreadOf(d, strain.E));
      V ratio;
      P = stressOf<kLaw>(d, law, strain, stretch2, scalar, material, ratio);
      largest.add(ratio);
      if (viscous) P = P + viscousStress(d, hn::Set(d, law.twoEta), G, times(columns3(rates), inverseMoment));
    }
    const Mat3Lanes<V> M = mulAdd(hn::Neg(number(kControl)), G, times(scaled(number(kCloudVolume), P), inverseMoment));
    const Vec3Lanes<V> own = column(fitted, 3) + times(M, Vec3Lanes<V>{number(kRestX), number(kRestY), number(kRestZ)});
    const Vec3Lanes<V> columns[4] = {M.c0, M.c1, M.c2, own};
    for (std::size_t b = 0; b < 4; ++b) {
      hn::Store(columns[b].x, d, answers[3 * b] + lane);
      hn::Store(columns[b].y, d, answers[3 * b + 1] + lane);
      hn::Store(columns[b].z, d, answers[3 * b + 2] + lane);
    }
  }
  if constexpr (kTask == Task::kTangents) return;
  if constexpr (kTask == Task::kForces) job.ratios[slice] = largest.value(d);
  for (std::size_t lane = 0; lane < kSlice; ++lane) {
    if (points[lane] == kNoPoint) continue;
    const std::size_t j = points[lane];
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c) job.tensors[16 * j + 4 * b + c] = answers[3 * b + c][lane];
    for (std::size_t c = 0; c < 3; ++c) job.own[4 * j + c] = answers[9 + c][lane];
  }
}

template <Task kTask, class T>
void solve(const CloudJob<T> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  for (std::size_t slice = begin; slice < end; ++slice)
    withLaw(job.laws[job.materials[slice]].law,
            [&](auto law) HWY_ATTR { solveSlice<decltype(law)::value, kTask>(job, scalar, slice); });
}

template <class T>
void forcesFromTensors(const CloudJob<T> &job, double *forces, std::size_t begin, std::size_t end) {
  Blocks<T> sum;
  HWY_ALIGN T sixteen[16];
  for (std::size_t j = begin; j < end; ++j) {
    sum.clear();
    const auto from = sum.turned(job.places + 4 * j);
    forPairs(job.offsets[j], job.offsets[j + 1], [&](std::size_t p, std::size_t chain) HWY_ATTR {
      const std::size_t k = job.neighbours[p];
      sum.addBlocks(chain, sum.pair(job.weights[p], job.places + 4 * k, from), job.tensors + 16 * k);
    });
    sum.store(sixteen);
    for (std::size_t c = 0; c < 3; ++c)
      forces[3 * j + c] = static_cast<double>((sixteen[c] + sixteen[4 + c]) + (sixteen[8 + c] + job.own[4 * j + c]));
  }
}

void CloudTensorsFloat(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kForces>(job, scalar, begin, end);
}
void CloudTangentsFloat(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kTangents>(job, scalar, begin, end);
}
void CloudProductsFloat(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kProducts>(job, scalar, begin, end);
}
void CloudTensorsDouble(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kForces>(job, scalar, begin, end);
}
void CloudTangentsDouble(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kTangents>(job, scalar, begin, end);
}
void CloudProductsDouble(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  solve<Task::kProducts>(job, scalar, begin, end);
}
void CloudForcesFloat(const CloudJob<float> &job, double *forces, std::size_t begin, std::size_t end) {
  forcesFromTensors(job, forces, begin, end);
}
void CloudForcesDouble(const CloudJob<double> &job, double *forces, std::size_t begin, std::size_t end) {
  forcesFromTensors(job, forces, begin, end);
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(CloudTensorsFloat);
HWY_EXPORT(CloudTensorsDouble);
HWY_EXPORT(CloudTangentsFloat);
HWY_EXPORT(CloudTangentsDouble);
HWY_EXPORT(CloudProductsFloat);
HWY_EXPORT(CloudProductsDouble);
HWY_EXPORT(CloudForcesFloat);
HWY_EXPORT(CloudForcesDouble);

void cloudTensors(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudTensorsFloat)(job, scalar, begin, end);
}
void cloudTensors(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudTensorsDouble)(job, scalar, begin, end);
}
void cloudTangents(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudTangentsFloat)(job, scalar, begin, end);
}
void cloudTangents(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudTangentsDouble)(job, scalar, begin, end);
}
void cloudProducts(const CloudJob<float> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudProductsFloat)(job, scalar, begin, end);
}
void cloudProducts(const CloudJob<double> &job, const ScalarLaw &scalar, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudProductsDouble)(job, scalar, begin, end);
}
void cloudForces(const CloudJob<float> &job, double *forces, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudForcesFloat)(job, forces, begin, end);
}
void cloudForces(const CloudJob<double> &job, double *forces, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CloudForcesDouble)(job, forces, begin, end);
}

}  // namespace pointbased::kernels
#endif
