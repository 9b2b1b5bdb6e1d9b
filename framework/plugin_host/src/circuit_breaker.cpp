// SPDX-License-Identifier: Apache-2.0
#include "circuit_breaker.h"

#include <fmt/format.h>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/text.h"
#include "c3de/registry/panel_registry.h"
#include "last_error.h"

namespace c3de::plugin_host {

void CircuitBreaker::noteFailure(const char *what, bool isDone, c3de_status status) {
  if (plugin_.isClosed()) return;
  if (isDone) {
    const std::string reason = takeLastError();
    log(LogLevel::error, fmt::format("plugin {}: {} failed: {}", plugin_.id(), what,
                                     displayText(reason.empty() ? statusName(status) : reason)));
  }
  if (++failures_ < kMaxFailures) return;
  isOff_ = true;
  reason_ =
      fmt::format("{} is switched off, because it failed {} times in a row; the log says how", name_, kMaxFailures);
  log(LogLevel::error, fmt::format("plugin {}: {}", plugin_.id(), reason_));
  const Services &services = plugin_.services();
  if (services.mainQueue) services.mainQueue->requestRedraw();  // the failed callback has drawn nothing
  if (!services.panels) return;
  const auto switchOnAgain = [fuse = weak_from_this()] {
    if (const auto alive = fuse.lock()) alive->switchOn();
  };
  const auto tell = [panels = services.panels, title = fmt::format("{} of {}", name_, plugin_.id()), reason = reason_,
                     switchOnAgain] {
    panels->notify(C3DE_LOG_ERROR, title, reason, {{"Switch on again", switchOnAgain}});
  };
  if (services.mainQueue && !plugin_.isMainThread())
    services.mainQueue->post(tell);
  else
    tell();
}

void CircuitBreaker::switchOn() {
  isOff_ = false;
  failures_ = 0;
  reason_.clear();
  if (plugin_.services().mainQueue) plugin_.services().mainQueue->requestRedraw();
}

}  // namespace c3de::plugin_host
