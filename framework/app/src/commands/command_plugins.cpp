// SPDX-License-Identifier: Apache-2.0
// `c3de plugins`
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/log.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/plugin_host/plugin_records.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/session/file_kind.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

/// What a plugin has declared and registered.
struct Offers {
  registry::ParameterRegistry parameters;
  const geometry::MeshFormats *formats = nullptr;

  template <class Each>
  void forParameters(const std::string &plugin, const Each &each) {
    for (const Handle handle : parameters.ownedBy(plugin))
      if (const registry::ParameterSet *set = parameters.find(handle))
        for (const ParameterDecl &decl : set->decls) each(decl);
  }
  /// Extensions without the dot.
  [[nodiscard]] std::vector<std::string> extensions(const std::string &plugin, bool written) const {
    std::vector<std::string> all;
    for (const auto &format : written ? formats->writers() : formats->readers())
      if (format.owner == plugin)
        for (const std::string &extension : format.extensions) all.push_back(extension.substr(1));
    return all;
  }
};

Json describe(const plugin_host::PluginInfo &plugin, Offers &offers) {
  Json json{{"path", plugin.path.string()}, {"state", plugin_host::stateName(plugin.state)}};
  if (plugin.state != plugin_host::PluginState::loaded) json["reason"] = plugin.reason;
  json["id"] = plugin.id;
  json["version"] = plugin.version;
  json["name"] = plugin.displayName;
  json["vendor"] = plugin.vendor;
  json["license"] = plugin.license;
  json["classes"] = plugin.classes;
  json["parameters"] = Json::array();
  offers.forParameters(plugin.id, [&](const ParameterDecl &decl) {
    json["parameters"].push_back(Json{{"id", decl.id},
                                      {"label", decl.label},
                                      {"unit", decl.unit},
                                      {"doc", decl.doc},
                                      {"accepted", decl.accepted()},
                                      {"default", decl.fallbackValue().display()}});
  });
  json["reads"] = offers.extensions(plugin.id, false);
  json["writes"] = offers.extensions(plugin.id, true);
  return json;
}

/// Switches plugins on and off for subsequent runs.
int switchPlugins(plugin_host::PluginRecords &records, const std::vector<std::string> &ids, bool isOff) {
  for (const std::string &id : ids) {
    if (!isOff && !records.isOff(id)) {
      const std::vector<std::string> known = records.allOff();
      const std::string nearest = nearestName(id, known);
      return reportError({ErrorCode::usage, "--on " + id + ": it is not switched off" +
                                                (nearest.empty() ? "" : "; did you mean " + nearest + "?")});
    }
    if (const auto kept = records.setOff(id, isOff); !kept) return reportError(kept.error());
    printOut(id + (isOff ? " stays off from the next start on\n" : " is loaded again from the next start on\n"));
  }
  return kDone;
}

/// The services that plugins find in a window, without a window: registries without a display.
struct WindowServices {
  std::unique_ptr<render::Renderer> renderer = render::createNullRenderer();
  registry::PanelRegistry panels;
  registry::ToolRegistry tools;
  registry::EditList edits;
  registry::CommandRegistry commands;
};

/// What `c3de plugins` lists.
struct Listing {
  std::vector<std::filesystem::path> folders;  ///< searched
  const plugin_host::PluginHost &host;
  Offers &offers;
  std::vector<plugin_host::PluginRecords::Crash> crashes;
};

