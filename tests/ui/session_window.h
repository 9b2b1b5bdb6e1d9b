// SPDX-License-Identifier: Apache-2.0
// What tests of sessions and recordings in the window share.
#pragma once

#include <filesystem>
#include <string>

#include "ui/workstation_driver.h"

namespace c3de::test {

/// An output file that does not exist.
std::filesystem::path freshFile(const std::string &name);
/// A folder for the settings of a user, which does not exist.
std::filesystem::path freshHome(const std::string &name);
/// The message with this title; null: there is none.
Json notification(const Json &state, const std::string &title);
/// Waits until a message contains this text.
void waitForMessage(WorkstationDriver &window, const std::string &wanted);
/// What `c3de info --json` reports for a session.
Json describe(const std::filesystem::path &session);
/// The recovery file below the home of the program; empty: there is none.
std::filesystem::path recoveryIn(const std::filesystem::path &home);
/// Replays a recording with 1, 2 and 7 threads: all state hashes are equal.
void checkReplays(const std::filesystem::path &recording);

}  // namespace c3de::test
