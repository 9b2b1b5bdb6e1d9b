// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "c3de/core/platform.h"
#include "support/catch.h"

/// Runs the program as a user would, to its end.
c3de::ProcessResult runC3de(std::vector<std::string> arguments);
/// The same in an environment without a display.
c3de::ProcessResult runWithoutDisplay(std::vector<std::string> arguments);

/// Runs a scene, which must succeed.
/// @param options  of `c3de run`
/// @return its report, written next to it
nlohmann::json runToReport(const std::filesystem::path &scene, std::vector<std::string> options = {});

/// An own, empty folder for a test case.
std::filesystem::path freshFolder(const std::string &name);
std::filesystem::path writeFile(const std::filesystem::path &file, const std::string &text);
std::string readFile(const std::filesystem::path &file);
nlohmann::json readJson(const std::filesystem::path &file);

/// A box [0,1] x [0,0.2] x [0,0.2] in OBJ, closed, faces outwards.
std::string boxObj();
/// A scene of that box, 1 m wide, falling; `more` is appended. Its mesh is written next to it.
std::filesystem::path writeBoxScene(const std::filesystem::path &folder, const std::string &more = "");
