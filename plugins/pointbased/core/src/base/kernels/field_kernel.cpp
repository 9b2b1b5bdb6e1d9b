// SPDX-License-Identifier: Apache-2.0
#include "base/kernels/field_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/kernels/field_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

void KickAll(const Kick &k, std::size_t begin, std::size_t end) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V h = hn::Set(d, k.h);
  const V g[3] = {hn::Set(d, k.gravity[0]), hn::Set(d, k.gravity[1]), hn::Set(d, k.gravity[2])};
  std::size_t i = begin;
  for (; i + lanes <= end; i += lanes) {
    V f[3], v[3];
    hn::LoadInterleaved3(d, k.forces + 3 * i, f[0], f[1], f[2]);
    hn::LoadInterleaved3(d, k.velocities + 3 * i, v[0], v[1], v[2]);
    const V inverse = hn::LoadU(d, k.inverseMasses + i);
    const auto moves = hn::Gt(inverse, hn::Zero(d));
    for (int c = 0; c < 3; ++c) {
      const V pull = k.gravityShares ? hn::Mul(hn::LoadU(d, k.gravityShares + i), g[c]) : g[c];
      const V change = hn::Mul(h, hn::Add(hn::Mul(inverse, f[c]), pull));
      v[c] = hn::IfThenElse(moves, hn::Add(v[c], change), v[c]);
    }
    hn::StoreInterleaved3(v[0], v[1], v[2], d, k.velocities + 3 * i);
  }
  for (; i < end; ++i) {
    if (!(k.inverseMasses[i] > 0.0)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double pull = k.gravityShares ? k.gravityShares[i] * k.gravity[c] : k.gravity[c];
      k.velocities[3 * i + c] += k.h * (k.inverseMasses[i] * k.forces[3 * i + c] + pull);
    }
  }
}

void AddScaled(double s, const double *b, double *a, std::size_t n) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V factor = hn::Set(d, s);
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    hn::StoreU(hn::Add(hn::LoadU(d, a + i), hn::Mul(factor, hn::LoadU(d, b + i))), d, a + i);
  for (; i < n; ++i) a[i] += s * b[i];
}

FieldBounds BoundsOf(const double *field, std::size_t count) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  FieldBounds out;
  for (std::size_t c = 0; c < 3; ++c) out.low[c] = out.high[c] = field[c];
  std::size_t i = 0;
  // Three registers hold a whole number of phyxels: lane l of register r is component (r lanes + l) % 3.
  if (count >= lanes) {
    V low[3], high[3];
    V sum = hn::Zero(d);
    for (std::size_t r = 0; r < 3; ++r) low[r] = high[r] = hn::LoadU(d, field + r * lanes);
    for (; i + lanes <= count; i += lanes)
      for (std::size_t r = 0; r < 3; ++r) {
        const V x = hn::LoadU(d, field + 3 * i + r * lanes);
        sum = hn::Add(sum, x);
        low[r] = hn::Min(low[r], x);
        high[r] = hn::Max(high[r], x);
      }
    HWY_ALIGN double lows[24], highs[24];
    for (std::size_t r = 0; r < 3; ++r) {
      hn::StoreU(low[r], d, lows + r * lanes);
      hn::StoreU(high[r], d, highs + r * lanes);
    }
    for (std::size_t k = 0; k < 3 * lanes; ++k) {
      out.low[k % 3] = std::min(out.low[k % 3], lows[k]);
      out.high[k % 3] = std::max(out.high[k % 3], highs[k]);
    }
    out.sum = hn::GetLane(hn::SumOfLanes(d, sum));
  }
  for (; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = field[3 * i + c];
      out.sum += x;
      out.low[c] = std::min(out.low[c], x);
      out.high[c] = std::max(out.high[c], x);
    }
  return out;
}

double RoughSumOfSquares(const double *numbers, std::size_t n) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  V sum[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  std::size_t i = 0;
  for (; i + 4 * lanes <= n; i += 4 * lanes)
    for (std::size_t r = 0; r < 4; ++r) {
      const V x = hn::LoadU(d, numbers + i + r * lanes);
      sum[r] = hn::MulAdd(x, x, sum[r]);
    }
  double all = hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(sum[0], sum[1]), hn::Add(sum[2], sum[3]))));
  for (; i < n; ++i) all += numbers[i] * numbers[i];
  return all;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(KickAll);
HWY_EXPORT(AddScaled);
HWY_EXPORT(BoundsOf);
HWY_EXPORT(RoughSumOfSquares);

void kick(const Kick &k, std::size_t begin, std::size_t end) { HWY_DYNAMIC_DISPATCH(KickAll)(k, begin, end); }
void addScaled(double s, const double *b, double *a, std::size_t n) { HWY_DYNAMIC_DISPATCH(AddScaled)(s, b, a, n); }
FieldBounds boundsOf(const double *field, std::size_t count) { return HWY_DYNAMIC_DISPATCH(BoundsOf)(field, count); }
double roughSumOfSquares(const double *numbers, std::size_t n) {
  return HWY_DYNAMIC_DISPATCH(RoughSumOfSquares)(numbers, n);
}

}  // namespace pointbased::kernels
#endif
