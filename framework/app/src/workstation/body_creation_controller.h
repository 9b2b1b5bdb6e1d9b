// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/session/body_creation.h"
#include "workstation/messages.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Creates bodies from what is picked in the image, or one body from all of a scan, starts the simulation with them and
/// reports the result. Main thread. Must outlive the session.
class BodyCreationController {
 public:
  struct Events {
    /// Bodies have joined a simulation, which begins anew. @param isNew  it contains no other bodies
    /// @param hasReplaced  it replaced another simulation
    std::function<void(bool isNew, bool hasReplaced)> joined;
    /// Undo removes them. @param label  "create liver" @param isPicked  from what was picked in the image
    std::function<void(const std::string &label, bool isPicked)> created;
    ReportError failed;
  };
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::ToolRegistry &tools;
    WorkstationLoader &loader;
    WorkstationImages &images;
  };
  BodyCreationController(const Parts &parts, Events events);

  void createBodies(std::vector<segmentation::BodyRequest> requests) { creation_.createBodies(std::move(requests)); }
  /// Ends with ScanBody::finished().
  void createScanBody(const std::string &scene);

 private:
  void onCreated(const BodyCreation::Result &result);
  void reportCreated(const BodyCreation::Result &result);
  void reportMissing(const BodyCreation::Result &result);

  Parts parts_;
  Events events_;
  BodyCreation creation_;
};

}  // namespace c3de::app
