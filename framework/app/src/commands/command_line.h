// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/session.h"
#include "commands/option_values.h"
#include "workstation/workstation.h"

namespace c3de::app {

class StudyRanks;

/// The command line as passed, and the options shared by several commands. These may also precede the command.
struct CommandLine {
  int argc;
  char **argv;
  int (*openWindow)(const WorkstationOptions &options);  ///< null: continues in the window program if a window is
                                                         ///< requested
  StudyRanks *ranks = nullptr;  ///< null: continues in the MPI program if mpirun has started several processes

  std::vector<std::string> files{}, plugins{}, pluginPaths{};
  std::vector<std::string> pluginParameters{};  ///< "PLUGIN:ID=VALUE" each
  std::vector<std::string> withoutPlugins{};    ///< ids or files
  bool safeMode = false, trustPlugins = false;
  bool noPlugins = false, json = false, version = false, verbose = false, quiet = false;
  std::optional<unsigned> threads{};
  std::optional<PictureSize> size{};
  std::string unit{};  ///< of meshes

  [[nodiscard]] SessionOptions sessionOptions() const;
};

/// An option whose text is converted to a value by a function.
template <class Value, class Parse>
CLI::Option *addParsed(CLI::App &app, const std::string &name, Value &value, const std::string &help, Parse parse) {
  return app.add_option_function<std::string>(
      name,
      [name, &value, parse](const std::string &text) {
        const auto parsed = parse(text);
        if (!parsed) throw CLI::ValidationError(name, parsed.error().message);
        value = *parsed;
      },
      help);
}

/// @param value  a double, or an optional one
template <class Value>
CLI::Option *addSeconds(CLI::App &app, const std::string &name, Value &value, double least, const std::string &help) {
  return addParsed(app, name, value, help,
                   [least](const std::string &text) { return parseDecimal(text, least, 1e9, "s"); })
      ->type_name("SECONDS");
}

/// @param value  an unsigned number that can hold `most`, or an optional one
template <class Value>
CLI::Option *addCount(CLI::App &app, const std::string &name, Value &value, long long least, long long most,
                      const std::string &help) {
  return addParsed(
             app, name, value, help,
             [least, most](const std::string &text) {
               return parseWhole(text, least, most).map([](long long n) { return static_cast<std::uint64_t>(n); });
             })
      ->type_name("N");
}

/// @param type  "FILE.json"
CLI::Option *addFile(CLI::App &app, const std::string &name, std::filesystem::path &file, const std::string &type,
                     const std::string &help);
/// Folders with files of a session that have moved.
CLI::Option *addSearch(CLI::App &app, std::vector<std::filesystem::path> &folders);
/// Same for several files: the option is repeatable.
CLI::Option *addFiles(CLI::App &app, const std::string &name, std::vector<std::filesystem::path> &files,
                      const std::string &type, const std::string &help);
CLI::Option *addSize(CLI::App &app, CommandLine &line, const std::string &help);
CLI::Option *addUnit(CLI::App &app, CommandLine &line);
/// Plugins, threads, -q and -v.
void addSessionOptions(CLI::App &app, CommandLine &line);
/// Makes --help, man pages and completion list the accepted values; the caller checks them.
[[nodiscard]] CLI::Validator listOfChoices(const std::string &choices);

}  // namespace c3de::app
