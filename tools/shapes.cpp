// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <algorithm>
#include <cmath>

namespace c3de::tools {

double ellipsoid(const Vec3 &p, const Vec3 &centre, const Vec3 &radii) {
  const Vec3 d = p - centre;
  double k0 = 0.0, k1 = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double s = d[k] / radii[k];
    k0 += s * s;
    k1 += s * s / (radii[k] * radii[k]);
  }
  k0 = std::sqrt(k0);
  k1 = std::sqrt(k1);
  return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -std::min({radii[0], radii[1], radii[2]});
}

Vec3 turned(const Vec3 &p, const Vec3 &centre, std::size_t axis, double degrees) {
  const double c = std::cos(degrees * 0.017453292519943295), s = std::sin(degrees * 0.017453292519943295);
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  Vec3 q = p;
  q[u] = centre[u] + c * (p[u] - centre[u]) + s * (p[v] - centre[v]);
  q[v] = centre[v] - s * (p[u] - centre[u]) + c * (p[v] - centre[v]);
  return q;
}

double blend(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - 0.25 * width * h * h;
}

double carve(double body, double tool, double width) { return -blend(-body, tool, width); }

double liver(const Vec3 &p) {
  const Vec3 right{-34, 0, 0}, tail{-50, 4, -34}, left{42, -10, 16}, tip{78, -14, 22};
  double d = ellipsoid(turned(p, right, 1, 12.0), right, {62, 50, 58});
  d = blend(d, ellipsoid(p, tail, {40, 36, 42}), 24.0);
  d = blend(d, ellipsoid(turned(p, left, 1, -10.0), left, {58, 34, 36}), 30.0);
  d = blend(d, ellipsoid(p, tip, {28, 20, 17}), 20.0);
  const Vec3 hilum{12, 26, -44}, notch{18, -44, -36}, fossa{-22, -22, -86};
  d = carve(d, ellipsoid(turned(p, hilum, 1, -25.0), hilum, {48, 34, 36}), 18.0);
  d = carve(d, ellipsoid(turned(p, notch, 1, 10.0), notch, {9, 30, 36}), 16.0);
  d = carve(d, ellipsoid(p, fossa, {20, 28, 32}), 20.0);
  return d;
}

}  // namespace c3de::tools
