// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace c3de::ui {

/// An event from the operating system. Positions in window pixels.
struct OsEvent {
  enum class Kind {
    press,
    release,
    move,
    wheel,
    keyDown,
    keyUp,
    character,
    focusLost,
    focusGained,
    leave,
    drop,
    close,
    other
  };
  enum class Role { other, shift, modifier };  ///< of a key; modifier: Ctrl, Alt, Super
  Kind kind = Kind::other;
  std::uint32_t button = 0, modifiers = 0;  ///< C3DE_BUTTON_*, C3DE_MOD_*
  std::uint32_t key = 0;                    ///< of keyDown: ASCII upper case or ui::Key; 0: another key
  bool isRepeat = false;
  Role role = Role::other;
  bool isAlt = false;                              ///< the left Alt key
  int rawKey = 0, scanCode = 0, rawModifiers = 0;  ///< of GLFW
  unsigned character = 0;
  double x = 0.0, y = 0.0, wheelX = 0.0, wheel = 0.0, time_s = 0.0;
  std::vector<std::filesystem::path> files;
};

/// Detects double clicks from event times. Frames may be slow; each press has its own time.
class ClickPairs {
 public:
  /// Whether this press is the second of a pair: same button, within 0.4 s, at about the same position. A third press
  /// starts a new pair.
  bool isSecond(const OsEvent &press);

 private:
  std::uint32_t button_ = 0;  ///< of the first press of a pair; 0: none
  double x_ = 0.0, y_ = 0.0, time_s_ = 0.0;
};

/// Takes events from the front of the queue, as many as one frame can show without losing any. Dear ImGui 1.86 samples
/// mouse and keys once per frame. A key that goes down and up, or a press and the move after it, therefore need a frame
/// each. Characters are queued by Dear ImGui: any number of them shares a frame, and the key-down events that produce
/// them may be lost.
/// @param holdsTyping  a text field is about to get the keyboard focus: typed input waits for it
[[nodiscard]] std::vector<OsEvent> takeFrameEvents(std::vector<OsEvent> &queue, bool holdsTyping = false);

}  // namespace c3de::ui
