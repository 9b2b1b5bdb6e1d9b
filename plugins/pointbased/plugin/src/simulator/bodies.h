// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/accuracy_control.h"
#include "simulator/attachments.h"
#include "simulator/change_access.h"
#include "simulator/external_forces.h"
#include "simulator/world_parameters.h"

namespace pointbased {

/// Builds, adds and rebuilds bodies, and changes their parameters.
class Bodies {
 public:
  Bodies(SimulatedWorld &world, WorldParameters &parameters, AccuracyControl &accuracy, Attachments &attachments,
         ExternalForces &forces)
      : world_(world), parameters_(parameters), accuracy_(accuracy), attachments_(attachments), forces_(forces) {}

  /// A body that reaches beyond world.box is an error.
  void add(const c3de_sim_body *body, c3de_handle *out);
  void getParameter(c3de_handle body, c3de_str id, c3de_param_value *out);
  [[nodiscard]] std::optional<BodySource> source(std::uint64_t body) const;
  /// Builds a body that is not added yet. Throws sdk::Error. Any thread.
  [[nodiscard]] BuiltBody build(const std::string &name, const BodySource &source, const ParameterValues &values,
                                const SamplingRequest &request, const sdk::Progress &progress) const;

  // Changes. The mutex of the world is held; sdk::Error, and nothing has changed.
  /// Adds a body loaded by the user: the walls are moved outwards. The simulation is reset.
  void addLoaded(ChangeAccess access, BodyRecord record, BuiltBody &built);
  void setParameter(ChangeAccess access, std::uint64_t body, const c3de_param_value &value);
  /// Replaces a body by one that was built with other values; the simulation is reset.
  void replace(ChangeAccess access, std::uint64_t body, BuiltBody &built, const ParameterValues &values,
               const std::vector<BodyPart> &parts);

 private:
  void addBuilt(BodyRecord record, BuiltBody &built, std::uint64_t *id);

  SimulatedWorld &world_;
  WorldParameters &parameters_;
  AccuracyControl &accuracy_;
  Attachments &attachments_;
  ExternalForces &forces_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
