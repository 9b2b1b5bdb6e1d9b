// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "pointbased/types.h"

namespace peers {

using pointbased::Vec3;

struct Solid {
  double youngsModulus = 1e4;  ///< Pa
  double poissonRatio = 0.3;
  double density = 1000.0;  ///< kg/m³
};

inline const Vec3 kGravity(0.0, 0.0, -9.81);  // m/s²

/// A body that falls from rest under gravity, partly fixed, with a fixed step: the common interface of all engines.
class MovingBody {
 public:
  virtual ~MovingBody() = default;
  /// One step.
  /// @return s of simulated time; 0: the engine has reported failure
  virtual double step() = 0;
  /// Kinetic energy minus the work of gravity since the start, J: positive only by errors of the integration. Not
  /// finite where the state is not.
  [[nodiscard]] virtual double surplus() const = 0;
  /// The measured displacement (mean over a part of the body), m.
  [[nodiscard]] virtual Vec3 displacement() const = 0;
  /// m: largest displacement of a node.
  [[nodiscard]] virtual double largestDisplacement() const = 0;
  /// Stops all motion; the shape is unchanged.
  virtual void stop() = 0;
  [[nodiscard]] virtual double kineticEnergy() const = 0;
};

}  // namespace peers
