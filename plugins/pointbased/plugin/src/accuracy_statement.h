// SPDX-License-Identifier: Apache-2.0
// How accurate the present state of a body is, in three lines: the same in the window, the summary and the report.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointbased/accuracy.h"
#include "pointbased/singular_places.h"
#include "verification.h"

namespace pointbased {

/// The trials from which the error of a body's displacements is estimated; independent of its state.
struct DisplacementTrials {
  std::shared_ptr<const AccuracySurvey> survey;  ///< null: there is none
  std::string failure;                           ///< why there is none
};

/// Error of displacements, of stress and strain, and the places that have no stress figure.
struct AccuracyStatement {
  enum class Basis {
    verified,   ///< compared with a finer solution of this state
    estimated,  ///< from trials at rest: predictError()
    none        ///< nothing is known; `reason`
  };
  Basis basis = Basis::none;
  double displacement = 0.0;         ///< m, 95 % of the skin are off by less; 0 with Basis::none
  double displacementAtMost = 0.0;   ///< m, all of the skin is; 0: not known
  double largestDisplacement = 0.0;  ///< m, of the skin, that `displacement` belongs to
  std::optional<Vec3> worst;         ///< world, m: where it is largest
  double finer = 0.0;                ///< times as many points as the body has, of the finer solution
  std::string reason;                ///< why there is no figure, or what the figure leaves out; may be empty
  double whole = 0.0;                ///< ErrorEstimate::relative of the whole body
  double stress = 0.0;               ///< 0 … 1, relativeErrorOutside()
  bool isStrained = false;           ///< else there is nothing that stress could be off by
  double leftOut = 0.0;              ///< SingularPlaces::volumePart
  std::vector<std::string> places;   ///< the singular places, in words
  std::string help;                  ///< what makes `stress` smaller; empty: it is small

  /// "Displacement: …", "Stress and strain: …", "Singular places: …".
  [[nodiscard]] std::array<std::string, 3> lines() const;
};

/// What a statement is made from, beside the body.
struct AccuracySources {
  double area = 0.0;                                    ///< of the body's surface, m²
  std::span<const std::string> fixes;                   ///< names of its fixes
  const DisplacementTrials *trials;                     ///< null: not made yet
  const BodyVerification *verification;                 ///< of the present state; null: none
  std::function<std::string(std::size_t id)> nameOfId;  ///< of a body, an obstacle or kWorldBox
};

/// Of a body that deforms, at its present state. Costs about one estimateError().
/// @param scratch  memory that is used again
[[nodiscard]] AccuracyStatement stateAccuracy(const Simulator &simulator, std::size_t id,
                                              const AccuracySources &sources, ErrorScratch &scratch,
                                              const ParallelFor &parallelFor);

}  // namespace pointbased
