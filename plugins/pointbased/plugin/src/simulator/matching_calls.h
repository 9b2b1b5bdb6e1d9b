// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

#include "c3de/abi/iface/matching.h"
#include "simulator/changes.h"

namespace pointbased {

/// iface.matching: brings a body to points measured on its surface. Any thread; the simulation may continue meanwhile,
/// and is replaced by the matched state at the end.
class MatchingCalls {
 public:
  explicit MatchingCalls(SimulatorParts &parts);
  ~MatchingCalls();

  void match(const c3de_match_request *request, const c3de_progress *progress, c3de_match_result *out, c3de_sink json);

 private:
  struct Kept;
  SimulatorParts &parts_;
  std::mutex keptMutex_;
  std::unique_ptr<Kept> kept_;  ///< solver of the last match, for the next frame; null: none
};

}  // namespace pointbased
