// SPDX-License-Identifier: Apache-2.0
#include "forces/limit_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forces/limit_kernels.cpp"
// Vectors of a length that is known only at run time cannot be elements of an array.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limits::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Latency times throughput of current cores is 8 to 10 chains; 12 leave registers for the factors.
constexpr std::size_t kChains = 12;

template <class T>
double multiplyAddsOf(T seed, std::size_t rounds, T &out) {
  const hn::ScalableTag<T> d;
  const auto factor = hn::Set(d, T(0.999)), term = hn::Set(d, seed);
  auto a0 = hn::Iota(d, T(0)), a1 = hn::Iota(d, T(1)), a2 = hn::Iota(d, T(2)), a3 = hn::Iota(d, T(3));
  auto a4 = hn::Iota(d, T(4)), a5 = hn::Iota(d, T(5)), a6 = hn::Iota(d, T(6)), a7 = hn::Iota(d, T(7));
  auto a8 = hn::Iota(d, T(8)), a9 = hn::Iota(d, T(9)), a10 = hn::Iota(d, T(10)), a11 = hn::Iota(d, T(11));
  for (std::size_t r = 0; r < rounds; ++r) {
    a0 = hn::MulAdd(a0, factor, term);
    a1 = hn::MulAdd(a1, factor, term);
    a2 = hn::MulAdd(a2, factor, term);
    a3 = hn::MulAdd(a3, factor, term);
    a4 = hn::MulAdd(a4, factor, term);
    a5 = hn::MulAdd(a5, factor, term);
    a6 = hn::MulAdd(a6, factor, term);
    a7 = hn::MulAdd(a7, factor, term);
    a8 = hn::MulAdd(a8, factor, term);
    a9 = hn::MulAdd(a9, factor, term);
    a10 = hn::MulAdd(a10, factor, term);
    a11 = hn::MulAdd(a11, factor, term);
  }
  const auto low = hn::Add(hn::Add(hn::Add(a0, a1), hn::Add(a2, a3)), hn::Add(a4, a5));
  const auto high = hn::Add(hn::Add(hn::Add(a6, a7), hn::Add(a8, a9)), hn::Add(a10, a11));
  out = hn::GetLane(hn::SumOfLanes(d, hn::Add(low, high)));
  return 2.0 * static_cast<double>(kChains * hn::Lanes(d)) * static_cast<double>(rounds);
}

double MultiplyAddsFloat(float seed, std::size_t rounds, float &out) { return multiplyAddsOf(seed, rounds, out); }
double MultiplyAddsDouble(double seed, std::size_t rounds, double &out) { return multiplyAddsOf(seed, rounds, out); }

void Triad(double *HWY_RESTRICT a, const double *HWY_RESTRICT b, const double *HWY_RESTRICT c, double s,
           std::size_t n) {
  const hn::ScalableTag<double> d;
  const auto factor = hn::Set(d, s);
  for (std::size_t i = 0; i + hn::Lanes(d) <= n; i += hn::Lanes(d))
    hn::Store(hn::MulAdd(factor, hn::Load(d, c + i), hn::Load(d, b + i)), d, a + i);
}

const char *TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace limits::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limits {

HWY_EXPORT(MultiplyAddsFloat);
HWY_EXPORT(MultiplyAddsDouble);
HWY_EXPORT(Triad);
HWY_EXPORT(TargetName);

const char *target() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }
double multiplyAdds(float seed, std::size_t rounds, float &out) {
  return HWY_DYNAMIC_DISPATCH(MultiplyAddsFloat)(seed, rounds, out);
}
double multiplyAdds(double seed, std::size_t rounds, double &out) {
  return HWY_DYNAMIC_DISPATCH(MultiplyAddsDouble)(seed, rounds, out);
}
void triad(double *a, const double *b, const double *c, double s, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(Triad)(a, b, c, s, n);
}

}  // namespace limits
#endif
