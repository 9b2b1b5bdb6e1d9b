// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"

namespace c3de::app {

/// `c3de --version`: product, ABI and (as JSON) services.
void printVersion(bool json);

}  // namespace c3de::app
