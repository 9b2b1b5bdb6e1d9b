// SPDX-License-Identifier: Apache-2.0
#include "frame/automation_state.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/ui/file_browser.h"
#include "frame/frame_context.h"

namespace c3de::ui {
namespace {

using Json = nlohmann::json;
constexpr double kSecondsBetweenWrites = 0.05;
constexpr std::size_t kAnswers = 128;  // more than the number of frames in a second

const char *modeName(std::uint32_t mode) {
  switch (mode) {
    case C3DE_SIM_PLAYING: return "playing";
    case C3DE_SIM_PAUSED: return "paused";
    case C3DE_SIM_FAILED: return "failed";
    default: return "stopped";
  }
}

const char *severityName(std::uint32_t severity) {
  const char *const names[] = {"debug", "info", "warn", "error"};
  return names[std::min<std::uint32_t>(severity, 3)];
}

Json transportJson(const SimulationView &simulation) {
  const c3de_sim_transport &t = simulation.transport;
  return {{"exists", simulation.exists},
          {"title", simulation.title},
          {"mode", modeName(t.mode)},
          {"steps", t.steps},
          {"time_s", t.time_s},
          {"target_rate", t.target_rate},
          {"real_time_factor", t.real_time_factor},
          {"step_ms", t.step_ms},
          {"step_running_s", t.step_running_s},
          {"activity", simulation.activity}};
}

}  // namespace

struct AutomationState::Impl {
  std::filesystem::path file;
  Json state = Json::object();
  Json widgets = Json::object(), scrolledOut = Json::object(), disabled = Json::array(), values = Json::object();
  Json answers = Json::array();
  std::size_t characters = 0;
  double lastWrite_s = -1e9;
  bool isWaiting = false, hasFailed = false;
};

AutomationState::AutomationState(std::filesystem::path file) : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
}
AutomationState::~AutomationState() = default;

bool AutomationState::isOn() const { return !impl_->file.empty(); }

void AutomationState::beginFrame() {
  if (!isOn()) return;
  impl_->widgets = Json::object();
  impl_->scrolledOut = Json::object();
  impl_->disabled = Json::array();
  impl_->values = Json::object();
}

void AutomationState::widget(const std::string &area, const std::string &id, const Rect &rect, const Rect &clip,
                             bool enabled) {
  if (!isOn()) return;
  const std::string key = area + "/" + id;
  const Rect shown{std::max(rect[0], clip[0]), std::max(rect[1], clip[1]), std::min(rect[2], clip[2]),
                   std::min(rect[3], clip[3])};
  // A sliver of a widget at the edge of its panel is not clickable.
  const float visible = shown[3] - shown[1], whole = rect[3] - rect[1];
  if (shown[2] - shown[0] < 2.0f || visible < 2.0f || visible < 0.6f * whole) {
    impl_->scrolledOut[key] = rect;
    return;
  }
  impl_->widgets[key] = shown;
  if (!enabled) impl_->disabled.push_back(key);
}

void AutomationState::value(const std::string &area, const std::string &name, const std::string &text) {
  if (isOn()) impl_->values[area + "/" + name] = text;
}

void AutomationState::endFrame(const FrameContext &frame, double now_s) {
  if (!isOn()) return;
  Json &s = impl_->state;
  s["format"] = 1;
  s["frame"] = frame.frame;
  s["processor_s"] = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  s["window"] = frame.windowSize;
  s["view"] = {{"x", frame.view.x}, {"y", frame.view.y}, {"w", frame.view.w}, {"h", frame.view.h}};
  s["area"] = {{"x", frame.area.x}, {"y", frame.area.y}, {"w", frame.area.w}, {"h", frame.area.h}};
  s["panes"] = Json::object();
  if (frame.shownImages())
    for (const Pane pane : {Pane::axial, Pane::sagittal, Pane::coronal, Pane::space})
      if (const PixelRect &r = frame.panes[static_cast<std::size_t>(pane)]; !r.isEmpty())
        s["panes"][paneName(pane)] = {{"x", r.x}, {"y", r.y}, {"w", r.w}, {"h", r.h}};
  s["mouse"] = {{"x", frame.mouseX}, {"y", frame.mouseY}, {"buttons", frame.mouseButtons}};
  s["focused"] = frame.isFocused;
  s["text_input"] = ImGui::GetIO().WantTextInput;
  s["title"] = frame.state.title;
  s["widgets"] = std::move(impl_->widgets);
  s["scrolled_out"] = std::move(impl_->scrolledOut);
  s["disabled"] = std::move(impl_->disabled);
  s["values"] = std::move(impl_->values);
  s["transport"] = transportJson(frame.simulation);
  s["tool"] = frame.activeToolId();
  s["notifications"] = Json::array();
  if (frame.services.panels)
    for (const registry::Notification &n : frame.services.panels->notifications())
      s["notifications"].push_back({{"severity", severityName(n.severity)}, {"title", n.title}, {"text", n.text}});
  s["jobs"] = Json::array();
  if (frame.services.jobs)
    for (const BackgroundJobs::Status &job : frame.services.jobs->running())
      s["jobs"].push_back({{"title", job.title}, {"what", job.what}, {"fraction", job.fraction}});
  s["camera"] = {{"yaw", frame.camera.yaw},
                 {"pitch", frame.camera.pitch},
                 {"distance", frame.camera.distance},
                 {"focus", frame.camera.focus}};
  s["nodes"] = Json::array();
  if (frame.services.scene)
    for (const scene::SceneGraph::Row &row : frame.services.scene->rows())
      if (const scene::Node *node = frame.services.scene->find(row.node))
        s["nodes"].push_back({{"name", node->name}, {"depth", row.depth}, {"visible", node->visible}});
  impl_->isWaiting = true;
  writeIfDue(now_s);
}

void AutomationState::shown(const FrameContext &frame, std::size_t characters) {
  if (!isOn()) return;
  const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  impl_->characters += characters;
  if (impl_->answers.size() >= kAnswers) impl_->answers.erase(impl_->answers.begin());
  impl_->answers.push_back({frame.frame, frame.mouseX, frame.mouseY, impl_->characters, now_s});
  impl_->isWaiting = true;
}

double AutomationState::secondsUntilWrite(double now_s) const {
  if (!isOn() || !impl_->isWaiting) return -1.0;
  return std::max(0.0, impl_->lastWrite_s + kSecondsBetweenWrites - now_s);
}

void AutomationState::writeIfDue(double now_s) {
  if (!isOn() || !impl_->isWaiting || now_s - impl_->lastWrite_s < kSecondsBetweenWrites) return;
  impl_->lastWrite_s = now_s;
  writeNow(false);
}

void AutomationState::writeNow(bool isClosing) {
  if (!isOn()) return;
  impl_->isWaiting = false;
  impl_->state["answers"] = impl_->answers;
  impl_->state["closing"] = isClosing;
  std::filesystem::path temporary = impl_->file;
  temporary += ".new";
  std::error_code error;
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out << impl_->state.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
    if (!out) error = std::make_error_code(std::errc::io_error);
  }
  if (!error) std::filesystem::rename(temporary, impl_->file, error);
  if (error && !impl_->hasFailed)
    log(LogLevel::warn,
        "the automation state cannot be written to '" + pathText(impl_->file) + "': " + error.message());
  impl_->hasFailed = static_cast<bool>(error);
}

}  // namespace c3de::ui
