// SPDX-License-Identifier: Apache-2.0
#include "reference/surfel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reference {

Vec3 surfelDisplacement(const Body &body, const Vec3 &point, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> byDistance;
  for (std::size_t i = 0; i < body.X.size(); ++i) byDistance.emplace_back((point - body.X[i]).norm(), i);
  std::sort(byDistance.begin(), byDistance.end());
  byDistance.resize(std::min(count, byDistance.size()));

  const double h = byDistance.back().first;
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for (const auto &[r, i] : byDistance) {
    const double w = h > 0.0 ? std::exp(-r * r / (h * h)) : 1.0;
    sum += w * (body.u[i] + (body.J[i] - Mat3::Identity()) * (point - body.X[i]));
    weights += w;
  }
  return sum / weights;
}

}  // namespace reference
