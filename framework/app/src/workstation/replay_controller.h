// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "c3de/session/timeline.h"
#include "c3de/ui/stretch.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"
#include "workstation/stretch_writer.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Replays a recording in the window, with a timeline. The simulation's own transport stays paused: this class steps
/// it, in parts of a fraction of a second on the simulation's thread. Main thread. Must outlive the session's
/// simulation and jobs.
class ReplayController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::ToolRegistry &tools;
    WorkstationLoader &loader;
    ReportError failed;
    std::function<void()> left;  ///< the simulation has become an ordinary one
    ui::WorkstationWindow &window;
    render::Renderer &renderer;
    std::function<bool()> isViewCurrent;  ///< images and tissues in the view are those of the last snapshot
  };
  explicit ReplayController(Parts parts) : parts_(std::move(parts)) {}

  /// Adds the actions of the timeline. During a replay those of the transport act on it. Call after the actions of the
  /// simulation and of the session were added.
  void connect(ui::WindowActions &actions);
  /// Reads a recording in a background job and builds its simulation.
  void open(const std::filesystem::path &file) { open(file, nullptr); }
  /// The same for the past of the present simulation, which is kept to return to.
  void openPast(const std::filesystem::path &file);
  enum class Present { replay, keptOne, other };
  /// Another simulation is the present one; ends the replay unless it is that of the replay.
  [[nodiscard]] Present onLoaded(const std::shared_ptr<const WorkstationLoader::OpenedSession> &session);
  /// Ends the replay.
  void end();
  [[nodiscard]] bool isReplaying() const { return opened_ != nullptr; }
  /// Whether the simulation from before the replay is kept.
  [[nodiscard]] bool hasKept() const { return opened_ && opened_->kept; }
  void play(bool plays);
  /// Called once per frame: plays on, and shows how far the replay is.
  void show(ui::SimulationView &view);
  /// Called when the views have received the last snapshot: draws the picture that an export is waiting for.
  void drawPicture();

 private:
  using Clock = std::chrono::steady_clock;
  /// A recording that was read.
  struct Opened {
    std::filesystem::path file;
    std::vector<FoundFile> files;
    std::shared_ptr<Timeline> timeline;  ///< used by the simulation's thread while isBusy_
    std::shared_ptr<const std::vector<ui::ReplayView::Mark>> marks;
    std::shared_ptr<const CapturedState> kept;  ///< the simulation from before the replay; null: not kept
  };

  void open(const std::filesystem::path &file, std::shared_ptr<const CapturedState> kept);
  void onRead(const std::shared_ptr<Opened> &opened, Expected<void> result);
  void returnTo(const std::shared_ptr<const CapturedState> &kept);
  void build(std::shared_ptr<Opened> opened, const Timeline::Jump &jump);
  void onBuilt(const Expected<void> &result, std::uint64_t serial);
  void seek(std::uint64_t position);
  void step();
  void cancel();
  void leave();
  void transport(std::uint32_t action);
  void continueSeek();
  void continuePlaying();
  /// Advances on the simulation's thread.
  void post(const Timeline::Jump &jump, Timeline::Limits limits);
  void onAdvanced(const Expected<Timeline::Advanced> &advanced);
  void measureRate(double simulated_s);

  // The export of a stretch: replay_export.cpp.
  /// An export in progress.
  struct Export {
    std::shared_ptr<StretchWriter> writer;
    std::uint64_t returnTo = 0;  ///< position from before it
    render::Camera camera;
    std::size_t pictures = 0;     ///< written, as it was last reported
    bool isWriting = false;       ///< the begin was reached
    bool isPictureReady = false;  ///< the snapshot to be drawn was published
    bool isCancelled = false;
  };
  void connectExport(ui::ReplayActions &actions);
  void beginStretch();
  void startExport(const ui::StretchExport &wanted);
  void continueExport();
  void onExported(const Expected<StretchWriter::Reached> &reached);
  /// Completes the files, and returns to the position from before the export.
  void finishExport(const Expected<void> &result);
  void writeFilmOf(const std::shared_ptr<StretchWriter> &writer);
  void showExport(ui::ReplayView &replay) const;

  Parts parts_;
  std::shared_ptr<Opened> opened_;                                   ///< null: there is no replay
  std::shared_ptr<Opened> isOpening_;                                ///< its simulation is being built
  std::shared_ptr<const WorkstationLoader::OpenedSession> pending_;  ///< being built
  std::shared_ptr<const Keyframe> pendingFrom_;
  std::shared_ptr<const WorkstationLoader::OpenedSession> returning_;  ///< the kept simulation, being built
  std::string keptTitle_;                                              ///< of the kept simulation
  std::filesystem::path file_;                                         ///< of the last replay
  Handle node_;                                                        ///< of its simulation
  std::uint64_t builds_ = 0, serial_ = 0;
  bool isBusy_ = false;
  std::shared_ptr<std::atomic<bool>> stop_ = std::make_shared<std::atomic<bool>>(false);
  std::optional<std::uint64_t> target_;  ///< of a jump in progress
  std::uint64_t position_ = 0;           ///< as it was last reported
  std::string warning_;
  bool isPlaying_ = false;
  double rate_ = 1.0;    ///< simulated seconds per second; 0: as fast as possible
  double owed_s_ = 0.0;  ///< simulated time that playing is behind
  Clock::time_point tick_{};
  double measured_s_ = 0.0, factor_ = 0.0;  ///< simulated time since measuredAt_; real-time factor
  Clock::time_point measuredAt_{};
  ui::Stretch stretch_;
  bool hasProbes_ = false;
  std::filesystem::path filmProgram_;  ///< empty: there is none
  std::optional<Export> export_;
};

}  // namespace c3de::app
