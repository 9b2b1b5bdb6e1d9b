// SPDX-License-Identifier: Apache-2.0
#include "solvers/sweep_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solvers/sweep_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

struct RowSum {
  float sums[3] = {0.0F, 0.0F, 0.0F};

  void add(const SweepRows &rows, std::size_t begin, std::size_t end) {
    for (std::size_t k = SweepRows::kEight * begin; k < SweepRows::kEight * end; ++k)
      for (std::size_t n = 0; n < 9; ++n)
        sums[n % 3] +=
            static_cast<float>(rows.blocks[9 * (k - k % 8) + 8 * n + k % 8]) * rows.x[4 * rows.columns[k] + n / 3];
  }
  void relax(const SweepRows &rows, std::size_t i) const {
    float right[3];
    for (std::size_t c = 0; c < 3; ++c) right[c] = rows.right[4 * i + c] - SweepRows::kUnit * sums[c];
    for (std::size_t c = 0; c < 3; ++c) {
      const float *inverse = rows.inverses + 12 * i + c;
      rows.x[4 * i + c] = inverse[0] * right[0] + inverse[4] * right[1] + inverse[8] * right[2];
    }
  }
  void storeResidual(float *out) const {
    for (std::size_t c = 0; c < 3; ++c) out[c] = -SweepRows::kUnit * sums[c];
  }
};

#else

using Eight = hn::CappedTag<float, SweepRows::kEight>;  // or four
using Four = hn::CappedTag<float, 4>;

/// Numbers of node `a`, and of `b` in the upper half of registers of eight.
template <class D>
HWY_INLINE hn::Vec<D> pairOf(D d, const float *x, std::uint32_t a, [[maybe_unused]] std::uint32_t b) {
  if constexpr (hn::MaxLanes(D()) == 8) {
    return hn::Combine(d, hn::Load(Four(), x + 4 * b), hn::Load(Four(), x + 4 * a));
  } else {
    return hn::Load(d, x + 4 * a);
  }
}

template <class D>
HWY_INLINE hn::Vec<Four> sumOfHalves([[maybe_unused]] D d, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) == 8) {
    return hn::Add(hn::LowerHalf(Four(), v), hn::UpperHalf(Four(), v));
  } else {
    return v;
  }
}

/// Lower or upper halves of the blocks of a and b, by pairs of lanes.
template <class D, class V = hn::Vec<D> >
HWY_INLINE V lowerPairs(D d, V a, V b) {
  const hn::Repartition<std::uint64_t, D> pairs;
  return hn::BitCast(d, hn::InterleaveLower(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
}
template <class D, class V = hn::Vec<D> >
HWY_INLINE V upperPairs(D d, V a, V b) {
  const hn::Repartition<std::uint64_t, D> pairs;
  return hn::BitCast(d, hn::InterleaveUpper(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
}

/// Sums of blocks times x over part of a row.
struct RowSum {
  using V = hn::Vec<Eight>;
  V x, y, z;

  HWY_INLINE RowSum() : x(hn::Zero(Eight())), y(hn::Zero(Eight())), z(hn::Zero(Eight())) {}

  HWY_INLINE void add(const SweepRows &rows, std::size_t begin, std::size_t end) {
    const Eight d;
    const hn::Rebind<std::int16_t, Eight> small;
    const hn::Rebind<std::int32_t, Eight> whole;
    constexpr std::size_t kLanes = hn::MaxLanes(Eight()), kUp = kLanes == 8 ? 4 : 0;
    for (std::size_t g = begin; g < end; ++g)
      for (std::size_t k = 0; k < SweepRows::kEight; k += kLanes) {
        const std::uint32_t *c = rows.columns + SweepRows::kEight * g + k;
        const V n0 = pairOf(d, rows.x, c[0], c[kUp]), n1 = pairOf(d, rows.x, c[1], c[1 + kUp]),
                n2 = pairOf(d, rows.x, c[2], c[2 + kUp]), n3 = pairOf(d, rows.x, c[3], c[3 + kUp]);
        const V xy01 = hn::InterleaveLower(d, n0, n1), xy23 = hn::InterleaveLower(d, n2, n3);
        const V z01 = hn::InterleaveUpper(d, n0, n1), z23 = hn::InterleaveUpper(d, n2, n3);
        const std::int16_t *block = rows.blocks + 9 * SweepRows::kEight * g + k;
        const auto addColumn = [&](V of) HWY_ATTR {
          const auto number = [&](std::size_t row) HWY_ATTR {
            return hn::ConvertTo(d, hn::PromoteTo(whole, hn::Load(small, block + row * SweepRows::kEight)));
          };
          x = hn::MulAdd(number(0), of, x);
          y = hn::MulAdd(number(1), of, y);
          z = hn::MulAdd(number(2), of, z);
          block += 3 * SweepRows::kEight;
        };
        addColumn(lowerPairs(d, xy01, xy23));
        addColumn(upperPairs(d, xy01, xy23));
        addColumn(lowerPairs(d, z01, z23));
      }
  }
  /// (x, y, z, 0), each summed over its lanes.
  HWY_INLINE hn::Vec<Four> total() const {
    const Eight d;
    const V none = hn::Zero(d);
    const V xy = hn::Add(hn::InterleaveLower(d, x, y), hn::InterleaveUpper(d, x, y));
    const V z0 = hn::Add(hn::InterleaveLower(d, z, none), hn::InterleaveUpper(d, z, none));
    return sumOfHalves(d, hn::Add(lowerPairs(d, xy, z0), upperPairs(d, xy, z0)));
  }
  HWY_INLINE void relax(const SweepRows &rows, std::size_t i) const {
    const Four d;
    const auto right = hn::NegMulAdd(hn::Set(d, SweepRows::kUnit), total(), hn::Load(d, rows.right + 4 * i));
    const float *inverse = rows.inverses + 12 * i;
    auto out = hn::Mul(hn::Load(d, inverse), hn::Broadcast<0>(right));
    out = hn::MulAdd(hn::Load(d, inverse + 4), hn::Broadcast<1>(right), out);
    out = hn::MulAdd(hn::Load(d, inverse + 8), hn::Broadcast<2>(right), out);
    hn::Store(out, d, rows.x + 4 * i);
  }
  HWY_INLINE void storeResidual(float *out) const {
    const Four d;
    hn::Store(hn::Mul(hn::Set(d, -SweepRows::kUnit), total()), d, out);
  }
};

#endif

void Forwards(const SweepRows &rows, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    RowSum sum;
    sum.add(rows, rows.eights[2 * i], rows.eights[2 * i + 1]);
    sum.relax(rows, i);
  }
}

void Backwards(const SweepRows &rows, std::size_t begin, std::size_t end) {
  for (std::size_t i = end; i-- > begin;) {
    RowSum sum;
    sum.add(rows, rows.eights[2 * i], rows.eights[2 * i + 2]);
    sum.relax(rows, i);
  }
}

void Residuals(const SweepRows &rows, float *out, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    RowSum sum;
    sum.add(rows, rows.eights[2 * i + 1], rows.eights[2 * i + 2]);
    sum.storeResidual(out + 4 * i);
  }
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(Forwards);
HWY_EXPORT(Backwards);
HWY_EXPORT(Residuals);

void sweepForwards(const SweepRows &rows, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Forwards)(rows, begin, end);
}
void sweepBackwards(const SweepRows &rows, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Backwards)(rows, begin, end);
}
void residualsAfter(const SweepRows &rows, float *out, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(Residuals)(rows, out, begin, end);
}

}  // namespace pointbased::kernels
#endif
