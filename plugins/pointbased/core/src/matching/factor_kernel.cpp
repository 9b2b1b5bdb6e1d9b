// SPDX-License-Identifier: Apache-2.0
#include "matching/factor_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/factor_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FactorLanes = hn::CappedTag<float, 16>;

void Scale(float by, float *row) {
  const FactorLanes d;
  const auto factor = hn::Set(d, by);
  for (std::size_t c = 0; c < kFactorColumns; c += hn::Lanes(d))
    hn::StoreU(hn::Mul(hn::LoadU(d, row + c), factor), d, row + c);
}

// to -= by from
void SubtractScaled(float by, const float *from, float *to) {
  const FactorLanes d;
  const auto factor = hn::Set(d, by);
  for (std::size_t c = 0; c < kFactorColumns; c += hn::Lanes(d))
    hn::StoreU(hn::NegMulAdd(factor, hn::LoadU(d, from + c), hn::LoadU(d, to + c)), d, to + c);
}

void SolveFactor(const SparseFactor &L, float *x) {
  const auto row = [x](std::size_t i) { return x + kFactorColumns * i; };
  for (std::size_t j = 0; j < L.size; ++j) {
    const int first = L.offsets[j], last = L.offsets[j + 1];
    Scale(1.0f / L.values[first], row(j));
    for (int e = first + 1; e < last; ++e)
      SubtractScaled(L.values[e], row(j), row(static_cast<std::size_t>(L.rows[e])));
  }
  for (std::size_t j = L.size; j-- > 0;) {
    const int first = L.offsets[j], last = L.offsets[j + 1];
    for (int e = first + 1; e < last; ++e)
      SubtractScaled(L.values[e], row(static_cast<std::size_t>(L.rows[e])), row(j));
    Scale(1.0f / L.values[first], row(j));
  }
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(SolveFactor);

void solveFactor(const SparseFactor &factor, float *x) { HWY_DYNAMIC_DISPATCH(SolveFactor)(factor, x); }

}  // namespace pointbased::kernels
#endif
