// SPDX-License-Identifier: Apache-2.0
// Periodic checks for defects that are not prevented and for high costs, reported as events. Private to the core.
#pragma once

#include "stepping/simulation/simulation_state.h"

namespace pointbased::detail {

class StepMonitor {
 public:
  StepMonitor(SimulationState &state, const World &world) : state_(state), world_(world) {}

  /// Once per simulation. Stops bodies that contact cannot separate from what they overlap.
  void reportInitialWarnings(const StepContext &context);
  [[nodiscard]] bool isSkinCheckDue() const;
  void checkSkins();
  void reportTornAttachments();
  /// The body is too thin for its spacing to touch itself. Once per body.
  void reportUnresolvedThickness(std::size_t id, double thickness);

 private:
  [[nodiscard]] std::uint64_t skinCheckInterval() const;
  void checkPairOverlap();
  void checkRigidTissue(std::size_t id);
  void reportPenetration(const Body &body, double depth, double spacings, double &deepest, const char *what,
                         const char *where);
  void checkContacts();
  void checkInitialState(const StepContext &context);
  void reportLostRestitution();

  SimulationState &state_;
  const World &world_;
  std::vector<Vec3> skin_;  // scratch for checking one skin
};

}  // namespace pointbased::detail
