// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation_screenshot.h"

#include <ctime>
#include <string>
#include <system_error>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::app {
namespace {

namespace fs = std::filesystem;

std::string timeStamp() {
  const std::time_t now = std::time(nullptr);
  char text[32] = "";
  if (const std::tm *local = std::localtime(&now)) std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", local);
  return text;
}

fs::path freeName(const fs::path &folder) {
  const std::string stem = "c3de-" + timeStamp();
  std::error_code ignored;
  fs::path file = folder / (stem + ".png");
  for (int i = 2; fs::exists(file, ignored); ++i) file = folder / (stem + "-" + std::to_string(i) + ".png");
  return file;
}

}  // namespace

Expected<fs::path> writeScreenshotFile(const std::vector<char> &bytes) {
  std::error_code error;
  std::string reasons;
  for (const fs::path &folder : {fs::current_path(error) / "out", userDataDirectory() / "screenshots"}) {
    fs::create_directories(folder, error);
    if (error) {
      reasons += (reasons.empty() ? "" : "; ") + pathText(folder) + ": " + error.message();
      continue;
    }
    const fs::path file = freeName(folder);
    const auto written = writeWholeFile(file, {bytes.data(), bytes.size()});
    if (written) return file;
    reasons += (reasons.empty() ? "" : "; ") + written.error().message;
  }
  return fail(ErrorCode::output, reasons);
}

}  // namespace c3de::app
