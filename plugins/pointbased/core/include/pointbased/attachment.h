// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "pointbased/region.h"
#include "pointbased/types.h"

namespace pointbased {

/// Id of the tissue around a body in the scan, used in place of the id of a body or an obstacle.
inline constexpr std::size_t kSurroundings = 0;

/// An elastic layer that joins the surface of a body to another body, to an obstacle, or to the position of the surface
/// in the reference. Its springs per area join points that coincide in the reference:
///
///     U = ½ Σ_p A_p d_p · K_p d_p,    K_p = k_n n_p n_p^T + k_t (I - n_p n_p^T),    d_p = u_1(X_p) - u_2(X_p)
///
/// over the points X_p of the surface of the first body, with n its normal, rotated with the body. u_2 is extrapolated
/// linearly from the nearest point of the second body, so bodies that rotate together do not stretch the layer, however
/// far apart they are. With k_n = k_t the layer conserves linear and angular momentum; otherwise a moment d × K d
/// remains. A point is released permanently when the tension and shear of its traction exceed `tearsAt`; compression
/// does not count.
struct Attachment {
  std::string name;
  std::size_t first = 0;                                    ///< id of a body that has a surface
  std::size_t second = kSurroundings;                       ///< id of another body or an obstacle, or kSurroundings
  Region region = EverywhereRegion{};                       ///< of the first body, material coordinates, world, m
  double within = std::numeric_limits<double>::infinity();  ///< m, > 0: largest distance of the two surfaces
  double stiffness = 0.0;                                   ///< k_n, Pa/m, finite, >= 0
  double tangential = 0.0;                                  ///< k_t, Pa/m, finite, >= 0
  double tearsAt = 0.0;                                     ///< Pa, finite, >= 0; 0: it never tears
};
/// Errors: text names the number, its value and the accepted range.
[[nodiscard]] Result<void> validate(const Attachment &attachment);

/// Present state of an attachment.
struct AttachmentSummary {
  std::size_t id = 0;
  std::size_t first = 0, second = 0;
  std::string name;
  double area = 0.0;           ///< m², of the layer before any of it tore
  double tornPart = 0.0;       ///< 0 … 1, of the area
  Vec3 force = Vec3::Zero();   ///< N, on the first
  Vec3 torque = Vec3::Zero();  ///< N m, on the first, about `centre`
  Vec3 centre = Vec3::Zero();  ///< m, world, of the layer in the reference
  double energy = 0.0;         ///< J
  double traction = 0.0;       ///< Pa, largest
};

}  // namespace pointbased
