// SPDX-License-Identifier: Apache-2.0
// Supports and loads on a part of the surface of a body, set while it is simulated.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointbased/types.h"
#include "simulator/object_name.h"

namespace pointbased {

/// A part of the surface in the reference: independent of how the body is sampled.
struct SurfacePatch {
  std::vector<Vec3> positions;                          ///< world, m
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  template <class Coder>
  void walk(Coder &coder) {
    coder(positions, triangles);
  }
};
/// m².
[[nodiscard]] double areaOf(const SurfacePatch &patch);
/// Area-weighted, not normalised: m², outwards.
[[nodiscard]] Vec3 areaVectorOf(const SurfacePatch &patch);

enum class ConditionKind : std::uint8_t {
  fix,       ///< holds the points where they are when it is set, or at rest
  displace,  ///< moves them by `vector` from there, at constant velocity
  force,     ///< `vector` in total, distributed by area
  pressure,  ///< `pressure`, along the present normal
};

/// "fix", "displace", "force", "pressure".
[[nodiscard]] std::string_view nameOf(ConditionKind kind);

struct SurfaceCondition {
  std::string name;
  ObjectName body;
  SurfacePatch patch;
  ConditionKind kind = ConditionKind::fix;
  Vec3 vector = Vec3::Zero();  ///< N or m
  double pressure = 0.0;       ///< Pa, positive into the body
  double ramp = 0.0;           ///< s, of simulated time, until a value that was set is reached
  bool atRest = false;         ///< of fix: returns the points to their reference during the ramp
  template <class Coder>
  void walk(Coder &coder) {
    auto number = static_cast<std::uint8_t>(kind);
    coder(name, body, patch, number, vector, pressure, ramp, atRest);
    kind = static_cast<ConditionKind>(number);
  }
  [[nodiscard]] bool isSupport() const { return kind == ConditionKind::fix || kind == ConditionKind::displace; }
};

// Largest accepted values.
inline constexpr double kMaxForce = 1e5;         ///< N, magnitude
inline constexpr double kMaxPressure = 1e7;      ///< Pa, magnitude
inline constexpr double kMaxDisplacement = 1.0;  ///< m, magnitude
inline constexpr double kMaxRamp = 3600.0;       ///< s

/// Why it is refused: what, which value, what is accepted. Empty: it is accepted.
[[nodiscard]] std::string problemOf(const SurfaceCondition &condition);

/// Present state of a condition.
struct ConditionSnapshot {
  std::uint64_t number = 0;
  SurfaceCondition condition;
  std::uint64_t body = 0;       ///< id
  double area = 0.0;            ///< m², in the reference
  Vec3 force = Vec3::Zero();    ///< N, on the body: the reaction of a support, the resultant of a load
  std::vector<Vec3> positions;  ///< world, m, of the patch
  std::string warning;          ///< why it has no effect; empty: it has one
};

}  // namespace pointbased
