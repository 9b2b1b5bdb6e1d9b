// SPDX-License-Identifier: Apache-2.0
// The manifest of changes: every kind has an id and codes its arguments in walk(). `apply` executes it with the mutex
// of the world held, and leaves everything as it was if it throws. `prepare` does what takes long, without the mutex; a
// second call has no effect. A kind with kFlags of C3DE_SIM_CHANGE_TRANSIENT is removed by a reset. A kind with a key()
// is superfluous once a later one of equal key was applied, unless changes in between depend on it. Members after
// walk() are results, or prepared data, and are not coded.
#pragma once

#include <variant>

#include "simulator/change_access.h"
#include "simulator/change_types.h"
#include "simulator/object_name.h"
#include "simulator/surface_condition.h"

namespace pointbased {

struct SimulatorParts;
struct BuiltBody;
struct BodySource;
struct RemovedObstacle;

inline constexpr std::uint32_t kTransient = C3DE_SIM_CHANGE_TRANSIENT;

/// Values of the world, accepted or refused together.
struct SetWorldParameters {
  static constexpr std::string_view kId = "world.parameter";
  ParameterEntries values;
  template <class Coder>
  void walk(Coder &coder) {
    coder(values);
  }
  [[nodiscard]] std::string key() const;
  /// Whether the simulation does not depend on it.
  [[nodiscard]] bool isOfTheView() const;
  [[nodiscard]] std::string text() const;
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

struct SetBodyParameter {
  static constexpr std::string_view kId = "body.parameter";
  ObjectName body;
  ParameterEntry value;
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, value);
  }
  [[nodiscard]] std::string key() const;
  [[nodiscard]] std::string text() const;
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// Fills a body again with other values.
struct RebuildBody {
  static constexpr std::string_view kId = "body.rebuild";
  ObjectName body;
  ParameterEntries values;
  /// What its sampling depended on: recorded when it is prepared for the first time.
  struct Inputs {
    SamplingInputs sampling;
    std::vector<ParameterEntries> parts;  ///< values of its parts
    std::vector<Load> grabs;              ///< pulls up to then
    template <class Coder>
    void walk(Coder &coder) {
      coder(sampling, parts, grabs);
    }
  };
  std::optional<Inputs> inputs = {};
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, values, inputs);
  }
  std::shared_ptr<BuiltBody> built = {};
  std::shared_ptr<const BodySource> source = {};
  [[nodiscard]] std::string text() const { return "rebuild " + textOf(body); }
  void prepare(SimulatorParts &parts, const sdk::Progress &progress);
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// A body without supports and loads, as the panel loads it.
struct LoadBody {
  static constexpr std::string_view kId = "body.load";
  std::string name;
  MeshData mesh;
  Placement placement;
  ParameterEntries values;
  std::optional<ObjectName> replaced;  ///< removed once the new one is there
  std::optional<SamplingInputs> inputs = {};
  template <class Coder>
  void walk(Coder &coder) {
    coder(name, mesh, placement, values, replaced, inputs);
  }
  std::shared_ptr<BuiltBody> built = {};
  std::shared_ptr<BodySource> source = {};
  [[nodiscard]] std::string text() const { return "load " + name; }
  void prepare(SimulatorParts &parts, const sdk::Progress &progress);
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// An obstacle that does not move by itself: an implant, a plate.
struct AddObstacle {
  static constexpr std::string_view kId = "obstacle.add";
  std::string name;
  MeshData mesh;
  Placement placement;
  double friction = 0.0, restitution = 0.0;
  template <class Coder>
  void walk(Coder &coder) {
    coder(name, mesh, placement, friction, restitution);
  }
  std::shared_ptr<RemovedObstacle> built = {};
  ObjectName added = {};
  bool hasReset = false;
  [[nodiscard]] std::string text() const { return "add " + name; }
  void prepare(SimulatorParts &parts, const sdk::Progress &progress);
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// Restores an obstacle that was removed, with its contact pairs and attachments.
struct RestoreObstacle {
  static constexpr std::string_view kId = "obstacle.restore";
  ObjectName obstacle;
  struct Pose {
    RigidMotion motion;      ///< when it was removed
    bool isInitial = false;  ///< restored before the first step: its position at every reset from then on
    template <class Coder>
    void walk(Coder &coder) {
      coder(motion, isInitial);
    }
  };
  std::optional<Pose> pose = {};  ///< recorded when it is applied for the first time
  template <class Coder>
  void walk(Coder &coder) {
    coder(obstacle, pose);
  }
  bool hasReset = false;
  [[nodiscard]] std::string text() const { return "restore " + textOf(obstacle); }
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// Moves an obstacle no faster than contact can follow. Before the first step it is placed, which a reset retains;
/// later a reset returns it.
struct MoveObstacle {
  static constexpr std::string_view kId = "obstacle.move";
  ObjectName obstacle;
  RigidMotion target;
  template <class Coder>
  void walk(Coder &coder) {
    coder(obstacle, target);
  }
  bool isPlaced = false;
  [[nodiscard]] std::string key() const { return obstacle.name + '\n' + std::to_string(obstacle.number); }
  [[nodiscard]] std::uint32_t flags() const { return isPlaced ? 0 : kTransient; }
  [[nodiscard]] std::string text() const { return "move " + textOf(obstacle); }
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// Removes what iface.simulator removes.
struct RemoveObject {
  static constexpr std::string_view kId = "object.remove";
  enum class What : std::uint8_t { body, obstacle, probe, attachment, grasp, load, hold };
  What what = What::body;
  ObjectName name;           ///< empty for loads and holds
  std::uint64_t number = 0;  ///< of AddLoad and BeginHold
  template <class Coder>
  void walk(Coder &coder) {
    auto kind = static_cast<std::uint8_t>(what);
    coder(kind, name, number);
    require(kind <= static_cast<std::uint8_t>(What::hold), "what it removes is not known");
    what = static_cast<What>(kind);
  }
  [[nodiscard]] bool isTransient() const { return what == What::load || what == What::hold; }
  [[nodiscard]] std::uint32_t flags() const { return isTransient() ? kTransient : 0; }
  [[nodiscard]] std::string text() const;
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

struct ClearWorld {
  static constexpr std::string_view kId = "world.clear";
  template <class Coder>
  void walk(Coder &) {}
  [[nodiscard]] std::string text() const { return "clear"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// The interactive instrument appears and replaces the previous one.
struct PlaceInstrument {
  static constexpr std::string_view kId = "instrument.place";
  static constexpr std::uint32_t kFlags = kTransient;
  double radius = 0.0, length = 0.0, friction = 0.0;  ///< of ProbeTool
  Vec3 at = Vec3::Zero(), axis = Vec3::UnitZ();
  template <class Coder>
  void walk(Coder &coder) {
    coder(radius, length, friction, at, axis);
  }
  [[nodiscard]] std::string text() const { return "place instrument"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct MoveInstrument {
  static constexpr std::string_view kId = "instrument.move";
  static constexpr std::uint32_t kFlags = kTransient;
  Vec3 middle = Vec3::Zero();  ///< m
  template <class Coder>
  void walk(Coder &coder) {
    coder(middle);
  }
  [[nodiscard]] std::string text() const { return "move instrument"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct RemoveInstrument {
  static constexpr std::string_view kId = "instrument.remove";
  static constexpr std::uint32_t kFlags = kTransient;
  template <class Coder>
  void walk(Coder &) {}
  [[nodiscard]] std::string text() const { return "remove instrument"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// Interactive jaws grasp a body and replace the previous ones.
struct BeginGrasp {
  static constexpr std::string_view kId = "jaws.begin";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  JawPositions places;
  GraspSettings settings;
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, places, settings);
  }
  [[nodiscard]] std::string text() const { return "grasp " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct MoveGrasp {
  static constexpr std::string_view kId = "jaws.move";
  static constexpr std::uint32_t kFlags = kTransient;
  Vec3 middle = Vec3::Zero();  ///< m
  Mat3 rotation = Mat3::Identity();
  template <class Coder>
  void walk(Coder &coder) {
    coder(middle, rotation);
  }
  [[nodiscard]] std::string text() const { return "move jaws"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct ReleaseGrasp {
  static constexpr std::string_view kId = "jaws.release";
  static constexpr std::uint32_t kFlags = kTransient;
  template <class Coder>
  void walk(Coder &) {}
  [[nodiscard]] std::string text() const { return "release jaws"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// The pinch holds a part of a body.
struct BeginPinch {
  static constexpr std::string_view kId = "pinch.begin";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  Grab grab;
  double ownLimit = 0.0;  ///< N, besides the limit of the tissue; 0: none
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, grab, ownLimit);
  }
  [[nodiscard]] std::string text() const { return "pull on " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct MovePinch {
  static constexpr std::string_view kId = "pinch.move";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  Vec3 target = Vec3::Zero();  ///< m
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, target);
  }
  [[nodiscard]] std::string text() const { return "pull on " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct ReleasePinch {
  static constexpr std::string_view kId = "pinch.release";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  template <class Coder>
  void walk(Coder &coder) {
    coder(body);
  }
  [[nodiscard]] std::string text() const { return "release " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// A load of another plugin. It is named by a number that is given when it is added.
struct AddLoad {
  static constexpr std::string_view kId = "load.add";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  Load load;
  std::uint64_t number = 0;  ///< 0: the next one
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, load, number);
  }
  std::uint64_t id = 0;
  [[nodiscard]] std::string text() const { return "load on " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access);
};
/// c3de_sim_hold, numbered in the same way.
struct BeginHold {
  static constexpr std::string_view kId = "hold.begin";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  Vec3 at = Vec3::Zero();
  double radius = 0.0, frequency_hz = 0.0, dampingRatio = 0.0, maxForce = 0.0;
  std::uint32_t holdFlags = 0;
  std::uint64_t number = 0;
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, at, radius, frequency_hz, dampingRatio, maxForce, holdFlags, number);
  }
  std::uint64_t id = 0;
  [[nodiscard]] std::string text() const { return "hold " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access);
};
struct PullHold {
  static constexpr std::string_view kId = "hold.pull";
  static constexpr std::uint32_t kFlags = kTransient;
  std::uint64_t number = 0;
  Vec3 target = Vec3::Zero();                            ///< m
  std::optional<std::array<double, 4>> quaternion = {};  ///< x, y, z, w
  template <class Coder>
  void walk(Coder &coder) {
    coder(number, target, quaternion);
  }
  [[nodiscard]] std::string text() const { return "pull"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// Adds or replaces a support or load on a part of a surface; without a condition it removes the one of this number.
struct SetSurfaceCondition {
  static constexpr std::string_view kId = "condition.set";
  std::uint64_t number = 0;  ///< 0: the next one
  std::optional<SurfaceCondition> condition = {};
  template <class Coder>
  void walk(Coder &coder) {
    coder(number, condition);
  }
  [[nodiscard]] std::string key() const { return std::to_string(number); }
  [[nodiscard]] std::string text() const {
    return condition ? "set " + condition->name : "remove support or load " + std::to_string(number);
  }
  void apply(SimulatorParts &parts, ChangeAccess access);
};

/// Puts a body into an equilibrium that was found for it, with the forces that hold it there. They act until a reset.
struct SetMatchedState {
  static constexpr std::string_view kId = "match.set";
  static constexpr std::uint32_t kFlags = kTransient;
  ObjectName body;
  std::vector<Vec3> displacements = {}, forces = {};  ///< [phyxels] m, N
  template <class Coder>
  void walk(Coder &coder) {
    coder(body, displacements, forces);
  }
  [[nodiscard]] std::string text() const { return "match " + textOf(body); }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// Stores the present state under a number, for exchange: undo of an interaction.
struct StoreCheckpoint {
  static constexpr std::string_view kId = "checkpoint.store";
  static constexpr std::uint32_t kFlags = kTransient;
  std::uint64_t number = 0;  ///< 0: the next one
  template <class Coder>
  void walk(Coder &coder) {
    coder(number);
  }
  [[nodiscard]] std::string text() const { return "begin interaction"; }
  void apply(SimulatorParts &parts, ChangeAccess access);
};
/// Restores the stored state and stores the present one under its number.
struct ExchangeCheckpoint {
  static constexpr std::string_view kId = "checkpoint.exchange";
  static constexpr std::uint32_t kFlags = kTransient;
  std::uint64_t number = 0;
  template <class Coder>
  void walk(Coder &coder) {
    coder(number);
  }
  [[nodiscard]] std::string text() const { return "exchange states"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};
struct DropCheckpoint {
  static constexpr std::string_view kId = "checkpoint.drop";
  static constexpr std::uint32_t kFlags = kTransient;
  std::uint64_t number = 0;
  template <class Coder>
  void walk(Coder &coder) {
    coder(number);
  }
  [[nodiscard]] std::string text() const { return "end interaction"; }
  void apply(SimulatorParts &parts, ChangeAccess access) const;
};

/// Serializes the present state. Iterative solvers then start anew, so a replay serializes it at the same step.
struct StoreState {
  static constexpr std::string_view kId = "state.store";
  static constexpr std::uint32_t kFlags = kTransient;
  std::string bytes = {};  ///< result
  template <class Coder>
  void walk(Coder &) {}
  [[nodiscard]] std::string text() const { return "store state"; }
  void apply(SimulatorParts &parts, ChangeAccess access);
};

using AnyChange =
    std::variant<SetWorldParameters, SetBodyParameter, RebuildBody, LoadBody, AddObstacle, RestoreObstacle,
                 MoveObstacle, RemoveObject, ClearWorld, PlaceInstrument, MoveInstrument, RemoveInstrument, BeginGrasp,
                 MoveGrasp, ReleaseGrasp, BeginPinch, MovePinch, ReleasePinch, AddLoad, BeginHold, PullHold,
                 SetSurfaceCondition, SetMatchedState, StoreCheckpoint, ExchangeCheckpoint, DropCheckpoint, StoreState>;

}  // namespace pointbased
