// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <list>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/platform.h"
#include "c3de/study/outcome.h"
#include "c3de/study/plan.h"
#include "c3de/study/point_run.h"

namespace c3de::study {

/// Runs points: in processes of this machine, or of others.
class Workers {
 public:
  virtual ~Workers() = default;
  [[nodiscard]] virtual bool hasRoom() const = 0;
  virtual void start(Task task) = 0;  ///< @pre hasRoom()
  struct Done {
    Task task;
    Expected<Result> result;  ///< same as PointRun::poll()
    bool isLost = false;      ///< the result is unknown: the point must be run again
  };
  /// Tasks that have ended since the last call.
  [[nodiscard]] virtual std::vector<Done> poll() = 0;
};

/// Child processes of this process.
class LocalWorkers : public Workers {
 public:
  explicit LocalWorkers(std::size_t most) : most_(most) {}
  [[nodiscard]] bool hasRoom() const override { return runs_.size() < most_; }
  void start(Task task) override { runs_.emplace_back(std::move(task)); }
  [[nodiscard]] std::vector<Done> poll() override;

 private:
  std::size_t most_;
  std::list<PointRun> runs_;
};

/// The folder of a study: a lock, the plan (`plan.json`), and a file per completed point (`points/ID.json`).
class StudyFolder {
 public:
  /// Creates the folder, locks it and writes or compares the plan. ErrorCode::output: it cannot be written.
  /// ErrorCode::usage: another process uses it; it contains this study and resume is false; it contains another study
  /// (the differences are reported); or it contains other files.
  [[nodiscard]] static Expected<StudyFolder> open(const std::filesystem::path &folder, const Study &study,
                                                  const Plan &plan, bool resume);
  [[nodiscard]] const std::filesystem::path &path() const { return path_; }
  /// Results of completed points; a point whose file cannot be read is not completed.
  [[nodiscard]] std::map<std::string, Result> results(const Plan &plan) const;
  [[nodiscard]] Expected<void> keep(const Result &result) const;
  [[nodiscard]] std::filesystem::path workOf(const std::string &id) const { return path_ / "work" / id; }

 private:
  StudyFolder(std::filesystem::path path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  std::filesystem::path path_;
  FileLock lock_;
};

struct StudyOptions {
  /// Options of every run in addition to its scene and settings: plugins
  std::vector<std::string> runOptions;
  bool quiet = false;
};

/// Number of concurrent points if the study does not specify it: as many as have a processor per thread.
[[nodiscard]] std::size_t jobsFor(const Study &study, const Plan &plan);

/// Runs points that are not completed, each once, and evaluates all. Ctrl-C (ErrorCode::cancelled) ends it soon. Points
/// completed by then are stored; this also holds if the process is killed. ErrorCode::output: a file of the folder
/// cannot be written.
[[nodiscard]] Expected<Outcome> runStudy(const Study &study, const Plan &plan, const Program &program,
                                         const StudyFolder &folder, const StudyOptions &options, Workers &workers);

/// Writes study.csv, study.json, report.html and a CASE.svg per case; for several cases also overview.svg.
[[nodiscard]] Expected<void> writeOutputs(const Study &study, const Plan &plan, const Program &program,
                                          const Outcome &outcome, const std::filesystem::path &folder);

}  // namespace c3de::study
