// SPDX-License-Identifier: Apache-2.0
#include "commands/window_program.h"

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "commands/exit_code.h"

namespace c3de::app {
namespace {

std::filesystem::path windowProgram() {
  const std::filesystem::path self = executablePath();
  return self.parent_path() / ("c3de-workstation" + self.extension().string());
}

}  // namespace

std::filesystem::path consoleProgram() {
  const std::filesystem::path self = executablePath();
  const std::filesystem::path other = self.parent_path() / ("c3de" + self.extension().string());
  std::error_code code;
  return std::filesystem::exists(other, code) ? other : std::filesystem::path();
}

bool hasWindowProgram() {
  std::error_code code;
  return std::filesystem::exists(windowProgram(), code);
}

int continueInWindowProgram(int argc, char **argv) {
  const std::filesystem::path other = windowProgram();
  if (!hasWindowProgram())
    return reportError(
        {ErrorCode::graphics, "a window and pictures need " + pathText(other) +
                                  ", which is missing; without it: c3de run SCENE.toml --report FILE.json"});
  std::vector<std::string> arguments(argv, argv + argc);
  arguments.front() = pathText(other);
  const auto ended = continueAs(arguments);
  return ended ? *ended : reportError({ErrorCode::graphics, ended.error().message});
}

}  // namespace c3de::app
