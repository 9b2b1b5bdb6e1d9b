// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace bench {

class Report;

/// The options of every benchmark, and the given ones of the requested question.
class Options {
 public:
  unsigned threads = 1;
  double seconds = 0.5;   ///< per measurement
  std::string json, csv;  ///< files to write; empty: none

  void add(std::string option, std::string value) { given_.emplace_back(std::move(option), std::move(value)); }
  [[nodiscard]] bool has(const std::string &option) const { return !texts(option).empty(); }
  /// All values of an option, in their order.
  [[nodiscard]] std::vector<std::string> texts(const std::string &option) const;
  [[nodiscard]] std::string text(const std::string &option, const std::string &otherwise = {}) const;
  [[nodiscard]] double number(const std::string &option, double otherwise) const;
  [[nodiscard]] std::size_t count(const std::string &option, std::size_t otherwise) const;

 private:
  std::vector<std::pair<std::string, std::string>> given_;
};

/// What a benchmark can measure. An exception ends it: std::invalid_argument for options, others for failures.
struct Question {
  std::string name;
  std::string options;  ///< beside those of every benchmark: "[--only TEXT] [--quick]"
  std::function<void(const Options &, Report &)> measure;
};

/// Measures the question that the first argument names, or all of them without one, and writes the requested files.
///
///     bench_steps newton --case swing --json FILE
///
/// @return exit code: 0, 1 for a failed measurement, 2 for unknown arguments, 7 for a file that cannot be written; all
///         but 0 with a line on stderr
[[nodiscard]] int run(const std::string &name, const std::vector<Question> &questions, int argc, char **argv);

/// The value of a result, or an exception with its reason.
template <class Result>
typename Result::value_type valueOf(Result result) {
  if (!result) {
    if constexpr (requires { result.error().message; })
      throw std::runtime_error(result.error().message);
    else if constexpr (requires { result.error().text; })
      throw std::runtime_error(result.error().text);
    else
      throw std::runtime_error(result.error());
  }
  if constexpr (!std::is_void_v<typename Result::value_type>) return std::move(*result);
}

}  // namespace bench
