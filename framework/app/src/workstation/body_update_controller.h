// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "workstation/simulation_history.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Replaces the mask of a body while it is simulated: builds the simulation again with the new mask in the background,
/// continues from the present state, and reports the change of energy. One undo step each. Main thread. Must outlive the
/// session's jobs.
class BodyUpdateController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::ToolRegistry &tools;
    WorkstationLoader &loader;
    WorkstationImages &images;
    SessionController &sessions;
    SimulationHistory &history;
    ReportError failed;
  };
  /// @param prepare  called before each update: why there can be none now, for the user; empty: there can
  BodyUpdateController(const Parts &parts, std::function<std::string()> prepare)
      : parts_(parts), prepare_(std::move(prepare)) {}

  /// A later call for a body replaces one that waits.
  void update(const std::string &body, std::shared_ptr<const imaging::Mask> mask);
  /// Lists the bodies of the present simulation in the segmentation. Cheap if none has changed.
  void showBodies();

 private:
  using Clock = std::chrono::steady_clock;
  struct Request {
    std::string body;
    std::shared_ptr<const imaging::Mask> mask;
    Clock::time_point requested;
    int tries = 0;
    bool isPlaying = false;
    bool isOfStroke = false;  ///< it follows one change of the mask
  };
  void begin(Request request);
  void build(const Request &request);
  void onBuilt(const Request &request, const std::vector<ContinuedBody> &bodies);
  void onFailed(const Request &request, const Error &error);
  void end();

  Parts parts_;
  std::function<std::string()> prepare_;
  bool isRunning_ = false;
  std::optional<Request> next_;
  const ChangeLog *shownLog_ = nullptr;
  std::uint64_t shownCount_ = 0;
};

}  // namespace c3de::app
