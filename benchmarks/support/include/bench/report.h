// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/command_line.h"

namespace bench {

struct Column {
  std::string key;    ///< in JSON and CSV, with its unit: "forces_ms"
  std::string title;  ///< in the printed table; empty: not printed
  int digits = 3;     ///< decimals, of numbers that are not integers
};

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
  void table(std::string name, std::vector<Column> columns);
  /// One cell per column; null is printed as "-".
  void row(std::vector<Cell> cells);
  /// A line below the tables.
  void note(const std::string &text);
  /// A figure outside of the rows, in the JSON's "facts".
  void fact(const std::string &key, Cell value);

  /// Writes the requested files.
  /// @return exit code: 0, or 7 with a line on stderr
  [[nodiscard]] int write() const;

 private:
  std::string name_;
  Options options_;
  nlohmann::ordered_json json_;
  std::string csv_;
  std::string tableName_;
  std::vector<Column> columns_;
  std::vector<int> widths_;
};

}  // namespace bench
