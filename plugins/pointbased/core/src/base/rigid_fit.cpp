// SPDX-License-Identifier: Apache-2.0
#include "base/rigid_fit.h"

#include "base/polar.h"

namespace pointbased::detail {

RigidFit rigidFit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  RigidFit fit;
  Vec3 middle = Vec3::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    fit.centre += weights[i] * from[i];
    middle += weights[i] * to[i];
    sum += weights[i];
  }
  fit.centre /= sum;
  middle /= sum;
  fit.shift = middle - fit.centre;
  Mat3 product = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    product += weights[i] * (to[i] - middle) * (from[i] - fit.centre).transpose();
  fit.rotation = polarBySvd(product).R;
  return fit;
}

}  // namespace pointbased::detail
