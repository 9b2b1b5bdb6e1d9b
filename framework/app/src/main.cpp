// SPDX-License-Identifier: Apache-2.0
// The command line: what each sub-command accepts. What it does stands in command_*.cpp and workstation.cpp.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "command_info.h"
#include "command_plugins.h"
#include "command_run.h"
#include "exit_code.h"
#include "resources.h"
#include "workstation.h"

namespace {

using namespace c3de;
using namespace c3de::app;

/// Options as text; what they mean is checked where it can be said well.
struct Arguments {
  SessionOptions session;
  std::vector<std::string> plugins, pluginPaths, files;
  bool noPlugins = false, json = false, version = false, play = false, quiet = false, verbose = false, patientNames = false;
  std::string unit, size, automationState, scene, exportList, exportSurface, exportImage, exportDisplacement;
  double until_s = -1.0, timeLimit_s = -1.0;
  double exportEvery_s = kDefaultExportEvery_s;
  long long steps = -1, threads = 0, seed = -1, probesEvery = 1;
  std::vector<std::string> overrides;
  std::string report, probes, screenshot, series;
};

void addSessionOptions(CLI::App &app, Arguments &arguments) {
  app.add_option("--plugin", arguments.plugins, "Load this plugin; ends with 4 if it is refused (repeatable)")
      ->type_name("PATH")->allow_extra_args(false);
  app.add_option("--plugin-path", arguments.pluginPaths, "Look for plugins in this folder, too (repeatable)")
      ->type_name("DIR")->allow_extra_args(false);
  app.add_flag("--no-plugins", arguments.noPlugins, "Load no plugin");
  app.add_option("--threads", arguments.threads, "Threads that compute; default: as many as the machine has")
      ->check(CLI::Range(1LL, 1024LL))->type_name("N");
  app.add_flag("-v,--verbose", arguments.verbose, "Say more");
}

CLI::Option *addUnit(CLI::App &app, Arguments &arguments) {
  return app.add_option("--unit", arguments.unit, "Unit of meshes: m, mm or cm; default: what the file says, else mm")
      ->check(CLI::IsMember({"m", "mm", "cm"}))->type_name("UNIT");
}

/// "1280x720"
bool parseSize(const std::string &text, int &width, int &height) {
  char rest = 0;
  return std::sscanf(text.c_str(), "%5dx%5d%c", &width, &height, &rest) == 2 && width >= 16 && height >= 16 &&
         width <= 16384 && height <= 16384;
}

Error sizeError(const std::string &text) {
  return {ErrorCode::usage, "--size " + text + ": accepted: WIDTHxHEIGHT in pixels, 16 to 16384, for example 1280x720"};
}

SessionOptions sessionOptions(const Arguments &arguments) {
  SessionOptions options;
  options.usePlugins = !arguments.noPlugins;
  for (const std::string &file : arguments.plugins) options.pluginFiles.emplace_back(file);
  for (const std::string &folder : arguments.pluginPaths) options.pluginFolders.emplace_back(folder);
  options.threads = static_cast<unsigned>(arguments.threads);
  return options;
}

bool hasDisplay() {
#if defined(_WIN32) || defined(__APPLE__)
  return true;
#else
  return !environmentVariable("DISPLAY").empty() || !environmentVariable("WAYLAND_DISPLAY").empty();
#endif
}

int openWorkstation(const Arguments &arguments) {
  WorkstationOptions options;
  options.session = sessionOptions(arguments);
  options.meshUnit = arguments.unit;
  options.play = arguments.play;
  options.automationState = arguments.automationState;
  if (!arguments.size.empty() && !parseSize(arguments.size, options.width, options.height))
    return reportError(sizeError(arguments.size));
  for (const std::string &file : arguments.files) {
    std::error_code code;
    if (!std::filesystem::exists(file, code)) {
      // A single word is more likely a misspelt command than a file.
      const std::vector<std::string> commands{"run", "info", "plugins", "study"};
      if (file.find_first_of("./\\") == std::string::npos) {
        const std::string nearest = nearestName(file, commands);
        return reportError({ErrorCode::usage, "'" + file + "' is neither a command nor a file; " +
                                                  (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                                  "commands: run, info, plugins"});
      }
      return reportError({ErrorCode::input, file + ": no such file; accepted: meshes, images and scenes (.toml)"});
    }
    options.files.emplace_back(file);
  }
  if (options.files.empty()) {
    const auto scene = findDefaultScene();
    if (!scene) return reportError(scene.error());
    options.files.push_back(scene->file);
    options.notice = scene->notice;
  }
  if (!hasDisplay())
    return reportError({ErrorCode::graphics, "there is no display (DISPLAY and WAYLAND_DISPLAY are empty); `c3de run "
                                             "SCENE.toml --report FILE.json --screenshot FILE.png` works without one"});
  return runWorkstation(options);
}

int run(const Arguments &arguments) {
  RunOptions options;
  options.session = sessionOptions(arguments);
  options.scene = arguments.scene;
  options.meshUnit = arguments.unit;
  if (arguments.until_s >= 0.0) options.until_s = arguments.until_s;
  if (arguments.timeLimit_s >= 0.0) options.timeLimit_s = arguments.timeLimit_s;
  if (arguments.steps >= 0) options.steps = static_cast<std::uint64_t>(arguments.steps);
  if (arguments.seed >= 0) options.seed = static_cast<std::uint64_t>(arguments.seed);
  options.overrides = arguments.overrides;
  options.report = arguments.report;
  options.probes = arguments.probes;
  options.probesEvery = static_cast<std::uint64_t>(arguments.probesEvery);
  options.screenshot = arguments.screenshot;
  options.exportList = arguments.exportList;
  options.exportEvery_s = arguments.exportEvery_s;
  options.exportSurface = arguments.exportSurface;
  options.exportImage = {arguments.exportImage, arguments.exportDisplacement};
  options.quiet = arguments.quiet;
  if (!arguments.size.empty()) {
    if (arguments.screenshot.empty()) return reportError({ErrorCode::usage, "--size is for --screenshot"});
    if (!parseSize(arguments.size, options.width, options.height)) return reportError(sizeError(arguments.size));
  }
  return runScene(options);
}

int dispatch(int argc, char **argv) {
  Arguments arguments;
  CLI::App app("Workstation for medical images that hosts simulation plugins.\n"
               "Without a command: open the workstation on FILES, or on a default scene.", "c3de");
  app.set_help_flag("-h,--help", "Say this");
  app.require_subcommand(0, 1);
  app.add_option("FILES", arguments.files, "Meshes, scenes (.toml) and images (DICOM folder, NIfTI, NRRD, MetaImage) to open; images after the first are label maps");
  app.add_flag("--version", arguments.version, "Print product, ABI and (with --json) services");
  app.add_flag("--json", arguments.json, "With --version: as JSON");
  app.add_flag("--play", arguments.play, "Play as soon as the scene is there");
  app.add_option("--size", arguments.size, "Size of the window")->type_name("WxH");
  app.add_option("--automation-state", arguments.automationState, "Mirror the program's state to this file as JSON")
      ->type_name("FILE");
  addUnit(app, arguments);
  addSessionOptions(app, arguments);

  CLI::App *runCommand = app.add_subcommand("run", "Simulate without a window");
  runCommand->add_option("SCENE", arguments.scene, "A scene (.toml), or a mesh as one body")->required();
  CLI::Option *until = runCommand->add_option("--until", arguments.until_s, "Simulated time to reach; default: 1 s (a quasi-static solution: its full load)")
                           ->check(CLI::Range(0.0, 1e9))->type_name("SECONDS");
  runCommand->add_option("--steps", arguments.steps, "Steps to make, instead of --until")
      ->check(CLI::Range(0LL, 1000000000000LL))->type_name("N")->excludes(until);
  runCommand->add_option("--time-limit", arguments.timeLimit_s,
                         "Wall-clock time after which the run stops between two steps, writes its outputs and ends with 124")
      ->check(CLI::Range(0.0, 1e9))->type_name("SECONDS");
  runCommand->add_option("--set", arguments.overrides,
                         "Replace a value of the scene, for example body.liver.material.youngs_modulus=6e3 (repeatable)")
      ->type_name("PATH=VALUE")->allow_extra_args(false);
  runCommand->add_option("--report", arguments.report, "Write the report as JSON")->type_name("FILE.json");
  runCommand->add_option("--probes", arguments.probes, "Write the probes over time as CSV")->type_name("FILE.csv");
  runCommand->add_option("--probes-every", arguments.probesEvery, "Steps between two rows of --probes")
      ->check(CLI::Range(1LL, 1000000000LL))->type_name("N")->capture_default_str();
  runCommand->add_option("--screenshot", arguments.screenshot, "Draw the end state")->type_name("FILE.png");
  runCommand->add_option("--size", arguments.size, "Size of the screenshot; default: 1280x720")->type_name("WxH");
  CLI::Option *exportList = runCommand->add_option("--export", arguments.exportList, "Write the simulation for ParaView: phyxels and skins over time")
                                ->type_name("FILE.pvd");
  runCommand->add_option("--export-every", arguments.exportEvery_s, "Simulated time between two frames of --export")
      ->check(CLI::Range(1e-9, 1e9))->type_name("SECONDS")->capture_default_str()->needs(exportList);
  runCommand->add_option("--export-image", arguments.exportImage, "Write the scene's image as the tissue lies at the end (nrrd, nii, nii.gz, mha)")
      ->type_name("FILE");
  runCommand->add_option("--export-displacement", arguments.exportDisplacement, "Write how far the tissue has come, mm at the voxels of the image")
      ->type_name("FILE");
  runCommand->add_option("--export-surface", arguments.exportSurface, "Write the skin of the end state (obj, stl, ply, vtp); of several bodies FILE-NAME each")
      ->type_name("FILE");
  runCommand->add_option("--seed", arguments.seed, "Kept in the report; nothing in this version is random")
      ->check(CLI::Range(0LL, 9223372036854775807LL))->type_name("N");
  runCommand->add_flag("-q,--quiet", arguments.quiet, "Say nothing but errors");
  addUnit(*runCommand, arguments);
  addSessionOptions(*runCommand, arguments);

  CLI::App *infoCommand = app.add_subcommand("info", "What a mesh, image, folder of images or scene contains, and what is wrong with it");
  infoCommand->add_option("FILE", arguments.files, "Meshes, images (DICOM, NIfTI, NRRD, MetaImage), folders of DICOM files and scenes")->required();
  infoCommand->add_option("--series", arguments.series, "The series of a folder that holds several")->type_name("ID");
  infoCommand->add_flag("--patient-names", arguments.patientNames, "Show the names of patients, which are left out otherwise");
  infoCommand->add_flag("--json", arguments.json, "One object for one file, a list for several");
  addUnit(*infoCommand, arguments);
  addSessionOptions(*infoCommand, arguments);

  CLI::App *pluginsCommand = app.add_subcommand("plugins", "What was found, loaded, refused and why");
  pluginsCommand->add_flag("--json", arguments.json, "As JSON");
  addSessionOptions(*pluginsCommand, arguments);

  CLI::App *studyCommand = app.add_subcommand("study", "Not served yet")->allow_extras();

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp &help) {
    app.exit(help);
    return kDone;
  } catch (const CLI::ParseError &error) {
    const CLI::App *at = app.get_subcommands().empty() ? &app : app.get_subcommands().front();
    reportError({ErrorCode::usage, error.what()});
    std::fprintf(stderr, "%s", at->help(at == &app ? "" : "c3de").c_str());
    return kUsage;
  }

  if (arguments.verbose) setLogThreshold(LogLevel::debug);
  if (arguments.quiet) setLogThreshold(LogLevel::error);
  if (studyCommand->parsed())
    return reportError({ErrorCode::usage, "'study' is not served yet; this version serves run, info and plugins"});
  if (arguments.version) {
    printVersion(arguments.json);
    return kDone;
  }
  if (runCommand->parsed()) return run(arguments);
  if (infoCommand->parsed()) {
    InfoOptions options;
    options.session = sessionOptions(arguments);
    for (const std::string &file : arguments.files) options.files.emplace_back(file);
    options.meshUnit = arguments.unit;
    options.series = arguments.series;
    options.patientNames = arguments.patientNames;
    options.json = arguments.json;
    return showInfo(options);
  }
  if (pluginsCommand->parsed()) return listPlugins(sessionOptions(arguments), arguments.json);
  if (arguments.json) return reportError({ErrorCode::usage, "--json is for --version, info and plugins"});
  return openWorkstation(arguments);
}

}  // namespace

int main(int argc, char **argv) {
  try {
    return dispatch(argc, argv);
  } catch (const std::exception &error) {
    return reportError({ErrorCode::internal, std::string("unexpected: ") + error.what()});
  }
}
