// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/point_run.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "c3de/core/csv.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/sample_points.h"
#include "c3de/study/first_frequency.h"
#include "work_folder.h"

namespace c3de::study {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// A child ends within seconds of its own limit, unless a step hangs permanently.
constexpr double kGrace_s = 30.0;

// As defined by the contract of the command line.
constexpr int kOutputCode = 7, kDivergedCode = 5, kTimeLimitCode = 124, kInterruptedCode = 130;

std::string textIn(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

/// 128 plus a signal on POSIX; on Windows a number that no command returns.
std::optional<std::string> crashOf(int exitCode) {
  if (exitCode == 128 + 9) return "it was killed (signal 9); perhaps there was too little memory";
  if (exitCode > 128 && exitCode != kInterruptedCode && exitCode < 128 + 65)
    return "it ended by signal " + std::to_string(exitCode - 128) +
           (exitCode == 128 + 11  ? " (memory that is not there)"
            : exitCode == 128 + 6 ? " (abort)"
                                  : "");
  if (exitCode < 0 || exitCode > 255) return "it ended with code " + std::to_string(exitCode);
  return std::nullopt;
}

double numberIn(const std::string &text) {
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// A table of numbers.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<double>> rows;
};

Table readTable(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::string row;
  std::getline(in, row);
  Table out{splitCsvRow(row).value_or(std::vector<std::string>{}), {}};
  while (std::getline(in, row)) {
    const auto cells = splitCsvRow(row);
    if (!cells || cells->size() != out.head.size()) continue;
    std::vector<double> &numbers = out.rows.emplace_back();
    for (const std::string &cell : *cells) numbers.push_back(numberIn(cell));
  }
  return out;
}

/// First frequency of a component of a probe over time, as --probes writes it.
Expected<double> frequencyOf(const Table &table, const std::string &probe, std::size_t component) {
  const auto found = std::find(table.head.begin(), table.head.end(), probe + "." + "xyz"[component] + " [m]");
  if (found == table.head.end()) return fail(ErrorCode::state, "the run has no probe '" + probe + "'");
  const auto column = static_cast<std::size_t>(found - table.head.begin());
  std::vector<double> time, signal;
  for (const std::vector<double> &row : table.rows) {
    if (!time.empty() && !(row[0] > time.back())) continue;
    time.push_back(row[0]);
    signal.push_back(row[column]);
  }
  return firstFrequency(time, signal);
}

/// The maximum over time of stored plus kinetic energy, or of the energy exchanged with gravity.
double energyInPlay(const Table &table) {
  double most = 0.0;
  for (const std::vector<double> &row : table.rows) {
    double stored = 0.0, given = 0.0;
    for (std::size_t i = 1; i < row.size(); ++i) {
      if (table.head[i] == "gravity [J]")
        given += row[i] - table.rows.front()[i];
      else
        stored += row[i];
    }
    most = std::max({most, stored, std::abs(given)});
  }
  return most;
}

}  // namespace

std::string Task::text() const {
  return Json{{"id", id},
              {"arguments", arguments},
              {"repeat", repeat},
              {"time_limit", timeLimit_s},
              {"folder", pathText(folder)},
              {"samples", pathText(samples)},
              {"frequency_of", frequencyOf},
              {"component", component},
              {"wants_energies", needsEnergies}}
      .dump();
}

Expected<Task> Task::fromText(const std::string &text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::internal, "a task that is no JSON");
  try {
    return Task{json.at("id"),
                json.at("arguments"),
                json.at("repeat"),
                json.at("time_limit"),
                pathFromText(json.at("folder")),
                pathFromText(json.at("samples")),
                json.at("frequency_of"),
                json.at("component"),
                json.at("wants_energies")};
  } catch (const Json::exception &error) {
    return fail(ErrorCode::internal, std::string("not a task: ") + error.what());
  }
}

PointRun::PointRun(Task task) : task_(std::move(task)) {}

void PointRun::cancel() { child_.reset(); }

