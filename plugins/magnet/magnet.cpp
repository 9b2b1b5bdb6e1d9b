// SPDX-License-Identifier: Apache-2.0
// A magnet: pulls the points of every body, whoever simulates it, towards a pole. Shows how a plugin that knows nothing
// of a simulator acts on a running simulation, live by parameters, and reads something of it.
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

/// What the simulation's thread reads and the window writes.
struct Pole {
  sdk::Vec3 place_m{0.0, 0.3, 0.0};
  double strength = 0.0;  ///< m/s² at the pole
  double reach_m = 0.1;   ///< where a quarter of it is left
};

constexpr std::array kParams{
    sdk::numberParam(
        {.id = "strength", .label = "Strength", .unit = "m/s²", .doc = "Acceleration near the pole; 0: off."},
        {.min = 0.0, .max = 1000.0, .softMin = 0.0, .softMax = 100.0}, 0.0),
    sdk::numberParam(
        {.id = "reach", .label = "Reach", .unit = "m", .doc = "Distance at which a quarter of it is left."},
        {.min = 1e-3, .max = 10.0, .softMin = 0.01, .softMax = 0.5}, 0.1),
    sdk::vec3Param({.id = "pole", .label = "Pole", .unit = "m", .doc = "In the frame of the simulation."},
                   {.min = -100.0, .max = 100.0, .softMin = -0.5, .softMax = 0.5}, {0.0, 0.3, 0.0})};

class Magnet : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.c3de.magnet", .version = "1.0.0", .displayName = "Magnet", .vendor = "C3DE", .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_forces_v1>(), sdk::optional<c3de_params_v1>(),
                                    sdk::optional<c3de_panels_v1>(), sdk::optional<c3de_time_v1>()};

  explicit Magnet(sdk::Host host) {
    field_ = sdk::orThrow(sdk::Forces(host).add("magnet", [this](const c3de_force_call &call) { return pull(call); }));
    if (const sdk::Params params(host); params)
      params_ = sdk::orThrow(params.declare("Magnet", kParams, [this](const c3de_param_value &v) { changed(v); }));
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "org.c3de.magnet.panel", "Magnet"));
  }

  void stop() { field_.remove(); }

  void draw(sdk::Ui &ui) override {
    ui.params(params_.handle());
    char text[96];
    std::snprintf(text, sizeof text, "%.3g N on %llu points", force_N_.load(),
                  static_cast<unsigned long long>(points_.load()));
    ui.value("Pulls with", text);
  }

 private:
  void changed(const c3de_param_value &value) {
    const std::lock_guard lock(mutex_);
    const std::string_view id = sdk::text(value.id);
    if (id == "strength") pole_.strength = value.num;
    if (id == "reach") pole_.reach_m = value.num;
    if (id == "pole") pole_.place_m = {value.vec[0], value.vec[1], value.vec[2]};
  }

  // On the simulation's thread, before each step, for each body.
  sdk::Result<void> pull(const c3de_force_call &call) {
    Pole pole;
    {
      const std::lock_guard lock(mutex_);
      pole = pole_;
    }
    double sum = 0.0;
    if (pole.strength > 0.0)
      for (std::uint64_t i = 0; i < call.count; ++i) {
        const double *x = call.positions_m + 3 * i;
        const double d[3] = {pole.place_m[0] - x[0], pole.place_m[1] - x[1], pole.place_m[2] - x[2]};
        const double r = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), s = 1.0 + r / pole.reach_m;
        const double force = call.masses_kg[i] * pole.strength / (s * s);
        // At the pole itself there is no direction.
        for (int c = 0; c < 3; ++c) call.forces_N[3 * i + c] += force * d[c] / std::max(r, 1e-6);
        sum += force;
      }
    force_N_ = sum;
    points_ = pole.strength > 0.0 ? call.count : 0;
    return {};
  }

  std::mutex mutex_;
  Pole pole_;
  std::atomic<double> force_N_{0.0};
  std::atomic<std::uint64_t> points_{0};
  sdk::ParameterSet params_;
  sdk::ForceField field_;  // goes first: it uses what stands above
};

}  // namespace

C3DE_DEFINE_PLUGIN(Magnet)
