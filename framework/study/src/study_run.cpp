// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/study_run.h"

#include <algorithm>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/progress_line.h"
#include "c3de/study/report.h"
#include "work_folder.h"

namespace c3de::study {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// A point lost this often is itself the cause, rather than the processes that ran it.
constexpr int kMaxLosses = 3;

std::vector<std::string> commandOf(const Case &one, const Program &program, const StudyOptions &options) {
  std::vector<std::string> out{pathText(program.file), "run", pathText(one.scene)};
  out.insert(out.end(), options.runOptions.begin(), options.runOptions.end());
  return out;
}

void addSettings(std::vector<std::string> &arguments, const std::vector<Setting> &settings) {
  for (const Setting &setting : settings)
    arguments.insert(arguments.end(), {"--set", setting.path + "=" + setting.value});
}

/// Initial skins of the bodies of a case, before anything moves, as built by the simulator.
Expected<std::vector<Skin>> skinsOf(const Study &study, const Case &one, const PlannedCase &planned,
                                    const Program &program, const StudyFolder &folder, const StudyOptions &options) {
  const std::filesystem::path work = folder.workOf("skins of " + one.name);
  std::error_code code;
  std::filesystem::create_directories(work, code);
  std::vector<std::string> arguments = commandOf(one, program, options);
  addSettings(arguments, one.set);
  const std::filesystem::path file = work / "skin.obj";
  arguments.insert(arguments.end(), {"--steps", "0", "--export-surface", pathText(file), "-q", "--end-with-parent"});
  const auto ran = runProcess(arguments, study.timeLimit_s);
  if (!ran) return tl::unexpected(ran.error());
  if (ran->exitCode != 0) {
    if (session::wasInterrupted()) return fail(ErrorCode::cancelled, "interrupted before the first point");
    std::string reason = displayMessage(ran->errorOutput);
    const std::string_view error = "c3de: error: ";
    if (const std::size_t at = reason.rfind(error); at != std::string::npos) reason.erase(0, at + error.size());
    return fail(ErrorCode::input, study.where(one.line) + ": the bodies of case '" + one.name +
                                      "' cannot be built: " + (ran->timedOut ? "the time limit was reached" : reason));
  }
  const std::vector<std::string> names = scene::namesOfBodies(planned.scene);
  const std::vector<std::filesystem::path> files = session::surfaceFiles(file, names);
  std::vector<Skin> skins;
  for (std::size_t i = 0; i < names.size() && i < files.size(); ++i) {
    if (std::find(planned.bodies.begin(), planned.bodies.end(), names[i]) == planned.bodies.end()) continue;
    auto mesh = geometry::loadMesh(files[i], geometry::LengthUnit::millimetre);
    if (!mesh) return tl::unexpected(mesh.error());
    skins.push_back({names[i], std::move(mesh->mesh)});
  }
  removeWorkFolder(work);
  return skins;
}

Json jsonOf(const Samples &samples) {
  Json json{{"inside", samples.inside}, {"skin_begin", samples.skinBegin}, {"weights", samples.weights}};
  for (const session::SamplePoint &point : samples.points)
    json["points"].push_back(Json::array({point.body, point.at_m}));
  return json;
}

std::optional<Samples> samplesIn(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  const Json json = in ? Json::parse(in, nullptr, false) : Json();
  if (!json.is_object()) return std::nullopt;
  Samples samples;
  samples.inside = json.value("inside", std::size_t{0});
  samples.skinBegin = json.value("skin_begin", std::size_t{0});
  samples.weights = json.value("weights", std::vector<double>{});
  int line = 2;
  for (const Json &point : json.value("points", Json::array()))
    samples.points.push_back({point.at(0).get<std::string>(), point.at(1).get<Vec3>(), line++});
  return samples;
}

/// The points at which the fields of a case are compared; none if nothing is known of its field.
Expected<Samples> samplesOf(const Study &study, const Plan &plan, std::size_t c, const Program &program,
                            const StudyFolder &folder, const StudyOptions &options) {
  const Case &one = study.cases[c];
  Samples samples;
  if (one.reference.source == Reference::Source::value) return samples;
  if (one.reference.source == Reference::Source::file) {
    if (const auto truth = statedReference(study, one, samples); !truth) return tl::unexpected(truth.error());
    return samples;
  }
  // Drawn once, so that a resumed study compares at the same points.
  const std::filesystem::path kept = folder.path() / "points" / ("samples of " + one.name + ".json");
  if (auto before = samplesIn(kept)) return std::move(*before);
  const auto skins = skinsOf(study, one, plan.cases[c], program, folder, options);
  if (!skins) return tl::unexpected(skins.error());
  auto drawn = drawSamples(*skins, study.samples, study.seed);
  if (!drawn) return fail(drawn.error().code, study.where(one.line) + ": " + drawn.error().message);
  if (const auto written = writeWholeFile(kept, jsonOf(*drawn).dump() + "\n"); !written)
    return tl::unexpected(written.error());
  return drawn;
}

Task taskOf(const Study &study, const Point &point, const Samples &samples, const Program &program,
            const StudyFolder &folder, const StudyOptions &options) {
  const Case &one = study.cases[point.ofCase];
  Task task;
  task.id = point.id;
  task.arguments = commandOf(one, program, options);
  addSettings(task.arguments, point.settings);
  if (one.until_s) task.arguments.insert(task.arguments.end(), {"--until", formatNumber(*one.until_s)});
  if (one.steps) task.arguments.insert(task.arguments.end(), {"--steps", std::to_string(*one.steps)});
  task.arguments.insert(task.arguments.end(),
                        {"--threads", std::to_string(point.threads), "--seed", std::to_string(study.seed)});
  task.repeat = point.isReference ? 1 : study.repeat;
  task.timeLimit_s = study.timeLimit_s;
  task.needsEnergies = point.conservesEnergy;
  task.folder = folder.workOf(point.id);
  if (!samples.points.empty()) task.samples = folder.workOf("samples of " + one.name + ".csv");
  if (one.quantity.kind == Quantity::Kind::frequency) {
    task.frequencyOf = one.quantity.name;
    task.component = one.quantity.component;
  }
  return task;
}

/// One line: how many points are completed, what is running, how long it may take.
std::string lineOf(std::size_t done, std::size_t all, std::size_t before, const std::vector<std::string> &running,
                   Clock::time_point begin) {
  std::string text = std::to_string(done) + " of " + std::to_string(all) + " points";
  if (!running.empty()) text += ", runs " + running.front();
  if (running.size() > 1) text += " and " + std::to_string(running.size() - 1) + " more";
  if (done > before) {
    const double spent = std::chrono::duration<double>(Clock::now() - begin).count();
    const double left = spent / static_cast<double>(done - before) * static_cast<double>(all - done);
    text += ", about " +
            (left < 90.0 ? formatNumber(std::ceil(left)) + " s" : formatNumber(std::ceil(left / 60.0)) + " min") +
            " left";
  }
  return text;
}

class Run {
 public:
  Run(const Study &study, const Plan &plan, const Program &program, const StudyFolder &folder,
      const StudyOptions &options, Workers &workers)
      : study_(study), plan_(plan), program_(program), folder_(folder), options_(options), workers_(workers) {}

