// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "pointbased/attachment.h"
#include "pointbased/body.h"
#include "pointbased/contact_settings.h"
#include "pointbased/stage_clock.h"
#include "pointbased/step_composition.h"
#include "pointbased/stop_request.h"
#include "pointbased/world_settings.h"

namespace pointbased {

namespace detail {
class AttachmentLayer;
class IslandScheduler;
class Island;
class BodyStepper;
class SkinContacts;
class StepActivity;
struct StepContext;
struct SimulatorCheckpoint;
}  // namespace detail

/// The state of a simulation at one time, for Simulator::restore(). Cheap to copy.
using Checkpoint = std::shared_ptr<const detail::SimulatorCheckpoint>;

struct Probe {
  std::size_t id = 0;
  std::string name;
  std::size_t body = 0;
  Vec3 reference = Vec3::Zero();  ///< world, m
  Interpolation binding;          ///< one point
  /// m, displacement of the point from `reference` to its binding position (rereferencing.h)
  Vec3 referenceShift = Vec3::Zero();
};

struct SimulationEvent {
  double time = 0.0;  ///< s
  /// substep | slowed | smaller_step | stopped | switched | chosen | renewed | restored | note | warning | skin |
  /// overlap | torn | step
  std::string kind;
  std::string text;
};

/// The reason why no step was made: every body that could move has stopped, or the step was cancelled.
struct StepFailure {
  std::string text;      ///< body, phyxel, quantity, and the setting that would help
  bool ended = false;    ///< by the stop request; the state is that before the step
  std::size_t body = 0;  ///< being computed at that time; 0: none
};

/// Simulates bodies and obstacles in time. The stages of a step are composed from what the scene contains: no viscous
/// stage without viscosity, no contact without an obstacle or the box. Surfels are computed on request.
///
/// The guard checks every body after every step. A body with non-finite values or with an energy gain returns to the
/// state before the step and retries with smaller steps. If that does not help, it stops there with an event that names
/// the phyxel, the quantity and the setting that would help; the other bodies continue.
///
/// One thread at a time. Results are bitwise identical for any number of threads behind parallelFor.
class Simulator {
 public:
  explicit Simulator(ParallelFor parallelFor = serialFor());
  ~Simulator();

  [[nodiscard]] const WorldSettings &world() const { return world_; }
  /// May be called between any two steps; positions, velocities and plastic state are kept. A change to a quasi-static
  /// solution begins at load factor 0. A change from one continues at the time at which every ramp has reached the load
  /// factor: no earlier than the load factor times the longest ramp.
  void setWorld(const WorldSettings &world);

