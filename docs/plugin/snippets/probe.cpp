// SPDX-License-Identifier: Apache-2.0
// A plugin in C++ with the SDK: a class, a panel, a tool, parameters, a job and a frame callback.
#include "c3de/sdk/sdk.hpp"

#include <cmath>
#include <cstdio>
#include <optional>

namespace {

namespace sdk = c3de::sdk;

// Objects of a class that others create by its id. It answers no interface yet; see simulator.hpp for one that does.
class Probe : public sdk::Object<Probe> {
 public:
  static std::array<sdk::Interface, 0> interfaces() { return {}; }
  template <class Factory>
  explicit Probe(Factory &) {}
};

constexpr std::array kParams{
    sdk::numberParam({.id = "scale", .label = "Scale", .unit = "", .doc = "Factor of the reading.", .group = ""},
                     {.min = 0.0, .max = 10.0, .softMin = 0.0, .softMax = 10.0}, 1.0, C3DE_PARAM_MIN_OPEN)};

class PressTool : public sdk::Tool {
 public:
  bool onEvent(const c3de_event &event) override {
    if (event.type != C3DE_EVENT_PRESS) return false;
    // In the 3D view what is met along the ray would have to be found first; a slice shows the point itself.
    seen_mm_.reset();
    if (sdk::isInSlice(event)) seen_mm_ = {event.ray_origin_mm[0], event.ray_origin_mm[1], event.ray_origin_mm[2]};
    return true;
  }
  [[nodiscard]] const std::optional<sdk::Vec3> &seen() const { return seen_mm_; }

 private:
  std::optional<sdk::Vec3> seen_mm_;
};

class ProbePlugin : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{.id = "org.example.probe",
                                        .version = "1.0.0",
                                        .displayName = "Probe",
                                        .vendor = "Example",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>(), sdk::required<c3de_mesh_v1>(),
                                    sdk::optional<c3de_panels_v1>()};

  explicit ProbePlugin(sdk::Host host) : host_(host), mesh_(host), jobs_(host), imaging_(host), log_(host) {
    sdk::orThrow(sdk::Registry(host).add<Probe>("org.example.Probe/0", "Probe", "Measures.", *this));
    if (sdk::Params params(host); params) {
      params_ = sdk::orThrow(params.declare("Probe", kParams, [this](const c3de_param_value &v) { scale_ = v.num; }));
    }
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "org.example.probe.panel", "Probe"));
    if (host.service<c3de_tools_v1>())
      sdk::orThrow(tool_.add(
          host,
          {.id = "org.example.probe.tool", .label = "Press", .hint = "Press something in a slice", .inSlices = true}));
    if (sdk::Time time(host); time) frame_ = sdk::orThrow(time.addFrameCallback([this] { ++frames_; }));
  }

  void start() {
    // Every plugin is there now: look up what the others offer.
    const auto greeters = sdk::Registry(host_).classesWith("org.c3de.hello.iface.greeter/0");
    if (greeters) log_.info(std::to_string(greeters->size()) + " greeters");
  }

  void draw(sdk::Ui &ui) override {
    ui.heading("Probe");
    if (ui.button("measure", "Measure", jobs_ && !measuring_)) measure();
    if (volume_mm3_) ui.value("Volume", number(*volume_mm3_) + " mm³");
    if (const auto value = valueAt(tool_.seen().value_or(sdk::Vec3{}))) ui.value("Image at the point", number(*value));
    ui.value("Frames", std::to_string(frames_));
    ui.value("Scale is", number(scale_));
    ui.params(params_.handle());
  }

 private:
  // Of the first image, at a point of the world (LPS, mm); nothing outside of it.
  std::optional<double> valueAt(const sdk::Vec3 &point_mm) const {
    const auto images = imaging_.images();
    if (!images || images->empty()) return std::nullopt;
    double value = 0.0;
    if (!imaging_.sample(images->front(), {&point_mm, 1}, {&value, 1}) || std::isnan(value)) return std::nullopt;
    return value;
  }

  // Long work goes to a job: run() on a worker, done() on the main thread.
  void measure() {
    struct Reading {
      double volume_mm3 = 0.0;
    };
    const auto reading = std::make_shared<Reading>();
    const auto submitted = jobs_.submit(
        "Measuring",
        [mesh = mesh_, reading](sdk::Progress progress) -> sdk::Result<void> {
          constexpr std::array<sdk::Vec3, 4> corners{{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}}};
          constexpr std::array<std::array<std::uint32_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
          if (!progress.update(0.5, "half way")) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
          const auto made = mesh.create(sdk::rows<double, 3>(corners), sdk::rows<std::uint32_t, 3>(faces));
          if (!made) return made.failure();
          const auto found = mesh.info(made->handle());
          if (!found) return found.failure();
          reading->volume_mm3 = found->volume_mm3;
          return {};
        },
        [this, reading](const sdk::Result<void> &result) {
          measuring_ = false;
          if (result)
            volume_mm3_ = reading->volume_mm3;
          else
            log_.warn("not measured: " + result.failure().message);
        });
    measuring_ = submitted.ok();
  }

  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
  }

  sdk::Host host_;
  sdk::Mesh mesh_;
  sdk::Jobs jobs_;
  sdk::Imaging imaging_;
  sdk::Log log_;
  sdk::ParameterSet params_;
  PressTool tool_;
  sdk::FrameCallback frame_;
  double scale_ = 1.0;
  std::uint64_t frames_ = 0;
  bool measuring_ = false;
  std::optional<double> volume_mm3_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(ProbePlugin)
