// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "body_table.h"
#include "c3de/pointbased/point_sets.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/scene_record.hpp"
#include "c3de/sdk/simulator.hpp"
#include "parameters.h"
#include "pointbased/probe_tool.h"
#include "report.h"
#include "snapshot_writer.h"
#include "step_request.h"
#include "verification.h"

namespace pointbased {

class WorldSimulator;

/// Who wants to know which simulators are attached to a scene node: the controller and the views.
class SimulatorListener {
 public:
  virtual ~SimulatorListener() = default;
  virtual void attached(WorldSimulator &simulator, c3de_handle node) = 0;  // [main]
  virtual void detached(WorldSimulator &simulator) = 0;                    // [main]
};

/// Jaws of a scene.
struct GraspPlace {
  double time = 0.0;                                             ///< s
  Vec3 at = Vec3::Zero();                                        ///< m, of the middle between the jaws
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< since they took hold
};
struct SceneGrasp {
  std::uint64_t body = 0;
  JawPlaces places;
  GraspSettings settings;
  std::vector<GraspPlace> path;  ///< empty: they stay where they took hold

  [[nodiscard]] double begins() const;  ///< s
  /// Where they are to be at a time.
  void lead(Grasp &grasp, double time) const;
};
struct GraspRecord {
  std::string name;
  std::optional<SceneGrasp> scene;  ///< none: in a hand
  std::optional<Grasp> now;         ///< none: does not hold
  bool isOver = false;              ///< has let go, until the simulation begins anew
};

/// What a hand's step of Undo goes back to.
struct HandState {
  Checkpoint state;
  std::map<std::uint64_t, GraspRecord> grasps;
};

/// What objects of the plugin share.
struct PluginContext {
  explicit PluginContext(sdk::Host host, SimulatorListener *l)
      : services(host), listener(l), laws(services), speed(host, services) {}

