// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "pointbased/region.h"
#include "pointbased/types.h"

namespace pointbased {

/// Stands for what surrounds a body in the scan where the id of a body or an obstacle is asked for.
inline constexpr std::size_t kSurroundings = 0;

/// An elastic layer between the surface of a body and another body, an obstacle, or where the surface is in the
/// reference: springs per area between points that are at the same place in the reference,
///
///     U = ½ Σ_p A_p d_p · K_p d_p,    K_p = k_n n_p n_p^T + k_t (I - n_p n_p^T),    d_p = u_1(X_p) - u_2(X_p)
///
/// over the points X_p of the surface of the first body, n its normal as it has turned. u_2 is continued linearly from
/// the nearest point of the second body, so bodies that turn together stretch nothing, however far they are apart. With
/// k_n = k_t the layer keeps linear and angular momentum; else a moment d × K d remains. A point at which the layer
/// pulls with more than `tearsAt` is free from then on.
struct Attachment {
  std::string name;
  std::size_t first = 0;                                    ///< id of a body that has a surface
  std::size_t second = kSurroundings;                       ///< id of another body or an obstacle, or kSurroundings
  Region region = EverywhereRegion{};                       ///< of the first body, material coordinates, world, m
  double within = std::numeric_limits<double>::infinity();  ///< m, > 0: where the two surfaces are that near
  double stiffness = 0.0;                                   ///< k_n, Pa/m, finite, >= 0
  double tangential = 0.0;                                  ///< k_t, Pa/m, finite, >= 0
  double tearsAt = 0.0;                                     ///< Pa, finite, >= 0; 0: it does not tear
};
/// Errors: which number, its value and what is accepted.
[[nodiscard]] Result<void> validate(const Attachment &attachment);

/// What an attachment does now.
struct AttachmentSummary {
  std::size_t id = 0;
  std::size_t first = 0, second = 0;
  std::string name;
  double area = 0.0;           ///< m², of the layer before it tore
  double tornPart = 0.0;       ///< 0 … 1, of the area
  Vec3 force = Vec3::Zero();   ///< N, on the first
  Vec3 torque = Vec3::Zero();  ///< Nm, on the first, about `centre`
  Vec3 centre = Vec3::Zero();  ///< m, world, of the layer in the reference
  double energy = 0.0;         ///< J
  double traction = 0.0;       ///< Pa, the largest
};

}  // namespace pointbased
