// SPDX-License-Identifier: Apache-2.0
// The skin of a body at rest as a surface. Private to the core.
#pragma once

#include "pointbased/rest_state.h"

namespace pointbased::detail {

/// Frame of the phyxels, m. Empty if the body has no skin.
[[nodiscard]] inline Surface skinOf(const RestState &rest) {
  Surface out;
  for (std::size_t p = 0; p < rest.surfels.count(); ++p)
    out.positions.push_back(rest.surfels.position(p, rest.positions));
  out.triangles = rest.skin;
  return out;
}

}  // namespace pointbased::detail
