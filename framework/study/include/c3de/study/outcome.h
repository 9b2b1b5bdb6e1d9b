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

/// What a point costs: ms per simulated second, of a solution without time ms.
struct Cost {
  double cheapest = 0.0, median = 0.0, dearest = 0.0;             ///< of the repeats
  double stepMedian_ms = 0.0, step99_ms = 0.0, stepMax_ms = 0.0;  ///< median of the repeats
  double cpu_s = 0.0, toFirstStep_s = 0.0;                        ///< likewise
};

struct PointOutcome {
  std::string failure, reason;  ///< kind; empty: it went well
  Errors errors;                ///< where it went well and the case has a truth, or what needs none
  std::optional<Cost> cost;
  bool isOnFront = false;
  bool isBelowBar = false;  ///< nearer to the reference than that is certain
  std::uint64_t steps = 0;
  double time_s = 0.0, dt_s = 0.0;
  std::string integrator, stateHash;
};

struct CaseOutcome {
  std::optional<Truth> truth;
  std::string error;    ///< why there is none
  bool hasTime = true;  ///< false: solutions without time
};

/// All that a study has found out.
struct Outcome {
  std::vector<CaseOutcome> cases;    ///< as in the study
  std::vector<PointOutcome> points;  ///< as in the plan
  std::string cpu, host, date;       ///< where and when
  unsigned processors = 0;
  std::optional<EarlierRun> earlier;  ///< drawn and told beside
};

/// What the points of a case cost by what they cost in the earlier run: the median; empty: none is in both.
[[nodiscard]] std::optional<double> costRatio(const Plan &plan, const Outcome &outcome, std::size_t ofCase);

/// @param samples  of each case; empty where fields are not compared
/// @param results  by the id of a point
[[nodiscard]] Outcome evaluate(const Study &study, const Plan &plan, std::vector<Samples> samples,
                               const std::map<std::string, Result> &results);

/// A row per point, those of references too. What depends on the clock stands at the end, from `cost_ms` on: what is
/// before is the same, to the last digit, in every run of the study.
[[nodiscard]] std::string tableOf(const Study &study, const Plan &plan, const Outcome &outcome);
/// The same with more words, as JSON.
[[nodiscard]] std::string jsonOf(const Study &study, const Plan &plan, const Program &program, const Outcome &outcome);

}  // namespace c3de::study
