// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "app.h"

namespace c3de::app {

/// A term of a list in help and man pages.
struct TopicEntry {
  const char *term, *text;
};

/// Every environment variable that program, library or Python package read.
[[nodiscard]] std::span<const TopicEntry> environmentVariables();
/// Exit codes, part of the contract of the command line.
[[nodiscard]] std::span<const TopicEntry> exitCodes();
/// Files and folders of the user.
[[nodiscard]] std::span<const TopicEntry> userFiles();

/// A list as text, the terms in a column.
[[nodiscard]] std::string textOf(std::span<const TopicEntry> entries);

}  // namespace c3de::app
