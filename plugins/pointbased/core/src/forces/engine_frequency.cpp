// SPDX-License-Identifier: Apache-2.0
#include "forces/engine_frequency.h"

#include <algorithm>
#include <cmath>

#include "base/expects.h"
#include "forces/point_loops.h"
#include "pointbased/engine.h"

namespace pointbased {
namespace {

std::vector<Vec3> pseudoRandomField(std::size_t n) {
  std::vector<Vec3> field(n);
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  for (Vec3 &v : field)
    for (int c = 0; c < 3; ++c) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      v[c] = static_cast<double>(state >> 40) / static_cast<double>(1u << 24) - 0.5;
    }
  return field;
}

// Σ over phyxels of term(i), in an order that does not depend on how the loop is divided.
class BlockSum {
 public:
  BlockSum(std::size_t n, const ParallelFor &parallelFor)
      : n_(n), parallelFor_(parallelFor), blocks_((n + kBlock - 1) / kBlock) {}

  template <class Term>
  double operator()(const Term &term) {
    detail::runLoop(parallelFor_, blocks_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        double sum = 0.0;
        for (std::size_t i = b * kBlock; i < std::min(n_, (b + 1) * kBlock); ++i) sum += term(i);
        blocks_[b] = sum;
      }
    });
    double sum = 0.0;
    for (const double block : blocks_) sum += block;
    return sum;
  }

 private:
  static constexpr std::size_t kBlock = 256;
  std::size_t n_;
  const ParallelFor &parallelFor_;
  std::vector<double> blocks_;
};

// T of the Lanczos recurrence, whose largest eigenvalue grows towards that of K q = λ M q.
struct Tridiagonal {
  std::vector<double> diagonal, below;  // below.back(): coupling with the next vector

  struct Top {
    double value = 0.0;
    double missing = 0.0;  // estimate
  };
  [[nodiscard]] Top top() const {
    const double value = eigenvalue(0), gap = diagonal.size() > 1 ? value - eigenvalue(1) : value;
    // Eigenvector, computed from its end, where it is smallest if the value has converged.
    double here = 1.0, behind = 0.0, squares = 1.0;
    for (std::size_t i = diagonal.size(); i-- > 1;) {
      const double coupled = i + 1 < diagonal.size() ? below[i] * behind : 0.0;
      behind = here;
      here = ((value - diagonal[i]) * here - coupled) / below[i - 1];
      squares += here * here;
    }
    const double residual = below.back() / std::sqrt(squares);
    return {value, residual < gap ? residual * residual / gap : residual};
  }

 private:
  // Bisection: a Sturm sequence counts the eigenvalues above a value.
  [[nodiscard]] double eigenvalue(std::size_t fromTop) const {
    double high = 0.0;
    for (std::size_t i = 0; i < diagonal.size(); ++i)
      high = std::max(high, diagonal[i] + (i > 0 ? below[i - 1] : 0.0) + (i + 1 < diagonal.size() ? below[i] : 0.0));
    double low = 0.0;
    for (const double tiny = 1e-300 + 1e-14 * high; high - low > tiny;) {
      const double middle = 0.5 * (low + high);
      std::size_t above = 0;
      double pivot = 1.0;
      for (std::size_t i = 0; i < diagonal.size(); ++i) {
        pivot = diagonal[i] - middle - (i > 0 ? below[i - 1] * below[i - 1] / pivot : 0.0);
        if (std::abs(pivot) < tiny) pivot = -tiny;
        if (pivot > 0.0) ++above;
      }
      (above > fromTop ? low : high) = middle;
    }
    return low;
  }
};

}  // namespace

// Lanczos recurrence without reorthogonalisation: loss of orthogonality only produces copies of the same eigenvalues.
double detail::largestFrequencyOf(const StiffnessProduct &product, std::span<const double> masses,
                                  std::span<const double> extra, const ParallelFor &parallelFor) {
  constexpr std::size_t kFewest = 12, kMost = 200, kBetweenChecks = 4;
  constexpr double kAccuracy = 5e-4;
  const std::size_t n = masses.size();
  std::vector<Vec3> before(n, Vec3::Zero()), mode = pseudoRandomField(n), next(n);
  BlockSum sum(n, parallelFor);
  double norm = std::sqrt(sum([&](std::size_t i) { return masses[i] * mode[i].squaredNorm(); }));
  if (!(norm > 0.0)) return 0.0;
  Tridiagonal t;
  Tridiagonal::Top top;
  double coupling = 0.0;
  while (t.diagonal.size() < kMost) {
    (void)sum([&](std::size_t i) {
      mode[i] /= norm;
      return 0.0;
    });
    product(mode, next);
    const double here = sum([&](std::size_t i) {
      next[i] = extra.empty() ? Vec3(-next[i]) : Vec3(extra[i] * mode[i] - next[i]);
      return mode[i].dot(next[i]);
    });
    norm = std::sqrt(sum([&](std::size_t i) {
      next[i] = next[i] / masses[i] - here * mode[i] - coupling * before[i];
      return masses[i] * next[i].squaredNorm();
    }));
    t.diagonal.push_back(here);
    t.below.push_back(norm);
    coupling = norm;
    const std::size_t k = t.diagonal.size();
    const bool isInvariant = !(norm > 1e-6 * *std::max_element(t.diagonal.begin(), t.diagonal.end()));
    if (isInvariant || k == kMost || (k >= kFewest && k % kBetweenChecks == 0)) {
      const double known = top.value;
      top = t.top();
      if (isInvariant || (top.missing <= kAccuracy * top.value && top.value - known <= kAccuracy * top.value)) break;
    }
    before.swap(mode);
    mode.swap(next);
  }
  return std::sqrt(std::max(0.0, top.value));
}

double largestFrequency(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                        std::span<const double> masses, std::span<const double> extra, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && masses.size() == X.size(),
                     "one position and one mass per phyxel");
  const std::vector<Vec3> rest(X.size(), Vec3::Zero());
  const std::vector<Mat3> identity(s.pointCount(), Mat3::Identity());
  const PointHistory fresh;
  TangentScratch scratch;
  return detail::largestFrequencyOf(
      [&](std::span<const Vec3> du, std::span<Vec3> df) {
        forceDifferential(constitution, s, X, rest, identity, fresh, 0.0, 0.0, du, scratch, df, parallelFor);
      },
      masses, extra, parallelFor);
}

}  // namespace pointbased
