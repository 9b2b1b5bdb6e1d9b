// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"
#include "pointbased/newton.h"
#include "pointbased/stage_clock.h"
#include "pointbased/stop_request.h"

namespace pointbased {

enum class Integrator {
  /// explicitVerlet or implicitSdirk, whichever has the lower predicted cost for the body (Stepper::predictedCost)
  automatic,
  explicitVerlet,    ///< velocity Verlet in substeps below the stable step
  implicitSdirk,     ///< two-stage diagonally implicit Runge-Kutta: second order, damps only what dt does not resolve
  implicitMidpoint,  ///< second order, no numerical damping: conserves energy and momenta, oscillations persist
  backwardEuler,     ///< first order, strongly damped
  quasiStatic        ///< equilibrium at a load factor that grows from 0 to 1
};

/// Stages of a step, as named by the clock.
enum Stage : std::size_t {
  kGradients,
  kFlow,
  kStresses,
  kForces,
  kSupports,
  kContact,
  kIntegrate,
  kSolve,
  kGuard,
  kSurfels,
  kStages
};
[[nodiscard]] std::vector<std::string> stageNames();

/// Environment of a step of a body.
struct Environment {
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  double damping = 0.0;         ///< 1/s, mass-proportional
  std::span<const Obstacle> obstacles;
  WorldBox box;
  double tolerance = 0.0;  ///< m, of implicit and static solutions; 0: 1e-5 of the spacing (static 1e-6)
  Preconditioner preconditioner = Preconditioner::automatic;
  const ParallelFor *parallelFor = nullptr;
  StageClock *clock = nullptr;
  const StopRequest *stop = nullptr;  ///< raised: Stopped is thrown, the body is left as it is

  [[nodiscard]] bool contact() const { return box.enabled || !obstacles.empty(); }
};

/// One substep of velocity Verlet from time to time + dt. The caller keeps dt below the stable step.
///
/// Half kick, contact impulses, drift, supports, plastic flow, new forces, half kick, projection of contact velocities.
/// Stages that the scene does not need are skipped.
/// @source  Müller et al. 2004 with velocity Verlet; contact as in contact.h, supports as in patch_solver.h
void explicitSubstep(Body &body, const Environment &environment, double time, double dt);

/// Largest speed of an impact of the body within dt, m/s. An impact sets phyxels in relative motion that moved together
/// before. 0: no impact, or none that moves a point farther than `stride` within dt.
/// @param stride     m
/// @param meanSpeed  m/s, of the body; the substep limits speeds relative to it already. Infinite: not determined
[[nodiscard]] double impactSpeed(Body &body, const Environment &environment, double time, double dt, double stride,
                                 double meanSpeed);

struct ImplicitResult {
  NewtonResult newton;
  std::string failure;  ///< empty: success; else the cause; newton.worst is the phyxel
};

/// One implicit step from time to time + dt. On failure the body is left in the failed state: the caller restores it.
///
/// A stage solves  M (v - q)/h = f(u),  u = p + h v  as the minimum of  ½ |u - p - h q|²_M / h² + W(u) + supports +
/// contact - loads; forces without a potential (viscous, relaxing, followers) enter the merit function by their work.
/// Backward Euler: h = dt. Midpoint: h = dt/2, then u <- 2u - u_n. SDIRK2: h = (1 - 1/√2) dt twice.
/// @source  Hairer and Wanner, Solving Ordinary Differential Equations II, ch. IV.6 (SDIRK)
[[nodiscard]] ImplicitResult implicitStep(Body &body, NewtonSolver &solver, const Environment &environment, double time,
                                          double dt, Integrator scheme);

/// Equilibrium at load factor `to`, starting from that at `from`. A body without supports is held by its own inertia in
/// a pseudo time that increases until it is at rest.
[[nodiscard]] ImplicitResult quasiStaticStep(Body &body, NewtonSolver &solver, const Environment &environment,
                                             double from, double to, const std::function<bool()> &shouldContinue = {});

/// Springs of all grabs at the present state: adds their forces to body.forces() and fills ActiveGrab::status.
/// @param stiffnessLimit  rad/s: the sum of all springs stays below it, and each below an equal share; inf: no limit
void applyGrabs(Body &body, double stiffnessLimit);

}  // namespace pointbased
