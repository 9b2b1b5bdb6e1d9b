// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>

#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;

TEST_CASE("a process gives back its output and exit code") {
  const auto result = runProcess({"cmake", "-E", "echo", "hello"}, 20.0);
  REQUIRE(result);
  CHECK(result->exitCode == 0);
  CHECK_THAT(result->output, Contains("hello"));
  const auto failing = runProcess({"cmake", "-E", "no_such_command"}, 20.0);
  REQUIRE(failing);
  CHECK(failing->exitCode != 0);
  CHECK_FALSE(failing->errorOutput.empty());
}

TEST_CASE("a process that does not end is ended") {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = runProcess({"cmake", "-E", "sleep", "30"}, 0.5);
  REQUIRE(result);
  CHECK(result->timedOut);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 10.0);
}

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
