// SPDX-License-Identifier: Apache-2.0
#include "trial.h"

#include <fmt/format.h>

#include <cstdio>

namespace c3de::validate {

const char *resultName(Result result) {
  switch (result) {
    case Result::pass: return "pass";
    case Result::skip: return "skip";
    case Result::warn: return "warn";
    case Result::fail: break;
  }
  return "fail";
}

std::vector<Check> allChecks() {
  std::vector<Check> all;
  for (const auto &part : {entryChecks(), lifecycleChecks(), callbackChecks(), classChecks()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

void recordAction(const std::string &what) {
  std::printf("\n%.*s%s\n", static_cast<int>(kActionMark.size()), kActionMark.data(), what.c_str());
  std::fflush(stdout);
}

LoadedPlugin::LoadedPlugin(const Trial &trial, TrialHost::Serves serves, const TrialHost::Change &change)
    : host(std::make_unique<TrialHost>(trial.folder / "settings", serves, change)) {
  for (const auto &companion : trial.companions)
    if (const std::string why = host->refusalOf(companion); !why.empty()) {
      refusal = "its companion " + companion.filename().string() + " is not loaded: " + why;
      return;
    }
  refusal = host->refusalOf(trial.plugin);
  id_ = host->host->plugins().back().id;
}

Verdict LoadedPlugin::complaints() const {
  const auto errors = host->linesFrom(LogLevel::error);
  if (!errors.empty())
    return fail(fmt::format("{} error{}, the first: {}", errors.size(), errors.size() == 1 ? "" : "s", errors[0]));
  const auto warnings = host->linesFrom(LogLevel::warn);
  if (!warnings.empty())
    return warn(
        fmt::format("{} warning{}, the first: {}", warnings.size(), warnings.size() == 1 ? "" : "s", warnings[0]));
  return pass();
}

}  // namespace c3de::validate