  /// Ids stay valid until the body is removed; they are not reused.
  std::size_t addBody(std::unique_ptr<Body> body);
  std::size_t addObstacle(Obstacle obstacle);
  bool removeBody(std::size_t id);
  bool removeObstacle(std::size_t id);
  /// Adds an obstacle while the simulation runs: an instrument. The simulated history stays valid, also when
  /// removeObstacle() removes the instrument. reset() removes it; restore() restores the instruments of the checkpoint.
  std::size_t addInstrument(Obstacle obstacle);
  [[nodiscard]] bool isInstrument(std::size_t id) const { return instruments_.contains(id); }
  /// Moves an obstacle from its present pose to another one at constant rates, after which it stays at rest. It rotates
  /// about target.centre by the smaller angle while that centre moves in a straight line. This replaces the obstacle's
  /// own motion, which reset() restores. Before the first step the obstacle is moved at once, and one that was static
  /// starts from there from then on. No effect if no obstacle has this id.
  /// @param target    finite
  /// @param duration  s, or load factor, >= 0
  void guideObstacle(std::size_t id, const RigidMotion &target, double duration);
  /// True if guideObstacle() has moved it since the last reset().
  [[nodiscard]] bool isGuided(std::size_t id) const { return ownMotions_.contains(id); }
  /// Obstacle::motion as reset() restores it; empty: it is static, or no obstacle has this id.
  [[nodiscard]] std::function<RigidMotion(double t)> motionAtReset(std::size_t id) const;
  void clear();
  [[nodiscard]] Body *body(std::size_t id);
  [[nodiscard]] const Body *body(std::size_t id) const;
  [[nodiscard]] std::vector<std::size_t> bodyIds() const;
  [[nodiscard]] std::span<const Obstacle> obstacles() const { return obstacles_; }
  /// Null if no obstacle has this id.
  [[nodiscard]] const Obstacle *obstacle(std::size_t id) const;
  /// Adds a warning about a body or obstacle. It is reported as an event at the start of every simulation, and is
  /// removed with the body or obstacle.
  void addWarning(std::size_t id, const std::string &text);
  /// obstacles() as one body sees them: with the friction of its pairs. Those that it passes through have no
  /// Obstacle::closest. Valid until one of these settings changes.
  [[nodiscard]] std::span<const Obstacle> obstaclesOf(std::size_t body) const;
  /// Same for WorldSettings::box.
  [[nodiscard]] WorldBox boxOf(std::size_t body) const;
  /// The integrator of a body: that of the world, or the one that is used in its place.
  [[nodiscard]] Integrator integratorOf(std::size_t body) const;
  /// Stages that a step of the body has now, with reasons. The next step uses the same decisions.
  [[nodiscard]] StepComposition compositionOf(std::size_t body) const;
  /// Force evaluations per simulated second: (explicit, implicit). The basis of Integrator::automatic.
  [[nodiscard]] std::pair<double, double> predictedCost(std::size_t body) const;
  /// Rigid motion of an obstacle at the present time.
  [[nodiscard]] RigidMotion obstacleMotion(std::size_t id) const;
  /// @return  id of the probe; 0 if there is no such body
  std::size_t addProbe(std::string name, std::size_t body, const Vec3 &reference);
  bool removeProbe(std::size_t id);
  [[nodiscard]] const std::vector<Probe> &probes() const { return probes_; }
  struct ProbeState {
    Vec3 position, velocity;  ///< world, m and m/s
  };
  [[nodiscard]] ProbeState probeState(const Probe &probe) const;

  /// Changes the material of a body during the simulation; forces and the stable step are updated.
  void setConstitution(std::size_t body, Constitution constitution);
  /// Changes how the surroundings hold a body during the simulation. Errors: those of Body::setFoundation(); nothing is
  /// changed then.
  [[nodiscard]] Result<void> setFoundation(std::size_t body, const Foundation &foundation);

  /// Body::setRigid() during the simulation. A static body costs nothing and cannot be grabbed. The stable step of a
  /// rigid body limits no step.
  void setRigid(std::size_t body, bool rigid, bool free = false);

  /// Joins a body to another body, to an obstacle or to its surroundings. Call between two steps; the simulation is
  /// reset. The attachment is removed together with either of the two that it joins.
  /// Errors, with nothing changed: settings that validate() refuses; an unknown id, or the same body twice; a body
  /// without a surface; no part of the surface is in the region, near enough and facing the other body.
  /// @return  id of the attachment
  [[nodiscard]] Result<std::size_t> addAttachment(const Attachment &attachment);
  bool removeAttachment(std::size_t id);
  /// Present state of all attachments, in the order in which they were added.
  [[nodiscard]] std::vector<AttachmentSummary> attachments() const;

  /// Contact between bodies. May be called between any two steps. It is a setting, not state: reset() and restore() do
  /// not change it. Wakes all bodies.
  /// @param contact  friction >= 0
  void setContact(const ContactSettings &contact);
  [[nodiscard]] const ContactSettings &contact() const { return contact_; }
  /// Contact of one pair, in either order; kWorldBox for the walls. The setting is removed together with the body or
  /// obstacle. No effect if one of the ids does not exist, or if neither is a body.
  void setContactPair(std::size_t a, std::size_t b, const ContactPairSettings &settings);
  /// By ids, the smaller one first.
  using ContactPairs = std::map<std::pair<std::size_t, std::size_t>, ContactPairSettings>;
  [[nodiscard]] const ContactPairs &contactPairs() const { return contactPairs_; }
  /// Settings in effect between two: those of the pair, or the general ones. friction >= 0, that of the obstacle or the
  /// walls if the pair has none. Not enabled if contact between bodies is off or an id does not exist.
  [[nodiscard]] ContactPairSettings contactPair(std::size_t a, std::size_t b) const;
  /// Whether two bodies collide with each other, or a body with itself: contact is enabled, and both have a skin.
  [[nodiscard]] bool canTouch(std::size_t a, std::size_t b) const;
  /// Touching pairs, by ids: those with contact forces in the last step. Empty before the first step and for a body
  /// whose state has been replaced since. From the impulses of the substeps for explicit steps, from the penalty forces
  /// for implicit ones.
  [[nodiscard]] std::vector<ContactSummary> contacts() const;
  /// Contact pressure of obstacles, walls, other bodies and the body itself on a body, Pa: normal forces over the skin
  /// area that a phyxel carries, mean over the last step. Its integral over these areas is ContactSummary::pressing.
  /// @param out  [phyxels]; 0 without contact
  void contactPressures(std::size_t body, std::vector<double> &out) const;

