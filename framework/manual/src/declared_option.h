// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace c3de::manual {

/// What the value of an option or argument is, for completion.
enum class ValueKind { none, text, choice, file, folder };

struct DeclaredOption {
  std::vector<std::string> names;  ///< "-q", "--quiet"; of an argument its name alone
  std::string type;                ///< "FILE.json"; empty: a flag
  std::string fallback;            ///< default value; it may be empty
  std::string text;                ///< one line
  std::string group;
  std::vector<std::string> choices;  ///< of ValueKind::choice
  std::string extension;             ///< of ValueKind::file, without the dot; empty: any
  ValueKind kind = ValueKind::none;
  bool isRequired = false, isRepeatable = false;
};

/// Options that --help shows, in its order.
[[nodiscard]] std::vector<DeclaredOption> optionsOf(const CLI::App &app);
/// Arguments without a name of an option.
[[nodiscard]] std::vector<DeclaredOption> argumentsOf(const CLI::App &app);
/// Commands that --help shows, in its order.
[[nodiscard]] std::vector<const CLI::App *> commandsOf(const CLI::App &app);

}  // namespace c3de::manual
