// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "c3de/core/crash_journal.h"
#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;
using Place = CrashRecord::Place;

namespace {

std::filesystem::path emptyFolder(const std::string &name) {
  const auto folder = std::filesystem::temp_directory_path() / "c3de-crash-journal" / name;
  std::filesystem::remove_all(folder);
  return folder;
}

std::size_t filesIn(const std::filesystem::path &folder) {
  std::size_t n = 0;
  for ([[maybe_unused]] const auto &entry : std::filesystem::directory_iterator(folder)) ++n;
  return n;
}

}  // namespace

TEST_CASE("a run that dies leaves behind who was called", "[crash_journal]") {
  struct Case {
    const char *way;
    Place place;
    const char *owner, *what;
  };
  for (const Case &one :
       {Case{"program", Place::program, "", ""}, Case{"before", Place::before, "org.test", "step"},
        Case{"abort", Place::call, "org.test", "create"}, Case{"fault", Place::call, "org.test", "create"},
        Case{"overflow", Place::call, "org.test", "create"}, Case{"worker", Place::call, "org.worker", "step"},
        Case{"thread", Place::thread, "org.library", ""}}) {
    INFO(one.way);
#ifdef C3DE_HAS_SANITIZERS
    if (std::string(one.way) == "overflow" || std::string(one.way) == "worker") continue;  // the sanitizer ends it
#endif
    const auto folder = emptyFolder(one.way);
    const auto ended = runProcess({C3DE_DYING_PROGRAM, folder.string(), one.way, C3DE_DYING_LIBRARY}, 30.0);
    REQUIRE(ended);
#ifdef _WIN32
    CHECK(ended->exitCode != 0);
#else
    CHECK(ended->exitCode >= 128);  // it has ended as without a journal
#endif
    CHECK_FALSE(ended->timedOut);
    const auto records = CrashJournal::popCrashRecords(folder);
    REQUIRE(records.size() == 1);
    CHECK(records[0].place == one.place);
    CHECK(records[0].owner == one.owner);
    CHECK(records[0].what == one.what);
#ifdef _WIN32
    CHECK((records[0].how.starts_with("SIGABRT") || records[0].how.starts_with("0xC00000")));
#else
    CHECK(records[0].how.starts_with("SIG"));
#endif
    INFO(records[0].cause());
    INFO(ended->errorOutput);
    // Also on the error stream, for users who see the crash.
    CHECK(ended->errorOutput.find("c3de: fatal: " + records[0].how) != std::string::npos);
    CHECK(ended->errorOutput.find(one.owner) != std::string::npos);
    CHECK(records[0].cause().find(one.owner) != std::string::npos);
    CHECK(CrashJournal::popCrashRecords(folder).empty());  // reported once
    CHECK(filesIn(folder) == 0);
  }
}

TEST_CASE("a run that ends well, or is ended while all is well, leaves nothing", "[crash_journal]") {
  const auto folder = emptyFolder("well");
  REQUIRE(runProcess({C3DE_DYING_PROGRAM, folder.string(), "well"}, 30.0));
  CHECK(filesIn(folder) == 0);
  // The slow call had returned when the run was ended.
  const auto slow = runProcess({C3DE_DYING_PROGRAM, folder.string(), "slow"}, 30.0);
  REQUIRE(slow);
  CHECK(slow->exitCode != 0);
  CHECK(CrashJournal::popCrashRecords(folder).empty());
}

TEST_CASE("a run that is ended while a call does not return names it, and a living run is let be", "[crash_journal]") {
  const auto folder = emptyFolder("hang");
  const auto log = std::filesystem::temp_directory_path() / "c3de-crash-journal" / "hang.log";
  {
    auto child = ChildProcess::start({C3DE_DYING_PROGRAM, folder.string(), "hang"}, log);
    REQUIRE(child);
    const auto hasWritten = [&] {
      std::error_code error;
      for (const auto &entry : std::filesystem::directory_iterator(folder, error))
        if (entry.file_size() > 0) return true;
      return false;
    };
    for (int i = 0; i < 1000 && !hasWritten(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(hasWritten());
    CHECK(CrashJournal::popCrashRecords(folder).empty());
    child->kill();
  }
  const auto records = CrashJournal::popCrashRecords(folder);
  REQUIRE(records.size() == 1);
  CHECK(records[0].place == Place::hang);
  CHECK(records[0].cause() == "was ended from outside while plugin org.test (create) did not return for 3 s");
}

TEST_CASE("a journal that is damaged says nothing", "[crash_journal]") {
  const auto folder = emptyFolder("damaged");
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.run") << "who\nknows\n";
  std::ofstream(folder / "b.run") << std::string(100000, '\0');
  std::ofstream(folder / "c.txt") << "call\nx\ny\nz\n";
  CHECK(CrashJournal::popCrashRecords(folder).empty());
  CHECK(filesIn(folder) == 1);
  CHECK_FALSE(CrashJournal::begin(folder / "c.txt" / "below a file"));
}
