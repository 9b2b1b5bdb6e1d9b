// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <optional>

#include "base/accuracy_target.h"
#include "base/parameters.h"
#include "base/placed_mesh.h"
#include "fields/colouring.h"
#include "instruments/grasp.h"
#include "pointbased/probe_tool.h"
#include "pointbased/simulator.h"
#include "report/accuracy_statement.h"
#include "report/verification.h"
#include "simulator/surface_condition.h"

namespace pointbased {

struct BodySnapshot {
  std::uint64_t id = 0;
  std::string name;
  std::shared_ptr<const std::vector<std::string>> tissues;  ///< names of its parts, from 0; may be empty
  std::vector<std::string> supports;                        ///< of the scene: names, or numbers where they have none
  std::shared_ptr<const RestState> rest;
  std::shared_ptr<PlacedMesh> surface;
  std::shared_ptr<const ParameterValues> values;
  std::shared_ptr<const AccuracyPrediction> promise;  ///< null: its sampling was specified
  std::shared_ptr<const AdaptiveSampling> adaptive;   ///< null: finer cells were not requested
  std::string addedMass;                              ///< addedMassText()
  /// sRGB, of the surface by the material; none: by its index among the bodies
  std::optional<std::array<float, 3>> colour;
  std::uint64_t changes = 0;  ///< of the simulator: equal numbers mean equal positions
  std::size_t held = 0;       ///< phyxels that do not move freely: heldPhyxels()
  bool asleep = false;
  bool rigid = false;
  bool isStatic = false;  ///< rigid, and nothing moves it
  bool isExplicit = true;
  double stableStep = 0.0;                         ///< s, at rest
  std::string computed;                            ///< computation method: "explicit, double precision, AVX3"
  std::vector<Vec3> phyxels;                       ///< world, m
  std::vector<Vec3f> surfels, normals;             ///< world, m; single precision, as required for display
  std::vector<Vec3> points;                        ///< world, m; interior points shown by view.points; empty if none
  std::vector<Rgba8> surfelColours, pointColours;  ///< empty: by the material
  std::uint64_t colours = 0;                       ///< equal numbers mean equal colours
  double mass = 0.0;                               ///< kg
  double youngsModulus = 0.0;                      ///< Pa
  AccuracyStatement accuracy;                      ///< of the present or a slightly earlier state; empty for a rigid
                                                   ///< body
  bool hasTrials = false;                          ///< the trials of its statement have been computed
  double cost = 0.0;                               ///< s of computing per simulated second
  Diagnostics::Energy energy;
  Neighbours neighbours;
  std::optional<GrabStatus> grab;
};

/// Contact between two objects.
struct ContactSnapshot {
  ContactSummary summary;
  std::string first, second;  ///< names
};

struct AttachmentSnapshot {
  std::string name, first, second;
  double force = 0.0;     ///< N
  double tornPart = 0.0;  ///< 0 … 1
};

/// Total action of all bodies on an obstacle, mean over the last step.
struct ObstacleTouch {
  Vec3 force = Vec3::Zero();           ///< N, on the obstacle
  double pressing = 0.0, depth = 0.0;  ///< N, m
  double area = 0.0;                   ///< m², of pressing skin
  std::size_t points = 0;
  double displaced = 0.0;  ///< m³, of tissue whose reference position is inside the present obstacle

  void add(const ContactSnapshot &contact, std::uint64_t obstacle) {
    if (contact.summary.second != obstacle) return;
    force -= contact.summary.force;
    pressing += contact.summary.normalForce;
    depth = std::max(depth, contact.summary.depth);
    area += contact.summary.area;
    points += contact.summary.points;
  }
};

struct ObstacleSnapshot {
  std::uint64_t id = 0;
  std::string name;
  std::shared_ptr<PlacedMesh> mesh;    ///< at rest
  RigidMotion motion;                  ///< present motion from rest
  bool hasOwnMotion = false;           ///< prescribed by the scene
  bool isInstrument = false;           ///< controlled interactively
  std::optional<ProbeTool> tool = {};  ///< none: the obstacle is a mesh
  ObstacleTouch touch = {};

