// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "grasp_tool.h"
#include "move_tool.h"
#include "obstacle_panel.h"
#include "pinch_tool.h"
#include "simulator_view.h"
#include "touch_tool.h"
#include "verification_panel.h"
#include "world_simulator.h"

namespace pointbased {

/// The plugin's panel: load, sampling, material, world, run, view, pinch. Holds no physics; edits go to the solver as
/// commands between two steps, numbers come from the latest snapshot. Main thread.
class Controller : public sdk::Panel {
 public:
  /// Those in its order in the window.
  struct Tools {
    PinchTool &pinch;
    TouchTool &touch;
    GraspTool &grasp;
    MoveTool &move;
  };
  Controller(const Services &services, const MaterialLaws &laws, const Tools &tools);

  void draw(sdk::Ui &ui) override;

  /// The simulator and view it shows; null: none.
  void setSimulator(WorldSimulator *simulator, SimulatorView *view);
  /// Verifies the paused state. Fails with what is to be done first.
  [[nodiscard]] sdk::Result<void> verify();

 private:
  [[nodiscard]] bool isMoving() const;
  void declareBody();
  void drawBody(sdk::Ui &ui, const Snapshot *snapshot);
  void drawAccuracy(sdk::Ui &ui, const Snapshot *snapshot);
  void drawMaterial(sdk::Ui &ui);
  void drawRun(sdk::Ui &ui, const Snapshot *snapshot);
  void drawStages(sdk::Ui &ui, const Snapshot &snapshot);
  void drawView(sdk::Ui &ui, const Snapshot *snapshot);
  void drawPinch(sdk::Ui &ui);
  void drawWorld(sdk::Ui &ui);

  void load();
  void rebuild();
  void makeFiner(const BodySnapshot &body);
  void makeTrials(const Snapshot &snapshot);
  /// Every body that deforms, with its sampling left to the dial.
  void applyWish(const Snapshot &snapshot);
  void startRebuilding(const std::string &title, std::vector<std::pair<std::uint64_t, ParameterValues>> bodies);
  void finish(const char *what, const sdk::Result<void> &result);
  void transport(std::uint32_t action);
  void followBody(const Snapshot *snapshot);
  void showBody(const BodySnapshot &body);
  void chooseBody(sdk::Ui &ui, const Snapshot &snapshot);
  void offerRigid(sdk::Ui &ui, const Snapshot &snapshot);
  void makeRigid(std::uint64_t body);
  void bodyParameterChanged(const c3de_param_value &value);
  void worldParameterChanged(const c3de_param_value &value);
  void report(const std::string &title, const std::string &text);

  const Services &services_;
  Tools tools_;
  WorldSimulator *simulator_ = nullptr;
  SimulatorView *view_ = nullptr;
  sdk::ParameterSet bodyParameters_, worldParameters_;
  const MaterialLaws &laws_;
  std::span<const c3de_param_decl> declared_;       // of bodyParameters_
  ParameterValues nextValues_{bodyDeclarations()};  // what the next load or rebuild uses
  std::optional<c3de_handle> trials_;               // the job that makes them
  std::uint64_t body_ = 0;                          // the one the parameters belong to
  std::string path_;
  std::uint32_t unit_ = 0;  // index into the unit names
  bool replace_ = true;
  std::optional<c3de_handle> job_;
  PinchSettings pinchSettings_;
  VerificationPanel verification_;
  ObstaclePanel obstacles_;
};

}  // namespace pointbased
