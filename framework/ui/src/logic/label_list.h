// SPDX-License-Identifier: Apache-2.0
// Lists of labels in panels: a label map may have hundreds.
#pragma once

#include <string>

#include "logic/panel_widgets.h"

namespace c3de::ui {

/// From this count on, a list has a filter and scrolls.
inline constexpr std::size_t kManyLabels = 12;

/// Every word of the filter occurs in the name. Case is ignored, and "_" counts as a space.
[[nodiscard]] bool isListed(const std::string &name, const std::string &filter);

/// Draws filter and frame of a list of `count` labels, of which `listed` match, if there are many; `rows` draws the
/// rows.
template <typename Rows>
void labelList(const c3de_ui_v1 &ui, std::size_t count, std::size_t listed, std::string &filter, const Rows &rows) {
  if (count <= kManyLabels) return rows();
  inputText(ui, "label_filter", "Filter", filter);
  tooltip(ui, "Labels whose names have these letters in them: \"kidney\", \"lung left\"");
  ui.list_begin(ui.ctx, toAbi(std::string_view("labels")),
                static_cast<std::uint32_t>(std::clamp<std::size_t>(listed, 1, kManyLabels)));
  if (listed == 0) text(ui, "No label matches.");
  rows();
  ui.list_end(ui.ctx);
}

}  // namespace c3de::ui
