// SPDX-License-Identifier: Apache-2.0
// The command line: what each sub-command accepts. What it does stands in command_*.cpp and workstation.cpp.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/session/resources.h"
#include "command_info.h"
#include "command_plugins.h"
#include "command_run.h"
#include "exit_code.h"
#include "option_values.h"
#include "standard_output.h"
#include "window_program.h"
#ifdef C3DE_HAS_WINDOW
#include "workstation.h"
#endif

namespace {

using namespace c3de;
using namespace c3de::app;

/// Options as they were given; what they mean together is checked where it can be said well.
struct Arguments {
  SessionOptions session;
  std::vector<std::string> plugins, pluginPaths, files;
  bool noPlugins = false, json = false, version = false, play = false, quiet = false, verbose = false,
       patientNames = false, infoQuick = false;
  std::string unit, view, automationState, scene, exportList, exportSurface, exportImage, exportDisplacement;
  std::optional<double> until_s, timeLimit_s;
  std::optional<double> exportEvery_s;
  std::optional<long long> steps, threads, seed, probesEvery;
  std::optional<PictureSize> size;
  std::vector<std::string> overrides;
  std::string report, probes, screenshot, series;
  long long time = 0;
};

/// An option whose text is turned into a value by a function of ours.
template <class T, class Parse>
CLI::Option *addParsed(CLI::App &app, const std::string &name, std::optional<T> &value, const std::string &help,
                       Parse parse) {
  return app.add_option_function<std::string>(
      name,
      [name, &value, parse](const std::string &text) {
        const auto parsed = parse(text);
        if (!parsed) throw CLI::ValidationError(name, parsed.error().message);
        value = *parsed;
      },
      help);
}

CLI::Option *addSeconds(CLI::App &app, const std::string &name, std::optional<double> &value, double least,
                        const std::string &help) {
  return addParsed(app, name, value, help,
                   [least](const std::string &text) { return parseDecimal(text, least, 1e9, "s"); })
      ->type_name("SECONDS");
}

CLI::Option *addCount(CLI::App &app, const std::string &name, std::optional<long long> &value, long long least,
                      long long most, const std::string &help) {
  return addParsed(app, name, value, help,
                   [least, most](const std::string &text) { return parseWhole(text, least, most); })
      ->type_name("N");
}

CLI::Option *addSize(CLI::App &app, Arguments &arguments, const std::string &help) {
  return addParsed(app, "--size", arguments.size, help, [](const std::string &text) { return parseSize(text); })
      ->type_name("WxH");
}

/// @param type  "FILE.json"
CLI::Option *addFile(CLI::App &app, const std::string &name, std::string &file, const std::string &type,
                     const std::string &help) {
  const auto isNamed = [](const std::string &text) -> std::string {
    if (text.empty()) return "the name is empty; accepted: a file name";
    if (text.starts_with("--")) return "'" + text + "' is an option; accepted: a file name";
    return {};
  };
  return app.add_option(name, file, help)->type_name(type)->check(CLI::Validator(isNamed, "", ""));
}

void addSessionOptions(CLI::App &app, Arguments &arguments) {
  app.add_option("--plugin", arguments.plugins, "Load this plugin; ends with 4 if it is refused (repeatable)")
      ->type_name("PATH")
      ->allow_extra_args(false);
  app.add_option("--plugin-path", arguments.pluginPaths, "Look for plugins in this folder, too (repeatable)")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_flag("--no-plugins", arguments.noPlugins, "Load no plugin");
  addCount(app, "--threads", arguments.threads, 1, 1024, "Threads that compute; default: as many as the machine has");
  app.add_flag("-v,--verbose", arguments.verbose, "Say more");
}

CLI::Option *addUnit(CLI::App &app, Arguments &arguments) {
  return app.add_option("--unit", arguments.unit, "Unit of meshes: m, mm or cm; default: what the file says, else mm")
      ->check(CLI::IsMember({"m", "mm", "cm"}))
      ->type_name("UNIT");
}

SessionOptions sessionOptions(const Arguments &arguments) {
  SessionOptions options;
  options.usePlugins = !arguments.noPlugins;
  for (const std::string &file : arguments.plugins) options.pluginFiles.emplace_back(file);
  for (const std::string &folder : arguments.pluginPaths) options.pluginFolders.emplace_back(folder);
  options.threads = static_cast<unsigned>(arguments.threads.value_or(0));
  return options;
}

bool hasDisplay() {
#if defined(_WIN32) || defined(__APPLE__)
  return true;
#else
  return !environmentVariable("DISPLAY").empty() || !environmentVariable("WAYLAND_DISPLAY").empty();
#endif
}

/// What the window is to open, and what is to be said about it.
struct Opened {
  std::vector<std::filesystem::path> files;
  std::string notice;
};

/// Refused before there is a window.
Expected<Opened> whatToOpen(const Arguments &arguments) {
  Opened opened;
  for (const std::string &file : arguments.files) {
    std::error_code code;
    if (!std::filesystem::exists(file, code)) {
      // A single word is more likely a misspelt command than a file.
      const std::vector<std::string> commands{"run", "info", "plugins", "study"};
      if (file.find_first_of("./\\") == std::string::npos) {
        const std::string nearest = nearestName(file, commands);
        return fail(ErrorCode::usage, "'" + file + "' is neither a command nor a file; " +
                                          (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                          "commands: run, info, plugins");
      }
      return fail(ErrorCode::input, file + ": no such file; accepted: meshes, images and scenes (.toml)");
    }
    opened.files.emplace_back(file);
  }
  if (opened.files.empty()) {
    const auto scene = findDefaultScene();
    if (!scene) return tl::unexpected(scene.error());
    opened = {{scene->file}, scene->notice};
  }
  if (!hasDisplay())
    return fail(ErrorCode::graphics,
                "there is no display (DISPLAY and WAYLAND_DISPLAY are empty); `c3de run "
                "SCENE.toml --report FILE.json --screenshot FILE.png` works without one");
  return opened;
}

#ifdef C3DE_HAS_WINDOW
int openWorkstation(const Arguments &arguments, const Opened &opened) {
  WorkstationOptions options;
  options.session = sessionOptions(arguments);
  options.meshUnit = arguments.unit;
  options.play = arguments.play;
  options.automationState = arguments.automationState;
  if (arguments.size) {
    options.width = arguments.size->width;
    options.height = arguments.size->height;
  }
  options.files = opened.files;
  options.notice = opened.notice;
  return runWorkstation(options);
}
#endif

int run(const Arguments &arguments) {
  RunOptions options;
  options.session = sessionOptions(arguments);
  options.scene = arguments.scene;
  options.meshUnit = arguments.unit;
  options.until_s = arguments.until_s;
  options.timeLimit_s = arguments.timeLimit_s;
  if (arguments.steps) options.steps = static_cast<std::uint64_t>(*arguments.steps);
  if (arguments.seed) options.seed = static_cast<std::uint64_t>(*arguments.seed);
  options.overrides = arguments.overrides;
  options.report = arguments.report;
  options.probes = arguments.probes;
  options.probesEvery = static_cast<std::uint64_t>(arguments.probesEvery.value_or(1));
  options.screenshot = arguments.screenshot;
  options.exportList = arguments.exportList;
  options.exportEvery_s = arguments.exportEvery_s.value_or(kDefaultExportEvery_s);
  options.exportSurface = arguments.exportSurface;
  options.exportImage = {arguments.exportImage, arguments.exportDisplacement};
  options.quiet = arguments.quiet;
  if (arguments.size) {
    if (arguments.screenshot.empty()) return reportError({ErrorCode::usage, "--size is for --screenshot"});
    options.width = arguments.size->width;
    options.height = arguments.size->height;
  }
  if (!arguments.view.empty()) {
    if (arguments.screenshot.empty()) return reportError({ErrorCode::usage, "--view is for --screenshot"});
    options.view = pictureViewOf(arguments.view);
    if (!options.view)
      return reportError(
          {ErrorCode::usage, "--view " + arguments.view + ": accepted: 3d, axial, sagittal, coronal, four-up"});
  }
  return runScene(options);
}

/// One line. Of an option that is not known the nearest one.
std::string whatIsWrong(const CLI::ParseError &error, const CLI::App &app, const CLI::App &at) {
  if (dynamic_cast<const CLI::ExtrasError *>(&error) == nullptr) return error.what();
  std::vector<std::string> known;
  for (const CLI::Option *option : at.get_options())
    for (const std::string &name : option->get_lnames()) known.push_back("--" + name);
  std::string text;
  std::vector<std::string> extras = app.remaining(true);
  // What follows an option that is not known is most often its value.
  const auto isOption = [](const std::string &extra) { return extra.starts_with('-'); };
  if (std::any_of(extras.begin(), extras.end(), isOption))
    std::erase_if(extras, [&](const std::string &extra) { return !isOption(extra); });
  for (const std::string &extra : extras) {
    const std::string name = extra.substr(0, extra.find('='));
    const std::string nearest = name.starts_with("--") ? nearestName(name, known) : "";
    text += (text.empty() ? "" : "; ") + ("'" + extra + "' is not accepted here") +
            (nearest.empty() ? "" : ", did you mean " + nearest + "?");
  }
  return text;
}

int dispatch(int argc, char **argv) {
  Arguments arguments;
  CLI::App app(
      "Workstation for medical images that hosts simulation plugins.\n"
      "Without a command: open the workstation on FILES, or on a default scene.",
      "c3de");
  app.set_help_flag("-h,--help", "Say this");
  app.require_subcommand(0, 1);
  app.add_option("FILES", arguments.files,
                 "Meshes, scenes (.toml) and images (DICOM folder, NIfTI, NRRD, MetaImage) to open; images after the "
                 "first are label maps");
  app.add_flag("--version", arguments.version, "Print product, ABI and (with --json) services");
  app.add_flag("--json", arguments.json, "With --version: as JSON");
  app.add_flag("--play", arguments.play, "Play as soon as the scene is there");
  addSize(app, arguments, "Size of the window, at most that of the screen");
  addFile(app, "--automation-state", arguments.automationState, "FILE",
          "Mirror the program's state to this file as JSON");
  addUnit(app, arguments);
  addSessionOptions(app, arguments);

  CLI::App *runCommand = app.add_subcommand("run", "Simulate without a window");
  runCommand->add_option("SCENE", arguments.scene, "A scene (.toml), or a mesh as one body")->required();
  CLI::Option *until = addSeconds(*runCommand, "--until", arguments.until_s, 0.0,
                                  "Simulated time to reach; default: 1 s (a quasi-static solution: its full load)");
  addCount(*runCommand, "--steps", arguments.steps, 0, 1000000000000LL, "Steps to make, instead of --until")
      ->excludes(until);
  addSeconds(*runCommand, "--time-limit", arguments.timeLimit_s, 0.0,
             "Wall-clock time after which the run stops between two steps, writes its outputs and ends with 124");
  runCommand
      ->add_option("--set", arguments.overrides,
                   "Replace a value of the scene, for example body.liver.material.youngs_modulus=6e3 (repeatable)")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  addFile(*runCommand, "--report", arguments.report, "FILE.json", "Write the report as JSON");
  addFile(*runCommand, "--probes", arguments.probes, "FILE.csv", "Write the probes over time as CSV");
  addCount(*runCommand, "--probes-every", arguments.probesEvery, 1, 1000000000LL, "Steps between two rows of --probes")
      ->default_str("1");
  addFile(*runCommand, "--screenshot", arguments.screenshot, "FILE.png", "Draw the end state");
  addSize(*runCommand, arguments, "Size of the screenshot; default: 1280x720");
  runCommand
      ->add_option(
          "--view", arguments.view,
          "What the screenshot shows: 3d, axial, sagittal, coronal or four-up; default: four-up where the scene has an "
          "image, else 3d")
      ->type_name("VIEW");
  CLI::Option *exportList = addFile(*runCommand, "--export", arguments.exportList, "FILE.pvd",
                                    "Write the simulation for ParaView: phyxels and skins over time");
  addSeconds(*runCommand, "--export-every", arguments.exportEvery_s, 1e-9,
             "Simulated time between two frames of --export")
      ->default_str(formatNumber(kDefaultExportEvery_s))
      ->needs(exportList);
  addFile(*runCommand, "--export-image", arguments.exportImage, "FILE",
          "Write the scene's image as the tissue lies at the end (nrrd, nii, nii.gz, mha)");
  addFile(*runCommand, "--export-displacement", arguments.exportDisplacement, "FILE",
          "Write how far the tissue has come, mm at the voxels of the image");
  addFile(*runCommand, "--export-surface", arguments.exportSurface, "FILE",
          "Write the skin of the end state (obj, stl, ply, vtp); of several bodies FILE-NAME each");
  addCount(*runCommand, "--seed", arguments.seed, 0, 9223372036854775807LL,
           "Kept in the report; nothing in this version is random");
  runCommand->add_flag("-q,--quiet", arguments.quiet, "Say nothing but errors");
  addUnit(*runCommand, arguments);
  addSessionOptions(*runCommand, arguments);

  CLI::App *infoCommand =
      app.add_subcommand("info", "What a mesh, image, folder of images or scene contains, and what is wrong with it");
  infoCommand
      ->add_option("FILE", arguments.files,
                   "Meshes, images (DICOM, NIfTI, NRRD, MetaImage), folders of DICOM files and scenes")
      ->required();
  infoCommand
      ->add_option(
          "--series", arguments.series,
          "The series of a folder that holds several: its identifier, number or description, a part behind a #")
      ->type_name("ID");
  infoCommand->add_option("--time", arguments.time, "The time point of an image that holds several, from 0")
      ->check(CLI::Range(0LL, 1000000LL))
      ->type_name("N");
  infoCommand->add_flag("--patient-names", arguments.patientNames,
                        "Show the names of patients, which are left out otherwise");
  infoCommand->add_flag("--quick", arguments.infoQuick,
                        "Do not build the bodies of scenes; what only that can tell is not checked");
  infoCommand->add_flag("--json", arguments.json, "One object for one file, a list for several");
  addUnit(*infoCommand, arguments);
  addSessionOptions(*infoCommand, arguments);

  CLI::App *pluginsCommand = app.add_subcommand("plugins", "What was found, loaded, refused and why");
  pluginsCommand->add_flag("--json", arguments.json, "As JSON");
  addSessionOptions(*pluginsCommand, arguments);

  CLI::App *studyCommand = app.add_subcommand("study", "Not served yet")->allow_extras();

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError &error) {
    const CLI::App &at = app.get_subcommands().empty() ? app : *app.get_subcommands().front();
    const std::string command = &at == &app ? "c3de" : "c3de " + at.get_name();
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      printOut(at.help(&at == &app ? "" : "c3de"));
      return kDone;
    }
    return reportError({ErrorCode::usage, whatIsWrong(error, app, at) + "; see " + command + " --help"});
  }