  Expected<Outcome> run() {
    results_ = folder_.results(plan_);
    if (auto queued = queue(); !queued) return tl::unexpected(queued.error());
    const std::size_t before = results_.size(), all = before + queue_.size();
    const Clock::time_point begin = Clock::now();
    session::ProgressLine progress(options_.quiet);
    while (!queue_.empty() || !running_.empty()) {
      if (session::wasInterrupted())
        return fail(ErrorCode::cancelled, "interrupted; " + std::to_string(results_.size()) + " of " +
                                              std::to_string(all) + " points are done and kept in " +
                                              folder_.path().string() + "; --resume goes on");
      while (!queue_.empty() && workers_.hasRoom()) {
        running_.emplace(queue_.front().id, shownOf(queue_.front().id));
        workers_.start(std::move(queue_.front()));
        queue_.pop_front();
      }
      for (Workers::Done &done : workers_.poll())
        if (auto taken = take(done); !taken) return tl::unexpected(taken.error());
      if (progress.isDue()) {
        std::vector<std::string> names;
        for (const auto &[id, name] : running_) names.push_back(name);
        progress.update(static_cast<double>(results_.size()) / static_cast<double>(all),
                        lineOf(results_.size(), all, before, names, begin));
      }
      if (!running_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return evaluate(study_, plan_, std::move(samples_), results_);
  }

 private:
  /// Queues points that are not completed: references first, because the others depend on them.
  Expected<void> queue();
  Expected<void> take(Workers::Done &done);
  [[nodiscard]] std::string shownOf(const std::string &id) const {
    for (const Point &point : plan_.points)
      if (point.id == id) return study_.cases[point.ofCase].name + ": " + shown(point.parameters);
    return id;
  }

  const Study &study_;
  const Plan &plan_;
  const Program &program_;
  const StudyFolder &folder_;
  const StudyOptions &options_;
  Workers &workers_;
  std::vector<Samples> samples_;
  std::map<std::string, Result> results_;
  std::deque<Task> queue_;
  std::map<std::string, std::string> running_;  ///< display names by id
  std::map<std::string, int> losses_;
};

Expected<void> Run::queue() {
  for (std::size_t c = 0; c < study_.cases.size(); ++c) {
    auto samples = samplesOf(study_, plan_, c, program_, folder_, options_);
    if (!samples) return tl::unexpected(samples.error());
    if (!samples->points.empty())
      if (auto written = session::writeSamplePoints(folder_.workOf("samples of " + study_.cases[c].name + ".csv"),
                                                    samples->points);
          !written)
        return written;
    samples_.push_back(std::move(*samples));
  }
  for (const bool references : {true, false})
    for (const Point &point : plan_.points) {
      const bool isQueued = std::any_of(queue_.begin(), queue_.end(), [&](const Task &t) { return t.id == point.id; });
      if (point.isReference == references && !results_.contains(point.id) && !isQueued)
        queue_.push_back(taskOf(study_, point, samples_[point.ofCase], program_, folder_, options_));
    }
  return {};
}

Expected<void> Run::take(Workers::Done &done) {
  const std::string id = done.task.id;
  running_.erase(id);
  if (done.isLost && ++losses_[id] < kMaxLosses) {
    queue_.push_front(std::move(done.task));
    return {};
  }
  if (done.isLost) {
    results_[id] = Result::failed(id, "crashed", "the process that ran it was lost three times");
    return {};
  }
  if (done.result) {
    results_[id] = *done.result;
    return folder_.keep(*done.result);
  }
  // Interrupted externally, not by this process: --resume runs it again.
  if (done.result.error().code == ErrorCode::cancelled) {
    if (!session::wasInterrupted()) results_[id] = Result::failed(id, "interrupted", done.result.error().message);
    return {};
  }
  return tl::unexpected(done.result.error());
}

}  // namespace

std::vector<Workers::Done> LocalWorkers::poll() {
  std::vector<Done> out;
  for (auto run = runs_.begin(); run != runs_.end();) {
    auto result = run->poll();
    if (!result) {
      ++run;
      continue;
    }
    out.push_back({run->task(), std::move(*result)});
    run = runs_.erase(run);
  }
  return out;
}

std::size_t jobsFor(const Study &study, const Plan &plan) {
  if (study.jobs) return *study.jobs;
  unsigned threads = 1;
  for (const Point &point : plan.points) threads = std::max(threads, point.threads);
  return std::max(1u, std::thread::hardware_concurrency() / threads);
}

Expected<Outcome> runStudy(const Study &study, const Plan &plan, const Program &program, const StudyFolder &folder,
                           const StudyOptions &options, Workers &workers) {
  return Run(study, plan, program, folder, options, workers).run();
}

Expected<void> writeOutputs(const Study &study, const Plan &plan, const Program &program, const Outcome &outcome,
                            const std::filesystem::path &folder) {
  std::vector<std::pair<std::string, std::string>> files{{"study.csv", tableOf(study, plan, outcome)},
                                                         {"study.json", jsonOf(study, plan, program, outcome)},
                                                         {"report.html", reportOf(study, plan, program, outcome)}};
  if (study.cases.size() > 1) files.emplace_back("overview.svg", overviewOf(study, plan, outcome));
  for (std::size_t c = 0; c < study.cases.size(); ++c)
    files.emplace_back(study.cases[c].name + ".svg", diagramOf(study, plan, outcome, c));
  for (const auto &[name, text] : files)
    if (auto written = writeWholeFile(folder / pathFromText(name), text); !written) return written;
  return {};
}

}  // namespace c3de::study
