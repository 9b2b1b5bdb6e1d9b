// SPDX-License-Identifier: Apache-2.0
// The skin of a body at rest as a surface. Private to the core.
#pragma once

#include "pointbased/rest_state.h"

namespace pointbased::detail {

/// Bound to the phyxels, in their frame.
[[nodiscard]] Surface restSurface(const RestState &rest);

}  // namespace pointbased::detail
