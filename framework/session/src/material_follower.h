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

/// Finds material points again in a displacement that is told by present places: x with x - u(x) = X. What of the image
/// stays, or has been left, is nothing to it. Any thread.
class MaterialFollower {
 public:
  /// @param u          must outlive it
  /// @param reference  around all that will be followed
  /// @param own        ownPoints(); empty: all is of its body
  MaterialFollower(const imaging::DisplacementGrid &u, const imaging::WorldBox &reference,
                   std::vector<std::uint8_t> own);

  struct Found {
    Vec3 displacement{};
    double J = 1.0;  ///< det F
  };
  /// Nothing: the displacement does not lead there.
  [[nodiscard]] std::optional<Found> find(const Vec3 &X) const;
  /// The displacement alone, within a fiftieth of a step; quick where it is near one that is known, as that of a moment
  /// ago.
  [[nodiscard]] std::optional<Vec3> findNear(const Vec3 &X, const Vec3 &known) const;

 private:
  using Mat3 = std::array<Vec3, 3>;  // columns
  /// A present place.
  struct Seed {
    Vec3 x{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};  ///< NaN: none
    bool isInside = false;                                       ///< of the body, not only beside it
  };

  [[nodiscard]] std::optional<Found> findFrom(Vec3 x, const Vec3 &X) const;
  /// About how far a place is from points inside the body, mm; infinity: farther than a step.
  [[nodiscard]] double outsideAt(const Vec3 &x) const;
  [[nodiscard]] bool isOwnAt(const Vec3 &x) const;
  /// dX/dx
  [[nodiscard]] Mat3 inverseGradient(const Vec3 &x) const;
  [[nodiscard]] std::optional<std::size_t> cellOf(const Vec3 &X, const std::array<int, 3> &beside) const;
  /// Near first, those inside of the body before those beside it.
  [[nodiscard]] std::vector<Vec3> seedsOf(const Vec3 &X) const;

  const imaging::DisplacementGrid &u_;
  std::vector<std::uint8_t> own_;
  Mat4 toIndex_;
  Vec3 low_;
  double step_ = 1.0;
  std::array<std::size_t, 3> size_{};
  std::vector<Seed> seeds_;  ///< by cells of the reference, two steps wide
};

/// Of each point of a grid whether it is inside a body or beside it, and not inside another one: where bodies, or
/// pieces of one, have moved apart what lies between them goes with either. 0: neither. Empty: its skin is not known.
[[nodiscard]] std::vector<std::uint8_t> ownPoints(const std::vector<BodyState> &bodies, const std::string &name,
                                                  const imaging::VolumeGeometry &grid);

}  // namespace c3de::session
