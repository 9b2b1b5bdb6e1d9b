// SPDX-License-Identifier: Apache-2.0
// From create to destroy, in hosts that provide more and fewer services.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include "c3de/core/platform.h"
#include "check.h"
#include "negotiation.h"
#include "trial.h"

namespace c3de::validate {
namespace {

using Clock = std::chrono::steady_clock;

/// Of this process; 0 if unknown.
std::uint64_t residentBytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * 4096;
}

std::size_t threadsNow() {
  std::size_t n = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/self/task", error), end; !error && it != end; it.increment(error))
    ++n;
  return n;
}

/// Threads that end take a moment to disappear.
std::size_t settledThreadCount(std::size_t wanted) {
  for (int i = 0; i < 100 && threadsNow() > wanted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return threadsNow();
}

Verdict live(const Trial &trial, TrialHost::Serves serves, const TrialHost::Change &change = {}) {
  const LoadedPlugin loaded(trial, serves, change);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  for (int i = 0; i < 20; ++i) loaded.host->mainQueue.runFrame();
  loaded.host->host.reset();
  if (const std::string left = loaded.host->leftOver(); !left.empty()) return fail("leaves behind: " + left);
  return loaded.complaints();
}

Verdict once(const Trial &trial) { return live(trial, TrialHost::Serves::all); }

/// The host's message if the plugin's descriptor requires a service the host does not provide; empty if it does not.
std::string requirementBeyond(const Trial &trial, TrialHost::Serves serves) {
  const auto library = DynamicLibrary::open(trial.plugin);
  if (!library) return {};
  const TrialHost host(trial.folder / "settings", serves);
  const auto negotiated = plugin_host::negotiate(*library, host.services);
  return negotiated ? std::string() : negotiated.error().message;
}

Verdict headless(const Trial &trial) {
  // A descriptor may state that a window is required.
  if (const std::string why = requirementBeyond(trial, TrialHost::Serves::headless);
      !why.empty() && requirementBeyond(trial, TrialHost::Serves::all).empty())
    return pass("refuses itself: " + why);
  return live(trial, TrialHost::Serves::headless);
}

Verdict least(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::least);
  // A plugin may report that it needs more services; its message must name them.
  if (!loaded.refusal.empty()) return pass("refuses itself: " + loaded.refusal);
  loaded.host->host.reset();
  return loaded.complaints();
}

template <auto Member>
void withhold(plugin_host::Services &services) {
  services.*Member = nullptr;
}

struct Withheld {
  const char *what;
  void (*change)(plugin_host::Services &services);
};
using plugin_host::Services;
constexpr std::array kWithheld{
    Withheld{"images", &withhold<&Services::images>},     Withheld{"simulations", &withhold<&Services::simulations>},
    Withheld{"forces", &withhold<&Services::forces>},     Withheld{"files", &withhold<&Services::meshFormats>},
    Withheld{"settings", &withhold<&Services::settings>}, Withheld{"render", &withhold<&Services::renderer>},
    Withheld{"panels", &withhold<&Services::panels>},     Withheld{"params", &withhold<&Services::parameters>},
    Withheld{"tools", &withhold<&Services::tools>},       Withheld{"history", &withhold<&Services::edits>},
    Withheld{"commands", &withhold<&Services::commands>}};

Verdict without(const Trial &trial) {
  const auto library = DynamicLibrary::open(trial.plugin);
  if (!library) return fail(library.error().message);
  std::string required;
  Verdict worst = pass();
  for (const Withheld &one : kWithheld) {
    {
      const TrialHost host(trial.folder / "settings", TrialHost::Serves::all, one.change);
      if (!plugin_host::negotiate(*library, host.services)) {
        required += (required.empty() ? "" : ", ") + std::string(one.what);
        continue;
      }
    }
    recordAction(std::string("lives without ") + one.what);
    Verdict verdict = live(trial, TrialHost::Serves::all, one.change);
    if (verdict.result == Result::fail)
      return fail(fmt::format("without {}, which it does not require: {}", one.what, verdict.text));
    if (verdict.result == Result::warn) worst = warn(fmt::format("without {}: {}", one.what, verdict.text));
  }
  if (worst.result != Result::pass || required.empty()) return worst;
  return pass("requires " + required);
}

Verdict repeated(const Trial &trial) {
  constexpr int kMost = 1000, kWarmUp = 50;
  constexpr std::uint64_t kMaxGrowth = 2048;  // bytes per cycle: several times what the host itself leaves
  const auto begin = Clock::now();
  std::uint64_t before = 0;
  int cycles = 0;
  for (; cycles < kMost && Clock::now() - begin < std::chrono::seconds(6); ++cycles) {
    if (cycles == kWarmUp) before = residentBytes();
    const LoadedPlugin loaded(trial, TrialHost::Serves::all);
    if (!loaded.refusal.empty()) return fail(fmt::format("is refused in cycle {}: {}", cycles + 1, loaded.refusal));
  }
  if (residentBytes() == 0) return pass(fmt::format("{} cycles; memory is not known on this system", cycles));
  const int counted = cycles - kWarmUp;
  if (counted < kWarmUp) return warn(fmt::format("only {} cycles in 6 s; memory was not checked", cycles));
  const std::uint64_t after = residentBytes();
  const std::uint64_t each = after > before ? (after - before) / static_cast<std::uint64_t>(counted) : 0;
  if (each > kMaxGrowth)
    return fail(
        fmt::format("{} bytes are not given back in each of {} cycles of create, start, stop and destroy; at "
                    "most {} are taken for noise",
                    each, counted, kMaxGrowth));
  return pass(fmt::format("{} cycles, {} bytes each", cycles, each));
}

Verdict threads(const Trial &trial) {
  if (threadsNow() == 0) return skip("threads cannot be counted on this system");
  const std::size_t before = threadsNow();
  {
    const LoadedPlugin loaded(trial, TrialHost::Serves::all);
    if (!loaded.refusal.empty()) return fail(loaded.refusal);
    for (int i = 0; i < 5; ++i) loaded.host->mainQueue.runFrame();
  }
  const std::size_t after = settledThreadCount(before);
  if (after > before) return fail(fmt::format("{} of its threads still run after stop and destroy", after - before));
  return pass();
}

constexpr std::array kChecks{
    Check{"lifecycle", "create, start, some frames, stop, destroy; nothing is left behind or complained of", &once},
    Check{"lifecycle.headless", "The same without a window", &headless},
    Check{"lifecycle.least", "A host with few services is refused with a reason, or enough", &least},
    Check{"lifecycle.without", "Without each service in turn: what it does not require, it can do without", &without},
    Check{"lifecycle.repeated", "1000 times in one process, or for 6 s: memory is given back", &repeated},
    Check{"lifecycle.threads", "No thread of its own is left after stop", &threads}};

}  // namespace

std::span<const Check> lifecycleChecks() { return kChecks; }

}  // namespace c3de::validate
