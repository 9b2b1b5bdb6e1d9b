// SPDX-License-Identifier: Apache-2.0
// Crashes in the requested way. Arguments: folder of the journal, way, plugin to load (for "thread").
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "c3de/core/crash_journal.h"

namespace {

using namespace c3de;

// Each level writes to its part of the stack, so that the compiler cannot remove any.
int overflow(volatile char *above) {
  if (above != nullptr && *above != '\0') return 0;  // never
  volatile char level[4096];
  level[0] = above != nullptr ? *above : '\0';
  return overflow(level) + level[0];
}

int die(const std::string &way) {
  if (way == "well") return 0;
  if (way == "program") std::abort();
  if (way == "before") {
    { const PluginCall call("org.test", "step", CallKind::step); }
    std::abort();
  }
  const PluginCall call("org.test", "create", CallKind::prompt);
  if (way == "abort") std::abort();
  if (way == "fault") {
    volatile int *nowhere = nullptr;
    *nowhere = 1;
  }
  if (way == "overflow") return overflow(nullptr);
  if (way == "worker") {
    std::thread([] {
      const PluginCall step("org.worker", "step", CallKind::step);
      (void)overflow(nullptr);
    }).join();
  }
  if (way == "hang" || way == "slow") {
    LongCall told{"org.test", "create", CallKind::prompt, 0, 3.0};
    noteHang(told);
    if (way == "hang") std::this_thread::sleep_for(std::chrono::seconds(60));
    told.isOver = true;
    noteHang(told);
    (void)std::raise(SIGTERM);
  }
  return 3;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc < 3) return 2;
  auto journal = CrashJournal::begin(argv[1]);
  if (!journal) return 2;
  const std::string way = argv[2];
  if (way == "thread") {
    const auto library = DynamicLibrary::open(std::filesystem::absolute(argv[3]));
    if (!library) return 2;
    notePluginCode("org.library", library->codeRange());
    reinterpret_cast<void (*)()>(library->symbol("begin_thread"))();
    std::this_thread::sleep_for(std::chrono::seconds(60));
  }
  return die(way);
}
