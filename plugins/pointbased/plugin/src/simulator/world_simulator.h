// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "base/parameters.h"
#include "base/step_request.h"
#include "c3de/pointbased/point_sets.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/scene_record.hpp"
#include "c3de/sdk/simulator.hpp"
#include "pointbased/probe_tool.h"
#include "report/report.h"
#include "report/verification.h"
#include "simulator/body_table.h"
#include "simulator/snapshot_writer.h"

namespace pointbased {

class WorldSimulator;

/// Notified when simulators are attached to and detached from a scene node: implemented for the controller and the
/// views.
class SimulatorListener {
 public:
  virtual ~SimulatorListener() = default;
  virtual void attached(WorldSimulator &simulator, c3de_handle node) = 0;  // [main]
  virtual void detached(WorldSimulator &simulator) = 0;                    // [main]
};

/// A pose of a scene's jaws on their path.
struct GraspPose {
  double time = 0.0;                                             ///< s
  Vec3 at = Vec3::Zero();                                        ///< m, of the middle between the jaws
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< since they took hold
};
struct SceneGrasp {
  std::uint64_t body = 0;
  JawPositions places;
  GraspSettings settings;
  std::vector<GraspPose> path;  ///< empty: they stay where they took hold

  [[nodiscard]] double begins() const;  ///< s
  /// Sets the prescribed pose at a time.
  void lead(Grasp &grasp, double time) const;
};
struct GraspRecord {
  std::string name;
  std::optional<SceneGrasp> scene;  ///< none: controlled interactively
  std::optional<Grasp> now;         ///< none: holds nothing
  bool isOver = false;              ///< has released, until the simulation is restarted
};

/// The state that an undo step of an interactive tool restores.
struct InteractionState {
  Checkpoint state;
  std::map<std::uint64_t, GraspRecord> grasps;
};

/// Shared by the objects of the plugin.
struct PluginContext {
  explicit PluginContext(sdk::Host host, SimulatorListener *l)
      : services(host), listener(l), laws(services), speed(host, services) {}

  Services services;
  SimulatorListener *listener = nullptr;
  bool hasWindow = false;  // a user waits for steps
  MaterialLaws laws;
  MachineSpeedCache speed;
};

/// The registered class C3DE_POINTBASED_WORLD_SIMULATOR_CLASS: iface.simulator on top of the physics. A mutex
/// serialises the solver's step and the additions and reads of others. The window reads snapshots and never locks it.
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
  /// A scene's body that reaches beyond world.box is an error. For a body loaded by the user, the walls are moved
  /// outwards.
  void addLoadedBody(const c3de_sim_body *body, c3de_handle *out) { add(body, out, Walls::growWorldBox); }
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
  /// @param ownLimit  N, set for the tool in addition to the limit of the tissue; 0: none
  void setGrab(std::uint64_t body, Grab grab, double ownLimit);
  void moveGrab(std::uint64_t body, const Vec3 &target);
  void releaseGrab(std::uint64_t body);
  /// The interactive instrument: appears at the first position of its path and replaces the previous one. The simulated
  /// state is kept. Throws errors of obstacleOf() as sdk::Error. [sim]
  void placeInstrument(ProbeTool tool);
  /// Moves its middle to another position, m; does nothing if there is none. [sim]
  void moveInstrument(const Vec3 &middle);
  void removeInstrument();
  /// Moves an obstacle or the instrument to another pose, no faster than contact can follow. [sim]
  void guide(std::uint64_t obstacle, const RigidMotion &target);
  /// Interactive jaws take hold of a body and replace the previous ones; does nothing if the body no longer exists.
  /// [sim]
  /// @param places  for which problemOf() is empty
  void grasp(std::uint64_t body, const JawPositions &places, const GraspSettings &settings);
  /// Prescribed middle between the interactive jaws, m, and their rotation; does nothing if there are none. [sim]
  void moveInteractiveGrasp(const Vec3 &middle, const Mat3 &rotation);
  void releaseInteractiveGrasp();
  /// An obstacle that has been removed, with its associated data. Accessed on the simulation's thread.
  struct RemovedObstacle;
  /// Removes the obstacle of this id, as remove() does; does nothing if there is none. [sim]
  void takeOut(RemovedObstacle &obstacle);
  /// Restores it where it was, under another id, with its contact pairs and its attachments. The simulated state is
  /// kept, unless there were attachments or skin is now where the obstacle was: then the simulation is reset. Does
  /// nothing if the obstacle is present. [sim] @return whether the simulation has been reset
  bool putBack(RemovedObstacle &obstacle);
  /// A new obstacle, with the default friction. Throws sdk::Error. Any thread.
  [[nodiscard]] RemovedObstacle prepareObstacle(const std::string &name, c3de_handle mesh, const Placement &placement);
  /// The state before the pull that begins. [sim]
  [[nodiscard]] InteractionState checkpoint() const;
  /// Restores the stored state and stores the present one; does nothing if the simulation has been restarted since.
  /// [sim]
  void exchange(InteractionState &kept);
  /// m, as slices show it: the displacement by which the material has reached a position; 0 where there is no body.
  /// Waits for a step. Any thread.
  [[nodiscard]] Vec3 displacementAt(const Vec3 &place) const;
  /// Abandons a step that has taken long, before a command is posted that changes it: the state before the step is
  /// kept. Any thread.
  void abandonLongStep() { request_.abandonLongStep(); }
  /// Called before a grab is posted: the present step is not abandoned for its budget. Any thread.
  void liftStepBudget() { request_.liftStepBudget(); }
  [[nodiscard]] ParameterValues worldValues() const;
  [[nodiscard]] std::optional<BodySource> source(std::uint64_t body) const;
  /// Number of bodies that share a budget target. Any thread.
  void shareBudget(std::size_t bodies);
  /// Rebuilds the body with other values and replaces the old one; the simulation is reset. The old body is kept if
  /// building fails. Throws sdk::Error. Any thread.
  void rebuildBody(std::uint64_t body, const ParameterValues &values, const sdk::Progress &progress);
  /// Deviation of the bodies from their fine references, between two steps. The simulation does not change, and may
  /// continue meanwhile. Throws sdk::Error when cancelled. Any thread.
  std::shared_ptr<const WorldVerification> verifyBodies(const sdk::Progress &progress);
  /// Computes the trials from which displacement errors are estimated, for bodies that have none yet: some tenths of a
  /// second each. If a body cannot be tried, or its trials are cancelled, its statement reports this. Any thread.
  void computeTrials(const sdk::Progress &progress, const ParallelFor &parallelFor);
  /// Reads a body under the lock; false if the body no longer exists.
  bool readBody(std::uint64_t body, const std::function<void(const Body &)> &read) const;

