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
class BodyCrew;
class BodyGroup;
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
  /// m, way of the point from `reference` to where it is bound (rereferencing.h)
  Vec3 referenceShift = Vec3::Zero();
};

struct SimulationEvent {
  double time = 0.0;  ///< s
  /// substep | slowed | smaller_step | stopped | switched | renewed | restored | note | warning | skin | overlap |
  /// torn | step
  std::string kind;
  std::string text;
};

/// Why there was no step: no body is left that could move, or it was ended half way.
struct StepFailure {
  std::string text;      ///< body, phyxel, quantity, and the setting that would help
  bool ended = false;    ///< by the request; the state is that before the step
  std::size_t body = 0;  ///< that was being computed then; 0: none
};

/// Bodies, obstacles and the clock. Composes the stages of a step from what the scene has: no viscous stage without
/// viscosity, no contact without obstacle or box; surfels move when somebody asks.
///
/// The guard checks every body after every step. A body that has left the finite numbers or gained energy goes back to
/// the state before the step and tries smaller ones; where that does not help it stops there, with an event that names
/// the phyxel, the quantity and the setting that would help, and the others go on.
///
/// One thread at a time. The same bits for any number of threads behind parallelFor.
class Simulator {
 public:
  explicit Simulator(ParallelFor parallelFor = serialFor());
  ~Simulator();

  [[nodiscard]] const WorldSettings &world() const { return world_; }
  /// Any time between two steps; positions, velocities and plastic state stay. A change to a quasi-static solution
  /// begins at load factor 0; a change from one goes on at the time at which every ramp is over that the load factor
  /// had passed.
  void setWorld(const WorldSettings &world);

  /// Ids stay valid until the body is removed; they are not reused.
  std::size_t addBody(std::unique_ptr<Body> body);
  std::size_t addObstacle(Obstacle obstacle);
  bool removeBody(std::size_t id);
  bool removeObstacle(std::size_t id);
  /// An obstacle that comes while the simulation goes on: an instrument. What has been simulated stands, also when
  /// removeObstacle() takes it away; reset() takes it away, and restore() goes back to the instruments of then.
  std::size_t addInstrument(Obstacle obstacle);
  [[nodiscard]] bool isInstrument(std::size_t id) const { return instruments_.contains(id); }
  /// Leads an obstacle from where it is to another place, evenly: it turns about target.centre by the shorter way while
  /// that goes straight, and then stands. In place of its own motion, which reset() gives back. Before the first step
  /// it is there at once, and where it stood still begins there from then on. Of no effect where there is none of this
  /// id.
  /// @param target    finite
  /// @param duration  s, or load factor, >= 0
  void guideObstacle(std::size_t id, const RigidMotion &target, double duration);
  /// guideObstacle() has led it since the last reset().
  [[nodiscard]] bool isGuided(std::size_t id) const { return ownMotions_.contains(id); }
  /// Obstacle::motion as reset() gives it back; empty: it stands still, or there is none of this id.
  [[nodiscard]] std::function<RigidMotion(double t)> motionAtReset(std::size_t id) const;
  void clear();
  [[nodiscard]] Body *body(std::size_t id);
  [[nodiscard]] const Body *body(std::size_t id) const;
  [[nodiscard]] std::vector<std::size_t> bodyIds() const;
  [[nodiscard]] std::span<const Obstacle> obstacles() const { return obstacles_; }
  /// Null: there is none of this id.
  [[nodiscard]] const Obstacle *obstacle(std::size_t id) const;
  /// What is unusual about a body or obstacle, told as an event from the start of every simulation; it goes with it.
  void addWarning(std::size_t id, const std::string &text);
  /// As obstacles(), as one body feels them: with the friction of its pairs; those that it passes through have no
  /// Obstacle::closest. Valid until something of it changes.
  [[nodiscard]] std::span<const Obstacle> obstaclesOf(std::size_t body) const;
  /// WorldSettings::box, likewise.
  [[nodiscard]] WorldBox boxOf(std::size_t body) const;
  /// What integrates a body: the world's integrator, or what is chosen in its place.
  [[nodiscard]] Integrator integratorOf(std::size_t body) const;
  /// Which stages a step of a body has now, and why: what the next step decides by.
  [[nodiscard]] StepComposition compositionOf(std::size_t body) const;
  /// Force evaluations per simulated second: (explicit, implicit). What Integrator::automatic decides by.
  [[nodiscard]] std::pair<double, double> predictedCost(std::size_t body) const;
  /// Where an obstacle is now: its rigid motion at the present time.
  [[nodiscard]] RigidMotion obstacleMotion(std::size_t id) const;
  /// @return its id; 0 where there is no such body
  std::size_t addProbe(std::string name, std::size_t body, const Vec3 &reference);
  bool removeProbe(std::size_t id);
  [[nodiscard]] const std::vector<Probe> &probes() const { return probes_; }
  struct ProbeState {
    Vec3 position, velocity;  ///< world, m and m/s
  };
  [[nodiscard]] ProbeState probeState(const Probe &probe) const;

