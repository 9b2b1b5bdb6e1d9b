// SPDX-License-Identifier: Apache-2.0
// A clamp: takes hold of the topmost part of every body, whoever simulates it, lifts and turns it. Shows how a plugin
// reads fields of a running simulation and moves a part of a body, while others may hold it, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

constexpr double kRadian = 3.14159265358979323846 / 180.0;

/// What the simulations' threads read and the window writes.
struct Wanted {
  bool isClosed = false;
  double radius_m = 0.02, lift_m = 0.0, turn_rad = 0.0;
};

constexpr std::array kParams{
    sdk::boolParam({.id = "closed", .label = "Closed", .doc = "Holds the topmost part of every body."}, false),
    sdk::numberParam({.id = "radius", .label = "Radius", .unit = "m", .doc = "Of what is held; from when it closes."},
                     {.min = 1e-3, .max = 1.0, .softMin = 0.005, .softMax = 0.1}, 0.02),
    sdk::numberParam({.id = "lift", .label = "Lift", .unit = "m", .doc = "Along y, from where it closed."},
                     {.min = -1.0, .max = 1.0, .softMin = -0.05, .softMax = 0.05}, 0.0),
    sdk::numberParam({.id = "turn", .label = "Turn", .unit = "°", .doc = "About y, from where it closed."},
                     {.min = -180.0, .max = 180.0, .softMin = -90.0, .softMax = 90.0}, 0.0)};

class Clamp : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.c3de.clamp", .version = "1.0.0", .displayName = "Clamp", .vendor = "C3DE", .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_simulation_v1>(2), sdk::optional<c3de_params_v1>(),
                                    sdk::optional<c3de_panels_v1>()};

  explicit Clamp(sdk::Host host) : simulations_(host), log_(host) {
    watch_ = sdk::orThrow(simulations_.watch([this](c3de_handle node) { added(node); },
                                             [this](c3de_handle node) { removed(node); },
                                             [this](c3de_handle node, std::uint64_t, double) { stepped(node); }));
    if (const sdk::Params params(host); params)
      params_ = sdk::orThrow(params.declare("Clamp", kParams, [this](const c3de_param_value &v) { changed(v); }));
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "org.c3de.clamp.panel", "Clamp"));
  }

  void stop() { watch_ = {}; }

  void draw(sdk::Ui &ui) override {
    ui.params(params_.handle());
    const std::lock_guard lock(mutex_);
    ui.value("Pulls with", number(force_N_) + " N");
    ui.value("Turns with", number(torque_Nm_) + " N m");
    ui.value("Is off by", number(1e3 * off_m_) + " mm");
  }

 private:
  struct Held {
    c3de_handle hold{};
    sdk::Vec3 from{};  // where it closed, m
  };
  struct Simulation {
    sdk::RunningSimulator simulator;
    std::map<std::uint64_t, Held> bodies;
  };

  void added(c3de_handle node) {
    const sdk::RunningSimulator simulator(sdk::orThrow(simulations_.find(node)));
    const std::lock_guard lock(mutex_);
    simulationByNode_[node.v].simulator = simulator;
  }
  void removed(c3de_handle node) {
    const std::lock_guard lock(mutex_);
    simulationByNode_.erase(node.v);
  }
  void changed(const c3de_param_value &value) {
    const std::lock_guard lock(mutex_);
    const std::string_view id = sdk::text(value.id);
    if (id == "closed") wanted_.isClosed = value.num != 0.0;
    if (id == "radius") wanted_.radius_m = value.num;
    if (id == "lift") wanted_.lift_m = value.num;
    if (id == "turn") wanted_.turn_rad = kRadian * value.num;
  }

  // On the simulation's thread, after each step.
  void stepped(c3de_handle node) {
    const std::lock_guard lock(mutex_);
    const auto found = simulationByNode_.find(node.v);
    if (found == simulationByNode_.end()) return;
    Simulation &simulation = found->second;
    const auto bodies = simulation.simulator.bodies();
    if (!bodies) return;
    force_N_ = torque_Nm_ = off_m_ = 0.0;
    for (const c3de_handle body : *bodies) {
      const auto held = simulation.bodies.find(body.v);
      if (wanted_.isClosed && held == simulation.bodies.end()) {
        close(simulation, body);
      } else if (wanted_.isClosed) {
        // After a reset nobody holds: closes again after the next step.
        if (!move(simulation.simulator, held->second)) simulation.bodies.erase(held);
      } else if (held != simulation.bodies.end()) {
        (void)simulation.simulator.remove(held->second.hold);
        simulation.bodies.erase(held);
      }
    }
  }

  void close(Simulation &simulation, c3de_handle body) {
    const auto surface = simulation.simulator.vectors(body, C3DE_SIM_ON_SURFACE, C3DE_SIM_FIELD_POSITION);
    if (!surface || surface->empty()) return;
    const sdk::Vec3 top = *std::max_element(surface->begin(), surface->end(),
                                            [](const sdk::Vec3 &a, const sdk::Vec3 &b) { return a[1] < b[1]; });
    c3de_sim_hold hold{};
    hold.size = sizeof hold;
    hold.flags = C3DE_SIM_HOLD_SHAPE;
    std::copy(top.begin(), top.end(), hold.at_m);
    hold.radius_m = wanted_.radius_m;
    auto taken = simulation.simulator.hold(body, hold);
    if (!taken && taken.failure().status == C3DE_E_UNSUPPORTED) {  // one that leads the mean of what is held at least
      hold.flags = 0;
      taken = simulation.simulator.hold(body, hold);
    }
    if (taken)
      simulation.bodies[body.v] = {*taken, top};
    else
      log_.warn("not held: " + taken.failure().message);
  }

  bool move(const sdk::RunningSimulator &simulator, const Held &held) {
    const double half = 0.5 * wanted_.turn_rad;
    const sdk::Vec3 target{held.from[0], held.from[1] + wanted_.lift_m, held.from[2]};
    if (!simulator.pull(held.hold, target, std::array{0.0, std::sin(half), 0.0, std::cos(half)})) return false;
    if (const auto state = simulator.holdState(held.hold)) {
      const auto length = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); };
      force_N_ += length(state->force_N[0], state->force_N[1], state->force_N[2]);
      torque_Nm_ += length(state->torque_Nm[0], state->torque_Nm[1], state->torque_Nm[2]);
      off_m_ = std::max(
          off_m_, length(state->point_m[0] - target[0], state->point_m[1] - target[1], state->point_m[2] - target[2]));
    }
    return true;
  }

  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
  }

  sdk::Simulation simulations_;
  sdk::Log log_;
  std::mutex mutex_;
  Wanted wanted_;
  std::map<std::uint64_t, Simulation> simulationByNode_;
  double force_N_ = 0.0, torque_Nm_ = 0.0, off_m_ = 0.0;
  sdk::ParameterSet params_;
  sdk::SimulationWatch watch_;  // goes first: it uses what stands above
};

}  // namespace

C3DE_DEFINE_PLUGIN(Clamp)
