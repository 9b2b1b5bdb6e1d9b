// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "c3de/sdk/panel.hpp"
#include "panels/load_panel.h"
#include "panels/obstacle_panel.h"
#include "panels/panel_mode.h"
#include "panels/verification_panel.h"
#include "simulator/world_simulator.h"
#include "tools/grasp_tool.h"
#include "tools/load_tool.h"
#include "tools/move_tool.h"
#include "tools/pinch_tool.h"
#include "tools/touch_tool.h"
#include "view/simulator_view.h"

namespace pointbased {

/// The plugin's panel: load, sampling, material, world, run, view, pinch. Contains no physics. Edits are sent to the
/// solver as commands between two steps; numbers are read from the latest snapshot. Its simple mode has the rows that a
/// user needs first; warnings and the accuracy are in both (PanelMode). Main thread.
class Controller : public sdk::Panel {
 public:
  /// In the order of the window.
  struct Tools {
    PinchTool &pinch;
    TouchTool &touch;
    GraspTool &grasp;
    MoveTool &move;
    LoadTool &load;
  };
  Controller(const Services &services, const MaterialLaws &laws, const Tools &tools);

  void draw(sdk::Ui &ui) override;

  /// The simulator and view that the panel shows; null if none.
  void setSimulator(WorldSimulator *simulator, SimulatorView *view);
  /// Verifies the paused state. If that is not possible yet, the failure states what has to be done first.
  [[nodiscard]] sdk::Result<void> verify();

 private:
  [[nodiscard]] bool isMoving() const;
  void declareBody();
  void drawActiveTools(sdk::Ui &ui, const Snapshot *snapshot);
  void drawWarnings(sdk::Ui &ui, const Snapshot &snapshot);
  void drawSimple(sdk::Ui &ui, const Snapshot *snapshot);
  void drawTissue(sdk::Ui &ui, const Snapshot &snapshot);
  void drawSupports(sdk::Ui &ui, const Snapshot &snapshot);
  void drawAll(sdk::Ui &ui, const Snapshot *snapshot);
  void drawBody(sdk::Ui &ui, const Snapshot *snapshot);
  void drawAccuracy(sdk::Ui &ui, const Snapshot *snapshot);
  void drawMaterial(sdk::Ui &ui);
  void drawRun(sdk::Ui &ui, const Snapshot *snapshot);
  void drawStages(sdk::Ui &ui, const Snapshot &snapshot);
  void drawColours(sdk::Ui &ui, const Snapshot *snapshot);
  void drawView(sdk::Ui &ui, const Snapshot *snapshot);
  void drawPinch(sdk::Ui &ui);
  void drawWorld(sdk::Ui &ui);

  void load();
  void rebuild();
  void makeFiner(const BodySnapshot &body);
  void startTrials(const Snapshot &snapshot);
  /// Rebuilds every deformable body with its sampling chosen by the accuracy setting.
  void applyAccuracyTarget(const Snapshot &snapshot);
  /// A job that changes bodies, and its step of Undo.
  struct Work {
    std::string job, title, undoLabel;
    std::shared_ptr<std::atomic<bool>> hasChanged = std::make_shared<std::atomic<bool>>(false);  ///< set by the job
  };
  /// @param sharesTarget  the bodies share a budget target
  void startRebuilding(const Work &work, std::vector<std::pair<std::uint64_t, ParameterValues>> bodies,
                       bool sharesTarget = false);
  /// Captures the simulation for Undo, then runs the job.
  void start(const Work &work, std::function<sdk::Result<void>(sdk::Progress)> run);
  void finish(const Work &work, const sdk::Result<void> &result);
  [[nodiscard]] bool isBusy() const { return job_ || isCapturing_; }
  void transport(std::uint32_t action);
  void followBody(const Snapshot *snapshot);
  void showBody(const BodySnapshot &body);
  void followValues(const BodySnapshot &body);
  void followWorld();
  void chooseBody(sdk::Ui &ui, const Snapshot &snapshot);
  void suggestRigid(sdk::Ui &ui, const Snapshot &snapshot);
  void makeRigid(std::uint64_t body);
  void postEdit(std::function<void(WorldSimulator &)> edit);
  void bodyParameterChanged(const c3de_param_value &value);
  void worldParameterChanged(const c3de_param_value &value);
  void report(const std::string &title, const std::string &text);

  const Services &services_;
  Tools tools_;
  PanelMode mode_;
  WorldSimulator *simulator_ = nullptr;
  SimulatorView *view_ = nullptr;
  sdk::ParameterSet bodyParameters_, worldParameters_;
  const MaterialLaws &laws_;
  std::span<const c3de_param_decl> declared_;        // of bodyParameters_
  ParameterValues nextValues_{bodyDeclarations()};   // values for the next load or rebuild
  std::optional<c3de_handle> trials_;                // the job that computes the displacement trials
  std::shared_ptr<const ParameterValues> followed_;  // those of the body when they were last compared
  std::shared_ptr<const ParameterValues> followedWorld_;
  /// Edits that the simulation has not executed yet; until then the panel is ahead of it and does not follow.
  std::shared_ptr<std::atomic<int>> pendingEdits_ = std::make_shared<std::atomic<int>>(0);
  std::uint64_t body_ = 0;  // the body to which the parameters belong
  std::string path_;
  std::uint32_t unit_ = 0;  // index into the unit names
  bool replace_ = true;
  std::optional<c3de_handle> job_;
  bool isCapturing_ = false;  // a job begins when the simulation has been captured
  PinchSettings pinchSettings_;
  VerificationPanel verification_;
  ObstaclePanel obstacles_;
  LoadPanel loads_;
};

}  // namespace pointbased
