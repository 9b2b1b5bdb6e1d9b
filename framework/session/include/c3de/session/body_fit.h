// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/iface/identification.h"
#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/vec.h"
#include "c3de/session/force_curve.h"

namespace c3de::session {

/// Null: the simulator neither fits nor differentiates. Errors (plugin): its table is malformed.
[[nodiscard]] Expected<const c3de_identification_v0 *> identificationTable(c3de_object *simulator);

struct BodyFitOptions {
  /// Reference position, m, of the point whose displacement was measured while a force of the scene acted; none: the
  /// displacement of a support is prescribed, and its reaction was measured
  std::optional<Vec3> watched_m;
  double noise = 0.0;  ///< standard deviation of the measurement noise, N (or m with `watched_m`); 0: unknown
};

enum class FitVerdict : std::uint32_t {
  found = C3DE_FIT_FOUND,
  unexplained = C3DE_FIT_UNEXPLAINED,
  undetermined = C3DE_FIT_UNDETERMINED
};
[[nodiscard]] const char *nameOf(FitVerdict verdict);  ///< "found", "unexplained", "undetermined"

struct FittedMaterial {
  std::string material;  ///< name of the body or of a part
  double value_Pa = 0.0, low_Pa = 0.0;
  std::optional<double> high_Pa;  ///< none: no upper limit
  bool isOwn = false;             ///< false: it has a common factor with others
};

/// Young's moduli by which the body reproduces a measured curve.
struct BodyFit {
  FitVerdict verdict = FitVerdict::undetermined;
  std::string reason;  ///< of a verdict other than found
  bool hasConverged = false, isLoaded = false;
  unsigned iterations = 0;
  std::uint64_t solutions = 0;            ///< static ones that were computed
  double residual = 0.0, measured = 0.0;  ///< N, or m with isLoaded
  std::vector<FittedMaterial> moduli;
  std::vector<double> predicted;  ///< [points] N, or m
};

/// Fits the stiffness of a body of the simulator, which does not change. Errors: those of checkForceCurve(); the
/// simulator does not fit, or has no body of this name; its own reason (plugin); cancelled. Any thread.
/// @param owner      plugin of the simulator
/// @param takeError  returns the text of the last failed call
[[nodiscard]] Expected<BodyFit> fitBody(c3de_object *simulator, const std::string &body, const ForceCurve &curve,
                                        const BodyFitOptions &options, const char *owner,
                                        const std::function<std::string()> &takeError, const ProgressFn &progress = {});

/// What a fit was made of, for reports.
struct FitFacts {
  std::string body, curve;  ///< names
  double noise = 0.0;
  double wall_s = 0.0;
};
/// `fit` of a report.
[[nodiscard]] std::string fitJson(const BodyFit &fit, const ForceCurve &curve, const FitFacts &facts);
/// For people: a line each.
[[nodiscard]] std::vector<std::string> fitLines(const BodyFit &fit, const ForceCurve &curve, const FitFacts &facts);
/// A table of the curve with the values of the fitted model, CSV.
[[nodiscard]] std::string fitTable(const BodyFit &fit, const ForceCurve &curve);

}  // namespace c3de::session
