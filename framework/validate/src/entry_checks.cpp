// SPDX-License-Identifier: Apache-2.0
// The file, its entry function, and what it states about itself.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstring>
#include <sstream>

#include "c3de/abi/entry.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "check.h"
#include "library_file.h"
#include "negotiation.h"
#include "trial_host.h"

namespace c3de::validate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char *kHostName = "c3de-validate";

Verdict file(const Trial &trial) {
  if (const auto checked = plugin_host::checkLibraryFile(trial.plugin); !checked) return fail(checked.error().message);
  return pass();
}

Verdict load(const Trial &trial) {
  const auto library = DynamicLibrary::open(trial.plugin);
  if (!library) return fail("the dynamic loader refuses it: " + library.error().message);
  return pass();
}

std::vector<std::string> symbolsOf(std::vector<std::string> arguments, const std::string &path) {
  arguments.insert(arguments.begin(), "nm");
  arguments.push_back(path);
  const auto listed = runProcess(arguments, 20.0);
  std::vector<std::string> lines;
  if (!listed || listed->exitCode != 0) return lines;
  std::istringstream text(listed->output);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

Verdict exports(const Trial &trial) {
  const auto nm = runProcess({"nm", "--version"}, 20.0);
  if (!nm || nm->exitCode != 0) return skip("the program nm is not installed");
  std::string others;
  bool hasEntry = false;
  for (const std::string &line : symbolsOf({"-D", "--defined-only"}, trial.plugin.string())) {
    const std::string name = line.substr(line.rfind(' ') + 1);
    if (name == C3DE_PLUGIN_QUERY_SYMBOL)
      hasEntry = true;
    else
      others += (others.empty() ? "" : ", ") + name;
  }
  if (!hasEntry) return fail("exports no function " C3DE_PLUGIN_QUERY_SYMBOL);
  if (!others.empty())
    return fail("exports more than " C3DE_PLUGIN_QUERY_SYMBOL ", which may clash with other plugins: " + others);
  for (const std::string &line : symbolsOf({}, trial.plugin.string()))
    if (line.find(" u ") != std::string::npos)
      return warn("has a unique symbol, which is shared with other plugins of the same compiler (-fno-gnu-unique): " +
                  line.substr(line.rfind(' ') + 1));
  return pass();
}

/// The entry function, or why there is none.
struct Entry {
  explicit Entry(const Trial &trial) {
    const auto library = DynamicLibrary::open(trial.plugin);
    if (!library) {
      problem = library.error().message;
      return;
    }
    query = reinterpret_cast<c3de_plugin_query_fn>(library->symbol(C3DE_PLUGIN_QUERY_SYMBOL));
    if (query == nullptr) problem = "no function " C3DE_PLUGIN_QUERY_SYMBOL;
  }
  c3de_plugin_query_fn query = nullptr;
  std::string problem;
};

c3de_offer offerOf(std::uint32_t least, std::uint32_t most, std::uint64_t flags = 0) {
  return {sizeof(c3de_offer), least, most, C3DE_ABI_MINOR, {kHostName, std::strlen(kHostName)}, {"1.0.0", 5}, flags};
}

Verdict query(const Trial &trial) {
  const Entry entry(trial);
  if (entry.query == nullptr) return fail(entry.problem);
  const c3de_plugin *first = nullptr;
  constexpr int kMaxTimes = 200;
  const auto begin = Clock::now();
  int times = 0;
  for (; times < kMaxTimes && Clock::now() - begin < std::chrono::seconds(1); ++times) {
    const c3de_offer offer = offerOf(C3DE_ABI_MAJOR, C3DE_ABI_MAJOR, times % 2 ? C3DE_OFFER_PROBE : 0u);
    c3de_answer answer{};
    answer.size = sizeof answer;
    const c3de_status status = entry.query(&offer, &answer);
    if (status < 0) return fail(fmt::format("answers {}: {}", status, displayText(answer.why_not)));
    if (answer.plugin == nullptr) return fail("answers that all is well, and gives no descriptor");
    if (times == 0) first = answer.plugin;
    if (answer.plugin != first) return fail("gives another descriptor each time; it must be the same static one");
  }
  const double each_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count() / times;
  if (each_ms > 10.0) return fail(fmt::format("takes {:.1f} ms; at most 10 ms are allowed", each_ms));
  return pass(fmt::format("{:.3f} ms", each_ms));
}

Verdict otherVersions(const Trial &trial) {
  const Entry entry(trial);
  if (entry.query == nullptr) return fail(entry.problem);
  bool isMute = false;
  for (const auto &[least, most] : {std::pair{0u, 0u}, std::pair{C3DE_ABI_MAJOR + 1u, C3DE_ABI_MAJOR + 9u}}) {
    if (least <= C3DE_ABI_MAJOR && most >= C3DE_ABI_MAJOR) continue;  // no such version
    const c3de_offer offer = offerOf(least, most);
    c3de_answer answer{};
    answer.size = sizeof answer;
    const c3de_status status = entry.query(&offer, &answer);
    if (status >= 0)
      return fail(
          fmt::format("answers OK to a host that offers ABI {} to {} only, but was built for {}; it must refuse", least,
                      most, C3DE_ABI_MAJOR));
    isMute = isMute || answer.why_not[0] == '\0';
  }
  return isMute ? warn("refuses hosts of another ABI without a reason in why_not") : pass();
}

Verdict olderHost(const Trial &trial) {
  const Entry entry(trial);
  if (entry.query == nullptr) return fail(entry.problem);
  // An answer of the first revision, followed by bytes that do not belong to the plugin.
  constexpr std::size_t kShort = offsetof(c3de_answer, why_not) + sizeof c3de_answer::why_not;
  constexpr unsigned char kUntouched = 0xa5;
  alignas(c3de_answer) std::array<unsigned char, kShort + 4096> memory{};
  memory.fill(kUntouched);
  auto *answer = reinterpret_cast<c3de_answer *>(memory.data());
  std::memset(memory.data(), 0, kShort);
  answer->size = static_cast<std::uint32_t>(kShort);
  for (const std::uint32_t most : {C3DE_ABI_MAJOR, C3DE_ABI_MAJOR + 9u}) {
    const c3de_offer offer = offerOf(most, most);
    (void)entry.query(&offer, answer);
    for (std::size_t i = kShort; i < memory.size(); ++i)
      if (memory[i] != kUntouched)
        return fail(fmt::format("writes to byte {} of an answer of {} bytes; it must look at size", i, kShort));
  }
  return pass();
}

Verdict descriptor(const Trial &trial) {
  const auto library = DynamicLibrary::open(trial.plugin);
  if (!library) return fail(library.error().message);
  TrialHost host(trial.folder / "settings");
  const auto candidate = plugin_host::negotiate(*library, host.services);
  if (!candidate) return fail(candidate.error().message);
  std::string missing;
  const auto want = [&](const char *what, const std::string &text) {
    if (text.empty()) missing += (missing.empty() ? "" : ", ") + std::string(what);
  };
  want("display_name", candidate->displayName);
  want("vendor", candidate->vendor);
  want("license", candidate->license);
  if (!missing.empty()) return warn("people will look for what is empty: " + missing);
  return pass(candidate->id + " " + candidate->version);
}

constexpr std::array kChecks{
    Check{"file", "It is a whole library for this machine", &file},
    Check{"file.load", "The dynamic loader takes it: no library and no symbol is missing", &load},
    Check{"file.exports", "It exports one function, and nothing that is shared with other plugins", &exports},
    Check{"entry", "c3de_plugin_query answers the same each time, within 10 ms", &query},
    Check{"entry.other-abi", "It refuses hosts of an older and a newer ABI, with a reason", &otherVersions},
    Check{"entry.older-host", "It writes nothing behind the answer of a host of the first revision", &olderHost},
    Check{"descriptor", "Ids, versions, texts and needs are sound, and the host has what is needed", &descriptor}};

}  // namespace

std::span<const Check> entryChecks() { return kChecks; }

}  // namespace c3de::validate
