// SPDX-License-Identifier: Apache-2.0
#include "workstation/report_controller.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "c3de/abi/c3de.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/core/thread_pool.h"
#include "c3de/ui/file_browser.h"
#include "workstation/workstation_export.h"

namespace c3de::app {
namespace {

constexpr std::size_t kKeptLogBytes = std::size_t{1} << 20;

std::filesystem::path pastFolder() { return userCacheDirectory() / "reports"; }

/// No other run has it.
std::filesystem::path pastFile() {
  std::random_device random;
  return pastFolder() / fmt::format("{}-{:08x}.c3dr", processId(), static_cast<std::uint32_t>(random()));
}

/// Name of the distribution, where there is one.
std::string systemName() {
#ifdef _WIN32
  return "Windows";
#else
  std::ifstream in("/etc/os-release");
  for (std::string line; std::getline(in, line);)
    if (constexpr std::string_view kKey = "PRETTY_NAME="; line.starts_with(kKey)) {
      std::string name = line.substr(kKey.size());
      std::erase(name, '"');
      return name;
    }
  return "POSIX";
#endif
}

/// Reads the plugins' files. Any thread.
std::string versionsText(const std::vector<plugin_host::PluginInfo> &plugins, const std::string &graphics,
                         unsigned threads) {
  nlohmann::ordered_json json{{"program", "C3DE " C3DE_VERSION},
                              {"plugin_abi", fmt::format("{}.{}", C3DE_ABI_MAJOR, C3DE_ABI_MINOR)},
                              {"system", systemName()},
                              {"processor", cpuName()},
                              {"threads", threads},
                              {"graphics", graphics},
                              {"plugins", nlohmann::ordered_json::array()}};
  for (const plugin_host::PluginInfo &plugin : plugins) {
    const auto hash = sha256Of(plugin.path);
    json["plugins"].push_back({{"id", plugin.id},
                               {"version", plugin.version},
                               {"file", pathText(plugin.path.filename())},
                               {"state", plugin_host::stateName(plugin.state)},
                               {"reason", plugin.reason},
                               {"sha256", hash ? *hash : "unknown: " + hash.error().message}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void removeFile(const std::filesystem::path &file) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
}

}  // namespace

KeptLog::KeptLog() {
  setLogListener([this](LogLevel level, const std::string &line) {
    constexpr std::array kLevels{"debug", "info", "warn", "error"};
    add(std::string(kLevels[static_cast<std::size_t>(level)]) + ": " + line);
  });
}

KeptLog::~KeptLog() { setLogListener({}); }

void KeptLog::add(const std::string &line) {
  const std::lock_guard lock(mutex_);
  bytes_ += line.size();
  lines_.push_back(line);
  while (bytes_ > kKeptLogBytes && lines_.size() > 1) {
    bytes_ -= lines_.front().size();
    lines_.pop_front();
  }
}

std::string KeptLog::text() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const std::string &line : lines_) text += line + "\n";
  return text;
}

ReportController::~ReportController() {
  if (past_) removeFile(past_->reported.recording);
}

void ReportController::connect(ui::WindowActions &actions) {
  actions.measureReport = [this] { measure(); };
  actions.reportContents = [this]() -> const ui::ReportContents & { return contents_; };
  actions.saveReport = [this](const ui::ReportRequest &wanted, const std::filesystem::path &file) {
    save(wanted, file);
  };
}

void ReportController::begin(bool hasState) {
  end();
  Session &session = parts_.session;
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr) return;
  const auto identity = presentSimulator(session);
  if (!identity) {
    whyNone_ = identity.error().message;
    return;
  }
  node_ = session.simulationNode();
  whyNone_ = "the simulation has just begun; try again";
  simulation->post([this, &session, simulation, changes = session.changes(), hasState, identity = *identity,
                    set = session.recorderSetter(RecorderUse::past), serial = serial_] {
    const auto past = std::make_shared<Past>();
    std::string why;
    const std::uint64_t before = changes->count();
    CapturedState &start = past->reported.start;
    const auto status = simulatorStatus(simulation->table(), simulation->object());
    // The initial state needs no bytes.
    if (const bool isInitial = status && status->steps == 0 && !hasState; isInitial) {
      start.source = changes->source();
      start.identity = identity;
    } else if (auto captured = captureState(session, simulation->object(), identity, *changes)) {
      start = std::move(*captured);
    } else {
      why = captured.error().message;
    }
    if (why.empty()) {
      std::error_code ignored;
      std::filesystem::create_directories(pastFolder(), ignored);
      past->reported.recording = pastFile();
      RecordingStart events;
      events.simulator = identity;
      events.hashEvery = kDefaultHashEvery;
      events.session.steps = start.steps;
      events.session.time_s = start.time_s;
      auto recorder = Recorder::create(past->reported.recording, events, simulation->object());
      if (recorder) set(past->recorder = std::move(*recorder));
      if (!recorder)
        why = recorder.error().message;
      else if (changes->count() != before)
        why = "the simulation was changed while its recording began";
    }
    if (!why.empty()) set(nullptr);
    session.mainQueue().post([this, past, why, serial] {
      if (serial == serial_ && why.empty()) {
        past_ = past;
        return;
      }
      removeFile(past->reported.recording);
      if (serial == serial_) whyNone_ = why;
    });
  });
}

void ReportController::end() {
  ++serial_;
  whyNone_ = "no simulation is open";
  contents_ = {};
  const std::shared_ptr<const Past> past = std::exchange(past_, nullptr);
  if (!past) return;
  if (scene::Simulation *simulation = parts_.session.simulation();
      simulation != nullptr && parts_.session.simulationNode() == node_)
    simulation->post([set = parts_.session.recorderSetter(RecorderUse::past), past] { set(nullptr); });
  removeFile(past->reported.recording);
}

void ReportController::stop() {
  if (scene::Simulation *simulation = parts_.session.simulation())
    simulation->call([this] { parts_.session.recorderSetter(RecorderUse::past)(nullptr); });
  if (past_) removeFile(past_->reported.recording);
  past_.reset();
}

void ReportController::measure() {
  contents_ = {};
  if (!past_ || parts_.session.simulation() == nullptr) {
    contents_.isMeasured = true;
    contents_.recording = "none: " + whyNone_;
    contents_.size = contents_.sizeWithImage = "Less than 1 MB.";
    return;
  }
  struct Sums {
    FileStamp without, with;
    bool needsImage = false;
  };
  const auto sums = std::make_shared<Sums>();
  const std::uint64_t steps = parts_.session.simulation()->state().steps;
  (void)parts_.session.jobs().submit(
      kJobOwner, "Counting the files of the report",
      [sums, past = past_](const ProgressFn &progress) -> Expected<void> {
        const SimulationSource &source = past->reported.start.source;
        sums->needsImage = needsImage(source);
        const auto without = stampOfFiles(withoutImages(source), {past->reported.recording}, progress);
        if (!without) return tl::unexpected(without.error());
        const auto with = stampOfFiles(source, {past->reported.recording}, progress);
        if (!with) return tl::unexpected(with.error());
        sums->without = *without;
        sums->with = *with;
        return {};
      },
      [this, sums, past = past_, steps](const Expected<void> &result) {
        if (!result) return parts_.failed("The report cannot contain the files", result.error());
        const CapturedState &start = past->reported.start;
        const auto sizeOf = [](const FileStamp &sum) {
          return fmt::format("{} files, {} before compression.", sum.files, ui::sizeText(sum.bytes));
        };
        contents_.isMeasured = true;
        contents_.needsImage = sums->needsImage;
        contents_.recording = fmt::format(
            "the simulation from step {} to step {}, all that was changed in it, and "
            "its meshes and label maps",
            start.steps, steps);
        contents_.size = sizeOf(sums->without);
        contents_.sizeWithImage = sizeOf(sums->with);
      });
}

std::string ReportController::values() const {
  std::string text;
  parts_.parameters.forEach([&text](const registry::ParameterSet &set) {
    for (std::size_t i = 0; i < set.decls.size() && i < set.values.size(); ++i) {
      const ParameterValue &value = set.values[i];
      std::string shown = value.text;
      if (value.type == C3DE_PARAM_VEC3)
        shown = fmt::format("[{}, {}, {}]", value.vec[0], value.vec[1], value.vec[2]);
      else if (shown.empty())
        shown = formatNumber(value.num);
      text += fmt::format("{} / {}: {} = {} {}\n", set.owner, set.title, set.decls[i].id, shown, set.decls[i].unit);
    }
  });
  return text;
}

std::string ReportController::logText() const {
  std::string text = parts_.log.text();
  for (const registry::Notification &one : parts_.panels.notifications())
    text += "message: " + one.title + ": " + one.text + "\n";
  return text;
}

void ReportController::save(const ui::ReportRequest &wanted, const std::filesystem::path &file) {
  ProblemReport report;
  report.description = wanted.description;
  report.hasImage = wanted.hasImage;
  report.values = values();
  report.log = logText();
  scene::Simulation *simulation = parts_.session.simulation();
  if (!past_ || simulation == nullptr || (!wanted.hasImage && needsImage(past_->reported.start.source)))
    return write(report, file);
  report.past = past_->reported;
  simulation->post([this, report, file, recorder = past_->recorder] {
    const auto present = recorder->addPresent();
    parts_.session.mainQueue().post([this, report, file, recorder, present] {
      if (!present) return parts_.failed("The report could not be saved", present.error());
      write(report, file);
    });
  });
}

void ReportController::write(const ProblemReport &report, const std::filesystem::path &file) {
  (void)parts_.session.jobs().submit(
      kJobOwner, "Saving " + pathText(file.filename()),
      [report = ProblemReport(report), file, past = past_, plugins = parts_.session.plugins().plugins(),
       graphics = parts_.graphics,
       threads = parts_.session.pool().threadCount()](const ProgressFn &progress) mutable -> Expected<void> {
        report.versions = versionsText(plugins, graphics, threads);
        // What was recorded before an error can be replayed.
        if (report.past && past)
          if (const auto written = past->recorder->waitUntilWritten(); !written)
            report.log += "error: " + written.error().message + "\n";
        return writeProblemReport(report, file, progress);
      },
      [this, file, hasPast = report.past.has_value()](const Expected<void> &result) {
        if (!result) return parts_.failed("The report could not be saved", result.error());
        std::error_code code;
        const auto bytes = std::filesystem::file_size(file, code);
        parts_.panels.notify(C3DE_LOG_INFO, "Report saved",
                             pathText(file) + (code ? "" : ", " + ui::sizeText(bytes)) + "\nIts contents: c3de info " +
                                 pathText(file) +
                                 (hasPast ? "\nTo repeat it: c3de replay " + pathText(file) + " --check" : ""));
      });
}

}  // namespace c3de::app
