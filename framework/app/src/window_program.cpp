// SPDX-License-Identifier: Apache-2.0
#include "window_program.h"

#ifdef _WIN32
#include <process.h>
#else
#include <unistd.h>
#endif

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "exit_code.h"

namespace c3de::app {
namespace {

std::filesystem::path windowProgram() {
  const std::filesystem::path self = executablePath();
  return self.parent_path() / ("c3de-workstation" + self.extension().string());
}

}  // namespace

bool hasWindowProgram() {
  std::error_code code;
  return std::filesystem::exists(windowProgram(), code);
}

int continueInWindowProgram(int argc, char **argv) {
  const std::filesystem::path other = windowProgram();
  if (!hasWindowProgram())
    return reportError({ErrorCode::graphics, "a window and pictures need " + pathText(other) +
                                                 ", which is not there; without it: c3de run SCENE.toml --report FILE.json"});
#ifdef _WIN32
  std::vector<std::string> quoted;
  for (int i = 1; i < argc; ++i) quoted.push_back('"' + std::string(argv[i]) + '"');
  const std::string program = other.string(), name = '"' + program + '"';
  std::vector<const char *> arguments{name.c_str()};
  for (const std::string &one : quoted) arguments.push_back(one.c_str());
  arguments.push_back(nullptr);
  const auto status = _spawnv(_P_WAIT, program.c_str(), arguments.data());
  if (status >= 0) return static_cast<int>(status);
#else
  const std::string program = other.string();
  std::vector<char *> arguments(argv, argv + argc);
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
#endif
  return reportError({ErrorCode::graphics, pathText(other) + " cannot be started: " + std::strerror(errno)});
}

}  // namespace c3de::app
