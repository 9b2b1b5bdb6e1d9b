// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/abi/log.h"
#include "c3de/core/expected.h"
#include "c3de/registry/panel_registry.h"

namespace c3de::app {

/// Shows an error in the window and logs it. Main thread.
using ReportError = std::function<void(const std::string &title, const Error &error)>;

/// Shows the notices as one message, a line each. No effect without any.
inline void reportNotices(registry::PanelRegistry &panels, const std::string &title,
                          const std::vector<std::string> &notices, registry::About about = registry::About::program) {
  std::string text;
  for (const std::string &notice : notices) text += (text.empty() ? "" : "\n") + notice;
  if (!text.empty()) panels.notify(C3DE_LOG_INFO, title, text, {}, about);
}

}  // namespace c3de::app
