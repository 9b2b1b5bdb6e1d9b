// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stage_clock.h"

#include <algorithm>
#include <utility>

namespace pointbased {

StageClock::StageClock(std::vector<std::string> names) {
  for (std::string &name : names) {
    stages_.emplace_back();
    stages_.back().name = std::move(name);
    stages_.back().recent_ms.reserve(kRecent);
  }
}

void StageClock::take(StageClock &other) {
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    Stage &from = other.stages_[k];
    stages_[k].pending_ms += std::exchange(from.pending_ms, 0.0);
    stages_[k].used = std::exchange(from.used, false) || stages_[k].used;
  }
}

void StageClock::commit() {
  for (Stage &stage : stages_) {
    if (!stage.used) continue;
    const auto sample = static_cast<float>(stage.pending_ms);
    if (stage.recent_ms.size() < kRecent) {
      stage.recent_ms.push_back(sample);
    } else {
      stage.recent_ms[stage.calls % kRecent] = sample;
    }
    ++stage.calls;
    stage.pending_ms = 0.0;
    stage.used = false;
  }
}

void StageClock::clear() {
  for (Stage &stage : stages_) {
    stage.calls = 0;
    stage.pending_ms = 0.0;
    stage.used = false;
    stage.recent_ms.clear();
  }
}

std::vector<StageClock::Summary> StageClock::summary() const {
  std::vector<Summary> out;
  for (const Stage &stage : stages_) {
    if (stage.recent_ms.empty()) continue;
    std::vector<float> sorted = stage.recent_ms;
    std::sort(sorted.begin(), sorted.end());
    Summary s;
    s.name = stage.name;
    s.calls = stage.calls;
    s.median_ms = static_cast<double>(sorted[sorted.size() / 2]);
    s.p99_ms = static_cast<double>(sorted[std::min(sorted.size() - 1, sorted.size() * 99 / 100)]);
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace pointbased
