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

/// The reference for the runs of a case. What the reference does not contain is not compared.
struct ReferenceSolution {
  std::optional<double> value;        ///< of the quantity of the case, unless it is a field
  std::vector<Vec3> displacements_m;  ///< at the samples; empty: unknown
  std::optional<double> elastic_J;
  std::optional<Vec3> reaction_N;  ///< of the first support, or the one of the quantity
  /// In the unit of the errors of the quantity; smaller errors cannot be distinguished
  double bar = 0.0;
  double uncertainty = 0.0;     ///< in the unit of the value
  std::string kind, from;       ///< display text
  std::optional<double> order;  ///< as observed
};

/// Errors of a run, as fractions of 1 unless stated otherwise. None: unknown, or meaningless here.
struct Errors {
  std::optional<double> value;     ///< of the quantity itself, in its unit
  std::optional<double> quantity;  ///< the plotted error: a fraction; for surfaces mm
  std::optional<double> fieldL2, surfaceMax_mm, surface95_mm;
  std::optional<double> energyNorm;  ///< sqrt(|U - U*| / U*)
  std::optional<double> reaction, frequency;
  std::optional<double> volumeChange;      ///< of the skins, since the start
  std::optional<double> energyDrift_1_s;   ///< of bodies without energy supply and without damping
  std::optional<double> momentumRoundOff;  ///< of bodies without external action
};

/// The quantity of a run. The error states why the result does not contain it.
[[nodiscard]] Expected<double> valueOf(const Quantity &quantity, const Result &result);
/// Displacements of the sample points at the end of a run; empty if it followed none.
[[nodiscard]] std::vector<Vec3> displacementsOf(const Samples &samples, const Result &result);

/// From a number or a file of the study.
/// @param samples  receives the points of a file
[[nodiscard]] Expected<ReferenceSolution> statedReference(const Study &study, const Case &one, Samples &samples);
/// From three refined runs, coarse to fine. The error states which of them failed, or that they do not converge.
/// @param spacings  refinement of each run, which tends to 0
[[nodiscard]] Expected<ReferenceSolution> extrapolatedReference(const Case &one, const Samples &samples,
                                                                const std::array<double, 3> &spacings,
                                                                const std::array<Result, 3> &runs);

/// @param result  of a run that succeeded
[[nodiscard]] Errors errorsOf(const Case &one, const Point &point, const ReferenceSolution &truth,
                              const Samples &samples, const Result &result);

}  // namespace c3de::study
