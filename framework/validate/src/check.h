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
  skip,  ///< there is nothing to check, or no way to
  warn,  ///< works, but is worth a look
  fail
};
[[nodiscard]] const char *resultName(Result result);

struct Verdict {
  Result result = Result::pass;
  std::string text;  ///< what was expected and what happened; of a pass what was done, if worth saying
};
[[nodiscard]] inline Verdict pass(std::string text = {}) { return {Result::pass, std::move(text)}; }
[[nodiscard]] inline Verdict skip(std::string text) { return {Result::skip, std::move(text)}; }
[[nodiscard]] inline Verdict warn(std::string text) { return {Result::warn, std::move(text)}; }
[[nodiscard]] inline Verdict fail(std::string text) { return {Result::fail, std::move(text)}; }

/// What a check is given.
struct Trial {
  std::filesystem::path plugin;                   ///< absolute
  std::vector<std::filesystem::path> companions;  ///< plugins that it needs, loaded before it
  std::uint64_t seed = 0;
  std::filesystem::path folder;  ///< to write in; removed afterwards
};

/// Before what a child tells its parent; what a plugin prints does not count.
inline constexpr std::string_view kVerdictMark = "c3de-validate verdict: ", kDoingMark = "c3de-validate doing: ";

/// Something that a good plugin does, or a bad one does not survive; runs in a process of its own, once.
struct Check {
  const char *name;     ///< "lifecycle.repeated"
  const char *summary;  ///< one line, for --list
  Verdict (*run)(const Trial &trial);
};

/// All, the first ones first: what they say makes what follows clear.
[[nodiscard]] std::vector<Check> allChecks();

// By what they look at; each file of checks has one.
[[nodiscard]] std::span<const Check> entryChecks();
[[nodiscard]] std::span<const Check> lifecycleChecks();
[[nodiscard]] std::span<const Check> callbackChecks();
[[nodiscard]] std::span<const Check> classChecks();

/// Notes what a check is about to do, for when it does not come back from that: the verdict then says it.
void nowDoing(const std::string &what);

/// Random choices that a seed makes the same on every machine (the distributions of the standard library are not).
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
