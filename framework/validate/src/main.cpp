// SPDX-License-Identifier: Apache-2.0
// c3de-validate: checks a plugin as its author, or a careful user, would; each check in a separate process.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "c3de/core/crash_journal.h"
#include "c3de/core/environment_faults.h"
#include "c3de/core/file_path.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/program_arguments.h"
#include "c3de/core/text.h"
#include "c3de/manual/manual.h"
#include "c3de/registry/settings_store.h"
#include "check.h"

namespace {

using namespace c3de;
using namespace c3de::validate;
using Json = nlohmann::ordered_json;

enum ExitCode { kGood = 0, kBad = 1, kUsage = 2 };

struct Options {
  std::vector<std::string> files, companions;
  std::string only, except, child, folder;
  std::uint64_t seed = 1;
  double timeout_s = 20.0;
  std::filesystem::path json, manual;
  std::string manualVersion, manualDate;
  bool list = false, inProcess = false, quiet = false;
};

struct Done {
  const Check *check;
  Verdict verdict;
  double seconds = 0.0;
};

Trial trialOf(const Options &options, const std::string &file, const std::filesystem::path &folder) {
  Trial trial{absolutePath(pathFromText(file)), {}, options.seed, folder};
  for (const std::string &companion : options.companions)
    trial.companions.push_back(absolutePath(pathFromText(companion)));
  return trial;
}

Verdict runHere(const Check &check, const Trial &trial) {
  try {
    return check.run(trial);
  } catch (const std::exception &error) {
    return fail(std::string("an exception came through: ") + error.what());
  } catch (...) {
    return fail("an exception came through that is not a std::exception");
  }
}

/// The last line left by a fatal error or an exit().
std::string lastErrorLine(const std::string &text) {
  std::string found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    for (const char *sign : {"c3de: fatal: ", "has ended the program", "AddressSanitizer", "runtime error"})
      if (line.find(sign) != std::string::npos) found = line;
    begin = end + 1;
  }
  return displayText(found.starts_with("c3de: ") ? found.substr(6) : found);
}

/// What the child was doing when it ended, " while it lives without tools"; empty if it has not reported it.
std::string whileDoing(const std::string &output) {
  const auto at = output.rfind(kActionMark);
  if (at == std::string::npos) return {};
  const auto begin = at + kActionMark.size();
  return " while it " + displayText(output.substr(begin, output.find('\n', begin) - begin));
}

Verdict runInChild(const Check &check, const std::string &file, const Options &options,
                   const std::filesystem::path &folder) {
  std::vector<std::string> arguments{
      pathText(executablePath()),  "--child", check.name, "--folder", pathText(folder), "--seed",
      std::to_string(options.seed)};
  for (const std::string &companion : options.companions) {
    arguments.emplace_back("--with");
    arguments.push_back(companion);
  }
  arguments.emplace_back("--");
  arguments.push_back(file);
  const auto ended = runProcess(arguments, options.timeout_s);
  if (!ended) return fail("no process could be started for it: " + ended.error().message);
  const std::string when = whileDoing(ended->output);
  if (ended->timedOut)
    return fail(fmt::format("had not come to an end after {} s (--timeout){}", options.timeout_s, when));
  if (const auto at = ended->output.rfind(kVerdictMark); at != std::string::npos) {
    const Json json = Json::parse(ended->output.substr(at + kVerdictMark.size()), nullptr, false);
    if (json.is_object() && ended->exitCode == 0)
      return {static_cast<Result>(json.value("result", static_cast<int>(Result::fail))), json.value("text", "")};
  }
  const std::string words = lastErrorLine(ended->errorOutput);
  return fail(words.empty() ? fmt::format("ended the process{}, with code {}", when, ended->exitCode)
                            : fmt::format("ended the process{}: {}", when, words));
}

/// A passed check of a plugin that changes the process environment becomes a failure.
Verdict withEnvironment(Verdict verdict) {
  // Changes made outside of a recorded call are detected by the next one.
  { const PluginCall last("c3de-validate", "the end of a check", CallKind::prompt); }
  const std::vector<std::string> faults = environmentFaults();
  return verdict.result == Result::fail || faults.empty() ? verdict : fail(faults.front());
}

int child(const Options &options) {
  if (options.files.size() != 1) return kUsage;
  registry::keepSettingsInMemory();
  { const PluginCall first("c3de-validate", "the beginning of a check", CallKind::prompt); }
  endWithParent();  // a plugin may never return
  for (const Check &check : allChecks()) {
    if (options.child != check.name) continue;
    const Verdict verdict =
        withEnvironment(runHere(check, trialOf(options, options.files.front(), pathFromText(options.folder))));
    const Json json{{"result", static_cast<int>(verdict.result)}, {"text", verdict.text}};
    const std::string line =
        "\n" + std::string(kVerdictMark) + json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    std::fwrite(line.data(), 1, line.size(), stdout);
    std::fflush(stdout);
    return kGood;
  }
  return kUsage;
}

std::filesystem::path ownFolder() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  return std::filesystem::temp_directory_path() / fmt::format("c3de-validate-{:x}", static_cast<std::uint64_t>(now));
}

std::vector<Done> checkPlugin(const std::string &file, const std::vector<Check> &checks, const Options &options) {
  std::vector<Done> all;
  const std::filesystem::path folder = ownFolder();
  bool isLibrary = true;
  for (const Check &check : checks) {
    const auto begin = std::chrono::steady_clock::now();
    Verdict verdict = skip("an earlier check has failed");
    if (isLibrary)
      verdict =
          options.inProcess ? runHere(check, trialOf(options, file, folder)) : runInChild(check, file, options, folder);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    // Without a library, or without a descriptor, no further check is possible.
    const std::string name = check.name;
    if (verdict.result == Result::fail && (name == "file" || name == "file.load" || name == "entry")) isLibrary = false;
    if (!options.quiet || verdict.result == Result::fail || verdict.result == Result::warn)
      std::printf("  %s  %-22s %s\n", resultName(verdict.result), check.name, verdict.text.c_str());
    std::fflush(stdout);
    all.push_back({&check, std::move(verdict), seconds});
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return all;
}

std::size_t countOf(const std::vector<Done> &all, Result result) {
  return static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const Done &one) { return one.verdict.result == result; }));
}

