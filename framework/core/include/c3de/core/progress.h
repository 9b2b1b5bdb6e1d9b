// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace c3de {

/// fraction in 0 … 1 (negative: unknown) and what is being done; false means: stop soon, the person cancelled.
using ProgressFn = std::function<bool(double fraction, const std::string &what)>;

}  // namespace c3de
