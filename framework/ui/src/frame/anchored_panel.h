// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "logic/scroll_anchor.h"

struct ImGuiWindow;

namespace c3de::ui {

/// A scrolling child window of Dear ImGui in which the row under the mouse does not move (ScrollAnchor): a press hits
/// what was visible. While the mouse is in it, or holds an item of it, the contents do not move at the end either.
class AnchoredPanel {
 public:
  void begin();  ///< after BeginChild()
  /// Called before a row is laid out. No effect in other windows, and outside of begin() and end().
  /// @param key  identifies the row in all frames
  void row(const std::string &key);
  void end();  ///< before EndChild()
  [[nodiscard]] bool isSettling() const { return anchor_.isSettling(); }

 private:
  ScrollAnchor anchor_;
  ImGuiWindow *window_ = nullptr;  ///< between begin() and end()
  std::optional<double> mouse_;    ///< its y when it was last free
  bool isClipped_ = false;
};

}  // namespace c3de::ui
