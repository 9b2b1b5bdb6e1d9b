// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pointbased/diagnostics.h"
#include "pointbased/state_archive.h"
#include "pointbased/stepper.h"
#include "pointbased/world.h"

namespace pointbased {

/// Simulates bodies and obstacles in time. The stages of a step are composed from what the scene contains: no viscous
/// stage without viscosity, no contact without an obstacle or the box. Surfels are computed on request.
///
/// The guard checks every body after every step. A body with non-finite values or with an energy gain returns to the
/// state before the step and retries with smaller steps. If that does not help, it stops there with an event that names
/// the phyxel, the quantity and the setting that would help; the other bodies continue.
///
/// One thread at a time. Results are bitwise identical for any number of threads behind parallelFor.
///
/// The most used functions of its parts are here; the others are reached through the parts.
class Simulator {
 public:
  explicit Simulator(ParallelFor parallelFor = serialFor());
  ~Simulator();

  [[nodiscard]] World &world() { return world_; }
  [[nodiscard]] const World &world() const { return world_; }
  [[nodiscard]] Stepper &stepper() { return stepper_; }
  [[nodiscard]] const Stepper &stepper() const { return stepper_; }
  [[nodiscard]] StateArchive &archive() { return archive_; }
  [[nodiscard]] const StateArchive &archive() const { return archive_; }
  [[nodiscard]] Diagnostics &diagnostics() { return diagnostics_; }
  [[nodiscard]] const Diagnostics &diagnostics() const { return diagnostics_; }

  // See World.
  void setWorld(const WorldSettings &settings) { world_.setSettings(settings); }
  std::size_t addBody(std::unique_ptr<Body> body) { return world_.addBody(std::move(body)); }
  std::size_t addObstacle(Obstacle obstacle) { return world_.addObstacle(std::move(obstacle)); }
  bool removeBody(std::size_t id) { return world_.removeBody(id); }
  bool removeObstacle(std::size_t id) { return world_.removeObstacle(id); }
  void clear() { world_.clear(); }
  [[nodiscard]] Body *body(std::size_t id) { return world_.body(id); }
  [[nodiscard]] const Body *body(std::size_t id) const { return std::as_const(world_).body(id); }
  [[nodiscard]] std::vector<std::size_t> bodyIds() const { return world_.bodyIds(); }

  /// Stepper::step().
  [[nodiscard]] tl::expected<void, StepFailure> step(const StopRequest *stop = nullptr) { return stepper_.step(stop); }
  /// Stepper::failed().
  [[nodiscard]] bool failed() const { return stepper_.failed(); }
  /// Returns everything to the initial state, bit for bit: time 0, no grabs.
  void reset();
  [[nodiscard]] double time() const;
  /// Quasi-static: 0 … 1; otherwise 1.
  [[nodiscard]] double loadFactor() const;
  [[nodiscard]] bool quasiStatic() const;
  [[nodiscard]] bool finished() const;
  [[nodiscard]] std::uint64_t steps() const;
  /// FNV-1a over displacements, velocities and plastic state of every phyxel, bodies in the order in which they were
  /// added.
  [[nodiscard]] std::uint64_t stateHash() const;

 private:
  std::unique_ptr<detail::SimulationState> state_;
  World world_;
  Stepper stepper_;
  StateArchive archive_;
  Diagnostics diagnostics_;
};

}  // namespace pointbased
