// SPDX-License-Identifier: Apache-2.0
#include "logic/os_event.h"

#include <cmath>
#include <iterator>
#include <set>

namespace c3de::ui {
namespace {

using Kind = OsEvent::Kind;
using Role = OsEvent::Role;

/// The events that a frame has used so far.
class Frame {
 public:
  /// @param types  the event is from a key that produces a character
  [[nodiscard]] bool wouldLose(const OsEvent &event, bool types) const {
    switch (event.kind) {
      case Kind::move: return hasButton_ || hasWheel_ || !keys_.empty();
      case Kind::press:
      case Kind::release: return hasButton_ || hasWheel_ || hasCharacter_ || !keys_.empty();
      case Kind::wheel: return hasButton_;
      // Dear ImGui first inserts the characters of a frame and then evaluates Backspace, Enter and similar keys; with
      // Ctrl down it drops the characters.
      case Kind::character: return hasButton_ || hasKeyDown_;
      case Kind::keyDown:
        if (event.isRepeat && !types) return hasButton_;  // it will be repeated anyway
        if (types || event.role == Role::shift) return hasButton_ || hasKeyDown_;
        if (event.role == Role::modifier) return hasButton_ || hasCharacter_ || hasKeyDown_;
        return hasButton_ || hasCharacter_ || keys_.contains(event.rawKey);
      // Also for another key: the A of Ctrl+A must be evaluated while Ctrl is still down.
      case Kind::keyUp: return hasButton_ || hasKeyDown_;
      default: return false;
    }
  }

  void take(const OsEvent &event, bool types) {
    hasButton_ = hasButton_ || event.kind == Kind::press || event.kind == Kind::release;
    hasWheel_ = hasWheel_ || event.kind == Kind::wheel;
    hasCharacter_ = hasCharacter_ || event.kind == Kind::character;
    if (types || (event.kind != Kind::keyDown && event.kind != Kind::keyUp)) return;
    keys_.insert(event.rawKey);
    hasKeyDown_ = hasKeyDown_ || (event.kind == Kind::keyDown && event.role == Role::other);
  }

 private:
  bool hasButton_ = false, hasWheel_ = false, hasCharacter_ = false;
  bool hasKeyDown_ = false;  ///< of a key that is neither a modifier nor produces a character
  std::set<int> keys_;
};

}  // namespace

bool ClickPairs::isSecond(const OsEvent &press) {
  constexpr double kWithin_s = 0.4, kWithin_px = 6.0;
  const bool isPair = button_ == press.button && press.time_s - time_s_ <= kWithin_s &&
                      std::hypot(press.x - x_, press.y - y_) <= kWithin_px;
  button_ = isPair ? 0 : press.button;
  x_ = press.x;
  y_ = press.y;
  time_s_ = press.time_s;
  return isPair;
}

std::vector<OsEvent> takeFrameEvents(std::vector<OsEvent> &queue, bool holdsTyping) {
  Frame frame;
  auto end = queue.begin();
  for (; end != queue.end(); ++end) {
    // The key and its character belong together.
    const auto next = std::next(end);
    const bool types = end->kind == Kind::keyDown && next != queue.end() && next->kind == Kind::character;
    if (holdsTyping && (end->kind == Kind::keyDown || end->kind == Kind::character)) break;
    if (frame.wouldLose(*end, types)) break;
    frame.take(*end, types);
  }
  std::vector<OsEvent> taken(std::make_move_iterator(queue.begin()), std::make_move_iterator(end));
  queue.erase(queue.begin(), end);
  return taken;
}

}  // namespace c3de::ui
