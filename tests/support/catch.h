// SPDX-License-Identifier: Apache-2.0
// The only place that includes Catch2, so that version 3 can follow the packaged version 2.
#pragma once

#include <catch2/catch.hpp>

#include <cctype>
#include <filesystem>
#include <iostream>
#include <string>

using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// A folder of the present test case's own, so that cases may run beside each other.
inline std::filesystem::path testOutputFolder() {
  std::string name = Catch::getResultCapture().getCurrentTestName();
  for (char &c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  const std::filesystem::path folder = std::filesystem::path(C3DE_TEST_OUTPUT) / name.substr(0, 100);
  std::filesystem::create_directories(folder);
  return folder;
}

/// Ends the test case as skipped, visibly, with the reason.
#define C3DE_SKIP(reason)                                         \
  do {                                                            \
    std::cout << "[C3DE-SKIPPED] " << (reason) << std::endl;      \
    return;                                                       \
  } while (false)

/// A file of the data made by others; skips the case where the folder is absent.
#define C3DE_DATA_OR_SKIP(variable, relativePath)                                        \
  const std::filesystem::path variable = std::filesystem::path(C3DE_TEST_DATA) / (relativePath); \
  if (!std::filesystem::exists(variable)) C3DE_SKIP("test data not present: " + variable.string())
