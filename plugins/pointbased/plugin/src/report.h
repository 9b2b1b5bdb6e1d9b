// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/simulator.h"

namespace pointbased {

struct ReportedBody {
  std::size_t id;
  double meshVolume;  ///< m³
};

/// The keys bodies, probes, stages and events of the run report, as one JSON object.
[[nodiscard]] std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies);

}  // namespace pointbased