  /// m, world; present and at rest. For a probe tool its middle, for a mesh the middle of its box.
  [[nodiscard]] Vec3 middleAtRest() const { return tool ? tool->path.front().at : Vec3(0.5 * (mesh->min + mesh->max)); }
  [[nodiscard]] Vec3 middle() const { return middleAtRest() + motion.displacementOf(middleAtRest()); }
};

/// A pair of jaws that holds tissue.
struct GraspSnapshot {
  std::uint64_t id = 0;  ///< kInteractiveGrasp: controlled interactively
  std::string name;      ///< of the scene; empty if controlled interactively
  std::uint64_t body = 0;
  std::array<SkinPoint, 2> points;  ///< of the skin, at the centres of the held patches
  GraspSettings settings;
  Vec3 middle = Vec3::Zero();        ///< m, prescribed position between the jaws
  Mat3 rotation = Mat3::Identity();  ///< prescribed rotation
  Vec3 axis = Vec3::UnitX();         ///< unit, from the first to the second, as they are rotated
  Vec3 normal = Vec3::UnitZ();       ///< unit, away from the tissue, as they are rotated
  GraspForces forces;

  /// m, world: where the arms of the jaws meet in the display.
  [[nodiscard]] Vec3 hinge(const BodySnapshot &of) const {
    return 0.5 * (points[0].at(of.surfels) + points[1].at(of.surfels)) + kArms * settings.opening * normal;
  }
  static constexpr double kArms = 1.2;  ///< in openings, from between the jaws to the hinge
};
inline constexpr std::uint64_t kInteractiveGrasp = 1;

/// The state of the simulation as seen by the window: complete, at one moment.
struct Snapshot {
  std::uint64_t generation = 0;
  double time = 0.0, dt = 0.0;
  std::uint64_t steps = 0, hash = 0;
  std::uint64_t historyEpoch = 0;  ///< changes when the simulation is restarted
  bool failed = false;
  bool quasiStatic = false;
  WorldBox box;
  Vec3 gravity = Vec3::Zero();
  ViewSettings view;
  std::optional<ColourScale> colours;  ///< none: by the material
  bool areColoursOutdated = false;     ///< they belong to an earlier state, because computing them takes long
  std::vector<BodySnapshot> bodies;
  std::vector<ObstacleSnapshot> obstacles;
  std::vector<ContactSnapshot> contacts;
  std::vector<AttachmentSnapshot> attachments;
  std::vector<GraspSnapshot> grasps;
  std::vector<ConditionSnapshot> conditions;
  std::vector<StageClock::Summary> stages;
  std::vector<StepComposition> compositions;  ///< of the bodies
  std::vector<SimulationEvent> events;
  std::vector<std::string> notices;                       ///< notices for the user about the events and the present
                                                          ///< state
  std::shared_ptr<const WorldVerification> verification;  ///< the latest; null if there is none
  bool verified = false;                                  ///< `verification` belongs to this state

  [[nodiscard]] const ObstacleSnapshot *obstacle(std::uint64_t id) const {
    for (const ObstacleSnapshot &o : obstacles)
      if (o.id == id) return &o;
    return nullptr;
  }
  /// Null if there is none.
  [[nodiscard]] const ObstacleSnapshot *instrument() const {
    for (const ObstacleSnapshot &o : obstacles)
      if (o.isInstrument) return &o;
    return nullptr;
  }
  /// Null if there is no interactive grasp.
  [[nodiscard]] const GraspSnapshot *interactiveGrasp() const {
    for (const GraspSnapshot &g : grasps)
      if (g.id == kInteractiveGrasp) return &g;
    return nullptr;
  }
  [[nodiscard]] const BodySnapshot *body(std::uint64_t id) const {
    for (const BodySnapshot &b : bodies)
      if (b.id == id) return &b;
    return nullptr;
  }
};

/// Passes the latest snapshot from the solver to the window. Neither waits for the other; buffers are reused.
class SnapshotExchange {
 public:
  /// A snapshot that is no longer read. Solver thread.
  [[nodiscard]] std::shared_ptr<Snapshot> writable() {
    const std::lock_guard lock(mutex_);
    for (std::shared_ptr<Snapshot> &s : buffers_) {
      if (s && s != latest_ && s.use_count() == 1) return s;
      if (!s) return s = std::make_shared<Snapshot>();
    }
    return std::make_shared<Snapshot>();
  }
  void publish(std::shared_ptr<Snapshot> snapshot) {
    const std::lock_guard lock(mutex_);
    latest_ = std::move(snapshot);
  }
  /// Null before the first. Any thread.
  [[nodiscard]] std::shared_ptr<const Snapshot> latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }

 private:
  mutable std::mutex mutex_;
  std::array<std::shared_ptr<Snapshot>, 3> buffers_;
  std::shared_ptr<Snapshot> latest_;
};

}  // namespace pointbased
