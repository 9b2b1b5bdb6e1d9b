// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/integrators.h"

namespace pointbased {

/// Fraction of the stable step that is used: margin for changes within a step and for an estimate from below.
inline constexpr double kStepSafety = 0.8;
/// A body with a smaller stable step is integrated implicitly if the integrator is chosen automatically ("auto").
inline constexpr double kSmallestExplicitStep = 2e-6;  // s
/// Step size of implicit integration if it is chosen automatically.
inline constexpr double kImplicitStep = 1.0 / 60.0;  // s

/// Settings that apply to all bodies of a simulation.
struct WorldSettings {
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  WorldBox box;
  Integrator integrator = Integrator::explicitVerlet;
  double dt = 0.0;  ///< s; 0: kStepSafety of the largest stable step, or kImplicitStep. Explicit: divided into substeps
  double damping = 0.0;    ///< 1/s, mass-proportional: velocities decay by exp(-damping t)
  double tolerance = 0.0;  ///< m, of implicit and static solutions; 0: derived from the spacing
  int loadSteps = 0;       ///< static: load increments; 0: 10
  Preconditioner preconditioner = Preconditioner::automatic;
  /// Of the forces of explicit steps; implicit and static solutions use double precision
  Precision precision = Precision::doublePrecision;
  bool sleep = false;       ///< bodies at rest cost nothing until something changes (sleep_detector.h)
  bool rereference = true;  ///< of clouds after large flow (rereferencing.h); false: for comparisons
};

}  // namespace pointbased
