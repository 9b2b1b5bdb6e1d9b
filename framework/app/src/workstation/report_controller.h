// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/core/log.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/session/problem_report.h"
#include "c3de/session/recorder.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"

namespace c3de::app {

/// The last lines of the log of this run. Any thread.
class KeptLog {
 public:
  KeptLog();
  ~KeptLog();
  KeptLog(const KeptLog &) = delete;
  KeptLog &operator=(const KeptLog &) = delete;
  [[nodiscard]] std::string text() const;

 private:
  void add(const std::string &line);

  mutable std::mutex mutex_;
  std::deque<std::string> lines_;
  std::size_t bytes_ = 0;
};

/// Records what happens in the present simulation in a file of the cache, and saves reports about problems with it.
/// Main thread. Must outlive the session's jobs and simulation.
class ReportController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::ParameterRegistry &parameters;
    const KeptLog &log;
    std::string graphics;  ///< of the renderer
    ReportError failed;
  };
  explicit ReportController(Parts parts) : parts_(std::move(parts)) {}
  ~ReportController();
  ReportController(const ReportController &) = delete;
  ReportController &operator=(const ReportController &) = delete;

  void connect(ui::WindowActions &actions);
  /// The present simulation is another one, or its bodies are. @param hasState  it does not begin at its initial state
  void begin(bool hasState);
  /// The present simulation has no past to report: it is a replay, or has been closed.
  void end();
  /// Before the session ends.
  void stop();

 private:
  struct Past {
    std::shared_ptr<Recorder> recorder;
    ReportedPast reported;
  };
  void measure();
  void save(const ui::ReportRequest &wanted, const std::filesystem::path &file);
  void write(const ProblemReport &report, const std::filesystem::path &file);
  [[nodiscard]] std::string values() const;
  [[nodiscard]] std::string logText() const;

  Parts parts_;
  std::uint64_t serial_ = 0;          ///< of what begin() has begun last
  std::shared_ptr<const Past> past_;  ///< null: none
  Handle node_;                       ///< of its simulation
  std::string whyNone_ = "no simulation is open";
  ui::ReportContents contents_;
};

}  // namespace c3de::app
