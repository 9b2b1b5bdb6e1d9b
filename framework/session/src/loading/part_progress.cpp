// SPDX-License-Identifier: Apache-2.0
#include "loading/part_progress.h"

#include "c3de/core/text.h"

namespace c3de::session {

PartProgress::PartProgress(const ProgressFn &all, std::string name, std::size_t index, std::size_t count)
    : all_(all), name_(std::move(name)), index_(static_cast<double>(index)),
      count_(static_cast<double>(std::max<std::size_t>(count, 1))) {
  abi_.size = sizeof abi_;
  abi_.self = this;
  abi_.update = [](void *self, double fraction, c3de_str text) -> c3de_status {
    // No exception may cross the boundary.
    try {
      return static_cast<PartProgress *>(self)->update(fraction, displayText(fromAbi(text))) ? C3DE_OK
                                                                                             : C3DE_E_CANCELLED;
    } catch (...) {
      return C3DE_E_EXCEPTION;
    }
  };
}

bool PartProgress::update(double fraction, const std::string &text) const {
  if (const PluginCall *call = call_) call->noteProgress();
  if (!all_) return true;
  const double part = fraction < 0.0 ? 0.0 : std::min(fraction, 1.0);
  return all_((index_ + part) / count_, text.empty() ? name_ : name_ + ": " + text);
}

}  // namespace c3de::session
