// SPDX-License-Identifier: Apache-2.0
// `c3de python-path`: the folder of the Python package.
#include <filesystem>

#include "c3de/core/embedding.h"
#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

int printPythonPath() {
  const std::filesystem::path folder =
      normalPath(modulePath().parent_path() / ".." / "lib" / "python3" / "dist-packages");
  std::error_code code;
  if (!std::filesystem::exists(folder / "c3de" / "__init__.py", code))
    return reportError({ErrorCode::input, pathText(folder / "c3de") +
                                              ": the Python package is not there; the Debian package python3-c3de or "
                                              "cmake --install BUILD --component embed installs it"});
  printOut(pathText(folder) + "\n");
  return kDone;
}

Handler declarePythonPath(CLI::App &, CommandLine &) { return printPythonPath; }

}  // namespace

const Command kPythonPathCommand{"python-path", "Print the folder of the Python package, for PYTHONPATH",
                                 declarePythonPath};

}  // namespace c3de::app
