// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/accuracy_control.h"
#include "simulator/attachments.h"
#include "simulator/external_forces.h"
#include "simulator/world_parameters.h"

namespace pointbased {

/// Builds, adds and rebuilds bodies, and changes their parameters.
class Bodies {
 public:
  Bodies(SimulatedWorld &world, WorldParameters &parameters, AccuracyControl &accuracy, Attachments &attachments,
         ExternalForces &forces)
      : world_(world), parameters_(parameters), accuracy_(accuracy), attachments_(attachments), forces_(forces) {}

  void add(const c3de_sim_body *body, c3de_handle *out) { addWithin(body, out, Walls::stay); }
  /// A scene's body that reaches beyond world.box is an error. For a body loaded by the user, the walls are moved
  /// outwards.
  void addLoaded(const c3de_sim_body *body, c3de_handle *out) { addWithin(body, out, Walls::grow); }
  void setParameter(c3de_handle body, const c3de_param_value *value);
  void getParameter(c3de_handle body, c3de_str id, c3de_param_value *out);
  [[nodiscard]] std::optional<BodySource> source(std::uint64_t body) const;
  /// Rebuilds the body with other values and replaces the old one; the simulation is reset. The old body is kept if
  /// building fails. Throws sdk::Error. Any thread.
  void rebuild(std::uint64_t body, const ParameterValues &values, const sdk::Progress &progress);

 private:
  enum class Walls { stay, grow };
  void addWithin(const c3de_sim_body *body, c3de_handle *out, Walls walls);

  SimulatedWorld &world_;
  WorldParameters &parameters_;
  AccuracyControl &accuracy_;
  Attachments &attachments_;
  ExternalForces &forces_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
