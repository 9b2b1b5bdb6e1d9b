// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pointbased/engine.h"

#include "base/expects.h"

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

}  // namespace

double largestFrequency(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                        std::span<const double> masses, std::span<const double> extra, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && masses.size() == X.size(),
                     "one position and one mass per phyxel");
  const std::size_t n = X.size();
  if (n == 0) return 0.0;
  const std::vector<Vec3> rest(n, Vec3::Zero());
  const std::vector<Mat3> identity(s.pointCount(), Mat3::Identity());
  const PointHistory fresh;
  TangentScratch scratch;
  std::vector<Vec3> mode = pseudoRandomField(n), force(n);

  double eigenvalue = 0.0, lastGain = 0.0;
  constexpr int kIterations = 60;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    forceDifferential(constitution, s, X, rest, identity, fresh, 0.0, 0.0, mode, scratch, force, parallelFor);
    // Rayleigh quotient in the mass norm, then the next vector M^-1 K u.
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      force[i] = -force[i];
      if (!extra.empty()) force[i] += extra[i] * mode[i];
      top += mode[i].dot(force[i]);
      bottom += masses[i] * mode[i].squaredNorm();
    }
    if (!(bottom > 0.0)) return 0.0;
    const double gain = top / bottom - eigenvalue;
    eigenvalue = std::max(eigenvalue, top / bottom);
    // What geometric convergence has still to bring, from the last two gains.
    const double ratio = gain / lastGain;
    if (iteration > 8 && ratio < 1.0 && gain * ratio <= 1e-3 * (1.0 - ratio) * eigenvalue) break;
    lastGain = gain;
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      mode[i] = force[i] / masses[i];
      largest = std::max(largest, mode[i].cwiseAbs().maxCoeff());
    }
    if (!(largest > 0.0)) return 0.0;
    for (Vec3 &v : mode) v /= largest;
  }
  return std::sqrt(std::max(0.0, eigenvalue));
}

}  // namespace pointbased
