// SPDX-License-Identifier: Apache-2.0
// The only file that includes Catch2: version 2 as Debian packages it, version 3 as vcpkg does. Guarded by a macro: it
// is part of precompiled headers, which a compiler cache may reuse after a change of white space. "#pragma once"
// compares contents and would then not recognise the header.
#ifndef C3DE_TESTS_SUPPORT_CATCH_H
#define C3DE_TESTS_SUPPORT_CATCH_H

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <cctype>
#include <filesystem>
#include <iostream>
#include <string>

#include "support/folders.h"

#if __has_include(<catch2/catch_all.hpp>)
inline auto Contains(const std::string &text) { return Catch::Matchers::ContainsSubstring(text); }
#else
using Catch::Matchers::Contains;
#endif
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// The present test case's own folder, so that cases may run concurrently.
inline std::filesystem::path testOutputFolder() {
  std::string name = Catch::getResultCapture().getCurrentTestName();
  for (char &c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  const std::filesystem::path folder = std::filesystem::path(testOutputRoot()) / name.substr(0, 100);
  std::filesystem::create_directories(folder);
  return folder;
}

namespace c3de::test {
/// Reports the reason immediately. The skip itself is reported at the end of the run, unless a check has failed.
void skip(const std::string &reason);
}  // namespace c3de::test

/// Ends the test case as skipped, visibly, with the reason. Earlier failures remain failures.
#define C3DE_SKIP(reason)     \
  do {                        \
    c3de::test::skip(reason); \
    return;                   \
  } while (false)

/// A file of the third-party data; skips the case where the folder is absent.
#define C3DE_DATA_OR_SKIP(variable, relativePath)                                                  \
  const std::filesystem::path variable = std::filesystem::path(testDataFolder()) / (relativePath); \
  if (!std::filesystem::exists(variable)) C3DE_SKIP("test data not present: " + variable.string())

#endif
