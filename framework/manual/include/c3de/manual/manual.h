// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

/// Man pages and shell completion from the declarations of a command line. What --help hides is left out. Any thread.
namespace c3de::manual {

/// A section of a man page after its options: a list of terms, each with a text.
struct Section {
  std::string title;  ///< "ENVIRONMENT"
  std::vector<std::pair<std::string, std::string>> entries;
};

struct PageFacts {
  std::string name;     ///< of the page: "c3de-run"
  std::string call;     ///< how the command is typed: "c3de run"
  std::string version;  ///< of the product: "0.1.0"
  std::string date;     ///< "2026-01-31"; it may be empty
  std::vector<Section> sections;
  std::vector<std::string> seeAlso;  ///< "c3de(1)"
};

/// The source of a man page of section 1: purpose, usage, arguments, options by group, commands, examples (the footer),
/// and the sections given.
[[nodiscard]] std::string manPage(const CLI::App &app, const PageFacts &facts);

/// A script for bash that completes commands, options and their values. It needs bash 4 and no other script.
[[nodiscard]] std::string bashCompletion(const CLI::App &root);
/// The same as a function for zsh, in a file to be called _NAME in a folder of fpath.
[[nodiscard]] std::string zshCompletion(const CLI::App &root);

}  // namespace c3de::manual
