// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/recorder.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"

namespace c3de::app {

/// Records the present simulation in a file that `c3de replay` repeats. Main thread. Must outlive the session's
/// simulation.
class RecordingController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::EditList &edits;
    ReportError failed;
    std::function<void(const std::filesystem::path &)> showTimeline;  ///< of a recording that is complete
  };
  explicit RecordingController(Parts parts) : parts_(std::move(parts)) {}

  /// Adds the actions that begin and end a recording.
  void connect(ui::WindowActions &actions);
  /// Name of the file that is being written; empty: none.
  [[nodiscard]] std::string fileName() const;
  /// Whether the present simulation is recorded, or was.
  [[nodiscard]] bool hasTimeline() const;
  /// The recorded simulation is the present one again.
  void onReturned() { node_ = parts_.session.simulationNode(); }
  /// Ends the recording because something happens that it cannot contain. @param why  a sentence
  void end(const std::string &why);
  /// Completes the file, and waits for it. Call before the session ends.
  void finish();

 private:
  using Finished = std::function<void(const Expected<void> &)>;
  void start(const std::filesystem::path &file);
  void begin(const std::filesystem::path &file, const Expected<std::shared_ptr<Recorder>> &recorder);
  void stop();
  void showTimeline();
  /// Completes the file of the recorder between two steps, or at once if its simulation has ended.
  void complete(const Finished &finished);

  Parts parts_;
  bool isStarting_ = false;
  std::shared_ptr<Recorder> recorder_;  ///< null: not recording
  Handle node_;                         ///< of the recorded simulation
  std::filesystem::path file_;
};

}  // namespace c3de::app
