// SPDX-License-Identifier: Apache-2.0
#include "solvers/cell_matrix_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solvers/cell_matrix_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 8>;
using V = hn::Vec<D>;

// The factors are multiplied in the same order for a pair and its mirror image, so that the matrix is symmetric to the
// last bit.
void AddCellRow(const float *factors, std::size_t width, std::size_t entry, float lambda, float mu, float *out) {
  const D d;
  const float *own = factors + entry;
  const V rootLambda = hn::Sqrt(hn::Abs(hn::Set(d, lambda))), rootMu = hn::Sqrt(hn::Abs(hn::Set(d, mu)));
  const float sign = lambda < 0.0F ? -1.0F : 1.0F, signMu = mu < 0.0F ? -1.0F : 1.0F;
  V ofLambda[3], ofMu[3];
  for (std::size_t n = 0; n < 3; ++n) {
    ofLambda[n] = hn::Mul(rootLambda, hn::Set(d, sign * own[n * width]));
    ofMu[n] = hn::Mul(rootMu, hn::Set(d, signMu * own[n * width]));
  }
  for (std::size_t k = 0; k < width; k += hn::Lanes(d)) {
    V byLambda[3], byMu[3];
    for (std::size_t n = 0; n < 3; ++n) {
      const V of = hn::Load(d, factors + n * width + k);
      byLambda[n] = hn::Mul(rootLambda, of);
      byMu[n] = hn::Mul(rootMu, of);
    }
    V both = hn::Zero(d);
    for (std::size_t n = 3; n < 10; ++n)
      both = hn::MulAdd(hn::Set(d, own[n * width]), hn::Load(d, factors + n * width + k), both);
    float *to = out + k;
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t row = 0; row < 3; ++row, to += width) {
        V sum = hn::MulAdd(ofLambda[row], byLambda[column], hn::Load(d, to));
        sum = hn::MulAdd(ofMu[column], byMu[row], sum);
        hn::Store(row == column ? hn::Add(sum, both) : sum, d, to);
      }
  }
}

// In the same order for a pair and its mirror image, as above.
void AddStrainGradientRow(const float *vectors, std::size_t width, std::size_t entry, float lambda, float mu,
                          float *out) {
  const D d;
  const V ofLambda = hn::Set(d, lambda), ofMu = hn::Set(d, mu);
  for (std::size_t axis = 0; axis < 3; ++axis, vectors += 3 * width) {
    const float *own = vectors + entry;
    const V a[3] = {hn::Set(d, own[0]), hn::Set(d, own[width]), hn::Set(d, own[2 * width])};
    for (std::size_t k = 0; k < width; k += hn::Lanes(d)) {
      const V c[3] = {hn::Load(d, vectors + k), hn::Load(d, vectors + width + k), hn::Load(d, vectors + 2 * width + k)};
      const V both = hn::Mul(ofMu, hn::MulAdd(a[2], c[2], hn::MulAdd(a[1], c[1], hn::Mul(a[0], c[0]))));
      float *to = out + k;
      for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row, to += width) {
          V sum = hn::MulAdd(ofLambda, hn::Mul(a[row], c[column]), hn::Load(d, to));
          sum = hn::MulAdd(ofMu, hn::Mul(a[column], c[row]), sum);
          hn::Store(row == column ? hn::Add(sum, both) : sum, d, to);
        }
    }
  }
}

void RoundRow(const float *row, const float *to, const float *back, std::size_t eights, std::int16_t *out,
              float *lost) {
  const D d;
  const hn::Rebind<std::int16_t, D> small;
  const V most = hn::Set(d, 32767.0F);
  for (std::size_t n = 0; n < 9; ++n) {
    V sum = hn::Zero(d);
    for (std::size_t g = 0; g < eights; ++g)
      for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
        const std::size_t at = 72 * g + 8 * n + k;
        const V exact = hn::Mul(hn::Load(d, to + 8 * g + k), hn::Load(d, row + at));
        const auto whole = hn::NearestInt(hn::Min(hn::Max(exact, hn::Neg(most)), most));
        hn::Store(hn::DemoteTo(small, whole), small, out + at);
        sum = hn::MulAdd(hn::Load(d, back + 8 * g + k), hn::Sub(exact, hn::ConvertTo(d, whole)), sum);
      }
    lost[n] += hn::GetLane(hn::SumOfLanes(d, sum));
  }
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(AddCellRow);
HWY_EXPORT(AddStrainGradientRow);
HWY_EXPORT(RoundRow);

void addCellRow(const float *factors, std::size_t width, std::size_t entry, float lambda, float mu, float *out) {
  HWY_DYNAMIC_DISPATCH(AddCellRow)(factors, width, entry, lambda, mu, out);
}
void addStrainGradientRow(const float *vectors, std::size_t width, std::size_t entry, float lambda, float mu,
                          float *out) {
  HWY_DYNAMIC_DISPATCH(AddStrainGradientRow)(vectors, width, entry, lambda, mu, out);
}
void roundRow(const float *row, const float *to, const float *back, std::size_t eights, std::int16_t *out,
              float *lost) {
  HWY_DYNAMIC_DISPATCH(RoundRow)(row, to, back, eights, out, lost);
}

}  // namespace pointbased::kernels
#endif
