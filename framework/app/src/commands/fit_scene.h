// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "c3de/session/run_options.h"

namespace c3de::app {

struct FitOptions {
  RunOptions run;                          ///< session, scene, overrides, unit of a mesh, report, quiet
  std::filesystem::path curve, residuals;  ///< residuals empty: not requested
  std::string body, probe;                 ///< empty: the only one
  std::optional<double> noise;             ///< N, or mm where a force is prescribed
};

/// Fits the stiffness of a body of a scene to a measured curve and prints the result. Returns the exit code: kFailed
/// where the curve does not determine it; the outputs are written then as well.
int fitScene(const FitOptions &options);

}  // namespace c3de::app
