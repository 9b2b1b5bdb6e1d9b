// SPDX-License-Identifier: Apache-2.0
// `c3de study`: its options, and those passed on to the runs.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/session/interrupt.h"
#include "c3de/study/report.h"
#include "c3de/study/study_run.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "commands/standard_output.h"
#include "commands/study_ranks.h"
#include "commands/window_program.h"

namespace c3de::app {
namespace {

struct StudyArguments {
  std::filesystem::path study, folder, earlier;
  bool resume = false;
};

/// The runs load the plugins specified for this command.
std::vector<std::string> pluginOptions(const CommandLine &line, const study::Study &study) {
  std::vector<std::string> out;
  const auto add = [&](const char *option, const std::vector<std::string> &values) {
    for (const std::string &value : values) out.insert(out.end(), {option, value});
  };
  add("--plugin", line.plugins);
  for (const std::filesystem::path &plugin : study.plugins) add("--plugin", {pathText(plugin)});
  add("--plugin-param", line.pluginParameters);
  add("--plugin-path", line.pluginPaths);
  add("--without", line.withoutPlugins);
  if (line.noPlugins) out.emplace_back("--no-plugins");
  if (line.safeMode) out.emplace_back("--safe-mode");
  if (line.trustPlugins) out.emplace_back("--trust-plugins");
  return out;
}

Expected<study::Program> programOf() {
  study::Program program{consoleProgram(), C3DE_VERSION, {}};
  auto build = study::hashOfFile(program.file);
  if (!build) return tl::unexpected(build.error());
  program.build = std::move(*build);
  return program;
}

void printSummary(const study::Study &study, const study::Plan &plan, const study::Outcome &outcome,
                  const std::filesystem::path &folder) {
  for (std::size_t c = 0; c < study.cases.size(); ++c) {
    std::size_t points = 0, failed = 0, front = 0;
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      if (plan.points[p].ofCase != c || plan.points[p].isReference) continue;
      ++points;
      if (!outcome.points[p].failure.empty()) ++failed;
      if (outcome.points[p].isOnFront) ++front;
    }
    const auto ratio = study::costRatio(plan, outcome, c);
    printOut(
        fmt::format("{}: {} points, {} on the front{}{}\n", study.cases[c].name, points, front,
                    failed > 0 ? fmt::format(", {} failed", failed) : "",
                    ratio ? fmt::format(", {} times the cost of before (median)", study::threeDigits(*ratio)) : ""));
  }
  printOut(fmt::format("{}\n", pathText(folder / "report.html")));
}

int run(const StudyArguments &arguments, const CommandLine &line) {
  if (line.ranks == nullptr && isUnderMpi()) return continueInMpiProgram(line.argc, line.argv);
  watchForInterrupt();
  const auto study = study::loadStudy(arguments.study);
  if (!study) return reportError(study.error());
  const auto program = programOf();
  if (!program) return reportError(program.error());
  SessionOptions sessionOptions = line.sessionOptions();
  sessionOptions.threads = 1;
  sessionOptions.pluginFiles.insert(sessionOptions.pluginFiles.end(), study->plugins.begin(), study->plugins.end());
  const auto journal = beginJournal(sessionOptions);
  auto session = Session::create(sessionOptions);
  if (!session) return reportError(session.error());
  const auto plan = study::planStudy(*study, **session, *program, line.threads.value_or(1));
  if (!plan) return reportError(plan.error());
  session->reset();  // from here on, runs are separate processes
  std::optional<study::EarlierRun> earlier;
  if (!arguments.earlier.empty()) {
    auto loaded = study::loadEarlierRun(arguments.earlier, *study, *plan);
    if (!loaded) return reportError(loaded.error());
    earlier = std::move(*loaded);
  }
  const auto folder = study::StudyFolder::open(arguments.folder, *study, *plan, arguments.resume);
  if (!folder) return reportError(folder.error());

  // The program that started the ranks has placed them, with one point each.
  const std::unique_ptr<study::Workers> workers =
      line.ranks != nullptr ? line.ranks->workers(study->jobs.value_or(line.ranks->count()))
                            : std::make_unique<study::LocalWorkers>(study::jobsFor(*study, *plan));
  const study::StudyOptions options{pluginOptions(line, *study), line.quiet};
  auto outcome = study::runStudy(*study, *plan, *program, *folder, options, *workers);
  if (!outcome) return reportError(outcome.error());
  outcome->earlier = std::move(earlier);
  if (const auto written = study::writeOutputs(*study, *plan, *program, *outcome, arguments.folder); !written)
    return reportError(written.error());
  if (!line.quiet) printSummary(*study, *plan, *outcome, arguments.folder);
  ExitCode exitCode = kDone;
  for (std::size_t c = 0; c < study->cases.size(); ++c)
    if (const std::string &error = outcome->cases[c].error; !error.empty())
      exitCode = reportError({ErrorCode::state, study->where(study->cases[c].reference.line) + ": case '" +
                                                    study->cases[c].name + "': " + error});
  return exitCode;
}

Handler declareStudy(CLI::App &app, CommandLine &line) {
  const auto arguments = std::make_shared<StudyArguments>();
  app.add_option_function<std::string>(
         "STUDY", [arguments](const std::string &text) { arguments->study = text; }, "What to run (.toml)")
      ->required();
  addFile(app, "--out", arguments->folder, "FOLDER", "Output folder for results and report: new or empty")->required();
  addFile(app, "--compare", arguments->earlier, "FOLDER",
          "Compare with an earlier run of this study in another folder: by an earlier build, on another machine");
  app.add_flag("--resume", arguments->resume, "Resume the study in the folder; completed points are not run again");
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de study STUDY.toml --out FOLDER\n"
      "    c3de study STUDY.toml --out FOLDER --resume          # what is missing\n"
      "    mpirun -n 8 c3de study STUDY.toml --out FOLDER");
  return [arguments, &line] { return run(*arguments, line); };
}

}  // namespace

const Command kStudyCommand{"study", "Measure speed against accuracy over a grid of settings", declareStudy};

}  // namespace c3de::app
