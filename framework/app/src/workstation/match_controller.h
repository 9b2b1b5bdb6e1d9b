// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/match_stages.h"
#include "c3de/session/session.h"
#include "c3de/ui/match_panel.h"
#include "c3de/ui/measurement_list.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/match_presenter.h"
#include "workstation/match_stream.h"
#include "workstation/match_values.h"
#include "workstation/messages.h"
#include "workstation/simulation_history.h"
#include "workstation/workstation_images.h"

namespace c3de::app {

/// Matches a body of the simulation to measurements: a panel, the match in a background job, and its result as a table
/// and in the 3D view. A deformed body is one step of undo. Main thread. The session must outlive it.
class MatchController {
 public:
  struct Parts {
    Session &session;
    render::Renderer &renderer;
    registry::PanelRegistry &panels;
    WorkstationImages &images;
    const ui::MeasurementList &measurements;
    SimulationHistory &history;
    MatchValues &values;
    ReportError failed;
    std::function<std::string()> blockingReason;  ///< why there can be no match now, for the user; empty: there can
  };
  explicit MatchController(Parts parts);
  ~MatchController();

  /// Adds the actions that open the panel and write the residuals.
  void connect(ui::WindowActions &actions);
  /// Of the panel; null: it is closed.
  [[nodiscard]] Handle panel() const { return panel_ ? panel_->handle() : Handle(); }
  /// Another simulation is the present one, or none is: a running match ends, and its result is forgotten.
  void onReplaced();
  /// Called before a frame.
  void update();

 private:
  struct Attempt;
  void beginStream();
  /// Starts the match of a new frame of the stream.
  void followStream();
  /// @param why  for the user; empty: the user ends it
  void endStream(const std::string &why);
  void onFrameMatched(const Attempt &attempt);
  using SharedAttempt = std::shared_ptr<Attempt>;
  void open();
  void close();
  void fillForm();
  [[nodiscard]] ui::MatchView view();
  [[nodiscard]] SharedScene presentScene() const;
  void readBodies();
  /// Landmarks of the window with their targets. Errors: those of the file of targets.
  [[nodiscard]] Expected<std::vector<Landmark>> landmarks(const std::filesystem::path &targets) const;
  void begin();
  /// From a candidate of the present result.
  void beginFrom(std::size_t candidate);
  void start(const SharedAttempt &attempt);
  void onRead(const SharedAttempt &attempt);
  void submit(const SharedAttempt &attempt);
  void onMatched(const SharedAttempt &attempt, const Expected<void> &result);
  void onMeasured(const SharedAttempt &attempt);
  void end(const SharedAttempt &attempt, const Error &error);
  void cancel();
  void show(std::size_t candidate);
  /// Shows the points at the rigid motion of the running match, and the shapes of its iterations.
  void showIterations();
  void showPoints(const Attempt &of, const geometry::TriangleMesh &skin, const ElasticMatch &elastic,
                  const Mat4 &motion);
  void forgetResult();
  void exportResiduals(const std::filesystem::path &file);
  /// The function, with no effect after the end of this object. For the main thread.
  template <class Function>
  [[nodiscard]] auto unlessDestroyed(Function function) const {
    return [lifetime = std::weak_ptr<const bool>(lifetime_), function = std::move(function)](auto &&...arguments) {
      if (!lifetime.expired()) function(std::forward<decltype(arguments)>(arguments)...);
    };
  }

  Parts parts_;
  std::optional<ui::MatchPanel> panel_;
  MatchPresenter presenter_;
  std::optional<MatchStream> stream_;
  SharedAttempt attempt_;         ///< that is running; null: none
  Handle job_;                    ///< of it; null: its data are being read from the simulation
  bool showsMotion_ = false;      ///< the presenter shows the points of the running match
  unsigned shownIterations_ = 0;  ///< of it
  SharedAttempt result_;          ///< the last one that has ended; null: none
  ui::MatchTexts texts_;          ///< of the result
  std::vector<std::string> bodies_;
  std::shared_ptr<ChangeLog> shownLog_;  ///< of these bodies
  std::uint64_t shownChanges_ = 0;
  std::uint64_t shownAssignments_ = 0;  ///< of the values that the panel shows
  std::shared_ptr<const bool> lifetime_ = std::make_shared<const bool>(true);
};

}  // namespace c3de::app