std::string asJson(const Listing &listing) {
  Json out{
      {"folders", Json::array()}, {"plugins", Json::array()}, {"classes", Json::array()}, {"crashes", Json::array()}};
  for (const auto &folder : listing.folders) out["folders"].push_back(folder.string());
  for (const auto &plugin : listing.host.plugins()) out["plugins"].push_back(describe(plugin, listing.offers));
  for (const auto &one : listing.host.classes())
    out["classes"].push_back(Json{{"id", one.id},
                                  {"label", one.label},
                                  {"doc", one.doc},
                                  {"plugin", one.plugin},
                                  {"interfaces", one.interfaces}});
  for (const auto &crash : listing.crashes)
    out["crashes"].push_back(Json{{"plugin", crash.id}, {"runs", crash.count}, {"last", crash.cause}});
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string asText(const plugin_host::PluginInfo &plugin, Offers &offers) {
  std::string text = plugin_host::stateName(plugin.state);
  text.resize(9, ' ');
  text += plugin.path.string() + "\n         ";
  if (plugin.state != plugin_host::PluginState::loaded) return text + plugin.reason + "\n";
  text += plugin.id + " " + plugin.version + ", " + plugin.displayName + "; " + plugin.vendor + "; " + plugin.license +
          "\n";
  for (const auto &one : plugin.classes) text += "         class " + one + "\n";
  for (const auto &one : offers.extensions(plugin.id, false)) text += "         reads ." + one + "\n";
  for (const auto &one : offers.extensions(plugin.id, true)) text += "         writes ." + one + "\n";
  offers.forParameters(plugin.id, [&](const ParameterDecl &decl) {
    text += fmt::format("         --plugin-param {}:{}={}  {}{}; accepted: {}\n", plugin.id, decl.id,
                        decl.fallbackValue().display(), decl.label, decl.unit.empty() ? "" : ", " + decl.unit,
                        decl.accepted());
  });
  return text;
}

std::string asText(const Listing &listing) {
  std::string text;
  for (const auto &folder : listing.folders) text += "searched " + folder.string() + "\n";
  for (const auto &plugin : listing.host.plugins()) text += asText(plugin, listing.offers);
  if (listing.host.plugins().empty()) text += "no plugin was found\n";
  for (const auto &crash : listing.crashes)
    text += fmt::format("crashed  {}: {} {}\n", crash.id,
                        crash.count == 1 ? "one run" : fmt::format("{} runs; the last", crash.count), crash.cause);
  return text;
}

/// Lists what was found, loaded or refused, and why. A refused plugin that was named with --plugin counts as an error;
/// a refused one in a folder does not.
int listPlugins(const SessionOptions &options, bool json, bool isAsInWindow) {
  // Named plugins are loaded here, one by one, because this command shows a refusal instead of ending with it.
  SessionOptions withoutNamed = options;
  withoutNamed.searchPlugins = false;
  withoutNamed.pluginFiles.clear();
  std::optional<WindowServices> window;
  if (isAsInWindow) {
    window.emplace();
    withoutNamed.renderer = window->renderer.get();
    withoutNamed.panels = &window->panels;
    withoutNamed.tools = &window->tools;
    withoutNamed.edits = &window->edits;
    withoutNamed.commands = &window->commands;
  }
  Offers offers;
  withoutNamed.parameters = &offers.parameters;
  auto session = Session::create(withoutNamed);
  if (!session) return reportError(session.error());
  plugin_host::PluginHost &host = (*session)->plugins();
  offers.formats = &(*session)->meshFormats();
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
  const Listing listing{std::move(folders), host, offers, options.loadRules.records->crashes()};
  if (json) {
    printOut(asJson(listing));
    return exitCode;
  }
  printOut((options.searchPlugins ? "" : "--no-plugins: no folder was looked in\n") + asText(listing));
  return exitCode;
}

Handler declarePlugins(CLI::App &app, CommandLine &line) {
  app.add_flag("--json", line.json, "As JSON");
  const auto isAsInWindow = std::make_shared<bool>(false);
  app.add_flag("--as-in-window", *isAsInWindow, "Provide the services of a window, as in the trial of a first use");
  const auto on = std::make_shared<std::vector<std::string>>(), off = std::make_shared<std::vector<std::string>>();
  app.add_option("--off", *off, "Switch this plugin off for the runs that follow (repeatable)")
      ->type_name("ID")
      ->allow_extra_args(false);
  app.add_option("--on", *on, "Switch it on again (repeatable)")->type_name("ID")->allow_extra_args(false);
  const auto isTrial = std::make_shared<bool>(false);
  app.add_flag("--trial", *isTrial, "Keep settings of plugins in memory alone, as where a first use is tried");
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de plugins --plugin FILE.so       # test whether it loads\n"
      "    c3de plugins --off org.c3de.magnet  # from the next start on");
  return [&line, on, off, isAsInWindow, isTrial] {
    const SessionOptions options = line.sessionOptions();
    if (*isTrial) registry::keepSettingsInMemory();
    if (!off->empty())
      if (const int failed = switchPlugins(*options.loadRules.records, *off, true)) return failed;
    if (!on->empty()) return switchPlugins(*options.loadRules.records, *on, false);
    return off->empty() ? listPlugins(options, line.json, *isAsInWindow) : static_cast<int>(kDone);
  };
}

}  // namespace

const Command kPluginsCommand{"plugins", "What was found, loaded, refused and why", declarePlugins};

}  // namespace c3de::app
