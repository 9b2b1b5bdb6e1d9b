// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "c3de/imaging/displacement.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/session/body_states.h"

namespace c3de::session {

/// Finds material points again in a displacement given at present positions: x with x - u(x) = X. Fixed and vacated
/// regions of the image have no effect on it. Any thread.
class MaterialFollower {
 public:
  /// @param u          must outlive it
  /// @param reference  encloses all points to be tracked
  /// @param own        ownPoints(); empty: all points belong to its body
  MaterialFollower(const imaging::DisplacementGrid &u, const imaging::WorldBox &reference,
                   std::vector<std::uint8_t> own);

  struct Found {
    Vec3 displacement{};
    double J = 1.0;  ///< det F
  };
  /// None: the displacement does not reach the point.
  [[nodiscard]] std::optional<Found> find(const Vec3 &X) const;
  /// The displacement alone, within a fiftieth of a step. Fast where it is close to a known one, such as the previous
  /// one.
  [[nodiscard]] std::optional<Vec3> findNear(const Vec3 &X, const Vec3 &known) const;

 private:
  using Mat3 = std::array<Vec3, 3>;  // columns
  /// A present position.
  struct Seed {
    Vec3 x{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};  ///< NaN: none
    bool isInside = false;                                       ///< inside the body, not only next to it
  };

  [[nodiscard]] std::optional<Found> findFrom(Vec3 x, const Vec3 &X) const;
  /// Approximate distance of a position from points inside the body, mm; infinity: farther than a step.
  [[nodiscard]] double outsideAt(const Vec3 &x) const;
  [[nodiscard]] bool isOwnAt(const Vec3 &x) const;
  /// dX/dx
  [[nodiscard]] Mat3 inverseGradient(const Vec3 &x) const;
  [[nodiscard]] std::optional<std::size_t> cellOf(const Vec3 &X, const std::array<int, 3> &beside) const;
  /// Nearest first, those inside the body before those next to it.
  [[nodiscard]] std::vector<Vec3> seedsOf(const Vec3 &X) const;

  const imaging::DisplacementGrid &u_;
  std::vector<std::uint8_t> own_;
  Mat4 toIndex_;
  Vec3 low_;
  double step_ = 1.0;
  std::array<std::size_t, 3> size_{};
  std::vector<Seed> seeds_;  ///< by cells of the reference, two steps wide
};

/// Whether each point of a grid is inside a body or next to it, and not inside another one. Where bodies, or pieces of
/// one, have moved apart, the space between them belongs to both. 0: neither. Empty: its skin is not known.
[[nodiscard]] std::vector<std::uint8_t> ownPoints(const std::vector<BodyState> &bodies, const std::string &name,
                                                  const imaging::VolumeGeometry &grid);

}  // namespace c3de::session
