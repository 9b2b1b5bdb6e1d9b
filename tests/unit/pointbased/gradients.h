// SPDX-License-Identifier: Apache-2.0
// Deformation gradients for tests of material laws.
#pragma once

#include <cmath>

#include "pointbased/material.h"
#include "shapes.h"

namespace gradients {

using pointbased::Mat3;
using pointbased::Material;
using pointbased::MaterialLaw;
using pointbased::Vec3;

inline constexpr MaterialLaw kLaws[] = {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                        MaterialLaw::neoHookean};
inline constexpr MaterialLaw kObjectiveLaws[] = {MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                                 MaterialLaw::neoHookean};

inline Mat3 rotation(shapes::Random &random) {
  const Vec3 axis = (random.vector() + Vec3(1e-3, 0, 0)).normalized();
  return Eigen::AngleAxisd(3.14159265358979323846 * random(), axis).toRotationMatrix();
}

inline Mat3 any(shapes::Random &random) {
  Mat3 m;
  for (int c = 0; c < 3; ++c) m.col(c) = random.vector();
  return m;
}

inline Mat3 withStretches(shapes::Random &random, const Vec3 &stretches) {
  return rotation(random) * stretches.asDiagonal() * rotation(random);
}

/// Stretches from 1/largest to largest, uniform in logarithm; mirrored: det F < 0.
inline Mat3 stretched(shapes::Random &random, double largest, bool mirrored = false) {
  Vec3 s;
  for (int i = 0; i < 3; ++i) s[i] = std::pow(largest, random());
  if (mirrored) s[0] = -s[0];
  return withStretches(random, s);
}

inline Mat3 shear(double gamma) {
  Mat3 F = Mat3::Identity();
  F(0, 1) = gamma;
  return F;
}

inline double dot(const Mat3 &a, const Mat3 &b) { return a.cwiseProduct(b).sum(); }

}  // namespace gradients
