// SPDX-License-Identifier: Apache-2.0
// Curves over simulated time, drawn into a list of the current ImGui frame.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "c3de/ui/plots.h"
#include "logic/pixel_rect.h"

namespace c3de::ui {

struct PlotLook {
  std::optional<double> now_s{};  ///< a line marks it
  std::optional<float> hoverX{};  ///< pixel of the mouse
  bool isLight = false;
};
/// Which time was pointed at, and the values there.
struct PlotReadout {
  double time_s = 0.0;
  std::vector<std::string> lines;  ///< "finger: force 1.2 N"
};

/// Colour of the n-th shown curve.
[[nodiscard]] ImU32 plotColour(std::size_t shown, bool isLight);
/// One band per unit, all over the same time. Nothing is drawn without a shown curve.
/// @return nothing unless the mouse is over the curves
std::optional<PlotReadout> drawPlots(ImDrawList *list, const PixelRect &area, const PlotList &plots,
                                     const PlotLook &look);

}  // namespace c3de::ui
