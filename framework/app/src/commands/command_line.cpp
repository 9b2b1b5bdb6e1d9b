// SPDX-License-Identifier: Apache-2.0
#include "commands/command_line.h"

#include "c3de/plugin_host/plugin_records.h"
#include "commands/window_program.h"

namespace c3de::app {

SessionOptions CommandLine::sessionOptions() const {
  SessionOptions options;
  options.searchPlugins = !noPlugins;
  for (const std::string &file : plugins) options.pluginFiles.emplace_back(file);
  options.pluginParameters = pluginParameters;
  for (const std::string &folder : pluginPaths) options.pluginFolders.emplace_back(folder);
  options.loadRules.without = withoutPlugins;
  options.loadRules.isSafeMode = safeMode;
  options.loadRules.records = plugin_host::recordsOfUser();
  if (!trustPlugins) options.loadRules.prober = consoleProgram();
  options.threads = threads.value_or(0);
  return options;
}

namespace {

std::string whyNoFileName(const std::string &text) {
  if (text.empty()) return "the name is empty; accepted: a file name";
  if (text.starts_with("--")) return "'" + text + "' is an option; accepted: a file name";
  return {};
}

}  // namespace

CLI::Option *addFile(CLI::App &app, const std::string &name, std::filesystem::path &file, const std::string &type,
                     const std::string &help) {
  return app
      .add_option_function<std::string>(
          name, [&file](const std::string &text) { file = text; }, help)
      ->type_name(type)
      ->check(CLI::Validator(whyNoFileName, "", ""));
}

CLI::Option *addFiles(CLI::App &app, const std::string &name, std::vector<std::filesystem::path> &files,
                      const std::string &type, const std::string &help) {
  return app
      .add_option_function<std::vector<std::string>>(
          name, [&files](const std::vector<std::string> &texts) { files.assign(texts.begin(), texts.end()); }, help)
      ->type_name(type)
      ->allow_extra_args(false)
      ->check(CLI::Validator(whyNoFileName, "", ""));
}

CLI::Option *addSearch(CLI::App &app, std::vector<std::filesystem::path> &folders) {
  return app
      .add_option_function<std::vector<std::string>>(
          "--search", [&folders](const std::vector<std::string> &names) { folders.assign(names.begin(), names.end()); },
          "Look in this folder and its subfolders for files of a session that have moved (repeatable)")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

CLI::Option *addSize(CLI::App &app, CommandLine &line, const std::string &help) {
  return addParsed(app, "--size", line.size, help, [](const std::string &text) { return parseSize(text); })
      ->type_name("WxH");
}

CLI::Option *addUnit(CLI::App &app, CommandLine &line) {
  return app.add_option("--unit", line.unit, "Unit of meshes: m, mm or cm; default: as stated in the file, else mm")
      ->check(CLI::IsMember({"m", "mm", "cm"}))
      ->type_name("UNIT");
}

CLI::Validator listOfChoices(const std::string &choices) {
  return CLI::Validator([](const std::string &) { return std::string(); }, "{" + choices + "}", "");
}

void addSessionOptions(CLI::App &app, CommandLine &line) {
  constexpr const char *kPlugins = "Plugins", *kGeneral = "General";
  app.add_option("--plugin", line.plugins, "Load this plugin; ends with 4 if it is refused (repeatable)")
      ->type_name("PATH")
      ->allow_extra_args(false)
      ->group(kPlugins);
  app.add_option("--plugin-param", line.pluginParameters, "Set a parameter of a plugin, PLUGIN:ID=VALUE (repeatable)")
      ->type_name("PLUGIN:ID=VALUE")
      ->allow_extra_args(false)
      ->group(kPlugins);
  app.add_option("--plugin-path", line.pluginPaths, "Look for plugins in this folder, too (repeatable)")
      ->type_name("DIR")
      ->allow_extra_args(false)
      ->group(kPlugins);
  app.add_flag("--no-plugins", line.noPlugins, "Do not search folders for plugins; --plugin still loads")
      ->group(kPlugins);
  app.add_option("--without", line.withoutPlugins, "Leave out the plugin with this id or file name (repeatable)")
      ->type_name("ID")
      ->allow_extra_args(false)
      ->group(kPlugins);
  app.add_flag("--safe-mode", line.safeMode, "Load only the plugins that came with the program")
      ->excludes("--plugin")
      ->group(kPlugins);
  app.add_flag("--trust-plugins", line.trustPlugins,
               "Do not try the first use of a plugin in a process of its own before it is loaded")
      ->group(kPlugins);
  addCount(app, "--threads", line.threads, 1, 1024, "Threads that compute; default: as many as the machine has")
      ->group(kGeneral);
  CLI::Option *quiet = app.add_flag("-q,--quiet", line.quiet, "Print errors only")->group(kGeneral);
  app.add_flag("-v,--verbose", line.verbose,
               "Print details as well: plugins, files, times of the preparation, progress of the steps")
      ->excludes(quiet)
      ->group(kGeneral);
}

}  // namespace c3de::app
