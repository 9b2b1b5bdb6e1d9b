// SPDX-License-Identifier: Apache-2.0
#include "command_plugins.h"

#include <array>
#include <nlohmann/json.hpp>

#include "c3de/abi/draft/all.h"
#include "c3de/core/log.h"
#include "c3de/session/file_kind.h"
#include "exit_code.h"
#include "standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kServices{C3DE_COLLISION_ID, C3DE_HISTORY_ID,    C3DE_IMAGING_ID, C3DE_JOBS_ID,     C3DE_LOG_ID,
                               C3DE_MESH_ID,      C3DE_PANELS_ID,     C3DE_PARAMS_ID,  C3DE_REGISTRY_ID, C3DE_RENDER_ID,
                               C3DE_SCENE_ID,     C3DE_SIMULATION_ID, C3DE_TIME_ID,    C3DE_TOOLS_ID};

std::string dump(const Json &json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

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

}  // namespace

int listPlugins(const SessionOptions &options, bool json) {
  // The named ones are loaded here, one by one: a refusal is what this command is to show, not what ends it.
  SessionOptions withoutNamed = options;
  withoutNamed.usePlugins = false;
  auto session = Session::create(withoutNamed);
  if (!session) return reportError(session.error());
  plugin_host::PluginHost &host = (*session)->plugins();
  ExitCode exitCode = kDone;
  std::vector<std::filesystem::path> folders;
  if (options.usePlugins) {
    for (const auto &file : options.pluginFiles)
      if (const auto loaded = host.load(file); !loaded)
        exitCode = reportError({ErrorCode::plugin, loaded.error().message});
    for (const auto &folder : options.pluginFolders) {
      std::error_code code;
      if (std::filesystem::is_directory(folder, code))
        folders.push_back(folder);
      else
        exitCode = reportError({ErrorCode::plugin, "--plugin-path " + notAFolder(folder)});
    }
    for (const auto &folder : plugin_host::defaultPluginFolders()) folders.push_back(folder);
    for (const auto &folder : folders) host.loadFolder(folder);
    host.start();
  }

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
    printOut(dump(out) + "\n");
    return exitCode;
  }
  std::string text;
  if (!options.usePlugins) text += "--no-plugins: nothing was looked for\n";
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

void printVersion(bool json) {
  if (!json) {
    printOut("c3de " C3DE_VERSION ", plugin ABI " + std::to_string(C3DE_ABI_MAJOR) + "." +
             std::to_string(C3DE_ABI_MINOR) + "\n");
    return;
  }
  const Json out{{"product", "c3de"},
                 {"version", C3DE_VERSION},
                 {"abi", {{"major", C3DE_ABI_MAJOR}, {"minor", C3DE_ABI_MINOR}}},
                 {"services", kServices}};
  printOut(dump(out) + "\n");
}

}  // namespace c3de::app