  /// Material of a body while it runs; forces and the step follow.
  void setConstitution(std::size_t body, Constitution constitution);
  /// How its surroundings hold a body, while it runs. Errors of Body::setFoundation(); then nothing is changed.
  [[nodiscard]] Result<void> setFoundation(std::size_t body, const Foundation &foundation);

  /// Body::setRigid() while it runs: a body that stands costs nothing then, and nothing grabs it; of none that is rigid
  /// is the stable step anybody's.
  void setRigid(std::size_t body, bool rigid, bool free = false);

  /// Between two steps; the simulation is reset. It goes with either of what it joins. Errors, with nothing changed:
  /// what validate() refuses; ids of nobody, or of one body twice; a body without surface; no part of the surface is in
  /// the region, near enough and facing the other one.
  /// @return its id
  [[nodiscard]] Result<std::size_t> addAttachment(const Attachment &attachment);
  bool removeAttachment(std::size_t id);
  /// All of them as they are now, in the order they were added.
  [[nodiscard]] std::vector<AttachmentSummary> attachments() const;

  /// Contact of bodies with each other. Any time between two steps; a setting, not state: reset() and restore() leave
  /// it as it is. Wakes all bodies.
  /// @param contact  friction >= 0
  void setContact(const ContactSettings &contact);
  [[nodiscard]] const ContactSettings &contact() const { return contact_; }
  /// Contact of one pair, likewise; in any order, and kWorldBox for the walls. It goes with the body or obstacle. Of no
  /// effect where one of the ids is not there, or both are not bodies.
  void setContactPair(std::size_t a, std::size_t b, const ContactPairSettings &settings);
  /// By ids, the smaller one first.
  using ContactPairs = std::map<std::pair<std::size_t, std::size_t>, ContactPairSettings>;
  [[nodiscard]] const ContactPairs &contactPairs() const { return contactPairs_; }
  /// What holds between two: settings of the pair itself, or those of all. friction >= 0, that of the obstacle or the
  /// walls where none is set; not enabled where bodies have no contact, or an id is not there.
  [[nodiscard]] ContactPairSettings contactPair(std::size_t a, std::size_t b) const;
  /// Whether two bodies touch each other where they meet, or a body itself: contact is on, and both have a skin.
  [[nodiscard]] bool canTouch(std::size_t a, std::size_t b) const;
  /// Who touches whom, by ids: those that have pressed in the last step. Empty before the first step
  /// and where a body has been given another state since. Explicit steps: the impulses of their substeps; implicit
  /// ones: forces of the penalty.
  [[nodiscard]] std::vector<ContactSummary> contacts() const;
  /// Pressure by which obstacles, walls, other bodies and it itself press on a body, Pa: normal forces over the area of
  /// skin that a phyxel carries, mean over the last step; their sum over these areas is ContactSummary::pressing.
  /// @param out  [phyxels]; 0 where nothing presses
  void contactPressures(std::size_t body, std::vector<double> &out) const;

