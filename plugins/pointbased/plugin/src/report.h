// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "accuracy_dial.h"
#include "pointbased/simulator.h"

namespace pointbased {

struct ReportedBody {
  std::size_t id;
  double meshVolume;  ///< m³
  double meshArea;    ///< m²
  std::vector<std::uint32_t> fixNumbers;
  std::shared_ptr<const AccuracyPromise> promise;  ///< null: its sampling was said
};

/// What integrates a body and what computes its forces, for people: "explicit, double precision, AVX3".
[[nodiscard]] std::string howComputed(const Simulator &simulator, std::size_t body);

/// The keys accuracy, bodies, probes, reactions, stages, events and notices of the run report, as one JSON object.
[[nodiscard]] std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies);

}  // namespace pointbased
