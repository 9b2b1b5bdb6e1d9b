// SPDX-License-Identifier: Apache-2.0
#include "c3de/sdk/plugin.hpp"
#include "c3de/sdk/commands.hpp"

#include "panels/controller.h"
#include "simulator/point_sets.h"
#include "simulator/world_simulator.h"
#include "tools/grasp_tool.h"
#include "tools/load_tool.h"
#include "tools/move_tool.h"
#include "tools/pinch_tool.h"
#include "tools/touch_tool.h"
#include "view/simulator_view.h"

namespace pointbased {
namespace {

/// The point-based plugin: three public classes and, if there is a window, a panel, tools and a view per simulator.
class PointBasedPlugin : public SimulatorListener {
 public:
  static constexpr sdk::PluginInfo info{.id = "c3de.pointbased",
                                        .version = "0.1.0",
                                        .displayName = "Point-based organs",
                                        .vendor = "C3DE",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{
      sdk::required<c3de_log_v1>(),       sdk::required<c3de_registry_v1>(), sdk::required<c3de_mesh_v1>(),
      sdk::required<c3de_collision_v1>(), sdk::required<c3de_jobs_v1>(),     sdk::optional<c3de_scene_v1>(),
      sdk::optional<c3de_render_v1>(),    sdk::optional<c3de_params_v1>(),   sdk::optional<c3de_panels_v1>(),
      sdk::optional<c3de_tools_v1>(),     sdk::optional<c3de_time_v1>(),     sdk::optional<c3de_simulation_v1>(),
      sdk::optional<c3de_commands_v1>()};

  explicit PointBasedPlugin(sdk::Host host)
      : context_(host, this), pinch_(context_.services, steps_), touch_(context_.services, steps_),
        grasp_(context_.services, steps_), move_(context_.services, steps_), load_(context_.services, steps_) {
    const sdk::Registry &registry = context_.services.registry;
    sdk::orThrow(registry.add<WorldSimulator>(
        C3DE_POINTBASED_WORLD_SIMULATOR_CLASS, "Point-based simulator",
        "Deformable bodies by the point-based method of Müller et al. 2004; iface.simulator", context_));
    sdk::orThrow(registry.add<PhyxelSet>(C3DE_POINTBASED_PHYXEL_CLASS, "Phyxels",
                                         "Points that carry the physics of a body; iface.phyxel_set", context_));
    sdk::orThrow(registry.add<SurfelSet>(C3DE_POINTBASED_SURFEL_CLASS, "Surfels",
                                         "Points of a surface that follow phyxels; iface.surfel_set", context_));
    if (context_.services.params && context_.services.notifier && context_.services.simulation &&
        host.service<c3de_panels_v1>()) {
      context_.hasWindow = true;
      controller_ = std::make_unique<Controller>(context_.services, context_.laws,
                                                 Controller::Tools{pinch_, touch_, grasp_, move_, load_});
      sdk::orThrow(controller_->show(host, "pointbased.controller", "Point-based organ"));
      if (host.service<c3de_tools_v1>()) {
        sdk::orThrow(pinch_.add(host, {.id = "pointbased.pinch",
                                       .label = "Pinch",
                                       .hint = "Press on the organ, here or in a slice, and drag to pull; release or "
                                               "Escape ends the pull",
                                       .shortcut = 'P',
                                       .inSlices = true}));
        sdk::orThrow(touch_.add(
            host,
            {.id = "pointbased.touch",
             .label = "Touch",
             .hint =
                 "Press on the organ, or in a slice: an instrument stands there; drag moves it, D and B or in 3D the "
                 "wheel push it deeper and back, X takes it away",
             .shortcut = 'T',
             .inSlices = true}));
        sdk::orThrow(grasp_.add(
            host,
            {.id = "pointbased.grasp",
             .label = "Grasp",
             .hint = "Press on the organ: two jaws take hold on either side and close; drag moves them, the wheel "
                     "turns them, X lets go",
             .shortcut = 'G'}));
        sdk::orThrow(move_.add(host, {.id = "pointbased.move",
                                      .label = "Move",
                                      .hint = "Press on an obstacle and drag; its arrows and rings move it along and "
                                              "about one axis",
                                      .shortcut = 'M'}));
        sdk::orThrow(
            load_.add(host, {.id = "pointbased.load",
                             .label = "Load",
                             .hint = "Paint on the surface, click a face or drag a box (Q), then set a support "
                                     "or load in the panel; Alt removes; drag the tips of arrows",
                             .shortcut = 'N',
                             .inSlices = true}));
      }
      if (const sdk::Commands commands(host); commands)
        verify_ = sdk::orThrow(
            commands.add({.id = "pointbased.verify",
                          .title = "Verify the present state",
                          .doc = "Solves the paused state again with half the spacing and reports the difference in mm",
                          .key = 'V',
                          .modifiers = C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
                         [this] { return controller_->verify(); }));
    }
    if (context_.services.time) frame_ = sdk::orThrow(context_.services.time.addFrameCallback([this] { onFrame(); }));
  }

  sdk::Result<void> stop() {
    setSimulator(nullptr);
    if (controller_) controller_->setSimulator(nullptr, nullptr);
    views_.clear();
    return {};
  }

  void attached(WorldSimulator &simulator, c3de_handle node) override {
    SimulatorView *view = nullptr;
    if (context_.services.render && context_.services.scene)
      view = views_.emplace(&simulator, std::make_unique<SimulatorView>(context_.services, simulator, node))
                 .first->second.get();
    current_ = &simulator;
    setSimulator(&simulator);
    if (controller_) controller_->setSimulator(&simulator, view);
  }

  void detached(WorldSimulator &simulator) override {
    views_.erase(&simulator);
    if (current_ != &simulator) return;
    current_ = nullptr;
    setSimulator(nullptr);
    if (controller_) controller_->setSimulator(nullptr, nullptr);
  }

 private:
  void onFrame() {
    for (const auto &[simulator, view] : views_) view->update();
    pinch_.update();
    touch_.update();
    grasp_.update();
    move_.update();
    const auto view = views_.find(current_);
    load_.update(view == views_.end() ? nullptr : view->second.get());
  }
  void setSimulator(WorldSimulator *simulator) {
    pinch_.setSimulator(simulator);
    touch_.setSimulator(simulator);
    grasp_.setSimulator(simulator);
    move_.setSimulator(simulator);
    load_.setSimulator(simulator);
  }

  PluginContext context_;
  WorldSimulator *current_ = nullptr;  // the last attached one
  std::map<WorldSimulator *, std::unique_ptr<SimulatorView>> views_;
  std::shared_ptr<InteractionSteps> steps_ = std::make_shared<InteractionSteps>();
  PinchTool pinch_;
  TouchTool touch_;
  GraspTool grasp_;
  MoveTool move_;
  LoadTool load_;
  std::unique_ptr<Controller> controller_;
  sdk::Command verify_;
  sdk::FrameCallback frame_;
};

}  // namespace
}  // namespace pointbased

C3DE_DEFINE_PLUGIN(pointbased::PointBasedPlugin)
