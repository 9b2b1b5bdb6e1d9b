// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

namespace c3de::ui {

/// Keeps what is under the mouse in a scrolling panel where it is on the screen, while rows above it come, go and
/// change their height: the row that was there is moved back in the frame in which it would have moved, and from the
/// next one on the panel is scrolled by as much. Where it cannot be scrolled so far, there is room above the rows.
/// Pixels, y downwards. Draws nothing.
class RowAnchor {
 public:
  /// Begins a frame. @param top  where the contents begin on the screen, as far as the panel is scrolled
  /// @param visible  height of the panel
  /// @param mouse    its height on the screen while it holds the panel; none: nothing is kept
  /// @return the room above the rows, by which they begin below `top`
  double begin(double top, double visible, std::optional<double> mouse);
  /// Before a row is laid out whose upper edge would be at `y` on the screen. @param key  of the row in all frames
  /// @return how far it and what follows are to be moved
  double row(const std::string &key, double y);
  /// Nothing may be drawn or pressed below it before the row that is kept has come; none: it has, or there is none.
  [[nodiscard]] std::optional<double> edge() const;
  /// Ends the frame. @param scroll  of this frame
  /// @return that of the next one
  double end(double scroll);
  /// Whether the next frame is going to show the same elsewhere.
  [[nodiscard]] bool isSettling() const { return isSettling_; }

 private:
  std::map<std::string, double> before_, now_;  ///< upper edges from the first row on, of the last frame and this one
  double start_ = 0.0;                          ///< of the rows on the screen, where nothing has been moved
  double drawnStart_ = 0.0;                     ///< in the last frame, of what was under the mouse
  double visible_ = 0.0, room_ = 0.0, shift_ = 0.0;
  double kept_ = 0.0;   ///< upper edge of the row under the mouse, before
  double known_ = 0.0;  ///< of the last row that was there before
  bool isHeld_ = false, isWaiting_ = false, isSettling_ = false;
};

}  // namespace c3de::ui
