// SPDX-License-Identifier: Apache-2.0
#include "c3de/sdk/plugin.hpp"

#include <cstdio>

#include "body_view.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/panel.hpp"
#include "pinch_tool.h"
#include "spring_body.h"

namespace mass_spring {
namespace {

Method massSprings() {
  return {"mass springs",
          worldDeclarations(),
          bodyDeclarations(),
          [](const ParameterValues &of) {
            return Elasticity{of.number(C3DE_PARAM_ID_YOUNGS_MODULUS), of.number(C3DE_PARAM_ID_DENSITY),
                              of.number("material.retardation_time")};
          },
          [](Lattice lattice, Surface skin, std::vector<Elasticity> materials, const ParameterValues &) {
            return std::make_unique<SpringBody>(std::move(lattice), std::move(skin), std::move(materials));
          },
          {},
          {},
          {}};
}

/// A class for everybody, and where there is a window, a view per simulator, a tool, and a panel that says what is
/// pulled.
class MassSpringPlugin : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{.id = "org.c3de.mass_spring",
                                        .version = "1.0.0",
                                        .displayName = "Mass springs",
                                        .vendor = "C3DE",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_log_v1>(),       sdk::required<c3de_registry_v1>(),
                                    sdk::required<c3de_mesh_v1>(),      sdk::optional<c3de_scene_v1>(),
                                    sdk::optional<c3de_render_v1>(),    sdk::optional<c3de_tools_v1>(),
                                    sdk::optional<c3de_collision_v1>(), sdk::optional<c3de_simulation_v1>(),
                                    sdk::optional<c3de_time_v1>(),      sdk::optional<c3de_panels_v1>()};

  explicit MassSpringPlugin(sdk::Host host) : context_(host, massSprings()) {
    sdk::orThrow(sdk::Registry(host).add<Simulator>(
        Simulator::kClass, "Mass springs", "Deformable bodies of masses and springs on a cubic lattice", context_));
    if (!host.service<c3de_render_v1>() || !host.service<c3de_tools_v1>()) return;
    pinch_.emplace(host);
    sdk::orThrow(
        pinch_->add(host, {.id = "org.c3de.mass_spring.pinch",
                           .label = "Pull springs",
                           .hint = "Press on a body of masses and springs and drag; release or Escape ends the pull",
                           .shortcut = 'S'}));
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "org.c3de.mass_spring.panel", "Mass springs"));
    context_.attached = [this, host](Simulator &simulator, c3de_handle node) {
      if (node.v == 0) {
        pinch_->setSimulator(nullptr);
        shown_ = nullptr;
        views_.erase(&simulator);
        return;
      }
      views_.insert_or_assign(&simulator, std::make_unique<SimulatorView>(host, simulator, node));
      pinch_->setSimulator(&simulator);
      shown_ = &simulator;
    };
    frame_ = sdk::orThrow(sdk::Time(host).addFrameCallback([this] {
      for (const auto &[simulator, view] : views_) view->update();
      pinch_->update();
    }));
  }

  void draw(sdk::Ui &ui) override {
    const auto snapshot = shown_ != nullptr ? shown_->snapshot() : nullptr;
    if (!snapshot) return ui.text("No simulation of masses and springs is open.");
    double pull_N = 0.0;
    for (const Snapshot::Body &body : snapshot->bodies) {
      ui.value(body.name, std::to_string(body.masses) + " masses");
      if (body.handForce_N) pull_N += length(*body.handForce_N);
    }
    char text[32];
    std::snprintf(text, sizeof text, "%.3f N", pull_N);
    ui.value("Pull", text);
    if (ui.button("pull", pinch_->isActive() ? "Pull springs is active" : "Pull springs", !pinch_->isActive()))
      sdk::orThrow(pinch_->select());
  }

  sdk::Result<void> stop() {
    context_.attached = nullptr;
    shown_ = nullptr;
    if (pinch_) pinch_->setSimulator(nullptr);
    views_.clear();
    return {};
  }

 private:
  Context context_;
  std::optional<PinchTool> pinch_;
  const Simulator *shown_ = nullptr;  // the one that was attached last
  std::map<const Simulator *, std::unique_ptr<SimulatorView>> views_;
  sdk::FrameCallback frame_;
};

}  // namespace
}  // namespace mass_spring

C3DE_DEFINE_PLUGIN(mass_spring::MassSpringPlugin)
