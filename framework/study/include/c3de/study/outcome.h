// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/study/earlier_run.h"
#include "c3de/study/errors.h"
#include "c3de/study/plan.h"

namespace c3de::study {

/// Cost of a point: ms per simulated second; for a solution without time, ms.
struct Cost {
  double cheapest = 0.0, median = 0.0, dearest = 0.0;             ///< of the repeats
  double stepMedian_ms = 0.0, step99_ms = 0.0, stepMax_ms = 0.0;  ///< median of the repeats
  double cpu_s = 0.0, toFirstStep_s = 0.0;                        ///< median of the repeats
};

struct PointOutcome {
  std::string failure, reason;  ///< failure: its kind; empty: the point succeeded
  Errors errors;                ///< if the point succeeded and the case has a truth; errors that need no truth in any
                                ///< case
  std::optional<Cost> cost;
  bool isOnFront = false;
  bool isBelowResolution = false;  ///< nearer to the reference than the uncertainty of the reference
  std::uint64_t steps = 0;
  double time_s = 0.0, dt_s = 0.0;
  std::string integrator, stateHash;
};

struct CaseOutcome {
  std::optional<ReferenceSolution> truth;
  std::string error;    ///< why there is no truth
  bool hasTime = true;  ///< false: solutions without time
};

/// All results of a study.
struct Outcome {
  std::vector<CaseOutcome> cases;    ///< as in the study
  std::vector<PointOutcome> points;  ///< as in the plan
  std::string cpu, host, date;       ///< where and when it was run
  unsigned processors = 0;
  std::optional<EarlierRun> earlier;  ///< plotted and reported for comparison
};

/// Median ratio of the points' costs to those of the earlier run; empty if no point is in both.
[[nodiscard]] std::optional<double> costRatio(const Plan &plan, const Outcome &outcome, std::size_t ofCase);

/// @param samples  of each case; empty if fields are not compared
/// @param results  by the id of a point
[[nodiscard]] Outcome evaluate(const Study &study, const Plan &plan, std::vector<Samples> samples,
                               const std::map<std::string, Result> &results);

/// One row per point, including those of references. Columns that depend on the clock come last, from `cost_ms` on. The
/// columns before are identical, to the last digit, in every run of the study.
[[nodiscard]] std::string tableOf(const Study &study, const Plan &plan, const Outcome &outcome);
/// Same in more detail, as JSON.
[[nodiscard]] std::string jsonOf(const Study &study, const Plan &plan, const Program &program, const Outcome &outcome);

}  // namespace c3de::study