  Services services;
  SimulatorListener *listener = nullptr;
  bool hasWindow = false;  // somebody waits before it for steps
  MaterialLaws laws;
  SpeedKeeper speed;
};

/// The registered class C3DE_POINTBASED_WORLD_SIMULATOR_CLASS: iface.simulator over the physics. A mutex stands
/// between the solver's step and what others add or read; the window reads snapshots and never takes it.
class WorldSimulator : public sdk::Object<WorldSimulator> {
 public:
  using EachField = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_field *field);
  using EachProbe = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_probe *probe);

  explicit WorldSimulator(PluginContext &context);
  ~WorldSimulator();

  // iface.simulator
  void attach(c3de_handle node);
  c3de_status declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride);
  sdk::Result<void> setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  void addBody(const c3de_sim_body *body, c3de_handle *out) { add(body, out, Walls::stay); }
  /// A body that reaches beyond world.box is a mistake of a scene; for one that a person loads the walls make room.
  void addLoadedBody(const c3de_sim_body *body, c3de_handle *out) { add(body, out, Walls::makeRoom); }
  void addObstacle(const c3de_sim_obstacle *obstacle, c3de_handle *out);
  void addProbe(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out);
  sdk::Result<void> setBodyParam(c3de_handle body, const c3de_param_value *value);
  sdk::Result<void> getBodyParam(c3de_handle body, c3de_str id, c3de_param_value *out);
  sdk::Result<void> remove(c3de_handle what);
  void clear();
  sdk::Result<void> step();
  void reset();
  void publish();
  void status(c3de_sim_status *out);
  void stateHash(std::uint64_t *out);
  void report(c3de_sink json);
  sdk::Result<void> bodyAt(std::uint64_t index, c3de_handle *out);
  sdk::Result<void> bodyInfo(c3de_handle body, c3de_sim_body_info *out);
  c3de_status enumFields(c3de_handle body, void *visitor, EachField each);
  void readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out);
  void triangles(c3de_handle body, c3de_view *out);
  c3de_status enumProbes(void *visitor, EachProbe each);
  void interrupt(std::uint32_t raised) { request_.interrupt(raised != 0); }
  void activity(c3de_sink text);
  void points(c3de_handle body, c3de_sim_points *out);
  void displacement(const c3de_sim_grid *grid, double rim, float *out, float *gaps) const;
  void addLoad(c3de_handle body, const c3de_sim_load *load, c3de_handle *out);
  void hold(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out);
  void pull(c3de_handle hold, const double *target_m3, const double *quaternion4);
  void holdState(c3de_handle hold, c3de_sim_hold_state *out);

  // iface.contact
  using EachProbeTool = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_probe_tool_state *state);
  void setPair(const c3de_sim_contact_pair *pair);
  void addProbeTool(const c3de_sim_probe_tool *tool, c3de_handle *out);
  c3de_status enumProbeTools(void *visitor, EachProbeTool each);

  // iface.attachment
  using EachAttachment = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_attachment_state *state);
  void addAttachment(const c3de_sim_attachment *attachment, c3de_handle *out);
  c3de_status enumAttachments(void *visitor, EachAttachment each);

  // iface.grasp
  void addGrasp(const c3de_sim_grasp *grasp, c3de_handle *out);

  c3de_status saveState(c3de_sink bytes);
  void loadState(const void *bytes, std::uint64_t n);
  void verify(const c3de_progress *progress, c3de_sink json);

  // pointbased.bodies
  void phyxels(c3de_handle body, c3de_object **out);
  void surfels(c3de_handle body, c3de_object **out);

  // For the controller, the view and the pinch of this plugin.
  [[nodiscard]] std::shared_ptr<const Snapshot> snapshot() const { return snapshots_.latest(); }
  [[nodiscard]] c3de_handle node() const { return node_; }
  /// @param ownLimit  N, of the hand beside what the tissue bears; 0: none
  void setGrab(std::uint64_t body, Grab grab, double ownLimit);
  void moveGrab(std::uint64_t body, const Vec3 &target);
  void releaseGrab(std::uint64_t body);
  /// The instrument in a hand: comes where its first place is, in the place of the one before; what has been simulated
  /// stands. Errors of obstacleOf() as sdk::Error. [sim]
  void placeInstrument(ProbeTool tool);
  /// Leads its middle to another place, m; nothing where there is none. [sim]
  void moveInstrument(const Vec3 &middle);
  void removeInstrument();
  /// Leads an obstacle or the instrument to another place, no faster than contact follows. [sim]
  void guide(std::uint64_t obstacle, const RigidMotion &target);
  /// Jaws in a hand take hold of a body, in the place of those before; nothing where it is gone. [sim]
  /// @param places  without problemOf()
  void grasp(std::uint64_t body, const JawPlaces &places, const GraspSettings &settings);
  /// Where the hand wants the middle between them, m, and how it has turned them; nothing where there are none. [sim]
  void leadGrasp(const Vec3 &middle, const Mat3 &rotation);
  void letGraspGo();
  /// An obstacle that has been taken out, with what belonged to it. Of the simulation's thread.
  struct TakenObstacle;
  /// Takes out the obstacle of this id, as remove() does; nothing where there is none. [sim]
  void takeOut(TakenObstacle &obstacle);
  /// Puts it back where it was, under another id, with its pairs of contact and what was attached to it. What has been
  /// simulated stays, unless something was attached, or skin has come where it was: then the simulation is reset.
  /// Nothing where it is in. [sim] @return whether the simulation has been reset
  bool putBack(TakenObstacle &obstacle);
  /// One that has not been in yet, with the usual friction. Errors as sdk::Error. Any thread.
  [[nodiscard]] TakenObstacle prepareObstacle(const std::string &name, c3de_handle mesh, const Placement &placement);
  /// The state before the pull that begins; [sim].
  [[nodiscard]] HandState checkpoint() const;
  /// Goes to the kept state and keeps the one that it leaves; nothing where the simulation has begun anew since. [sim]
  void exchange(HandState &kept);
  /// m, as slices show it: the material that is at a place has come by it; 0 where no body is. Waits for a step. Any
  /// thread.
  [[nodiscard]] Vec3 displacementAt(const Vec3 &place) const;
  /// Of a step that has taken long, before something is posted that changes it: the state before it stays. Any thread.
  void abandonLongStep() { request_.abandonLongStep(); }
  /// Before a hand's hold is posted: the present step is not given up for its budget. Any thread.
  void spareStep() { request_.spareStep(); }
  [[nodiscard]] ParameterValues worldValues() const;
  [[nodiscard]] std::optional<BodySource> source(std::uint64_t body) const;
  /// How many bodies share a budget that is wished. Any thread.
  void shareBudget(std::size_t bodies);
  /// Builds the body again with other values and puts it in the place of the old one; the simulation is reset. The old
  /// one stays when building fails. Errors as sdk::Error. Any thread.
  void rebuildBody(std::uint64_t body, const ParameterValues &values, const sdk::Progress &progress);
  /// How far the bodies are from their shadows, as they are between two steps; the simulation does not change, and may
  /// go on meanwhile. Errors as sdk::Error: cancelled. Any thread.
  std::shared_ptr<const WorldVerification> verifyBodies(const sdk::Progress &progress);
  /// Makes the trials from which displacement errors are estimated, of bodies that have none yet: some tenths of a
  /// second each. Bodies that cannot be tried, or whose trials are cancelled, say so in their statement. Any thread.
  void tryBodies(const sdk::Progress &progress, const ParallelFor &parallelFor);
  /// Takes a body's points out under the lock; false when the body is gone.
  bool readBody(std::uint64_t body, const std::function<void(const Body &)> &read) const;

  static std::array<sdk::Interface, 5> interfaces();

 private:
  /// Ids of loads and holds begin here, above those of bodies, obstacles and probes.
  static constexpr std::uint64_t kFirstLive = std::uint64_t{1} << 32;
  [[nodiscard]] std::vector<std::string> warningsOf(const ProbeTool &tool) const;
  [[nodiscard]] bool hasStepped() const;
  [[nodiscard]] std::vector<ReportedTool> reportedTools() const;
  [[nodiscard]] std::vector<ReportedAttachment> reportedAttachments() const;
  enum class Walls { stay, makeRoom };
  void add(const c3de_sim_body *body, c3de_handle *out, Walls walls);
  void takeInstrumentAway();
  void lead(std::uint64_t obstacle, const RigidMotion &target);
  void letGo(std::uint64_t grasp);
  void setHands(std::uint64_t id, const Grasp &grasp);
  /// Of its first jaw; the second has the next one.
  [[nodiscard]] static std::uint64_t handOf(std::uint64_t grasp);
  /// Nothing: it has lost what it held.
  [[nodiscard]] std::optional<GraspForces> forcesOn(std::uint64_t id, const Grasp &grasp) const;
  void leadGrasps();
  void resetGrasps();
  /// A hand holds a body, or leads the instrument.
  [[nodiscard]] bool isInHand() const;
  [[nodiscard]] std::vector<GraspSnapshot> graspsNow() const;
  [[nodiscard]] std::vector<ReportedGrasp> reportedGrasps() const;
  void resetSimulator();
  void makeRoom(const BodyRecord &body);
  /// Where hands hold and how they pull, for the trial of an adaptive sampling: the last eight places of a body.
  void keepHand(std::uint64_t body, const Grab &grab);
  void keepPull(std::uint64_t body, std::uint64_t hand);
  /// What a body that is built now asks the dial.
  [[nodiscard]] DialRequest dialRequest();
  /// measureFrame() in this world.
  [[nodiscard]] double frameTime(const Body &body, const StopRequest *stop) const;

  PluginContext &context_;
  mutable std::mutex mutex_;
  StepRequest request_;
  Simulator simulator_;
  ParameterValues world_{worldDeclarations()};
  BodyTable table_;
  mutable EvaluationPoints points_;
  SnapshotWriter snapshots_;
  /// To what is in the place of one that it was attached to; told where that cannot be.
  void attachAgain(Attachment attachment, std::uint64_t before, std::uint64_t now);
  std::map<std::uint64_t, GraspRecord> grasps_;
  /// Of bodies on which forces from outside are to act in the next step. Copies, because another thread may replace the
  /// body while they are being written.
  struct LentPoints {
    std::vector<Vec3> positions, velocities, forces;
    std::vector<double> masses;             // empty: to be taken anew
    std::shared_ptr<const RestState> rest;  // that the masses are of
    std::string name;
    bool asked = false;
  };
  std::map<std::uint64_t, LentPoints> lent_;
  /// A load that came while the body runs: acts as forces from outside.
  struct LiveLoad {
    std::uint64_t body = 0;
    Load load;
    LoadedPart part;
    std::shared_ptr<const RestState> rest;  // that the part is of
    double began_s = 0.0;
  };
  std::map<std::uint64_t, LiveLoad> liveLoads_;
  /// A hand of somebody else; that of the pinch has none.
  struct LiveHold {
    std::uint64_t body = 0;
    Vec3 fromNamed = Vec3::Zero();  // from the point that was named to the middle of what is held, m, before rotation
    Vec3 target = Vec3::Zero();     // world, m
    Mat3 rotation = Mat3::Identity();
    bool keepsShape = false;
  };
  std::map<std::uint64_t, LiveHold> holds_;
  std::uint64_t nextLive_ = kFirstLive;
  [[nodiscard]] LiveHold &holdOrThrow(c3de_handle hold);
  void bind(LiveLoad &load) const;
  void takeForces();
  [[nodiscard]] sdk::SceneRecord sceneRecord() const;
  c3de_handle node_{};
};

struct WorldSimulator::TakenObstacle {
  std::uint64_t id = 0;
  std::optional<ObstacleRecord> record = {};  ///< none: it is in
  Obstacle obstacle = {};                     ///< with the motion that a reset gives it
  RigidMotion place = {};                     ///< where it was
  Simulator::ContactPairs pairs = {};
  std::vector<Attachment> attachments = {};
};

}  // namespace pointbased