Expected<void> PointRun::start() {
  std::error_code code;
  std::filesystem::create_directories(task_.folder, code);
  if (code) return fail(ErrorCode::output, task_.folder.string() + ": " + code.message());
  std::filesystem::remove(task_.folder / "report.json", code);
  std::vector<std::string> arguments = task_.arguments;
  const auto add = [&](const char *option, const std::string &value) {
    arguments.emplace_back(option);
    arguments.push_back(value);
  };
  add("--report", pathText(task_.folder / "report.json"));
  add("--time-limit", formatNumber(task_.timeLimit_s));
  if (done_ == 0 && !task_.samples.empty()) {
    add("--sample-points", pathText(task_.samples));
    add("--sampled", pathText(task_.folder / "sampled.csv"));
  }
  if (done_ == 0 && !task_.frequencyOf.empty()) add("--probes", pathText(task_.folder / "probes.csv"));
  if (done_ == 0 && task_.needsEnergies) add("--energies", pathText(task_.folder / "energies.csv"));
  arguments.insert(arguments.end(), {"-q", "--end-with-parent"});
  auto child = ChildProcess::start(arguments, task_.folder / "log.txt");
  if (!child) return tl::unexpected(child.error());
  child_ = std::move(*child);
  overdue_ = Clock::now() +
             std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(task_.timeLimit_s + kGrace_s));
  return {};
}

std::optional<Expected<Result>> PointRun::poll() {
  if (!child_) {
    if (auto started = start(); !started) return tl::unexpected(started.error());
    return std::nullopt;
  }
  if (child_->isRunning()) {
    if (Clock::now() < overdue_) return std::nullopt;
    child_.reset();
    return failed("time limit", "it did not stop at its limit of " + formatNumber(task_.timeLimit_s) + " s");
  }
  const int exitCode = child_->wait(0.0).value_or(-1);
  child_.reset();
  auto result = finish(exitCode);
  if (result) removeWorkFolder(task_.folder);
  return result;
}

Expected<Result> PointRun::failed(const std::string &kind, const std::string &reason) const {
  const std::string which = done_ == 0 ? "" : "run " + std::to_string(done_ + 1) + ": ";
  return Result::failed(task_.id, kind, which + reason);
}

std::string PointRun::lastError() const {
  std::ifstream in(task_.folder / "log.txt", std::ios::binary);
  std::string line, last;
  const std::string_view error = "c3de: error: ";
  while (std::getline(in, line))
    if (line.starts_with(error)) last = line.substr(error.size());
  return last.empty() ? "no reason reported" : displayMessage(last);
}

Expected<void> PointRun::readFirst() {
  if (!task_.samples.empty()) {
    auto positions = session::readSampled(task_.folder / "sampled.csv");
    if (!positions) return tl::unexpected(positions.error());
    result_.positions_m = std::move(*positions);
  }
  if (!task_.frequencyOf.empty()) {
    const auto frequency =
        study::frequencyOf(readTable(task_.folder / "probes.csv"), task_.frequencyOf, task_.component);
    if (!frequency) return tl::unexpected(frequency.error());
    result_.frequency_Hz = *frequency;
  }
  if (task_.needsEnergies) result_.peakEnergy_J = energyInPlay(readTable(task_.folder / "energies.csv"));
  return {};
}

std::optional<Expected<Result>> PointRun::finish(int exitCode) {
  if (exitCode == kOutputCode) return fail(ErrorCode::output, lastError());
  if (exitCode == kInterruptedCode) return fail(ErrorCode::cancelled, "a run was interrupted");
  if (const auto crash = crashOf(exitCode)) return failed("crashed", *crash);
  auto run = Result::fromReport(task_.id, textIn(task_.folder / "report.json"));
  if (exitCode != 0) {
    const std::string reason = run && !run->reason.empty() ? displayMessage(run->reason) : lastError();
    return failed(exitCode == kDivergedCode    ? "diverged"
                  : exitCode == kTimeLimitCode ? "time limit"
                                               : "failed",
                  reason);
  }
  if (!run) return failed("failed", "it succeeded, but " + run.error().message);
  if (done_ == 0) {
    result_ = std::move(*run);
    if (const auto read = readFirst(); !read) return failed("failed", read.error().message);
  } else if (run->stateHash != result_.stateHash) {
    return failed("not repeatable", "the same run ends in another state");
  } else {
    result_.runs.push_back(run->runs.front());
  }
  if (++done_ < task_.repeat) return std::nullopt;
  return std::move(result_);
}

}  // namespace c3de::study
