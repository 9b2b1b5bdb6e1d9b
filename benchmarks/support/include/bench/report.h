// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/command_line.h"

namespace bench {

/// Of this build, with its version.
[[nodiscard]] std::string compilerName();

/// The results of a benchmark: tables on the screen as they grow, and one JSON format for all benchmarks:
///
///     { "benchmark": …, "machine": {cpu, cores}, "build": {version, compiler, type, sanitizers, assertions},
///       "threads": …, "seconds": …, "facts": { … }, "rows": [ {"table": …, column: value, …}, … ] }
class Report {
 public:
  using Cell = nlohmann::ordered_json;

  /// Prints machine and build.
  Report(std::string benchmark, const Options &options);

  /// Begins a table; rows follow.
  /// @param columns  "key=title:decimals; …": the key is that of JSON and CSV, with its unit ("forces_ms"). Without a
  ///                 title the key is printed, with an empty one nothing. Three decimals by default.
  void table(std::string name, const std::string &columns);
  /// One cell per column; null and what is not finite are printed as "-".
  void row(std::vector<Cell> cells);
  /// A line below the tables.
  void note(const std::string &text);
  /// A figure outside of the rows, in the JSON's "facts".
  void fact(const std::string &key, Cell value);

  /// Writes the requested files.
  /// @return exit code: 0, or 7 with a line on stderr
  [[nodiscard]] int write() const;

 private:
  struct Column {
    std::string key, title;
    int digits = 3, width = 0;
  };
  std::string name_;
  Options options_;
  nlohmann::ordered_json json_;
  std::string csv_;
  std::string tableName_;
  std::vector<Column> columns_;
  bool isFirstRow_ = false;
};

}  // namespace bench
