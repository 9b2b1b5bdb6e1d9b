// SPDX-License-Identifier: Apache-2.0
// Contact pressure on the skin of a body. Private to the core.
#pragma once

#include "contact/skin_pair.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// m², at rest: mean over both skins of the area of the vertices in contact at the end of the last step.
[[nodiscard]] double pressedArea(const SkinPair &pair);

/// Normal forces of the last step, by phyxel, over the skin area that each carries.
class PressureOnSkin {
 public:
  explicit PressureOnSkin(const Body &body);
  void addObstacles();  ///< including walls
  /// @param side  0 or 1: the side of the pair that is this body
  void addSkin(const SkinPair &pair, std::size_t side);
  [[nodiscard]] const std::vector<double> &pressures() const { return pressures_; }  ///< [phyxels] Pa, >= 0

 private:
  const Body &body_;
  std::vector<double> pressures_, forces_, areas_;  // [phyxels]
};

}  // namespace pointbased::detail
