// SPDX-License-Identifier: Apache-2.0
#include "frame/guide.h"

#include <array>
#include <string>
#include <vector>

#include "c3de/core/file_path.h"
#include "c3de/core/platform.h"

namespace c3de::ui {

std::filesystem::path findGuide(const std::filesystem::path &programFolder) {
  const std::filesystem::path documents = programFolder / ".." / "share" / "doc" / "c3de";
  const std::array candidates{documents / "reference" / "index.html", programFolder / ".." / "reference" / "index.html",
                              documents / "docs" / "user" / "index.md",
                              programFolder / ".." / ".." / ".." / "docs" / "user" / "index.md"};
  for (const std::filesystem::path &candidate : candidates) {
    std::error_code code;
    if (std::filesystem::is_regular_file(candidate, code)) return normalPath(candidate);
  }
  return {};
}

Expected<std::filesystem::path> showInBrowser(const std::filesystem::path &file) {
  if (file.empty())
    return fail(ErrorCode::input,
                "The guide is not installed. Install the component \"reference\", or read docs/user/index.md.");
#ifdef _WIN32
  const std::vector<std::string> command{"cmd", "/c", "start", "", file.string()};
#else
  // In the background: some openers end only with the browser.
  const std::vector<std::string> command{
      "/bin/sh", "-c", "command -v xdg-open >/dev/null || exit 3; xdg-open \"$0\" >/dev/null 2>&1 &", file.string()};
#endif
  const auto started = runProcess(command, 10.0);
  if (!started || started->exitCode != 0)
    return fail(ErrorCode::input,
                "xdg-open was not found (Debian package xdg-utils). The guide is this file: " + file.string());
  return file;
}

}  // namespace c3de::ui
