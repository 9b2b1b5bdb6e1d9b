// SPDX-License-Identifier: Apache-2.0
// `c3de plugins`
#include <nlohmann/json.hpp>

#include "c3de/core/log.h"
#include "c3de/session/file_kind.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

Json describe(const plugin_host::PluginInfo &plugin) {
  const bool loaded = plugin.state == plugin_host::PluginState::loaded;
  Json json{{"path", plugin.path.string()}, {"state", loaded ? "loaded" : "refused"}};
  if (!loaded) json["reason"] = plugin.reason;
  json["id"] = plugin.id;
  json["version"] = plugin.version;
  json["name"] = plugin.displayName;
  json["vendor"] = plugin.vendor;
  json["license"] = plugin.license;
  json["classes"] = plugin.classes;
  return json;
}

/// What was found, loaded, refused and why. A plugin that was named with --plugin and refused counts as an error, one
/// that lies in a folder does not.
int listPlugins(const SessionOptions &options, bool json) {
  // The named ones are loaded here, one by one: a refusal is what this command is to show, not what ends it.
  SessionOptions withoutNamed = options;
  withoutNamed.searchPlugins = false;
  withoutNamed.pluginFiles.clear();
  auto session = Session::create(withoutNamed);
  if (!session) return reportError(session.error());
  plugin_host::PluginHost &host = (*session)->plugins();
  ExitCode exitCode = kDone;
  std::vector<std::filesystem::path> folders;
  for (const auto &file : options.pluginFiles)
    if (const auto loaded = host.load(file); !loaded)
      exitCode = reportError({ErrorCode::plugin, loaded.error().message});
  if (options.searchPlugins) {
    for (const auto &folder : options.pluginFolders) {
      std::error_code code;
      if (std::filesystem::is_directory(folder, code))
        folders.push_back(folder);
      else
        exitCode = reportError({ErrorCode::plugin, "--plugin-path " + notAFolder(folder)});
    }
    for (const auto &folder : plugin_host::defaultPluginFolders()) folders.push_back(folder);
    for (const auto &folder : folders) host.loadFolder(folder);
  }
  host.start();

  if (json) {
    Json out{{"folders", Json::array()}, {"plugins", Json::array()}, {"classes", Json::array()}};
    for (const auto &folder : folders) out["folders"].push_back(folder.string());
    for (const auto &plugin : host.plugins()) out["plugins"].push_back(describe(plugin));
    for (const auto &one : host.classes())
      out["classes"].push_back(Json{{"id", one.id},
                                    {"label", one.label},
                                    {"doc", one.doc},
                                    {"plugin", one.plugin},
                                    {"interfaces", one.interfaces}});
    printOut(out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    return exitCode;
  }
  std::string text;
  if (!options.searchPlugins) text += "--no-plugins: no folder was looked in\n";
  for (const auto &folder : folders) text += "looked in " + folder.string() + "\n";
  for (const auto &plugin : host.plugins()) {
    if (plugin.state == plugin_host::PluginState::refused) {
      text += "refused  " + plugin.path.string() + "\n         " + plugin.reason + "\n";
      continue;
    }
    text += "loaded   " + plugin.path.string() + "\n         " + plugin.id + " " + plugin.version + ", " +
            plugin.displayName + "; " + plugin.vendor + "; " + plugin.license + "\n";
    for (const auto &one : plugin.classes) text += "         class " + one + "\n";
  }
  if (host.plugins().empty()) text += "no plugin was found\n";
  printOut(text);
  return exitCode;
}

Handler declare(CLI::App &app, CommandLine &line) {
  app.add_flag("--json", line.json, "As JSON");
  addSessionOptions(app, line);
  return [&line] { return listPlugins(line.sessionOptions(), line.json); };
}

}  // namespace

const Command kPluginsCommand{"plugins", "What was found, loaded, refused and why", declare};

}  // namespace c3de::app
