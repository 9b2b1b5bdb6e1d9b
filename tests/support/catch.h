// SPDX-License-Identifier: Apache-2.0
// The only place that includes Catch2, so that version 3 can follow the packaged version 2.
#pragma once

#include <catch2/catch.hpp>

#include <filesystem>
#include <iostream>
#include <string>

using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

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