/// Empty if a pattern is invalid.
std::optional<std::vector<Check>> chosenChecks(const Options &options) {
  try {
    const std::regex only(options.only.empty() ? ".*" : options.only), except(options.except);
    std::vector<Check> chosen;
    for (const Check &check : allChecks())
      if (std::regex_search(check.name, only) && (options.except.empty() || !std::regex_search(check.name, except)))
        chosen.push_back(check);
    return chosen;
  } catch (const std::regex_error &error) {
    std::fprintf(stderr, "c3de-validate: error: --only or --except: %s\n", error.what());
    return {};
  }
}

int run(const Options &options) {
  const auto checks = chosenChecks(options);
  if (!checks) return kUsage;
  if (options.list) {
    for (const Check &check : *checks) std::printf("%-22s %s\n", check.name, check.summary);
    return kGood;
  }
  if (checks->empty() || options.files.empty()) {
    std::fprintf(stderr, "c3de-validate: error: %s; see c3de-validate --help\n",
                 checks->empty() ? "no check has a name that --only accepts" : "no plugin is named");
    return kUsage;
  }
  Json report{{"seed", options.seed}, {"plugins", Json::array()}};
  std::size_t failures = 0;
  for (const std::string &file : options.files) {
    std::printf("%s\n", file.c_str());
    const auto all = checkPlugin(file, *checks, options);
    const std::size_t failed = countOf(all, Result::fail), warned = countOf(all, Result::warn);
    failures += failed;
    std::printf("%s: %zu checks, %zu failed, %zu warning%s, %zu skipped; seed %llu\n", failed == 0 ? "good" : "BAD",
                all.size(), failed, warned, warned == 1 ? "" : "s", countOf(all, Result::skip),
                static_cast<unsigned long long>(options.seed));
    Json list = Json::array();
    for (const Done &one : all)
      list.push_back(Json{{"check", one.check->name},
                          {"result", resultName(one.verdict.result)},
                          {"text", one.verdict.text},
                          {"seconds", one.seconds}});
    report["plugins"].push_back(Json{{"file", file}, {"good", failed == 0}, {"checks", std::move(list)}});
  }
  if (!options.json.empty()) {
    const auto written =
        writeWholeFile(options.json, report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    if (!written) {
      std::fprintf(stderr, "c3de-validate: error: %s\n", written.error().message.c_str());
      return kUsage;
    }
  }
  return failures == 0 ? kGood : kBad;
}

int writeManual(const Options &options, const CLI::App &app) {
  const manual::PageFacts facts{"c3de-validate",
                                "c3de-validate",
                                options.manualVersion,
                                options.manualDate,
                                {{"EXIT STATUS", {{"0", "No check fails."}, {"1", "A check fails."}, {"2", "Usage."}}}},
                                {"c3de(1)", "c3de-new-plugin(1)"}};
  const auto written = writeWholeFile(options.manual, manual::manPage(app, facts));
  if (written) return kGood;
  std::fprintf(stderr, "c3de-validate: error: %s\n", written.error().message.c_str());
  return kBad;
}

}  // namespace

int main(int argc, char **argv) {
  installFatalErrorReport();
  Options options;
  CLI::App app(
      "Checks C3DE plugins: the file, its descriptor, its lifecycle, and what it registers, each check in its own "
      "process.\nExit code: 0 if no check fails, 1 if one fails, 2 for a usage error.",
      "c3de-validate");
  app.allow_windows_style_options(false);  // a path may begin with a slash
  app.set_help_flag("-h,--help", "Show this help");
  app.add_option("PLUGINS", options.files, "Files of plugins");
  app.add_option("--with", options.companions, "A plugin that they need, loaded before them (repeatable)")
      ->type_name("PLUGIN")
      ->allow_extra_args(false);
  app.add_flag("--list", options.list, "List the checks");
  app.add_option("--only", options.only, "Checks whose names match this regular expression")->type_name("REGEX");
  app.add_option("--except", options.except, "But not those")->type_name("REGEX");
  app.add_option("--seed", options.seed, "Of random values and events (1); the same one does the same again");
  app.add_option("--timeout", options.timeout_s, "Seconds that a check may take (20)")->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--in-process", options.inProcess, "For a debugger: all in this process");
  app.add_option_function<std::string>(
         "--json", [&](const std::string &name) { options.json = pathFromText(name); }, "Report as JSON")
      ->type_name("FILE");
  app.add_flag("-q,--quiet", options.quiet, "Only failures and warnings");
  app.add_option("--child", options.child)->group("");
  app.add_option("--folder", options.folder)->group("");
  // For installation scripts: writes the man page.
  app.add_option("--write-man", options.manual)->group("");
  app.add_option("--man-version", options.manualVersion)->group("");
  app.add_option("--man-date", options.manualDate)->group("");
  ProgramArguments arguments(argc, argv);
  try {
    app.parse(arguments.count(), arguments.values());
  } catch (const CLI::ParseError &error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    std::fprintf(stderr, "c3de-validate: error: %s; see c3de-validate --help\n", error.what());
    return kUsage;
  }
  if (!options.manual.empty()) return writeManual(options, app);
  return options.child.empty() ? run(options) : child(options);
}