  if (arguments.verbose) setLogThreshold(LogLevel::debug);
  if (arguments.quiet) setLogThreshold(LogLevel::error);
  if (studyCommand->parsed())
    return reportError({ErrorCode::usage, "'study' is not served yet; this version serves run, info and plugins"});
  if (arguments.version) {
    printVersion(arguments.json);
    return kDone;
  }
#ifndef C3DE_HAS_WINDOW
  if (runCommand->parsed() && !arguments.screenshot.empty() && hasWindowProgram())
    return continueInWindowProgram(argc, argv);
#endif
  if (runCommand->parsed()) return run(arguments);
  if (infoCommand->parsed()) {
    InfoOptions options;
    options.session = sessionOptions(arguments);
    for (const std::string &file : arguments.files) options.files.emplace_back(file);
    options.meshUnit = arguments.unit;
    options.series = arguments.series;
    options.time = static_cast<std::size_t>(arguments.time);
    options.patientNames = arguments.patientNames;
    options.json = arguments.json;
    options.isQuick = arguments.infoQuick;
    return showInfo(options);
  }
  if (pluginsCommand->parsed()) return listPlugins(sessionOptions(arguments), arguments.json);
  if (arguments.json) return reportError({ErrorCode::usage, "--json is for --version, info and plugins"});
  const auto opened = whatToOpen(arguments);
  if (!opened) return reportError(opened.error());
#ifdef C3DE_HAS_WINDOW
  return openWorkstation(arguments, *opened);
#else
  return continueInWindowProgram(argc, argv);
#endif
}

}  // namespace

int main(int argc, char **argv) {
#ifdef SIGXFSZ
  // A file that reaches the limit of its size is an output that cannot be written, not a reason to die.
  std::signal(SIGXFSZ, SIG_IGN);
#endif
  try {
    return exitCodeAfterOutput(dispatch(argc, argv));
  } catch (const std::exception &error) {
    return reportError({ErrorCode::internal, std::string("unexpected: ") + error.what()});
  }
}
