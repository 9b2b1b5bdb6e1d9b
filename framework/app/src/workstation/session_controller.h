// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "c3de/ui/measurement_list.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/comparison_controller.h"
#include "workstation/match_values.h"
#include "workstation/messages.h"
#include "workstation/missing_files_controller.h"
#include "workstation/session_recovery.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Saves what the window shows as a session, opens sessions, and knows what is not saved yet. Main thread. Must outlive
/// the session's jobs and simulation.
class SessionController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    WorkstationLoader &loader;
    WorkstationImages &images;
    ui::WorkstationWindow &window;
    ui::MeasurementList &measurements;
    ComparisonController &comparison;
    MatchValues &match;
    ReportError failed;
  };
  explicit SessionController(Parts parts);

  /// This file is opened without its name: saving asks for another file. For files that exist only until then.
  void keepUnnamed(const std::filesystem::path &file) { unnamed_ = file; }
  /// Adds the actions that save a session.
  void connect(ui::WindowActions &actions);
  /// Reads a session in a background job and builds its simulation.
  void open(const std::filesystem::path &file);
  /// Another simulation is the present one. @param session  from which it was built; null: not from a session
  /// @param notRestored  as WorkstationLoader::Loaded
  void onLoaded(const std::shared_ptr<const WorkstationLoader::OpenedSession> &session,
                const std::string &notRestored = {});
  /// Bodies were created that no file contains. The session of a scan continues. @param hasReplaced  another simulation
  /// was replaced, and this is another session
  void onMade(bool hasReplaced);
  void onImageShown();
  void onSelectionRestored();
  void onComparisonRestored();
  void onClosed();
  /// Of the present session; empty: not saved yet.
  [[nodiscard]] const std::filesystem::path &file() const { return file_; }
  /// What differs from the file.
  struct Unsaved {
    bool simulation = false, measurements = false;
    bool selection = false;   ///< what is picked or painted in the image
    bool comparison = false;  ///< the pose of the second scan
    bool match = false;       ///< the values of the panel *Match*
  };
  [[nodiscard]] Unsaved unsaved() const;
  [[nodiscard]] bool isModified() const {
    const Unsaved parts = unsaved();
    return parts.simulation || parts.measurements || parts.selection || parts.comparison || parts.match;
  }
  /// Called about once a second: writes what is not saved yet to the recovery file.
  void autosaveIfDue();
  void setAutosaveInterval(double interval_s);
  /// Call before the session ends. @param isInterrupted  the next run offers what is not saved
  void stop(bool isInterrupted) { recovery_.stop(isInterrupted); }
  /// The dialog for files that are missing or have changed.
  [[nodiscard]] ui::MissingFiles &missingFiles() { return missing_.dialog(); }
  /// Offers what runs that ended without saving have left.
  void offerRecovery();
  /// Undo or redo has replaced the simulation, or removed it: what is saved, and where, is unchanged.
  void onReplaced();
  using Captured = std::shared_ptr<Expected<CapturedState>>;
  /// Captures the present simulation between two steps; without one, a state without a source. `done` is called on the
  /// main thread.
  void capture(std::function<void(Captured)> done);

 private:
  using Clock = std::chrono::steady_clock;
  /// The state of a simulation that a file has.
  struct Baseline {
    std::uint64_t simulation = 0;  ///< serial
    std::uint64_t changes = 0, steps = 0;
    std::uint64_t measurements = 0;  ///< revision
    std::uint64_t selection = 0;     ///< revision of the mask; 0: nothing is picked
    std::uint64_t comparison = 0;    ///< revision of the pose; 0: as in its file
    std::uint64_t match = 0;         ///< revision of the values
    friend bool operator==(const Baseline &, const Baseline &) = default;
  };

  [[nodiscard]] Baseline present() const;
  [[nodiscard]] std::string title() const;
  [[nodiscard]] ShownView shownView() const;
  void save(const std::filesystem::path &file, Embedding embedding, std::function<void()> saved);
  void write(const std::filesystem::path &file, Embedding embedding, const Captured &captured, const Baseline &baseline,
             const ShownView &shown, const std::function<void()> &saved);
  void onSaved(const std::filesystem::path &file, Embedding embedding, const Baseline &written);
  /// Counts the files that the session would contain, in a background job.
  void measure(std::function<void(const std::string &)> measured);
  /// Builds a session whose files are found.
  void build(const MissingFilesController::Opened &opened);
  /// Another simulation replaces the present one: offers what was not saved of that.
  void begin();
  void notifyLost(const std::string &title, const LostSession &lost);
  void onAutosaveRefused(const Error &error);
  void showView(const WorkstationLoader::OpenedSession &opened);

  Parts parts_;
  MissingFilesController missing_;
  std::filesystem::path file_;                  ///< empty: not saved yet
  std::filesystem::path unnamed_;               ///< of keepUnnamed(); or empty
  Embedding embedding_ = Embedding::extracted;  ///< of the file
  std::optional<Baseline> baseline_;
  bool isSaving_ = false;
  std::shared_ptr<FileReferences> references_ = std::make_shared<FileReferences>();
  SessionFile foreign_;                     ///< members and keys of the opened session that this program does not know
  std::optional<SessionView> pendingView_;  ///< applied when the image is shown
  std::shared_ptr<const imaging::Mask> pendingMask_;
  std::filesystem::path pendingComparison_;  ///< file of pendingView_->comparison
  std::filesystem::path recovered_;          ///< recovery file of another run; empty: none
  SessionRecovery recovery_;
  std::optional<Baseline> autosaved_;
  Clock::time_point autosaveTried_ = Clock::now();
  Clock::duration autosaveInterval_ = std::chrono::seconds(8);
  std::optional<Clock::time_point> refusedSince_;  ///< the state cannot be stored
  bool hasReportedRefusal_ = false;
  std::uint64_t serial_ = 1;  ///< of the present simulation
  std::string title_;         ///< of what the recovery file has
  std::filesystem::file_time_type openedAt_{};
};

}  // namespace c3de::app
