// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "workstation/simulation_history.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Replaces the mask of a body while it is simulated: builds the simulation again with the new mask in the background,
/// continues from the present state, and reports the change of energy. One undo step each. Main thread. Must outlive
/// the session's jobs.
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
  using MaskRange = SimulationHistory::MaskRange;
  /// @param blockingReason  why there can be no update now, for the user; empty: there can
  BodyUpdateController(const Parts &parts, std::function<std::string()> blockingReason)
      : parts_(parts), blockingReason_(std::move(blockingReason)) {}

  /// Begins in one of the next frames, when nothing else is being loaded or undone. A later call replaces one that waits.
  /// @param range  the changes that led to the mask: undo reverts them as well
  void update(const std::string &body, std::shared_ptr<const imaging::Mask> mask, const MaskRange &range);
  /// To be called before each frame. Also lists the bodies of the present simulation in the segmentation.
  void onFrame();

 private:
  using Clock = std::chrono::steady_clock;
  struct Request {
    std::string body;
    std::shared_ptr<const imaging::Mask> mask;
    Clock::time_point requested;
    MaskRange range;
    int attempts = 0;
    /// Of the simulation that it replaces, before its state is captured.
    std::shared_ptr<ChangeLog> log = nullptr;
    std::uint64_t changes = 0;
  };
  void showBodies();
  void begin(Request request);
  void build(const Request &request, std::uint64_t capture);
  void onBuilt(const Request &request, const std::vector<ContinuedBody> &bodies);
  void onFailed(const Request &request, const Error &error);

  Parts parts_;
  std::function<std::string()> blockingReason_;
  bool isRunning_ = false;
  bool isPlaying_ = false;  ///< the simulation that has just been replaced
  std::optional<Request> next_;
  std::shared_ptr<ChangeLog> shownLog_;
  std::uint64_t shownCount_ = 0;
  std::vector<MaskedBody> masked_;  ///< of these
  std::set<std::string> shownNames_;
};

}  // namespace c3de::app
