// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

namespace c3de::ui {

/// Keeps the row under the mouse in a scrolling panel at its position on the screen, while rows above it appear,
/// disappear and change their height. In the frame in which the row would move, it is shifted back; from the next frame
/// on, the panel is scrolled by the same amount. If it cannot be scrolled that far, space is left above the rows.
/// Pixels, y downwards. Draws nothing.
class ScrollAnchor {
 public:
  /// Begins a frame.
  /// @param top      screen position at which the contents begin, at the present scroll position
  /// @param visible  height of the panel
  /// @param mouse    its y on the screen while it holds the panel; none: nothing is anchored
  /// @return the space above the rows, by which they begin below `top`
  double begin(double top, double visible, std::optional<double> mouse);
  /// Called before a row is laid out whose upper edge would be at `y` on the screen.
  /// @param key  identifies the row in all frames
  /// @return offset of the row and of everything below it
  double row(const std::string &key, double y);
  /// Nothing may be drawn or pressed below this position until the anchored row has been laid out. None: it has been,
  /// or there is none.
  [[nodiscard]] std::optional<double> edge() const;
  /// Ends the frame. @param scroll  of this frame
  /// @return scroll position of the next frame
  double end(double scroll);
  /// Whether the next frame will show the same rows at other positions.
  [[nodiscard]] bool isSettling() const { return isSettling_; }

 private:
  std::map<std::string, double> before_, now_;  ///< upper edges relative to the first row, in the last frame and this
                                                ///< one
  double start_ = 0.0;                          ///< of the rows on the screen, before any shift
  double drawnStart_ = 0.0;                     ///< in the last frame, of the rows under the mouse
  double visible_ = 0.0, room_ = 0.0, shift_ = 0.0;
  double kept_ = 0.0;   ///< previous upper edge of the row under the mouse
  double known_ = 0.0;  ///< previous upper edge of the last row that already existed
  bool isHeld_ = false, isWaiting_ = false, isSettling_ = false;
};

}  // namespace c3de::ui
