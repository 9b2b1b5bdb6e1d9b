// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/pointbased/point_sets.hpp"
#include "c3de/sdk/object.hpp"
#include "simulator/bodies.h"
#include "simulator/body_queries.h"
#include "simulator/body_verifier.h"
#include "simulator/changing_calls.h"
#include "simulator/checkpoints.h"
#include "simulator/condition_calls.h"
#include "simulator/contacts.h"
#include "simulator/continuation.h"
#include "simulator/grasps.h"
#include "simulator/identification_calls.h"
#include "simulator/matching_calls.h"
#include "simulator/obstacles.h"
#include "simulator/probes.h"
#include "simulator/saved_state.h"
#include "simulator/surface_conditions.h"

namespace pointbased {

/// The parts of a WorldSimulator, each with one responsibility. A part refers only to those above it.
struct SimulatorParts {
  explicit SimulatorParts(PluginContext &context) : world(context) {}
  SimulatorParts(const SimulatorParts &) = delete;
  SimulatorParts &operator=(const SimulatorParts &) = delete;

  SimulatedWorld world;
  SnapshotWriter snapshots{world.context.services, world.simulator, world.table, world.points};
  WorldParameters parameters{world};
  AccuracyControl accuracy{world};
  Attachments attachments{world};
  Contacts contacts{world};
  ExternalForces forces{world};
  SurfaceConditions conditions{world};
  Holds holds{world};
  Grasps grasps{world};
  Probes probes{world};
  Bodies bodies{world, parameters, accuracy, attachments, forces};
  Obstacles obstacles{world, attachments};
  BodyQueries queries{world};
  BodyVerifier verifier{world, snapshots};
  SavedState savedState{world, forces, conditions, holds, grasps, obstacles};
  Continuation continuation{world, conditions};
  Checkpoints checkpoints{world, grasps};
  Changes changes{*this};
  ChangingCalls calls{*this};
  ConditionCalls conditionCalls{*this};
  MatchingCalls matching{*this};
  IdentificationCalls identification{*this};
};

/// The registered class C3DE_POINTBASED_WORLD_SIMULATOR_CLASS: iface.simulator on top of the physics. Its tables call
/// its parts; here is what concerns several of them. Errors are thrown as sdk::Error. The window reads snapshots and
/// never locks the mutex of the world.
class WorldSimulator : public sdk::Object<WorldSimulator> {
 public:
  explicit WorldSimulator(PluginContext &context);
  ~WorldSimulator();

  // iface.simulator
  void attach(c3de_handle node);
  void declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride);
  void step();
  void reset();
  void publish();
  void status(c3de_sim_status *out);
  void stateHash(std::uint64_t *out);
  void report(c3de_sink json);
  void interrupt(std::uint32_t raised) { parts_.world.request.interrupt(raised != 0); }
  void activity(c3de_sink text);

  // pointbased.bodies
  void phyxels(c3de_handle body, c3de_object **out);
  void surfels(c3de_handle body, c3de_object **out);

  static std::array<sdk::Interface, 10> interfaces();
  /// Null if the object is of another class, or of another plugin.
  [[nodiscard]] static WorldSimulator *fromAbi(c3de_object *object);

  // For the controller, the views and the tools of this plugin.
  [[nodiscard]] SimulatorParts &parts() { return parts_; }
  [[nodiscard]] c3de_handle node() const { return node_; }
  [[nodiscard]] std::shared_ptr<const Snapshot> snapshot() const { return parts_.snapshots.latest(); }
  /// Abandons a step that has taken long, before a command is posted that changes it: the state before the step is
  /// kept. Any thread.
  void abandonLongStep() { parts_.world.request.abandonLongStep(); }
  /// Called before a grab is posted: the present step is not abandoned for its budget. Any thread.
  void liftStepBudget() { parts_.world.request.liftStepBudget(); }

 private:
  /// A grab holds a body, or there is an interactive instrument.
  [[nodiscard]] bool isInteracting() const;
  [[nodiscard]] bool hasStepped();

  PluginContext &context_;
  SimulatorParts parts_;
  Simulator &simulator_ = parts_.world.simulator;
  BodyTable &table_ = parts_.world.table;
  c3de_handle node_{};
};

}  // namespace pointbased
