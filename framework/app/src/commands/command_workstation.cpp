// SPDX-License-Identifier: Apache-2.0
// The program without a sub-command: the files to open in the window.
#include <memory>

#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/session/resources.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/window_program.h"

namespace c3de::app {
namespace {

bool hasDisplay() {
#if defined(_WIN32) || defined(__APPLE__)
  return true;
#else
  return !environmentVariable("DISPLAY").empty() || !environmentVariable("WAYLAND_DISPLAY").empty();
#endif
}

tl::unexpected<Error> notThere(const std::string &file) {
  // A single word is more likely a misspelt command than a file.
  if (file.find_first_of("./\\") != std::string::npos)
    return fail(ErrorCode::input, file + ": no such file; accepted: meshes, images and scenes (.toml)");
  std::vector<std::string> names;
  for (const Command *command : commands())
    if (!command->isHidden) names.emplace_back(command->name);
  const std::string nearest = nearestName(file, names);
  return fail(ErrorCode::usage, "'" + file + "' is neither a command nor a file; " +
                                    (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                    "commands: " + availableCommands(", "));
}

/// Files are refused before there is a window.
Expected<void> chooseFiles(const CommandLine &line, WorkstationOptions &options) {
  for (const std::string &file : line.files) {
    std::error_code code;
    if (!std::filesystem::exists(file, code)) return notThere(file);
    options.files.emplace_back(file);
  }
  if (options.files.empty() && options.play) {
    const auto scene = findDefaultScene();
    if (!scene) return tl::unexpected(scene.error());
    options.files = {scene->file};
    options.notice = scene->notice;
  }
  if (!hasDisplay())
    return fail(ErrorCode::graphics,
                "there is no display (DISPLAY and WAYLAND_DISPLAY are empty); `c3de run "
                "SCENE.toml --report FILE.json --screenshot FILE.png` works without one");
  return {};
}

int open(WorkstationOptions options, const CommandLine &line) {
  if (line.json) return reportError({ErrorCode::usage, "--json is for --version, info and plugins"});
  if (const auto chosen = chooseFiles(line, options); !chosen) return reportError(chosen.error());
  if (!line.openWindow) return continueInWindowProgram(line.argc, line.argv);
  options.session = line.sessionOptions();
  options.meshUnit = line.unit;
  if (line.size) {
    options.width = line.size->width;
    options.height = line.size->height;
  }
  return line.openWindow(options);
}

}  // namespace

Handler declareWorkstation(CLI::App &app, CommandLine &line) {
  const auto options = std::make_shared<WorkstationOptions>();
  app.add_option("FILES", line.files,
                 "Meshes, scenes (.toml), sessions (.c3de) and images (DICOM folder, NIfTI, NRRD, MetaImage) to open; "
                 "images after the "
                 "first are label maps");
  app.add_flag("-V,--version", line.version, "Print product, ABI and (with --json) services");
  app.add_flag("--json", line.json, "With --version: as JSON");
  app.add_flag("--play", options->play, "Play as soon as the scene is there; without FILES the default scene");
  app.add_flag("--untitled", options->isUntitled,
               "The first file is a temporary session: saving asks for a file name, and it is not listed in the recent "
               "files");
  addSize(app, line, "Size of the window, at most that of the screen");
  addFile(app, "--automation-state", options->automationState, "FILE",
          "Mirror the program's state to this file as JSON");
  addUnit(app, line);
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de scan.nii.gz labels.nii.gz                  # a scan with its label map\n"
      "    c3de --play                                     # the default scene\n"
      "    c3de run SCENE.toml --until 2 --report r.json   # without a window\n"
      "    c3de help run                                   # a command; also: help environment, help exit-codes\n"
      "Man pages: c3de(1), c3de-run(1)");
  return [options, &line] { return open(*options, line); };
}

}  // namespace c3de::app
