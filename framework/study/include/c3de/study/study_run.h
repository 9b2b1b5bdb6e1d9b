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

/// Who runs points: processes of this machine, or of others.
class Workers {
 public:
  virtual ~Workers() = default;
  [[nodiscard]] virtual bool hasRoom() const = 0;
  virtual void start(Task task) = 0;  ///< @pre hasRoom()
  struct Done {
    Task task;
    Expected<Result> result;  ///< as PointRun::poll()
    bool isLost = false;      ///< nobody knows the result: it has to be run again
  };
  /// What has ended since the last call.
  [[nodiscard]] virtual std::vector<Done> poll() = 0;
};

/// Child processes of this one.
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

/// The folder of a study: a lock, what it will run (`plan.json`), a file per point that is done (`points/ID.json`).
class StudyFolder {
 public:
  /// Makes the folder, takes the lock and writes or compares the plan. Errors: ErrorCode::output, it cannot be written;
  /// ErrorCode::usage: another process works in it, it holds this study and resume is false, it holds another one (what
  /// differs is said), or it holds other things.
  [[nodiscard]] static Expected<StudyFolder> open(const std::filesystem::path &folder, const Study &study,
                                                  const Plan &plan, bool resume);
  [[nodiscard]] const std::filesystem::path &path() const { return path_; }
  /// Of points that are done; what cannot be read is not done.
  [[nodiscard]] std::map<std::string, Result> results(const Plan &plan) const;
  [[nodiscard]] Expected<void> keep(const Result &result) const;
  [[nodiscard]] std::filesystem::path workOf(const std::string &id) const { return path_ / "work" / id; }

 private:
  StudyFolder(std::filesystem::path path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  std::filesystem::path path_;
  FileLock lock_;
};

struct StudyOptions {
  /// What every run is started with beside its scene and settings: plugins
  std::vector<std::string> runOptions;
  bool quiet = false;
};

/// Points at a time where the study does not say: so many that they have a processor per thread.
[[nodiscard]] std::size_t jobsFor(const Study &study, const Plan &plan);

/// Runs what is not done yet, each point once, and evaluates all. Ctrl-C (ErrorCode::cancelled) ends it soon; what was
/// done by then is kept, as it is when the process is killed. ErrorCode::output: a file of the folder cannot be written.
[[nodiscard]] Expected<Outcome> runStudy(const Study &study, const Plan &plan, const Program &program,
                                         const StudyFolder &folder, const StudyOptions &options, Workers &workers);

/// study.csv, study.json, report.html and a CASE.svg per case; of several cases overview.svg.
[[nodiscard]] Expected<void> writeOutputs(const Study &study, const Plan &plan, const Program &program,
                                          const Outcome &outcome, const std::filesystem::path &folder);

}  // namespace c3de::study