  /// One step of the present size: explicit in the substeps that stability needs, up to 10 000 (then time goes on by
  /// what is done). Refused when every body has stopped. Quasi-static: one load increment; nothing when finished().
  /// @param stop  null, or what ends the step when it is raised, in a fraction of a second: every body is then where it
  ///              was before the step. Another thread may raise it.
  [[nodiscard]] tl::expected<void, StepFailure> step(const StopRequest *stop = nullptr);
  /// Of the step that is being computed: the body that it is at, why that may take long, what would help. Empty between
  /// steps. Any thread.
  [[nodiscard]] std::string activity() const;
  /// For who has ended a step that took too long, in sentences: how far it had come, and what would fit into the time.
  /// An evaluation of the forces of that body is timed for it, which takes as long as two of them.
  /// @param budget  s, that a step may take
  [[nodiscard]] std::string whatWouldFit(const StepFailure &ended, double budget);
  /// To the initial state of everything, bit for bit; time 0, nothing grabbed.
  void reset();

  /// The state between two steps: of bodies, clock, probes and events.
  [[nodiscard]] Checkpoint checkpoint() const;
  /// Back to (or on to) a state of these bodies, nothing grabbed; materials, world and what holds the bodies are those
  /// of now. From there explicit steps give the bits that they gave from there before, unless material flows (it flows
  /// once more at the start). An event tells of it.
  /// @return false: nothing is changed, because bodies or obstacles have come or gone since, or the simulation has been
  ///         reset
  bool restore(const Checkpoint &checkpoint);
  /// The state as bytes, for goToSavedState() of a simulator with the same bodies, obstacles, supports, loads and
  /// world. Factorisations and what is known of energies start anew here, too, so that this simulation and one that
  /// goes to the state make the same steps. Errors, with nothing changed: a body that a hand holds, that has stopped,
  /// or whose material has flowed so far that its reference was renewed.
  [[nodiscard]] Result<std::string> savedState();
  /// Goes to a state of savedState(), from which every step gives the bits that it gave from there. On an error, the
  /// bytes are not such a state, nothing has changed.
  [[nodiscard]] Result<void> goToSavedState(std::string_view bytes);
  /// Differs where checkpoints of before are refused.
  [[nodiscard]] std::uint64_t course() const { return course_; }

  [[nodiscard]] double time() const { return quasiStatic() ? 0.0 : time_; }
  /// Quasi-static: 0 … 1.
  [[nodiscard]] double loadFactor() const { return quasiStatic() ? loadFactor_ : 1.0; }
  [[nodiscard]] bool quasiStatic() const { return world_.integrator == Integrator::quasiStatic; }
  [[nodiscard]] bool finished() const;
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// s, of the next step: of the world, or the longest that any of its bodies takes by itself; 0 quasi-static.
  [[nodiscard]] double stepSize() const;
  /// s, in which a body takes it: explicit ones in substeps, of this size at rest; 0: it stands, or quasi-static.
  [[nodiscard]] double stepSizeOf(std::size_t body) const;
  /// Every body has stopped.
  [[nodiscard]] bool failed() const;
  [[nodiscard]] std::size_t stoppedBodies() const;
  /// The body has come to rest and costs nothing (WorldSettings::sleep): no stage runs, its state stays bit for bit,
  /// its velocities are 0. A hand, an obstacle that moves, another material, world or scene wakes it.
  [[nodiscard]] bool asleep(std::size_t body) const;
  /// For who has changed the state of a body from outside; velocities that are not 0 wake it without.
  void wake(std::size_t body);
  /// Grows whenever the state of a body may have changed: who has seen a number need not look again.
  [[nodiscard]] std::uint64_t changes(std::size_t body) const;

