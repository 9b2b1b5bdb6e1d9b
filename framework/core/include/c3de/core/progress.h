// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace c3de {

/// fraction in 0 … 1 (negative: unknown) and the current activity; false means: stop soon, the user cancelled.
using ProgressFn = std::function<bool(double fraction, const std::string &what)>;

}  // namespace c3de
