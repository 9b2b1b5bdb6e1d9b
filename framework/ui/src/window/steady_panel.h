// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "logic/row_anchor.h"

struct ImGuiWindow;

namespace c3de::ui {

/// A scrolling child window of Dear ImGui in which what is under the mouse stays there (RowAnchor): a press meets what
/// was seen. While the mouse is in it, or holds something of it, the contents do not give way at the end either.
class SteadyPanel {
 public:
  void begin();  ///< after BeginChild()
  /// Before a row is laid out. In other windows, and outside of begin() and end(), nothing is done.
  /// @param key  of the row in all frames
  void row(const std::string &key);
  void end();  ///< before EndChild()
  [[nodiscard]] bool isSettling() const { return anchor_.isSettling(); }

 private:
  RowAnchor anchor_;
  ImGuiWindow *window_ = nullptr;  ///< between begin() and end()
  std::optional<double> mouse_;    ///< its height when it was last free
  bool isClipped_ = false;
};

}  // namespace c3de::ui
