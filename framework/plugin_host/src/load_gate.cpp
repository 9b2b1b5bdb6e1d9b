// SPDX-License-Identifier: Apache-2.0
#include "load_gate.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/plugin_host/plugin_records.h"

namespace c3de::plugin_host {
namespace {

bool isBundled(const std::filesystem::path &file) {
  std::error_code error;
  return std::filesystem::equivalent(file.parent_path(), ownPluginFolder(), error);
}

std::string switchedOff(const std::string &name) {
  return fmt::format("switched off; `c3de plugins --on {}`, or the plugin manager, switches it on", name);
}

/// The last line of its output that states why it ended.
std::string lastFatalLine(const std::string &text) {
  std::string found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    for (const char *sign : {"c3de: fatal: ", "has ended the program"})
      if (line.find(sign) != std::string::npos) found = line;
    begin = end + 1;
  }
  for (const char *prefix : {"c3de: fatal: ", "c3de: error: "})
    if (found.starts_with(prefix)) found.erase(0, std::string(prefix).size());
  return displayText(found);
}

/// Why the plugin cannot be used; empty if no reason was found. Refusals by or of the plugin are found when it is
/// loaded, with all services available.
std::string tryInProcess(const LoadRules &rules, const std::filesystem::path &file) {
  std::vector<std::string> command{
      pathText(rules.prober), "plugins", "--no-plugins", "--trust-plugins", "--trial", "--plugin", pathText(file)};
  if (rules.hasWindow) command.emplace_back("--as-in-window");
  const auto ended = runProcess(command, LoadGate::kMaxSeconds);
  if (!ended) return {};
  if (ended->timedOut) return fmt::format("had not come to an end after {} s", LoadGate::kMaxSeconds);
  std::string said = lastFatalLine(ended->errorOutput);
  if (!said.empty()) return "has crashed it: " + said;
  // Exit codes of the program are small; termination by the system has a large or negative one.
  constexpr int kMaxOwn = 63;
  if (ended->exitCode < 0 || ended->exitCode > kMaxOwn)
    return fmt::format("has ended it with code {}", ended->exitCode);
  return {};
}

}  // namespace

std::string LoadGate::reasonFileIsOff(const std::filesystem::path &file, bool isNamed) {
  for (const std::string &name : rules_.without)
    if (name == pathText(file.filename()) || name == pathText(file.stem()) || name == pathText(file)) {
      matched_.insert(name);
      return "left out by --without " + name;
    }
  // A plugin that ends the program while it is loaded has not stated its id.
  if (const std::string name = pathText(file.filename()); !isNamed && rules_.records && rules_.records->isOff(name))
    return switchedOff(name);
  if (rules_.isSafeMode && !isBundled(file)) return "left out in safe mode: it did not come with the program";
  return {};
}

std::string LoadGate::reasonIdIsOff(const std::string &id, bool isNamed) {
  if (std::find(rules_.without.begin(), rules_.without.end(), id) != rules_.without.end()) {
    matched_.insert(id);
    return "left out by --without " + id;
  }
  if (!isNamed && rules_.records && rules_.records->isOff(id)) return switchedOff(id);
  return {};
}

Expected<void> LoadGate::tryFirstUse(const std::filesystem::path &file) {
  if (rules_.prober.empty() || isBundled(file)) return {};
  auto use = rules_.records ? rules_.records->firstUseOf(file, rules_.prober, rules_.hasWindow) : std::nullopt;
  if (!use) {
    use = PluginRecords::FirstUse{tryInProcess(rules_, file)};
    if (rules_.records) rules_.records->keepFirstUse(file, rules_.prober, rules_.hasWindow, *use);
  }
  if (use->reason.empty()) return {};
  return fail(ErrorCode::plugin, fmt::format("its first use, in a separate process, {}; to load it anyway: "
                                             "--trust-plugins",
                                             use->reason));
}

std::vector<std::string> LoadGate::unmatched() const {
  std::vector<std::string> names;
  for (const std::string &name : rules_.without)
    if (!matched_.contains(name)) names.push_back(name);
  return names;
}

}  // namespace c3de::plugin_host
