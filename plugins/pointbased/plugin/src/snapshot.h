// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <optional>

#include "accuracy_dial.h"
#include "accuracy_statement.h"
#include "colouring.h"
#include "grasp.h"
#include "parameters.h"
#include "placed_mesh.h"
#include "pointbased/probe_tool.h"
#include "pointbased/simulator.h"
#include "verification.h"

namespace pointbased {

struct BodySnapshot {
  std::uint64_t id = 0;
  std::string name;
  std::shared_ptr<const std::vector<std::string>> tissues;  ///< names of its parts, from 0; may be empty
  std::shared_ptr<const RestState> rest;
  std::shared_ptr<PlacedMesh> surface;
  std::shared_ptr<const ParameterValues> values;
  std::shared_ptr<const AccuracyPromise> promise;    ///< null: its sampling was said
  std::shared_ptr<const AdaptiveSampling> adaptive;  ///< null: finer cells were not asked for
  std::string addedMass;                             ///< addedMassText()
  /// sRGB, of the surface by the material; none: by its place among the bodies
  std::optional<std::array<float, 3>> colour;
  std::uint64_t changes = 0;  ///< of the simulator: the same number, the same places
  std::size_t held = 0;       ///< phyxels that do not move by themselves: heldPhyxels()
  bool asleep = false;
  bool rigid = false;
  bool stands = false;  ///< rigid, and nothing moves it
  bool isExplicit = true;
  double stableStep = 0.0;                         ///< s, at rest
  std::string computed;                            ///< how: "explicit, double precision, AVX3"
  std::vector<Vec3> phyxels;                       ///< world, m
  std::vector<Vec3f> surfels, normals;             ///< world, m; single precision, as a screen takes it
  std::vector<Vec3> points;                        ///< world, m: what view.points shows of the inside; empty: nothing
  std::vector<Rgba8> surfelColours, pointColours;  ///< empty: by the material
  std::uint64_t colours = 0;                       ///< the same number, the same colours
  double mass = 0.0;                               ///< kg
  double youngsModulus = 0.0;                      ///< Pa
  AccuracyStatement accuracy;                      ///< of now or a little before; of a rigid body nothing
  bool isTried = false;                            ///< the trials of its statement were made
  double cost = 0.0;                               ///< s of computing per simulated second
  Simulator::Energy energy;
  Neighbours neighbours;
  std::optional<GrabStatus> grab;
};

/// What passes between two that touch.
struct ContactSnapshot {
  ContactSummary summary;
  std::string first, second;  ///< names
};

struct AttachmentSnapshot {
  std::string name, first, second;
  double force = 0.0;     ///< N
  double tornPart = 0.0;  ///< 0 … 1
};

/// What all bodies do to an obstacle together, mean over the last step.
struct ObstacleTouch {
  Vec3 force = Vec3::Zero();           ///< N, on the obstacle
  double pressing = 0.0, depth = 0.0;  ///< N, m
  double area = 0.0;                   ///< m², of skin that presses
  std::size_t points = 0;
  double displaced = 0.0;  ///< m³, of tissue that lay in the reference where the obstacle is now

  void add(const ContactSnapshot &contact, std::uint64_t obstacle) {
    if (contact.summary.second != obstacle) return;
    force -= contact.summary.force;
    pressing += contact.summary.pressing;
    depth = std::max(depth, contact.summary.depth);
    area += contact.summary.area;
    points += contact.summary.points;
  }
};

struct ObstacleSnapshot {
  std::uint64_t id = 0;
  std::string name;
  std::shared_ptr<PlacedMesh> mesh;    ///< at rest
  RigidMotion motion;                  ///< where it is now
  bool hasOwnMotion = false;           ///< of the scene
  bool isInstrument = false;           ///< in a hand
  std::optional<ProbeTool> tool = {};  ///< none: made of a mesh
  ObstacleTouch touch = {};

  /// m, world: of a probe tool its middle, of a mesh that of its box, where it is now and at rest.
  [[nodiscard]] Vec3 middleAtRest() const { return tool ? tool->path.front().at : Vec3(0.5 * (mesh->min + mesh->max)); }
  [[nodiscard]] Vec3 middle() const { return middleAtRest() + motion.displacementOf(middleAtRest()); }
};

/// A pair of jaws that holds.
struct GraspSnapshot {
  std::uint64_t id = 0;  ///< kGraspInHand: of a person
  std::string name;      ///< of the scene; empty: in a hand
  std::uint64_t body = 0;
  std::array<SkinPoint, 2> points;  ///< of the skin, in the middles of what they hold
  GraspSettings settings;
  Vec3 middle = Vec3::Zero();        ///< m, between them, where they are led
  Mat3 rotation = Mat3::Identity();  ///< likewise
  Vec3 axis = Vec3::UnitX();         ///< unit, from the first to the second, as they are turned
  Vec3 normal = Vec3::UnitZ();       ///< unit, away from the tissue, likewise
  GraspForces forces;

  /// m, world: where the arms of the jaws meet, as they are drawn.
  [[nodiscard]] Vec3 hinge(const BodySnapshot &of) const {
    return 0.5 * (points[0].at(of.surfels) + points[1].at(of.surfels)) + kArms * settings.opening * normal;
  }
  static constexpr double kArms = 1.2;  ///< openings, from between the jaws to the hinge
};
inline constexpr std::uint64_t kGraspInHand = 1;

/// What the window sees of the simulation: one moment, complete.
struct Snapshot {
  std::uint64_t generation = 0;
  double time = 0.0, dt = 0.0;
  std::uint64_t steps = 0, hash = 0;
  std::uint64_t course = 0;  ///< differs where the simulation has begun anew
  bool failed = false;
  bool quasiStatic = false;
  WorldBox box;
  Vec3 gravity = Vec3::Zero();
  ViewSettings view;
  std::optional<ColourScale> colours;  ///< none: by the material
  bool coloursOld = false;             ///< they are those of an earlier state, because finding them takes long
  std::vector<BodySnapshot> bodies;
  std::vector<ObstacleSnapshot> obstacles;
  std::vector<ContactSnapshot> contacts;
  std::vector<AttachmentSnapshot> attachments;
  std::vector<GraspSnapshot> grasps;
  std::vector<StageClock::Summary> stages;
  std::vector<StepComposition> compositions;  ///< of the bodies
  std::vector<SimulationEvent> events;
  std::vector<std::string> notices;                       ///< what people should know of the events and of now
  std::shared_ptr<const WorldVerification> verification;  ///< the latest; null: none
  bool verified = false;                                  ///< it is of this state

  [[nodiscard]] const ObstacleSnapshot *obstacle(std::uint64_t id) const {
    for (const ObstacleSnapshot &o : obstacles)
      if (o.id == id) return &o;
    return nullptr;
  }
  /// Null: no hand holds one.
  [[nodiscard]] const ObstacleSnapshot *instrument() const {
    for (const ObstacleSnapshot &o : obstacles)
      if (o.isInstrument) return &o;
    return nullptr;
  }
  /// Null: no hand grasps.
  [[nodiscard]] const GraspSnapshot *graspInHand() const {
    for (const GraspSnapshot &g : grasps)
      if (g.id == kGraspInHand) return &g;
    return nullptr;
  }
  [[nodiscard]] const BodySnapshot *body(std::uint64_t id) const {
    for (const BodySnapshot &b : bodies)
      if (b.id == id) return &b;
    return nullptr;
  }
};

/// Hands the latest snapshot from the solver to the window; neither waits for the other, and buffers are used again.
class SnapshotExchange {
 public:
  /// A snapshot that nobody reads any more. Solver's thread.
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
