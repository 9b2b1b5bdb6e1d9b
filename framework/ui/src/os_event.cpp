// SPDX-License-Identifier: Apache-2.0
#include "os_event.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace c3de::ui {

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

std::vector<OsEvent> takeFrameEvents(std::vector<OsEvent> &queue) {
  using Kind = OsEvent::Kind;
  bool hasButton = false, hasWheel = false, hasCharacter = false, hasKeyDown = false;
  std::set<int> keys;
  const auto wouldBeLost = [&](const OsEvent &event) {
    switch (event.kind) {
      case Kind::move: return hasButton || hasWheel || !keys.empty();
      case Kind::press:
      case Kind::release: return hasButton || hasWheel || !keys.empty();
      case Kind::wheel: return hasButton;
      case Kind::keyDown: return hasButton || hasCharacter || keys.contains(event.rawKey);
      // Also of another key: A of Ctrl+A must be seen while Ctrl is still down.
      case Kind::keyUp: return hasButton || hasKeyDown;
      case Kind::character: return hasButton;
      default: return false;
    }
  };
  auto end = queue.begin();
  for (; end != queue.end() && !wouldBeLost(*end); ++end) {
    hasButton = hasButton || end->kind == Kind::press || end->kind == Kind::release;
    hasWheel = hasWheel || end->kind == Kind::wheel;
    hasKeyDown = hasKeyDown || end->kind == Kind::keyDown;
    hasCharacter = hasCharacter || end->kind == Kind::character;
    if (end->kind == Kind::keyDown || end->kind == Kind::keyUp) keys.insert(end->rawKey);
  }
  std::vector<OsEvent> taken(std::make_move_iterator(queue.begin()), std::make_move_iterator(end));
  queue.erase(queue.begin(), end);
  return taken;
}

}  // namespace c3de::ui
