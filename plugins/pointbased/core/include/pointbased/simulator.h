// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "pointbased/body.h"
#include "pointbased/contact.h"
#include "pointbased/stage_clock.h"

namespace pointbased {

/// Part of the stable step that is used: room for what changes within a step and for the estimate from below.
inline constexpr double kStepSafety = 0.8;

struct WorldSettings {
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  WorldBox box;
  double dt = 0.0;       ///< s; 0: kStepSafety of the largest stable step. A larger one is divided into substeps
  double damping = 0.0;  ///< 1/s, mass-proportional: velocities decay by exp(-damping t)
};

/// A damped spring between some phyxels and a point that somebody moves: the pinch.
struct Grab {
  std::vector<Index> phyxels;
  std::vector<double> weights;  ///< sum 1; the grabbed point is Σ w x
  Vec3 target = Vec3::Zero();   ///< world, m
  double frequency = 50.0;      ///< rad/s of the mass it holds; lowered where the step would not carry it
  double dampingRatio = 1.0;
  double maxForce = std::numeric_limits<double>::infinity();  ///< N: a tool that is torn away must not tear the body apart
};

struct GrabStatus {
  Vec3 point = Vec3::Zero();  ///< world, m, where the grabbed point is
  Vec3 force = Vec3::Zero();  ///< N
  double mass = 0.0;          ///< kg that it holds
};

struct Probe {
  std::string name;
  std::size_t body = 0;
  Vec3 reference = Vec3::Zero();  ///< world, m
  SurfelBinding binding;
};

struct SimulationEvent {
  double time = 0.0;  ///< s
  std::string kind;   ///< substep | diverged
  std::string text;
};

/// Why a step was refused.
struct StepFailure {
  std::string text;  ///< body, phyxel, quantity, and the setting that would help
};

/// Bodies, obstacles and the clock. Composes the stages of a step from what the scene has: no viscous stage without
/// viscosity, no contact without obstacle or box; surfels move when somebody asks.
///
/// One thread at a time. The same bits for any number of threads behind parallelFor.
class Simulator {
 public:
  explicit Simulator(ParallelFor parallelFor = serialFor());

  [[nodiscard]] const WorldSettings &world() const { return world_; }
  void setWorld(const WorldSettings &world);

  /// Ids stay valid until the body is removed; they are not reused.
  std::size_t addBody(std::unique_ptr<Body> body);
  std::size_t addObstacle(Obstacle obstacle);
  bool removeBody(std::size_t id);
  bool removeObstacle(std::size_t id);
  void clear();
  [[nodiscard]] Body *body(std::size_t id);
  [[nodiscard]] const Body *body(std::size_t id) const;
  [[nodiscard]] std::vector<std::size_t> bodyIds() const;
  void addProbe(std::string name, std::size_t body, const Vec3 &reference);
  [[nodiscard]] const std::vector<Probe> &probes() const { return probes_; }
  struct ProbeState {
    Vec3 position, velocity;  ///< world, m and m/s
  };
  [[nodiscard]] ProbeState probeState(const Probe &probe) const;

  /// Material of a body while it runs; forces and the step follow.
  void setMaterial(std::size_t body, const Material &material, double stabilisation);

  /// One step of the present step size, in as many substeps as stability needs. On failure the state before the step
  /// stays, and further steps are refused until reset().
  [[nodiscard]] tl::expected<void, StepFailure> step();
  /// To the initial state of everything, bit for bit; time 0, nothing grabbed.
  void reset();

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] double stepSize() const;  ///< s, of the next step
  [[nodiscard]] bool failed() const { return failed_; }

  void setGrab(std::size_t body, Grab grab);
  void moveGrab(std::size_t body, const Vec3 &target);
  void releaseGrab(std::size_t body);
  [[nodiscard]] std::optional<GrabStatus> grabStatus(std::size_t body) const;

  /// World positions and normals of a body's surfels.
  void surfels(std::size_t body, std::vector<Vec3> &positions, std::vector<Vec3> &normals);

  struct Energy {
    double kinetic = 0.0, elastic = 0.0, stabilisation = 0.0, gravity = 0.0;  ///< J; gravity relative to the start
  };
  [[nodiscard]] Energy energy(std::size_t body) const;

  /// FNV-1a over displacements and velocities of every phyxel, bodies in the order they were added.
  [[nodiscard]] std::uint64_t stateHash() const;

  [[nodiscard]] const std::vector<SimulationEvent> &events() const { return events_; }
  [[nodiscard]] std::vector<StageClock::Summary> stageTimes() const { return clock_.summary(); }

 private:
  enum Stage : std::size_t { kGradients, kStresses, kForces, kContact, kIntegrate, kSurfels };

  void evaluateForces(Body &body);
  void substep(double dt);
  void applyGrab(std::size_t id, Body &body);
  [[nodiscard]] std::optional<std::string> firstNonFinite() const;
  void note(const std::string &kind, const std::string &text);

  ParallelFor parallelFor_;
  WorldSettings world_;
  std::map<std::size_t, std::unique_ptr<Body>> bodies_;
  std::vector<Obstacle> obstacles_;
  std::vector<std::size_t> obstacleIds_;
  std::vector<Probe> probes_;
  std::map<std::size_t, Grab> grabs_;
  std::map<std::size_t, GrabStatus> grabStatus_;
  std::size_t nextId_ = 1;
  double time_ = 0.0;
  std::uint64_t steps_ = 0;
  bool failed_ = false;
  bool forcesCurrent_ = false;
  double presentDt_ = 0.0;
  std::uint64_t mostSubsteps_ = 1;
  std::vector<SimulationEvent> events_;
  StageClock clock_;
};

}  // namespace pointbased
