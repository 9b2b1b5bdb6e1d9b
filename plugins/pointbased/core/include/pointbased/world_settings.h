// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/integrators.h"

namespace pointbased {

/// Part of the stable step that is used: room for what changes within a step and for the estimate from below.
inline constexpr double kStepSafety = 0.8;
/// A body whose stable step is smaller than this is integrated implicitly when the step may be chosen ("auto").
inline constexpr double kSmallestExplicitStep = 2e-6;  // s
/// Implicit steps when the step may be chosen.
inline constexpr double kImplicitStep = 1.0 / 60.0;  // s

/// What holds for all bodies of a simulation.
struct WorldSettings {
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  WorldBox box;
  Integrator integrator = Integrator::explicitVerlet;
  double dt = 0.0;         ///< s; 0: kStepSafety of the largest stable step, or kImplicitStep. Explicit: in substeps
  double damping = 0.0;    ///< 1/s, mass-proportional: velocities decay by exp(-damping t)
  double tolerance = 0.0;  ///< m, of implicit and static solutions; 0: by the spacing
  int loadSteps = 0;       ///< static: load increments; 0: 10
  Preconditioner preconditioner = Preconditioner::automatic;
  /// Of the forces of explicit steps; implicit and static ones are double
  Precision precision = Precision::doublePrecision;
  bool sleep = false;       ///< bodies that have come to rest cost nothing until something changes (sleep_detector.h)
  bool rereference = true;  ///< of clouds that have flowed far (rereferencing.h); false: to compare
};

}  // namespace pointbased
