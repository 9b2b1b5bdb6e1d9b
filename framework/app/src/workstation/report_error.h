// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// Shows an error in the window and logs it. Main thread.
using ReportError = std::function<void(const std::string &title, const Error &error)>;

}  // namespace c3de::app
