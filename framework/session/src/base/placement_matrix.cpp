// SPDX-License-Identifier: Apache-2.0
#include "base/placement_matrix.h"

#include <cmath>
#include <numbers>

#include "c3de/scene/simulation.h"

namespace c3de::session {

Mat4 matrixOf(const scene::ScenePlacement &placement) {
  if (placement.matrix) {
    Mat4 m = *placement.matrix;
    for (const std::size_t i : {12, 13, 14}) m[i] *= scene::kMillimetresPerMetre;
    return m;
  }
  Mat4 m = kIdentity4;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double angle = placement.rotation_deg[axis] * std::numbers::pi / 180.0;
    const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    Mat4 turn = kIdentity4;
    turn[5 * b] = turn[5 * c] = std::cos(angle);
    turn[4 * b + c] = std::sin(angle);
    turn[4 * c + b] = -std::sin(angle);
    m = multiply(turn, m);
  }
  for (std::size_t i = 0; i < 12; ++i) m[i] *= i % 4 == 3 ? 1.0 : placement.scale;
  for (std::size_t axis = 0; axis < 3; ++axis) m[12 + axis] = scene::kMillimetresPerMetre * placement.position_m[axis];
  return m;
}

}  // namespace c3de::session