  /// Forces on the phyxels of a body from outside of the model (Body::swapExternalForces), from the next step on until
  /// they are set again; wakes it. Of no effect on a body that stands (Body::stands()).
  void setExternalForces(std::size_t body, std::span<const Vec3> forces);
  void swapExternalForces(std::size_t body, std::vector<Vec3> &forces);
  /// Takes hold of a body, from the next step on, until it is let go or the simulation reset. A hand that holds it
  /// already takes hold anew. Of no effect on a body that stands.
  /// @param hand  who holds; several may hold one body
  void setGrab(std::size_t body, Grab grab, std::uint64_t hand = 0);
  void moveGrab(std::size_t body, const Vec3 &target, std::uint64_t hand = 0);
  void turnGrab(std::size_t body, const Mat3 &rotation, std::uint64_t hand = 0);
  void releaseGrab(std::size_t body, std::uint64_t hand = 0);
  /// Nothing: this hand does not hold it.
  [[nodiscard]] std::optional<GrabStatus> grabStatus(std::size_t body, std::uint64_t hand = 0) const;

  /// How deep the skin of a body has been beyond walls, in obstacles or in rigid tissue of its own, m: the deepest
  /// point of contact of every step, and the skin as it is drawn, now and every 128 explicit steps (not in obstacles).
  [[nodiscard]] double skinDepth(std::size_t body) const;
  /// Wall-clock time that a body takes per simulated second, s; 0 before the first step and of quasi-static solutions.
  [[nodiscard]] double costOf(std::size_t body) const;

  /// World positions and normals of a body's surfels; in single precision for a screen.
  void surfels(std::size_t body, std::vector<Vec3> &positions, std::vector<Vec3> &normals);
  void surfels(std::size_t body, std::vector<Vec3f> &positions, std::vector<Vec3f> &normals);

  struct Energy {
    double kinetic = 0.0, elastic = 0.0, stabilisation = 0.0, gravity = 0.0;  ///< J; gravity relative to the start
    /// J, stored in the surroundings and, by halves where it joins two bodies, in attachments
    double foundation = 0.0;
  };
  [[nodiscard]] Energy energy(std::size_t body) const;
  [[nodiscard]] std::vector<Reaction> reactions(std::size_t body) const;

  /// FNV-1a over displacements, velocities and plastic state of every phyxel, bodies in the order they were added.
  [[nodiscard]] std::uint64_t stateHash() const;

  [[nodiscard]] const std::vector<SimulationEvent> &events() const { return events_; }
  [[nodiscard]] std::vector<StageClock::Summary> stageTimes() const { return clock_.summary(); }

 private:
  [[nodiscard]] Environment environment() const;
  [[nodiscard]] bool exists(std::size_t id) const;
  /// Of an obstacle, and of what is attached to it. Empty: it stands still.
  void setMotion(std::size_t obstacle, std::function<RigidMotion(double t)> motion);
  void takeObstacles(const detail::SimulatorCheckpoint &kept);
  void endGuidance();
  /// All that is felt by points of contact: the body's own rigid tissue, then obstaclesOf().
  [[nodiscard]] std::span<const Obstacle> surroundingsOf(std::size_t body) const;
  /// How many of these are its own.
  [[nodiscard]] std::size_t ownOf(std::size_t body) const;
  /// After a change of pairs or obstacles.
  void updateSurroundings(std::size_t body);
  void updateSurroundings();
  [[nodiscard]] detail::StepContext inSurroundings(std::size_t body, const detail::StepContext &order) const;
  [[nodiscard]] std::vector<detail::StepContext> ordersOf(const detail::BodyGroup &group,
                                                          const detail::StepContext &order) const;
  [[nodiscard]] detail::StepContext order(const StopRequest *stop);
  /// Those that move, for a step of dt; those that may touch each other in it as groups.
  detail::BodyCrew &gatherCrew(double dt);
  void formGroups(double dt);
  /// After a change of attachments, masses or what moves.
  void updateAttachments();
  void removeAttachmentsOf(std::size_t id);
  /// J, with half of what joins it to another body.
  [[nodiscard]] double attachedEnergy(std::size_t body) const;
  void tellWhatTears();
  [[nodiscard]] bool mayTouchItself(std::size_t body, double dt);
  /// Everybody on by dt. @return s that all have gone; less where a body's substeps were not enough
  double advanceBodies(const detail::StepContext &order);
  void increaseLoad(const detail::StepContext &order);
  /// Time, or load factor: what ramps count by.
  [[nodiscard]] double clockOfRamps() const { return quasiStatic() ? loadFactor_ : time_; }
  /// The present shape as the reference of a body that has flowed far (rereferencing.h); false: not due, or not
  /// possible.
  /// @param stop  raised: it is put off
  bool rereferenceIfNeeded(std::size_t body, const StopRequest *stop);
  void bindProbes(std::size_t body, std::span<const Vec3> ways);
  void reportEvent(const std::string &kind, const std::string &text);
  void describe(std::size_t body);
  [[nodiscard]] std::uint64_t lookEvery() const;
  [[nodiscard]] bool isSkinCheckDue() const;
  void checkSkins();
  void lookAtPairs();
  void lookAtRigidTissue(std::size_t id);
  void tellDepth(const Body &body, double depth, double spacings, double &deepest, const char *what, const char *where);
  void lookAtContacts();
  void tellUnresolved(std::size_t id, double thickness);
  void tellAtStart(const detail::StepContext &order);
  void lookAtStart(const detail::StepContext &order);
  void tellWhereRestitutionIsLost();

