// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "c3de/core/path_text.h"
#include "c3de/core/per_thread.h"
#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;

namespace {

/// Of the system's own shell: nothing else is on every machine.
std::vector<std::string> shell([[maybe_unused]] const char *posix, [[maybe_unused]] const char *windows) {
#if defined(_WIN32)
  return {"cmd", "/c", windows};
#else
  return {"sh", "-c", posix};
#endif
}

}  // namespace

TEST_CASE("a process gives back its output and exit code") {
  const auto result = runProcess(shell("echo hello", "echo hello"), 20.0);
  REQUIRE(result);
  CHECK(result->exitCode == 0);
  CHECK_THAT(result->output, Contains("hello"));
  const auto failing = runProcess(shell("no_such_command", "no_such_command"), 20.0);
  REQUIRE(failing);
  CHECK(failing->exitCode != 0);
  CHECK_FALSE(failing->errorOutput.empty());
}

TEST_CASE("a process that does not end is ended") {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runProcess(shell("exec sleep 30", "ping -n 31 127.0.0.1"), 0.5);
  REQUIRE(result);
  CHECK(result->timedOut);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 10.0);
}

TEST_CASE("text of paths is UTF-8, that of a plain string as well") {
  for (const std::string name : {"organ", "Größe é.txt", "肝臓", "😀 bild", "\u07ff\u0800\uffff"}) {
    INFO(name);
    const std::filesystem::path path(name);
    CHECK(path == pathFromText(name));
    CHECK(pathText(path) == name);
  }
}

#if !defined(_WIN32)
TEST_CASE("of a program that writes without end, the end is kept") {
  const auto result = runProcess({"sh", "-c", "yes 0123456789 | head -c 50000000; echo the end"}, 60.0);
  REQUIRE(result);
  CHECK(result->exitCode == 0);
  CHECK(result->output.size() >= ProcessResult::kKept);
  CHECK(result->output.size() <= 2 * ProcessResult::kKept);
  CHECK_THAT(result->output, Catch::Matchers::EndsWith("the end\n"));
}

TEST_CASE("a program is waited for although SIGCHLD was ignored") {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runProcess({"sh", "-c", "exit 7"}, 5.0);
  std::signal(SIGCHLD, before);
  REQUIRE(result);
  CHECK(result->exitCode == 7);
  CHECK_FALSE(result->timedOut);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 4.0);
}
#endif

TEST_CASE("a program that does not exist is an error with its name") {
  const auto result = runProcess({"no-such-program-anywhere"}, 5.0);
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error().message, Contains("no-such-program-anywhere"));
}

TEST_CASE("a file that is no library is refused with the reason") {
  std::filesystem::create_directories(testOutputRoot());
  const auto path = std::filesystem::absolute(std::filesystem::path(testOutputRoot()) / "text.so");
  std::ofstream(path) << "only text";
  const auto library = DynamicLibrary::open(path);
  REQUIRE_FALSE(library);
  CHECK_FALSE(library.error().message.empty());
}

TEST_CASE("the program knows where it is") { CHECK(std::filesystem::exists(executablePath())); }

TEST_CASE("names that are not UTF-8 are paths of files that do not exist", "[platform]") {
  const std::filesystem::path path = pathFromText("voxels\xff\xfe.raw");
  CHECK(path.extension() == ".raw");
  CHECK(!path.has_parent_path());
  CHECK_FALSE(std::filesystem::exists(path));
  CHECK(pathFromText("a/b\xc3\xa4.raw").filename() == std::filesystem::path(u8"b\u00e4.raw"));
}

TEST_CASE("an object of a thread is made once in it and destroyed at its end", "[platform]") {
  static std::atomic<int> made{0}, destroyed{0};
  struct Counted {
    std::string text = std::string(100, 'x');
    Counted() { ++made; }
    ~Counted() { destroyed += text.size() == 100 ? 1 : 1000; }
  };
  for (int i = 0; i < 20; ++i) {
    std::thread thread([] {
      auto *const first = &perThread<Counted>();
      CHECK(first == &perThread<Counted>());
      CHECK(static_cast<void *>(first) != &perThread<Counted, struct Another>());
    });
    thread.join();
  }
  CHECK(made == 40);
  CHECK(destroyed == 40);
}
