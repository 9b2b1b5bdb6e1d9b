// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/study/plan.h"
#include "c3de/study/result.h"
#include "c3de/study/sampling.h"
#include "c3de/study/study_file.h"

namespace c3de::study {

/// What the runs of a case are compared with. What the reference does not know is not compared.
struct Truth {
  std::optional<double> value;        ///< of the quantity of the case, unless it is a field
  std::vector<Vec3> displacements_m;  ///< at the samples; empty: not known
  std::optional<double> elastic_J;
  std::optional<Vec3> reaction_N;  ///< of the first support, or that of the quantity
  /// In the unit of the errors of the quantity: below it nothing can be told apart
  double bar = 0.0;
  double uncertainty = 0.0;     ///< in the unit of the value
  std::string kind, from;       ///< for people
  std::optional<double> order;  ///< as observed
};

/// How far a run is off; in shares of 1 where nothing else is said. None: not known, or it makes no sense here.
struct Errors {
  std::optional<double> value;     ///< of the quantity itself, in its unit
  std::optional<double> quantity;  ///< what is drawn: a share; of surfaces mm
  std::optional<double> fieldL2, surfaceMax_mm, surface95_mm;
  std::optional<double> energyNorm;  ///< sqrt(|U - U*| / U*)
  std::optional<double> reaction, frequency;
  std::optional<double> volumeChange;      ///< of the skins, since the start
  std::optional<double> energyDrift_1_s;   ///< of bodies that nothing feeds and nothing damps
  std::optional<double> momentumRoundOff;  ///< of bodies that nothing acts on
};

/// The quantity of a run. The error says why the result does not have it.
[[nodiscard]] Expected<double> valueOf(const Quantity &quantity, const Result &result);
/// Displacements of the sample points at the end of a run; empty: it followed none.
[[nodiscard]] std::vector<Vec3> displacementsOf(const Samples &samples, const Result &result);

/// From a number or a file of the study.
/// @param samples  of a file: its points are put there
[[nodiscard]] Expected<Truth> statedTruth(const Study &study, const Case &one, Samples &samples);
/// From three refined runs, coarse to fine. The error says what of them failed or does not converge.
/// @param spacings  what the lever of each takes to 0
[[nodiscard]] Expected<Truth> extrapolatedTruth(const Case &one, const Samples &samples,
                                                const std::array<double, 3> &spacings,
                                                const std::array<Result, 3> &runs);

/// @param result  of a run that went well
[[nodiscard]] Errors errorsOf(const Case &one, const Point &point, const Truth &truth, const Samples &samples,
                              const Result &result);

}  // namespace c3de::study