  /// Makes one step of the present size. Explicit: in the substeps that stability requires, at most 10 000; if these
  /// are not enough, time advances by what they cover. Refused if every body has stopped. Quasi-static: one load
  /// increment; no effect if finished().
  /// @param stop  null, or a request that cancels the step within a fraction of a second when it is raised. Every body
  ///              is then in its state before the step. Another thread may raise it.
  [[nodiscard]] tl::expected<void, StepFailure> step(const StopRequest *stop = nullptr);
  /// Describes the step that is being computed: the present body, why it may take long, and what would help. Empty
  /// between steps. Any thread.
  [[nodiscard]] std::string activity() const;
  /// Explains a cancelled step in sentences: how far it had advanced, and which settings would fit the time budget.
  /// Times an evaluation of the forces of that body, which costs as much as two of them.
  /// @param budget  s of wall-clock time for a step
  [[nodiscard]] std::string suggestAffordableStep(const StepFailure &ended, double budget);
  /// Returns everything to the initial state, bit for bit: time 0, no grabs.
  void reset();

  /// The state between two steps: bodies, clock, probes and events.
  [[nodiscard]] Checkpoint checkpoint() const;
  /// Returns (or advances) to a state of these bodies, without grabs. Materials, world and what holds the bodies are
  /// the present ones. Explicit steps from there repeat the earlier results bit for bit, unless material flows (it
  /// flows once more at the start). Reported as an event.
  /// @return  false: nothing is changed, because bodies or obstacles have been added or removed since, or the
  ///          simulation has been reset
  bool restore(const Checkpoint &checkpoint);
  /// The state as bytes, for restoreSavedState() of a simulator with the same bodies, obstacles, supports, loads and
  /// world. Factorisations and reference energies are reset here as well, so that this simulation and one that restores
  /// the state make the same steps.
  /// Errors, with nothing changed: a body that is grabbed, that has stopped, or whose reference was renewed after large
  /// flow; a guided obstacle or an instrument.
  [[nodiscard]] Result<std::string> savedState();
  /// Restores a state of savedState(), from which every step gives the same bits as there. On an error nothing is
  /// changed: the bytes are not such a state.
  [[nodiscard]] Result<void> restoreSavedState(std::string_view bytes);
  /// Changes whenever earlier checkpoints become invalid.
  [[nodiscard]] std::uint64_t historyEpoch() const { return historyEpoch_; }

  [[nodiscard]] double time() const { return quasiStatic() ? 0.0 : time_; }
  /// Quasi-static: 0 … 1; otherwise 1.
  [[nodiscard]] double loadFactor() const { return quasiStatic() ? loadFactor_ : 1.0; }
  [[nodiscard]] bool quasiStatic() const { return world_.integrator == Integrator::quasiStatic; }
  [[nodiscard]] bool finished() const;
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// s, of the next step: WorldSettings::dt, or the longest that any body would choose; 0 for a quasi-static solution.
  [[nodiscard]] double stepSize() const;
  /// s, step of one body; for explicit integration the size of its substeps at rest. 0: static body or quasi-static
  /// solution.
  [[nodiscard]] double stepSizeOf(std::size_t body) const;
  /// True if every body that is not static has stopped.
  [[nodiscard]] bool failed() const;
  [[nodiscard]] std::size_t stoppedBodies() const;
  /// The body is at rest and costs nothing (WorldSettings::sleep): no stage runs, its state is constant bit for bit,
  /// its velocities are 0. A grab, a moving obstacle, or a change of material, world or scene wakes it.
  [[nodiscard]] bool asleep(std::size_t body) const;
  /// Call after changing the state of a body from outside; velocities other than 0 wake it automatically.
  void wake(std::size_t body);
  /// Counter that grows whenever the state of a body may have changed, so that derived values can be cached.
  [[nodiscard]] std::uint64_t changes(std::size_t body) const;

