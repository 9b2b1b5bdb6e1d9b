// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace bench {

/// The options of every benchmark.
struct Options {
  unsigned threads = 1;
  double seconds = 0.5;   ///< per measurement
  std::string json, csv;  ///< files to write; empty: none
};

/// Options of the form --name VALUE: those of Options, and those that a benchmark adds.
///
///     CommandLine line("bench_error");
///     line.add("--only", "TEXT", [&](const std::string &value) { only = value; });
///     if (const auto exit = line.parse(argc, argv)) return *exit;
class CommandLine {
 public:
  explicit CommandLine(std::string name);

  void add(std::string option, std::string value, std::function<void(const std::string &)> take);
  /// Exit code where the benchmark is not to run: 0 for --help, 2 with the usage on stderr for unknown arguments.
  [[nodiscard]] std::optional<int> parse(int argc, char **argv);

  [[nodiscard]] const std::string &name() const { return name_; }
  [[nodiscard]] const Options &options() const { return options_; }
  Options defaults;  ///< change before parse()

 private:
  struct Option {
    std::string option, value;
    std::function<void(const std::string &)> take;
  };
  std::string name_;
  std::vector<Option> added_;
  Options options_;
};

}  // namespace bench
