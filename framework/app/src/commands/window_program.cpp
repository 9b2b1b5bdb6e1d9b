// SPDX-License-Identifier: Apache-2.0
#include "commands/window_program.h"

#include <filesystem>
#include <string>
#include <string_view>
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

/// Which library the loader of the system does not find for the window program; empty if it starts.
std::string missingLibrary(const std::filesystem::path &program) {
  constexpr int kLoaderFailed = 127;
  constexpr double kLongest_s = 60.0;
  const auto started = runProcess({pathText(program), "--version"}, kLongest_s);
  if (!started || started->exitCode != kLoaderFailed) return "";
  constexpr std::string_view kReason = "error while loading shared libraries: ";
  const std::string &text = started->errorOutput;
  const std::size_t at = text.find(kReason);
  const std::size_t begin = at == std::string::npos ? 0 : at + kReason.size();
  return text.substr(begin, text.find('\n', begin) - begin);
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
  if (const std::string library = missingLibrary(other); !library.empty())
    return reportError({ErrorCode::graphics, "a window and pictures need a library that cannot be loaded: " + library +
                                                 "; without it: c3de run SCENE.toml --report FILE.json"});
  std::vector<std::string> arguments(argv, argv + argc);
  arguments.front() = pathText(other);
  const auto ended = continueAs(arguments);
  return ended ? *ended : reportError({ErrorCode::graphics, ended.error().message});
}

}  // namespace c3de::app