  /// Sets external forces on the phyxels of a body (Body::swapExternalForces), from the next step until they are set
  /// again; wakes it. No effect on a static body (Body::isStatic()).
  void setExternalForces(std::size_t body, std::span<const Vec3> forces);
  void swapExternalForces(std::size_t body, std::vector<Vec3> &forces);
  /// Grabs a body from the next step until it is released or the simulation is reset. A grab with the same id is
  /// replaced. No effect on a static body.
  /// @param hand  id of the grab; a body may have several
  void setGrab(std::size_t body, Grab grab, std::uint64_t hand = 0);
  void moveGrab(std::size_t body, const Vec3 &target, std::uint64_t hand = 0);
  void turnGrab(std::size_t body, const Mat3 &rotation, std::uint64_t hand = 0);
  void releaseGrab(std::size_t body, std::uint64_t hand = 0);
  /// Empty if the body has no grab with this id.
  [[nodiscard]] std::optional<GrabStatus> grabStatus(std::size_t body, std::uint64_t hand = 0) const;

  /// Largest penetration of a body's skin into walls, obstacles or its own rigid tissue, m: of the deepest contact
  /// point of every step, and of the displayed skin, now and every 128 explicit steps (not in obstacles).
  [[nodiscard]] double skinDepth(std::size_t body) const;
  /// Wall-clock time per simulated second of a body, s; 0 before the first step and for quasi-static solutions.
  [[nodiscard]] double costOf(std::size_t body) const;

  /// World positions and normals of a body's surfels; the second overload in single precision for display.
  void surfels(std::size_t body, std::vector<Vec3> &positions, std::vector<Vec3> &normals);
  void surfels(std::size_t body, std::vector<Vec3f> &positions, std::vector<Vec3f> &normals);

  struct Energy {
    double kinetic = 0.0, elastic = 0.0, stabilisation = 0.0, gravity = 0.0;  ///< J; gravity relative to the start
    /// J, stored in the surroundings and in attachments; of an attachment between two bodies, half
    double foundation = 0.0;
  };
  [[nodiscard]] Energy energy(std::size_t body) const;
  [[nodiscard]] std::vector<Reaction> reactions(std::size_t body) const;

  /// FNV-1a over displacements, velocities and plastic state of every phyxel, bodies in the order in which they were
  /// added.
  [[nodiscard]] std::uint64_t stateHash() const;

  [[nodiscard]] const std::vector<SimulationEvent> &events() const { return events_; }
  [[nodiscard]] std::vector<StageClock::Summary> stageTimes() const { return clock_.summary(); }

 private:
  [[nodiscard]] Environment environment() const;
  [[nodiscard]] bool exists(std::size_t id) const;
  /// For an obstacle, and for what is attached to it. Empty: static.
  void setMotion(std::size_t obstacle, std::function<RigidMotion(double t)> motion);
  void restoreObstacles(const detail::SimulatorCheckpoint &kept);
  void endGuidance();
  /// Everything that contact points of the body collide with: its own rigid tissue, then obstaclesOf().
  [[nodiscard]] std::span<const Obstacle> surroundingsOf(std::size_t body) const;
  /// Number of these that are its own.
  [[nodiscard]] std::size_t ownObstacleCount(std::size_t body) const;
  /// Call after a change of pairs or obstacles.
  void updateSurroundings(std::size_t body);
  void updateSurroundings();
  [[nodiscard]] detail::StepContext contextFor(std::size_t body, const detail::StepContext &context) const;
  [[nodiscard]] std::vector<detail::StepContext> contextsOf(const detail::Island &island,
                                                            const detail::StepContext &context) const;
  [[nodiscard]] detail::StepContext context(const StopRequest *stop);
  /// Schedules the bodies that move in a step of dt; those that may touch each other in it as islands.
  detail::IslandScheduler &scheduleIslands(double dt);
  void buildIslands(double dt);
  /// Call after a change of attachments, masses or what moves.
  void updateAttachments();
  void removeAttachmentsOf(std::size_t id);
  /// J, with half of the attachments to another body.
  [[nodiscard]] double attachedEnergy(std::size_t body) const;
  void reportTornAttachments();
  [[nodiscard]] bool mayTouchItself(std::size_t body, double dt);
  /// Advances all bodies by dt. @return  s by which all have advanced; less if the substeps of a body were not enough
  double advanceBodies(const detail::StepContext &context);
  void increaseLoad(const detail::StepContext &context);
  /// Time or load factor: the argument of ramps.
  [[nodiscard]] double clockOfRamps() const { return quasiStatic() ? loadFactor_ : time_; }
  /// Makes the present shape the reference of a body that has flowed far (rereferencing.h). False: not due, or not
  /// possible.
  /// @param stop  raised: postponed
  bool rereferenceIfNeeded(std::size_t body, const StopRequest *stop);
  void bindProbes(std::size_t body, std::span<const Vec3> ways);
  void reportEvent(const std::string &kind, const std::string &text);
  void describe(std::size_t body);
  [[nodiscard]] std::uint64_t skinCheckInterval() const;
  [[nodiscard]] bool isSkinCheckDue() const;
  void checkSkins();
  void checkPairOverlap();
  void checkRigidTissue(std::size_t id);
  void reportPenetration(const Body &body, double depth, double spacings, double &deepest, const char *what,
                         const char *where);
  void checkContacts();
  void reportUnresolvedThickness(std::size_t id, double thickness);
  void reportInitialWarnings(const detail::StepContext &context);
  void checkInitialState(const detail::StepContext &context);
  void reportLostRestitution();

