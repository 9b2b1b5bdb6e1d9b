// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/report.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// Elastic layers between bodies, obstacles and surroundings: iface.attachment.
class Attachments {
 public:
  using Each = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_attachment_state *state);

  explicit Attachments(SimulatedWorld &world) : world_(world) {}

  void add(const c3de_sim_attachment *attachment, c3de_handle *out);
  c3de_status enumerate(void *visitor, Each each);

  // The mutex of the world is held.
  /// Attaches to the object that replaces the previously attached one; adds a warning where that is not possible.
  void reattach(Attachment attachment, std::uint64_t before, std::uint64_t now);
  [[nodiscard]] std::vector<ReportedAttachment> reported() const;

 private:
  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
