// SPDX-License-Identifier: Apache-2.0
// Accuracy of the present state of a body, in three lines: the same in the window, the summary and the report.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointbased/accuracy.h"
#include "pointbased/singular_regions.h"
#include "report/verification.h"

namespace pointbased {

/// The trials from which the displacement error of a body is estimated; independent of its state.
struct DisplacementTrials {
  std::shared_ptr<const AccuracySurvey> survey;  ///< null: there are none
  std::string failure;                           ///< why there are none
};

/// Errors of displacement and of stress and strain, and the regions for which no stress figure exists.
struct AccuracyStatement {
  enum class Basis {
    verified,   ///< compared with a finer solution of this state
    estimated,  ///< from trials at rest: predictError()
    none        ///< unknown; see `reason`
  };
  Basis basis = Basis::none;
  double displacement = 0.0;         ///< m; 95 % of the skin is off by less; 0 with Basis::none
  double displacementAtMost = 0.0;   ///< m; upper bound over all of the skin; 0: unknown
  double largestDisplacement = 0.0;  ///< m; of the skin; the displacement to which `displacement` refers
  std::optional<Vec3> worst;         ///< world, m; position of the largest error
  double finer = 0.0;                ///< number of points of the finer solution, as a multiple of the body's points
  std::string reason;                ///< why there is no figure, or what the figure omits; may be empty
  double whole = 0.0;                ///< ErrorEstimate::relative of the whole body
  double stress = 0.0;               ///< 0 … 1, relativeErrorOutside()
  bool isStrained = false;           ///< otherwise there is no stress that could be in error
  double leftOut = 0.0;              ///< SingularRegions::volumePart
  std::vector<std::string> places;   ///< descriptions of the singular regions
  std::string help;                  ///< what reduces `stress`; empty if it is small

  /// "Displacement: …", "Stress and strain: …", "Singular regions: …".
  [[nodiscard]] std::array<std::string, 3> lines() const;
};

/// Inputs of a statement, besides the body.
struct AccuracySources {
  double area = 0.0;                                    ///< of the body's surface, m²
  std::span<const std::string> fixes;                   ///< names of its fixes
  const DisplacementTrials *trials;                     ///< null: not computed yet
  const BodyVerification *verification;                 ///< of the present state; null if there is none
  std::function<std::string(std::size_t id)> nameOfId;  ///< of a body, an obstacle or kWorldBox
};

/// For a deformable body at its present state. Costs about one estimateError().
/// @param scratch  reused memory
[[nodiscard]] AccuracyStatement stateAccuracy(const Simulator &simulator, std::size_t id,
                                              const AccuracySources &sources, ErrorScratch &scratch,
                                              const ParallelFor &parallelFor);

}  // namespace pointbased
