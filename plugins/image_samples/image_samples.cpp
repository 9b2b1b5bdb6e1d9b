// SPDX-License-Identifier: Apache-2.0
// Reads the first image at the points of every body that is simulated, where they are now: mean and range per body in a
// panel where there is a window, in the log without. Walked through in docs/plugin/index.md.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <mutex>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;
using Clock = std::chrono::steady_clock;

constexpr std::array kParams{
    sdk::numberParam({.id = "every", .label = "Every", .unit = "s", .doc = "Wall-clock time between two looks."},
                     {.min = 0.0, .max = 3600.0, .softMin = 0.1, .softMax = 5.0}, 0.5)};

struct Samples {
  std::string body, unit;
  std::size_t points = 0, outside = 0;  // of them, where there is no image
  double mean = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
  Clock::time_point at{};
};

std::string textOf(const Samples &samples) {
  if (samples.points == samples.outside) return "lies outside of the image";
  char text[160];
  std::snprintf(text, sizeof text, "mean %.4g, %.4g to %.4g %s at %zu points, %zu outside", samples.mean, samples.low,
                samples.high, samples.unit.c_str(), samples.points - samples.outside, samples.outside);
  return text;
}

class ImageSamples : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{.id = "org.c3de.image_samples",
                                        .version = "1.0.0",
                                        .displayName = "Image samples",
                                        .vendor = "C3DE",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_forces_v1>(), sdk::required<c3de_imaging_v1>(),
                                    sdk::optional<c3de_params_v1>(), sdk::optional<c3de_panels_v1>(),
                                    sdk::optional<c3de_commands_v1>()};

  explicit ImageSamples(sdk::Host host) : log_(host), imaging_(host) {
    if (const sdk::Params params(host); params)
      params_ = sdk::orThrow(
          params.declare("Image samples", kParams, [this](const c3de_param_value &v) { every_s_ = v.num; }));
    hasPanel_ = host.service<c3de_panels_v1>() != nullptr;
    if (hasPanel_) sdk::orThrow(show(host, "org.c3de.image_samples.panel", "Image samples"));
    if (const sdk::Commands commands(host); commands)
      command_ = sdk::orThrow(commands.add({.id = "org.c3de.image_samples.log",
                                            .title = "Log image samples",
                                            .doc = "Writes what the panel shows into the log.",
                                            .key = 'L',
                                            .modifiers = C3DE_MOD_CTRL | C3DE_MOD_SHIFT},
                                           [this] { return say(); }));
    field_ = sdk::orThrow(
        sdk::Forces(host).add("image samples", [this](const c3de_force_call &call) { return look(call); }));
  }

  void stop() {
    field_.remove();
    if (!hasPanel_) (void)say();
  }

  void draw(sdk::Ui &ui) override {
    ui.params(params_.handle());
    const std::lock_guard lock(mutex_);
    if (bodies_.empty()) ui.text("No body is being simulated, or there is no image.");
    for (const auto &[body, samples] : bodies_) ui.value(samples.body, textOf(samples));
  }

 private:
  sdk::Result<void> say() {
    const std::lock_guard lock(mutex_);
    if (bodies_.empty()) return sdk::Failure{C3DE_E_STATE, "no body is being simulated, or there is no image"};
    for (const auto &[body, samples] : bodies_) log_.info(samples.body + ": " + textOf(samples));
    return {};
  }

  // On the simulation's thread, before each step, for each body; adds no force.
  sdk::Result<void> look(const c3de_force_call &call) {
    const auto images = imaging_.images();
    if (!images || images->empty()) return {};
    const auto now = Clock::now();
    {
      const std::lock_guard lock(mutex_);
      Samples &last = bodies_[call.body.v];
      if (last.points > 0 && std::chrono::duration<double>(now - last.at).count() < every_s_) return {};
    }
    // The simulation works in metres, images lie in millimetres: with the factor 1000 the two are one frame.
    std::vector<sdk::Vec3> points_mm(static_cast<std::size_t>(call.count));
    for (std::size_t i = 0; i < points_mm.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) points_mm[i][c] = 1000.0 * call.positions_m[3 * i + c];
    std::vector<double> values(points_mm.size());
    // An image that has just been taken away is no reason to stop the simulation.
    if (!imaging_.sample(images->front(), points_mm, values)) return {};
    const auto image = imaging_.imageInfo(images->front());

    Samples samples;
    samples.body = sdk::text(call.body_name);
    if (image) samples.unit = sdk::text(image->unit);
    samples.points = values.size();
    samples.at = now;
    double sum = 0.0;
    for (const double value : values) {
      if (std::isnan(value)) {
        ++samples.outside;
        continue;
      }
      samples.low = std::min(samples.low, value);
      samples.high = std::max(samples.high, value);
      sum += value;
    }
    if (samples.points > samples.outside) samples.mean = sum / static_cast<double>(samples.points - samples.outside);
    const std::lock_guard lock(mutex_);
    bodies_[call.body.v] = samples;
    return {};
  }

  sdk::Log log_;
  sdk::Imaging imaging_;
  bool hasPanel_ = false;
  std::atomic<double> every_s_{0.5};
  std::mutex mutex_;
  std::map<std::uint64_t, Samples> bodies_;
  sdk::ParameterSet params_;
  sdk::Command command_;
  sdk::ForceField field_;  // goes first: it uses what stands above
};

}  // namespace

C3DE_DEFINE_PLUGIN(ImageSamples)
