// SPDX-License-Identifier: Apache-2.0
// The table that the validation suite prints: the reference value, the computed value, and the limit.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace validation {

struct Row {
  double truth = 0.0, uncertainty = 0.0;
  double ours = 0.0;
  std::optional<double> limit{};  ///< of |error|; empty: for the record
  double milliseconds = 0.0;      ///< wall time of building and solving
  double scale = 0.0;             ///< error = (ours - truth) / scale; 0: ours / truth - 1

  [[nodiscard]] double error() const;
};

/// Adds a line to the table and checks the limit. Where known_misses.h contains the row, a missed limit is printed as
/// MISSED with its reason, and the test continues.
/// @param body      the computed problem and its sampling
/// @param quantity  with its unit
void judge(const std::string &body, const std::string &quantity, const Row &row);

/// A line of plain words: why a value could not be computed.
void remark(const std::string &body, const std::string &words);

/// A row without a value: the engine refused or found no solution. A failure unless it is a known miss.
/// @param asked  false: for the record
void noSolution(const std::string &body, const std::string &why, bool asked = true);

class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace validation