  static std::array<sdk::Interface, 5> interfaces();

 private:
  /// First id of loads and holds, above those of bodies, obstacles and probes.
  static constexpr std::uint64_t kFirstRuntimeId = std::uint64_t{1} << 32;
  [[nodiscard]] std::vector<std::string> warningsOf(const ProbeTool &tool) const;
  [[nodiscard]] bool hasStepped() const;
  [[nodiscard]] std::vector<ReportedTool> reportedTools() const;
  [[nodiscard]] std::vector<ReportedAttachment> reportedAttachments() const;
  enum class Walls { stay, growWorldBox };
  void add(const c3de_sim_body *body, c3de_handle *out, Walls walls);
  void takeInstrumentAway();
  void lead(std::uint64_t obstacle, const RigidMotion &target);
  void releaseGrasp(std::uint64_t grasp);
  void setGrabs(std::uint64_t id, const Grasp &grasp);
  /// Id of the grab of its first jaw; the second jaw has the next id.
  [[nodiscard]] static std::uint64_t findGrab(std::uint64_t grasp);
  /// Nothing if it has lost what it held.
  [[nodiscard]] std::optional<GraspForces> forcesOn(std::uint64_t id, const Grasp &grasp) const;
  void updateGrasps();
  void resetGrasps();
  /// A grab holds a body, or there is an interactive instrument.
  [[nodiscard]] bool isInteracting() const;
  [[nodiscard]] std::vector<GraspSnapshot> graspsNow() const;
  [[nodiscard]] std::vector<ReportedGrasp> reportedGrasps() const;
  void resetSimulator();
  void growWorldBox(const BodyRecord &body);
  /// Positions and pulls of grabs, for the trial of an adaptive sampling: the last eight positions of a body.
  void recordGrab(std::uint64_t body, const Grab &grab);
  void recordPull(std::uint64_t body, std::uint64_t hand);
  /// Input of the accuracy setting for a body that is built now.
  [[nodiscard]] SamplingRequest samplingRequest();
  /// measureFrame() in this world.
  [[nodiscard]] double frameTime(const Body &body, const StopRequest *stop) const;

  PluginContext &context_;
  mutable std::mutex mutex_;
  StepInterrupt request_;
  Simulator simulator_;
  ParameterValues world_{worldDeclarations()};
  BodyTable table_;
  mutable EvaluationPoints points_;
  SnapshotWriter snapshots_;
  /// Attaches to the object that replaces the previously attached one; adds a warning where that is not possible.
  void reattach(Attachment attachment, std::uint64_t before, std::uint64_t now);
  std::map<std::uint64_t, GraspRecord> grasps_;
  /// For bodies on which external forces act in the next step. Copies, because another thread may replace the body
  /// while they are being written.
  struct SharedPoints {
    std::vector<Vec3> positions, velocities, forces;
    std::vector<double> masses;             // empty: to be recomputed
    std::shared_ptr<const RestState> rest;  // to which the masses belong
    std::string name;
    bool asked = false;
  };
  std::map<std::uint64_t, SharedPoints> lent_;
  /// A load added while the body is simulated: acts as external forces.
  struct RuntimeLoad {
    std::uint64_t body = 0;
    Load load;
    LoadedPart part;
    std::shared_ptr<const RestState> rest;  // to which the part belongs
    double began_s = 0.0;
  };
  std::map<std::uint64_t, RuntimeLoad> liveLoads_;
  /// A grab added by hold(); the grab of the pinch has no entry.
  struct RuntimeHold {
    std::uint64_t body = 0;
    Vec3 fromNamed = Vec3::Zero();  // from the specified point to the middle of the held patch, m, before rotation
    Vec3 target = Vec3::Zero();     // world, m
    Mat3 rotation = Mat3::Identity();
    bool keepsShape = false;
  };
  std::map<std::uint64_t, RuntimeHold> holds_;
  std::uint64_t nextRuntimeId_ = kFirstRuntimeId;
  [[nodiscard]] RuntimeHold &holdOrThrow(c3de_handle hold);
  void bind(RuntimeLoad &load) const;
  void applyExternalForces();
  [[nodiscard]] sdk::SceneRecord sceneRecord() const;
  c3de_handle node_{};
};

struct WorldSimulator::RemovedObstacle {
  std::uint64_t id = 0;
  std::optional<ObstacleRecord> record = {};  ///< none: the obstacle is present
  Obstacle obstacle = {};                     ///< with the motion that a reset assigns to it
  RigidMotion place = {};                     ///< its pose when it was removed
  ContactPairs pairs = {};
  std::vector<Attachment> attachments = {};
};

}  // namespace pointbased
