// SPDX-License-Identifier: Apache-2.0
#include "logic/os_event.h"

#include "support/catch.h"

using namespace c3de::ui;
using Kind = OsEvent::Kind;

namespace {

OsEvent event(Kind kind, int key = 0) {
  OsEvent e;
  e.kind = kind;
  e.rawKey = key;
  return e;
}

std::vector<std::size_t> sizesOfFrames(std::vector<OsEvent> queue) {
  std::vector<std::size_t> sizes;
  while (!queue.empty()) sizes.push_back(takeFrameEvents(queue).size());
  return sizes;
}

}  // namespace

TEST_CASE("a click that comes at once takes two frames, and the move after a press another") {
  CHECK(sizesOfFrames({event(Kind::move), event(Kind::press), event(Kind::release)}) == std::vector<std::size_t>{2, 1});
  CHECK(sizesOfFrames({event(Kind::press), event(Kind::move), event(Kind::move), event(Kind::release)}) ==
        std::vector<std::size_t>{1, 3});
}

TEST_CASE("a key that goes down and up takes two frames, keys pressed together one") {
  CHECK(sizesOfFrames({event(Kind::keyDown, 1), event(Kind::keyDown, 2), event(Kind::keyUp, 2),
                       event(Kind::keyUp, 1)}) == std::vector<std::size_t>{2, 2});
  CHECK(sizesOfFrames({event(Kind::keyDown, 2), event(Kind::keyUp, 1)}) == std::vector<std::size_t>{1, 1});
  CHECK(sizesOfFrames({event(Kind::keyUp, 1), event(Kind::keyDown, 2)}) == std::vector<std::size_t>{2});
}

TEST_CASE("moves and other events without an effect on each other share a frame") {
  CHECK(sizesOfFrames({event(Kind::move), event(Kind::move), event(Kind::other), event(Kind::wheel),
                       event(Kind::wheel)}) == std::vector<std::size_t>{5});
}

TEST_CASE("two presses are a double click by the times they came at, however slow the frames are") {
  const auto press = [](double time_s, double x = 100.0, std::uint32_t button = 1) {
    OsEvent e = event(Kind::press);
    e.time_s = time_s;
    e.x = x;
    e.button = button;
    return e;
  };
  ClickPairs clicks;
  CHECK_FALSE(clicks.isSecond(press(10.0)));
  CHECK(clicks.isSecond(press(10.3)));
  CHECK_FALSE(clicks.isSecond(press(10.4)));  // a third starts again
  CHECK(clicks.isSecond(press(10.5)));
  CHECK_FALSE(clicks.isSecond(press(11.0)));
  CHECK_FALSE(clicks.isSecond(press(11.6)));            // too late
  CHECK_FALSE(clicks.isSecond(press(11.7, 120.0)));     // elsewhere
  CHECK_FALSE(clicks.isSecond(press(11.8, 120.0, 2)));  // another button
}

TEST_CASE("what is typed shares a frame, however fast it comes") {
  const OsEvent c = event(Kind::character);
  std::vector<OsEvent> typed;
  for (const int key : {1, 2, 2, 3})  // the same letter twice as well
    for (const OsEvent &e : {event(Kind::keyDown, key), c, event(Kind::keyUp, key)}) typed.push_back(e);
  CHECK(sizesOfFrames(typed) == std::vector<std::size_t>{12});
  // A capital letter: Shift needs no separate frame.
  OsEvent shift = event(Kind::keyDown, 9);
  shift.role = OsEvent::Role::shift;
  CHECK(sizesOfFrames({shift, event(Kind::keyDown, 1), c, event(Kind::keyUp, 1), event(Kind::keyUp, 9),
                       event(Kind::keyDown, 2), c}) == std::vector<std::size_t>{7});
}

TEST_CASE("Backspace between letters deletes the one before it, and Ctrl drops none") {
  const OsEvent c = event(Kind::character);
  CHECK(sizesOfFrames({event(Kind::keyDown, 1), c, event(Kind::keyUp, 1), event(Kind::keyDown, 8),
                       event(Kind::keyUp, 8), event(Kind::keyDown, 2), c}) == std::vector<std::size_t>{3, 1, 3});
  OsEvent control = event(Kind::keyDown, 9);
  control.role = OsEvent::Role::modifier;
  CHECK(sizesOfFrames({event(Kind::keyDown, 1), c, control, event(Kind::keyDown, 3)}) ==
        std::vector<std::size_t>{2, 2});
  // While it is held, it repeats automatically.
  OsEvent again = event(Kind::keyDown, 8);
  again.isRepeat = true;
  CHECK(sizesOfFrames({event(Kind::keyDown, 8), again, again}) == std::vector<std::size_t>{3});
}

TEST_CASE("what is typed waits for a field that is about to have the keyboard") {
  std::vector<OsEvent> queue{event(Kind::keyUp, 5), event(Kind::keyDown, 1), event(Kind::character),
                             event(Kind::keyUp, 1)};
  CHECK(takeFrameEvents(queue, true).size() == 1);
  CHECK(takeFrameEvents(queue, true).empty());
  CHECK(takeFrameEvents(queue, false).size() == 3);
}
