// SPDX-License-Identifier: Apache-2.0
#include "workstation/figure_clipboard.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::app {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience_s = 20.0;

bool isWindows() { return std::string_view(pluginExtension()) == ".dll"; }

/// The first program of this name in the folders of PATH; empty: none.
std::string findProgram(const std::string &name) {
  const std::string path = environmentVariable("PATH");
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find(pathListSeparator(), begin), path.size());
    const fs::path file = pathFromText(path.substr(begin, end - begin)) / name;
    std::error_code code;
    const fs::file_status status = fs::status(file, code);
    constexpr fs::perms kExecutable = fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec;
    if (end > begin && fs::is_regular_file(status) && (status.permissions() & kExecutable) != fs::perms::none)
      return pathText(file);
    begin = end + 1;
  }
  return {};
}

std::string firstLine(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

std::optional<ClipboardProgram> findClipboardProgram() {
  if (isWindows()) return std::nullopt;
  if (!environmentVariable("WAYLAND_DISPLAY").empty())
    if (const std::string program = findProgram("wl-copy"); !program.empty())
      return ClipboardProgram{{"/bin/sh", "-c", "exec \"$0\" --type image/png < \"$1\"", program}};
  if (const std::string program = findProgram("xclip"); !program.empty())
    return ClipboardProgram{{program, "-selection", "clipboard", "-target", "image/png", "-in"}};
  return std::nullopt;
}

std::string whyNoClipboard() {
  if (isWindows()) return "Pictures can be copied on Linux only. Save figure… writes a file.";
  return environmentVariable("WAYLAND_DISPLAY").empty()
             ? "The program xclip is not installed (Debian: apt install xclip). Save figure… writes a file."
             : "The program wl-copy is not installed (Debian: apt install wl-clipboard). Save figure… writes a file.";
}

Expected<void> copyPng(const ClipboardProgram &program, const std::vector<char> &png) {
  const fs::path folder = userCacheDirectory() / "clipboard";
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return fail(ErrorCode::output, pathText(folder) + ": cannot be created: " + code.message());
  const std::string id = std::to_string(processId());
  const fs::path file = folder / ("figure-" + id + ".png"), log = folder / ("figure-" + id + ".log");
  if (auto written = writeWholeFile(file, {png.data(), png.size()}); !written) return written;
  // The program has read the file when it returns. A process that it leaves behind answers requests for the picture.
  std::vector<std::string> command = program.arguments;
  command.push_back(pathText(file));
  Expected<void> result;
  auto process = ChildProcess::start(command, log);
  const Expected<int> exitCode =
      process ? process->wait(kPatience_s) : Expected<int>(tl::unexpected<Error>(process.error()));
  if (!exitCode)
    result = fail(ErrorCode::output, command.front() + ": " + exitCode.error().message);
  else if (*exitCode != 0)
    result = fail(ErrorCode::output,
                  command.front() + " ended with exit code " + std::to_string(*exitCode) + ": " + firstLine(log));
  fs::remove(file, code);
  fs::remove(log, code);
  return result;
}

}  // namespace c3de::app
