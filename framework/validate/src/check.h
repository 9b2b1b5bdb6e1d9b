// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace c3de::validate {

enum class Result {
  pass,
  skip,  ///< there is nothing to check, or no means to check it
  warn,  ///< works, but should be examined
  fail
};
[[nodiscard]] const char *resultName(Result result);

struct Verdict {
  Result result = Result::pass;
  std::string text;  ///< expected and actual behaviour; for a pass what was done, if worth stating
};
[[nodiscard]] inline Verdict pass(std::string text = {}) { return {Result::pass, std::move(text)}; }
[[nodiscard]] inline Verdict skip(std::string text) { return {Result::skip, std::move(text)}; }
[[nodiscard]] inline Verdict warn(std::string text) { return {Result::warn, std::move(text)}; }
[[nodiscard]] inline Verdict fail(std::string text) { return {Result::fail, std::move(text)}; }

/// Input of a check.
struct Trial {
  std::filesystem::path plugin;                   ///< absolute
  std::vector<std::filesystem::path> companions;  ///< plugins that it requires, loaded before it
  std::uint64_t seed = 0;
  std::filesystem::path folder;  ///< for writing; removed afterwards
};

/// Prefixes of messages from a child to its parent; other output of a plugin is ignored.
inline constexpr std::string_view kVerdictMark = "c3de-validate verdict: ", kActionMark = "c3de-validate doing: ";

/// A requirement on a plugin, which a faulty plugin may not survive; runs once in a separate process.
struct Check {
  const char *name;     ///< "lifecycle.repeated"
  const char *summary;  ///< one line, for --list
  Verdict (*run)(const Trial &trial);
};

/// All checks. The first ones come first, because their results explain later ones.
[[nodiscard]] std::vector<Check> allChecks();

// By subject; each file of checks has one.
[[nodiscard]] std::span<const Check> entryChecks();
[[nodiscard]] std::span<const Check> lifecycleChecks();
[[nodiscard]] std::span<const Check> callbackChecks();
[[nodiscard]] std::span<const Check> classChecks();

/// Records what a check is about to do; if the check does not return, the verdict states it.
void recordAction(const std::string &what);

/// Random choices that are the same on every machine for a given seed (the distributions of the standard library are
/// not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// 0 … n - 1; n > 0
  [[nodiscard]] std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  /// 0 … 1
  [[nodiscard]] double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  template <class Range>
  [[nodiscard]] const auto &of(const Range &range) {
    return range[below(std::size(range))];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace c3de::validate