  ParallelFor plainLoops_;
  StoppableLoops loops_;
  const ParallelFor &parallelFor_ = loops_.parallelFor();
  WorldSettings world_;
  std::map<std::size_t, std::unique_ptr<detail::BodyStepper>> bodies_;
  std::map<std::size_t, std::vector<std::string>> warnings_;  // about shape and sampling, by body
  std::unique_ptr<detail::StepActivity> activity_;
  std::unique_ptr<detail::BodyCrew> crew_;  // scratch of a step
  std::unique_ptr<detail::SkinContacts> skins_;
  std::vector<std::unique_ptr<detail::BodyGroup>> groups_;  // of a step; room is kept
  std::size_t groupCount_ = 0;
  std::set<std::size_t> grouped_;          // bodies of groups
  std::set<std::size_t> touchThemselves_;  // bodies that may, in this step
  std::map<std::size_t, std::unique_ptr<detail::AttachmentLayer>> attachments_;
  std::set<std::size_t> tornReported_;  // attachments
  std::vector<Obstacle> obstacles_;
  std::vector<std::size_t> obstacleIds_;
  std::set<std::size_t> instruments_;
  std::set<std::size_t> placed_;  // obstacles that stand still where guideObstacle() has put them before the first step
  std::map<std::size_t, std::function<RigidMotion(double t)>> ownMotions_;  // of obstacles that are guided
  ContactSettings contact_;
  ContactPairs contactPairs_;
  std::map<std::size_t, std::vector<Obstacle>> rigidTissues_;  // of bodies that have such
  // surroundingsOf() bodies that have pairs with obstacles or walls, or rigid tissue
  std::map<std::size_t, std::vector<Obstacle>> surroundings_;
  std::uint64_t contactSwitches_ = 0;  // grows when a pair is switched on or off
  std::vector<Probe> probes_;
  std::size_t nextId_ = 1;
  std::uint64_t course_ = 0;  // grows where what has been simulated ends: a reset, other bodies or obstacles
  double time_ = 0.0;         // s
  double loadFactor_ = 0.0;   // of a quasi-static solution
  std::uint64_t steps_ = 0;
  std::vector<SimulationEvent> events_;
  std::set<std::size_t> notRereferenced_;                   // bodies whose reference could not be
  std::map<std::size_t, double> skinDeepest_;               // m, as drawn, beyond the walls
  std::map<std::size_t, double> rigidDeepest_;              // m, as drawn, in rigid tissue of the body itself
  std::vector<Vec3> skin_;                                  // room for a look at one
  std::set<std::pair<std::size_t, std::size_t>> overlaps_;  // that have been told
  std::pair<std::size_t, std::size_t> lastPair_{0, 0};      // that was looked at for overlaps
  bool toldAtStart_ = false;
  std::map<std::size_t, double> spent_;  // s of wall-clock time, by body
  double advanced_ = 0.0;                // s simulated in that time
  StageClock clock_;
  ScreenPhyxels screenPhyxels_;
};

}  // namespace pointbased
