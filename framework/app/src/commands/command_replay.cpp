// SPDX-License-Identifier: Apache-2.0
// `c3de replay`: its options.
#include <memory>

#include "c3de/core/text.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/run_scene.h"

namespace c3de::app {
namespace {

Handler declareReplay(CLI::App &app, CommandLine &line) {
  const auto options = std::make_shared<RunOptions>();
  options->isReplay = true;
  app.add_option_function<std::string>(
         "RECORDING", [options](const std::string &text) { options->scene = text; },
         "A recording (.c3dr) of `c3de run --record`")
      ->required();
  app.add_flag("--check", options->checkHashes,
               "Compare the recorded state hashes; ends with 5 at the first that differs, and names its step");
  addSeconds(app, "--until", options->until_s, 0.0, "Simulated time to reach; default: the end of the recording");
  CLI::Option *exportList = addFile(app, "--export", options->exportList, "FILE.pvd",
                                    "Write the simulation for ParaView: points and skins over time");
  addSeconds(app, "--export-every", options->exportEvery_s, 1e-9, "Simulated time between two frames of --export")
      ->default_str(formatNumber(kDefaultExportEvery_s))
      ->needs(exportList);
  addSeconds(app, "--from", options->from_s, 0.0, "Simulated time at which --export begins")->needs(exportList);
  addSeconds(app, "--time-limit", options->timeLimit_s, 0.0,
             "Wall-clock time after which the replay stops between two steps, writes its outputs and ends with 124");
  addFile(app, "--report", options->report, "FILE.json", "Write the report as JSON");
  addFile(app, "--save-session", options->saveSession, "FILE.c3de",
          "Write scene, state and the names and hashes of all files at the end; `c3de run FILE.c3de` resumes it");
  addSearch(app, options->search);
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de run SCENE.toml --record day.c3dr --until 5\n"
      "    c3de replay day.c3dr --check                        # the same bits again?\n"
      "    c3de replay day.c3dr --export day.pvd --from 2      # for ParaView");
  return [options, &line]() -> int {
    options->quiet = line.quiet;
    if (options->from_s && options->until_s && *options->from_s > *options->until_s)
      return reportError({ErrorCode::usage, "--from " + formatNumber(*options->from_s) + ": accepted: up to --until " +
                                                formatNumber(*options->until_s)});
    options->session = line.sessionOptions();
    return runScene(*options);
  };
}

}  // namespace

const Command kReplayCommand{"replay", "Repeat a recorded simulation, and compare it with the recording",
                             declareReplay};

}  // namespace c3de::app
