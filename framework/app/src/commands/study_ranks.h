// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "app.h"
#include "c3de/study/study_run.h"

namespace c3de::app {

/// The processes started together by mpirun, in the program that supports MPI (c3de-study-mpi). This interface is for
/// the first of them, which reads the study and distributes points; the others run them.
class StudyRanks {
 public:
  virtual ~StudyRanks() = default;
  /// @param jobs  total number of concurrent points
  [[nodiscard]] virtual std::unique_ptr<study::Workers> workers(std::size_t jobs) = 0;
  [[nodiscard]] virtual std::size_t count() const = 0;
};

/// Whether mpirun, or srun, has started this process as one of several.
[[nodiscard]] bool isUnderMpi();
/// Continues as the program with MPI, which is in the same folder and accepts the same arguments. Returns an exit code,
/// with an error if there is no such program.
[[nodiscard]] int continueInMpiProgram(int argc, char **argv);

}  // namespace c3de::app