  ParallelFor plainLoops_;
  StoppableLoops loops_;
  const ParallelFor &parallelFor_ = loops_.parallelFor();
  WorldSettings world_;
  std::map<std::size_t, std::unique_ptr<detail::BodyStepper>> bodies_;
  std::map<std::size_t, std::vector<std::string>> warnings_;  // about shape and sampling, by body
  std::unique_ptr<detail::StepActivity> activity_;
  std::unique_ptr<detail::IslandScheduler> scheduler_;  // scratch of a step
  std::unique_ptr<detail::SkinContacts> skins_;
  std::vector<std::unique_ptr<detail::Island>> islands_;  // of a step; memory is reused
  std::size_t islandCount_ = 0;
  std::set<std::size_t> islandMembers_;    // bodies in islands
  std::set<std::size_t> touchThemselves_;  // bodies that may touch themselves in this step
  std::map<std::size_t, std::unique_ptr<detail::AttachmentLayer>> attachments_;
  std::set<std::size_t> tornReported_;  // attachments
  std::vector<Obstacle> obstacles_;
  std::vector<std::size_t> obstacleIds_;
  std::set<std::size_t> instruments_;
  std::set<std::size_t> placed_;  // obstacles at rest where guideObstacle() has put them before the first step
  std::map<std::size_t, std::function<RigidMotion(double t)>> ownMotions_;  // of guided obstacles
  ContactSettings contact_;
  ContactPairs contactPairs_;
  std::map<std::size_t, std::vector<Obstacle>> rigidTissues_;  // of bodies that have such tissue
  // surroundingsOf() bodies with pairs with obstacles or walls, or with rigid tissue
  std::map<std::size_t, std::vector<Obstacle>> surroundings_;
  std::uint64_t contactSwitches_ = 0;  // increases when a pair is switched on or off
  std::vector<Probe> probes_;
  std::size_t nextId_ = 1;
  // increases where the simulated history ends: a reset, bodies or obstacles added or removed
  std::uint64_t historyEpoch_ = 0;
  double time_ = 0.0;        // s
  double loadFactor_ = 0.0;  // of a quasi-static solution
  std::uint64_t steps_ = 0;
  std::vector<SimulationEvent> events_;
  std::set<std::size_t> notRereferenced_;       // bodies whose reference could not be renewed
  std::map<std::size_t, double> skinDeepest_;   // m, of the displayed skin, beyond the walls
  std::map<std::size_t, double> rigidDeepest_;  // m, of the displayed skin, in rigid tissue of the same body
  std::vector<Vec3> skin_;                      // scratch for checking one skin
  std::set<std::pair<std::size_t, std::size_t>> overlaps_;  // already reported
  std::pair<std::size_t, std::size_t> lastPair_{0, 0};      // last one checked for overlap
  bool initialWarningsReported_ = false;
  std::map<std::size_t, double> spent_;  // s of wall-clock time, by body
  double advanced_ = 0.0;                // s simulated in that time
  StageClock clock_;
  ScreenPhyxels screenPhyxels_;
};

}  // namespace pointbased
