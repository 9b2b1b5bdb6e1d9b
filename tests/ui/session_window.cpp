// SPDX-License-Identifier: Apache-2.0
#include "ui/session_window.h"

#include "c3de/core/platform.h"
#include "support/catch.h"
#include "ui/program_command.h"

namespace c3de::test {

namespace fs = std::filesystem;

fs::path freshFile(const std::string &name) {
  const fs::path file = outputFile(name);
  fs::remove(file);
  return file;
}

fs::path freshHome(const std::string &name) {
  fs::path home = outputFile(name);
  fs::remove_all(home);
  return home;
}

Json notification(const Json &state, const std::string &title) {
  for (const Json &one : state["notifications"])
    if (one["title"] == title) return one;
  return nullptr;
}

void waitForMessage(WorkstationDriver &window, const std::string &wanted) {
  C3DE_WAIT(window, wanted, s["notifications"].dump().find(wanted) != std::string::npos);
}

Json describe(const fs::path &session) {
  const auto described = runProcess(programCommand({"info", session.string(), "--json"}), 60.0);
  REQUIRE(described);
  INFO(described->errorOutput);
  REQUIRE(described->exitCode == 0);
  return Json::parse(described->output);
}

fs::path recoveryIn(const fs::path &home) {
  if (fs::exists(home))
    for (const auto &entry : fs::recursive_directory_iterator(home))
      if (entry.path().extension() == ".c3de") return entry.path();
  return {};
}

void checkReplays(const fs::path &recording) {
  for (const char *threads : {"1", "2", "7"}) {
    CAPTURE(threads);
    const auto replayed =
        runProcess(programCommand({"replay", recording.string(), "--check", "--threads", threads}), 300.0);
    REQUIRE(replayed);
    INFO(replayed->errorOutput);
    CHECK(replayed->exitCode == 0);
  }
}

}  // namespace c3de::test
