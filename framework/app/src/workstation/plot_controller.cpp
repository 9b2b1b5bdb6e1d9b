// SPDX-License-Identifier: Apache-2.0
#include "workstation/plot_controller.h"

#include <algorithm>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/plot_quantities.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {
namespace {

constexpr int kMeasurements = 1;  // as a source of curves; the simulator is 0
constexpr std::chrono::milliseconds kMinInterval{50};
constexpr int kPauseFactor = 10;  // reading takes at most one of so many parts of the time
constexpr std::size_t kMaxWaiting = 200;
constexpr double kFrame_s = 1.0 / 60.0;  // of simulated time, as of the accuracy setting "budget"

/// Milliseconds for a frame of simulated time, with the limit of real time.
std::optional<ui::PlotValue> costOf(const c3de_sim_transport &state, const c3de_sim_status &status) {
  if (!(status.dt_s > 0.0) || !(state.step_ms > 0.0)) return std::nullopt;
  ui::PlotValue cost{"cost", "computing time per 1/60 s", "ms", state.step_ms * kFrame_s / status.dt_s};
  cost.limit = 1e3 * kFrame_s;
  cost.limitText = "real time, 16.7 ms";
  return cost;
}

}  // namespace

void PlotController::connect(ui::WindowActions &actions) {
  actions.plots.show = [this](bool isShown) {
    isShown_ = isShown;
    if (!isShown) return;
    addMeasurements();
    // A simulation that is not playing publishes its state.
    if (scene::Simulation *simulation = parts_.session.simulation()) simulation->post([] {});
  };
  actions.plots.saveTable = [this](const std::filesystem::path &file) { saveTable(file); };
  actions.plots.savePicture = [this](const std::filesystem::path &file) { wanted_ = file; };
}

void PlotController::saveTable(const std::filesystem::path &file) {
  if (const auto written = writeWholeFile(file, plots_.csv()); !written)
    return parts_.failed("The plots were not saved", written.error());
  parts_.panels.notify(C3DE_LOG_INFO, "Plots saved", pathText(file));
}

void PlotController::onPublished(const scene::Simulation &simulation) {
  if (!isShown_) return;
  const auto now = std::chrono::steady_clock::now();
  const c3de_sim_transport state = simulation.state();
  // The state at which a simulation pauses is read; a replay, which publishes while paused, waits less.
  const auto pause =
      state.mode == C3DE_SIM_PLAYING ? std::max<decltype(took_)>(kMinInterval, kPauseFactor * took_) : 2 * took_;
  if (now - last_ < pause) return;
  last_ = now;
  const auto status = simulatorStatus(simulation.table(), simulation.object());
  if (!status) return;
  Sample sample;
  sample.time_s = status->time_s;
  if (auto cost = costOf(state, *status)) sample.values.push_back(std::move(*cost));
  std::string report;
  if (simulation.table()->report(simulation.object(), scene::sinkInto(report)) >= 0)
    for (PlotQuantity &one : plotQuantities(report))
      sample.values.push_back({std::move(one.id), std::move(one.label), std::move(one.unit), one.value, one.isMain});
  took_ = std::chrono::steady_clock::now() - now;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMaxWaiting) waiting_.erase(waiting_.begin());
  waiting_.push_back(std::move(sample));
}

void PlotController::onRemoved() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  plots_.clear();
  measuredRevision_ = 0;
}

void PlotController::update() {
  std::vector<Sample> samples;
  {
    const std::lock_guard lock(mutex_);
    samples = std::exchange(waiting_, {});
  }
  for (const Sample &sample : samples) plots_.add(sample.time_s, sample.values);
  if (isShown_) addMeasurements();
}

void PlotController::addMeasurements() {
  const ui::MeasurementList &list = parts_.measurements.list();
  const std::optional<double> time_s = list.lastTime_s();
  if (!time_s || list.positionsRevision() == measuredRevision_) return;
  measuredRevision_ = list.positionsRevision();
  std::vector<ui::PlotValue> values;
  std::vector<std::string> ids;
  for (const ui::MeasurementRow &row : list.rows()) {
    if (!row.now) continue;
    const bool isLandmark = row.kind == ui::MeasureKind::landmark;
    ui::PlotValue value{"measure." + row.name, row.name + (isLandmark ? ": displacement" : ""),
                        row.kind == ui::MeasureKind::angle ? "°" : "mm", *row.now, true};
    const auto &known = plots_.series();
    if (std::none_of(known.begin(), known.end(), [&](const auto &s) { return s.last.id == value.id; })) {
      std::vector<ui::PlotPoint> past;
      for (const ui::CurvePoint2 &point : list.curve(row.name)) past.push_back({point.time_s, point.value});
      plots_.addPast(value, past, kMeasurements);
    }
    ids.push_back(value.id);
    values.push_back(std::move(value));
  }
  plots_.keepOnly(kMeasurements, ids);
  plots_.add(*time_s, values, kMeasurements);
}

void PlotController::drawPicture(const ui::SimulationView &simulation) {
  if (!wanted_) return;
  const std::filesystem::path file = std::move(*wanted_);
  wanted_.reset();
  parts_.figures.savePlots(plots_, simulation, file);
}

}  // namespace c3de::app
