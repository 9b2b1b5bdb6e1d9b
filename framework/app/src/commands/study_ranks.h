// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "app.h"
#include "c3de/study/study_run.h"

namespace c3de::app {

/// The processes that mpirun has started beside each other, in the program that knows them (c3de-study-mpi). What is here
/// is for the first of them, which reads the study and hands out points; the others run them.
class StudyRanks {
 public:
  virtual ~StudyRanks() = default;
  /// @param jobs  points at a time, in all
  [[nodiscard]] virtual std::unique_ptr<study::Workers> workers(std::size_t jobs) = 0;
  [[nodiscard]] virtual std::size_t count() const = 0;
};

/// Whether mpirun, or srun, has started this process as one of several.
[[nodiscard]] bool isUnderMpi();
/// Goes on as the program that speaks MPI, which lies beside this one and takes the same arguments. Returns an exit
/// code, with an error where there is none.
[[nodiscard]] int continueInMpiProgram(int argc, char **argv);

}  // namespace c3de::app
