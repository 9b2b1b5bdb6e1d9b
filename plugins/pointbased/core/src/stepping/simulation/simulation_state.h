// SPDX-License-Identifier: Apache-2.0
// The data of a simulation, which its parts (World, Stepper, StateArchive, Diagnostics) share. Private to the core.
#pragma once

#include <map>
#include <memory>
#include <set>

#include "pointbased/simulator.h"
#include "stepping/coupling/attachment_layer.h"
#include "stepping/coupling/skin_contacts.h"
#include "stepping/islands/body_stepper.h"
#include "stepping/islands/island.h"
#include "stepping/monitoring/step_activity.h"

namespace pointbased::detail {

using ObstacleMotion = std::function<RigidMotion(double t)>;

/// Motion of a guided obstacle: at constant rates from one pose to another, where it stays. It rotates by the smaller
/// angle.
struct Guidance {
  RigidMotion from, to;                // about the same centre
  double begin = 0.0, duration = 0.0;  // s, or load factor

  [[nodiscard]] ObstacleMotion motion() const;
};

struct ObstacleSet {
  std::vector<Obstacle> all;
  std::vector<std::size_t> ids;  // of these
  std::set<std::size_t> instruments;
  std::map<std::size_t, ObstacleMotion> ownMotions;  // of guided obstacles: those that reset() restores
  std::map<std::size_t, Guidance> guidances;         // their present motions
};

struct ContactData {
  ContactSettings settings;
  ContactPairs pairs;
  std::uint64_t switches = 0;                                 // increases when a pair is switched on or off
  std::map<std::size_t, std::vector<Obstacle>> rigidTissues;  // of bodies that have such tissue
  // surroundingsOf() bodies with pairs with obstacles or walls, or with rigid tissue
  std::map<std::size_t, std::vector<Obstacle>> surroundings;
};

struct Progress {
  double time = 0.0;        // s
  double loadFactor = 0.0;  // of a quasi-static solution
  std::uint64_t steps = 0;
};

/// What has been reported once and is not reported again.
struct ReportedFindings {
  std::set<std::size_t> torn;                  // attachments
  std::set<std::size_t> notRereferenced;       // bodies whose reference could not be renewed
  std::map<std::size_t, double> skinDeepest;   // m, of the displayed skin, beyond the walls
  std::map<std::size_t, double> rigidDeepest;  // m, of the displayed skin, in rigid tissue of the same body
  std::set<std::pair<std::size_t, std::size_t>> overlaps;
  std::pair<std::size_t, std::size_t> lastPair{0, 0};  // last one checked for overlap
};

struct IslandSet {
  std::vector<std::unique_ptr<Island>> list;  // memory is reused
  std::size_t count = 0;
  std::set<std::size_t> members;          // bodies
  std::set<std::size_t> touchThemselves;  // bodies that may touch themselves in this step
};

struct ComputingTime {
  std::map<std::size_t, double> seconds;  // of wall-clock time, by body
  double advanced = 0.0;                  // s simulated in that time
};

struct SimulationState {
  explicit SimulationState(ParallelFor loopsOfCaller);

  [[nodiscard]] bool quasiStatic() const { return settings.integrator == Integrator::quasiStatic; }
  [[nodiscard]] bool finished() const { return quasiStatic() && progress.loadFactor >= 1.0 - 1e-12; }
  [[nodiscard]] double time() const { return quasiStatic() ? 0.0 : progress.time; }
  /// Time or load factor: the argument of ramps.
  [[nodiscard]] double rampTime() const { return quasiStatic() ? progress.loadFactor : progress.time; }
  [[nodiscard]] double stepSize() const;
  [[nodiscard]] Body *body(std::size_t id) const;
  [[nodiscard]] const Obstacle *obstacle(std::size_t id) const;
  void reportEvent(const std::string &kind, const std::string &text);
  void addWarning(std::size_t id, const std::string &text);

  [[nodiscard]] ContactPairSettings contactPair(std::size_t a, std::size_t b) const;
  /// Everything that contact points of the body collide with: its own rigid tissue, then World::obstaclesOf().
  [[nodiscard]] std::span<const Obstacle> surroundingsOf(std::size_t body) const;
  /// Number of these that are its own.
  [[nodiscard]] std::size_t ownObstacleCount(std::size_t body) const;
  /// Call after a change of pairs or obstacles.
  void updateSurroundings(std::size_t body);
  void updateSurroundings();

  bool removeObstacle(std::size_t id);
  /// For an obstacle, and for what is attached to it. Empty: static.
  void setMotion(std::size_t obstacle, ObstacleMotion motion);
  /// setMotion() until reset().
  void guide(std::size_t obstacle, const Guidance &guidance);
  bool removeAttachment(std::size_t id);
  void removeAttachmentsOf(std::size_t id);
  /// Call after a change of attachments, masses or what moves.
  void updateAttachments();
  [[nodiscard]] AttachmentLayer::AttachedState attachedState(const AttachmentLayer &layer) const;
  /// @param shifts  [probes] Probe::referenceShift of those of the body
  void bindProbes(std::size_t body, std::span<const Vec3> shifts);
  void reset();

  ParallelFor plainLoops;
  StoppableLoops loops;
  const ParallelFor &parallelFor = loops.parallelFor();
  WorldSettings settings;
  std::map<std::size_t, std::unique_ptr<BodyStepper>> bodies;
  ObstacleSet obstacles;
  std::set<std::size_t> placed;  // obstacles at rest where guideObstacle() has put them before the first step
  ContactData contact;
  SkinContacts skins;
  std::map<std::size_t, std::unique_ptr<AttachmentLayer>> attachments;
  std::vector<Probe> probes;
  std::size_t nextId = 1;
  // increases where the simulated history ends: a reset, bodies or obstacles added or removed
  std::uint64_t historyEpoch = 0;
  Progress progress;
  IslandSet islands;
  std::vector<SimulationEvent> events;
  std::map<std::size_t, std::vector<std::string>> warnings;  // by body, obstacle or attachment
  bool initialWarningsReported = false;
  ReportedFindings reported;
  StepActivity activity;
  ComputingTime computingTime;
  StageClock clock;
  ScreenPhyxels screenPhyxels;
};

}  // namespace pointbased::detail
