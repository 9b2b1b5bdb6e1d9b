// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "commands/exit_code.h"
#include "commands/study_ranks.h"

namespace c3de::app {

bool isUnderMpi() {
  // Open MPI, MPICH and its derivatives, Microsoft MPI: each sets its own variable for every process it starts.
  for (const char *name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
    if (!environmentVariable(name).empty()) return true;
  return false;
}

int continueInMpiProgram(int argc, char **argv) {
  const std::filesystem::path self = executablePath();
  const std::filesystem::path other = self.parent_path() / ("c3de-study-mpi" + self.extension().string());
  std::error_code code;
  if (!std::filesystem::exists(other, code))
    return reportError(
        {ErrorCode::usage, "a study under mpirun needs " + pathText(other) +
                               ", which is not there: this build has no MPI; accepted: c3de study without "
                               "mpirun, whose [run] jobs are processes of this machine"});
  std::vector<std::string> arguments(argv, argv + argc);
  arguments.front() = pathText(other);
  const auto ended = continueAs(arguments);
  return ended ? *ended : reportError({ErrorCode::state, ended.error().message});
}

}  // namespace c3de::app
