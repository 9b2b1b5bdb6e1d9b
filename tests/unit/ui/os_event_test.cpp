// SPDX-License-Identifier: Apache-2.0
#include "os_event.h"

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
  CHECK(sizesOfFrames({event(Kind::keyDown, 1), event(Kind::keyDown, 2), event(Kind::keyUp, 2), event(Kind::keyUp, 1)}) ==
        std::vector<std::size_t>{2, 2});
  CHECK(sizesOfFrames({event(Kind::keyDown, 1), event(Kind::character), event(Kind::keyUp, 1)}) ==
        std::vector<std::size_t>{2, 1});
  CHECK(sizesOfFrames({event(Kind::keyDown, 2), event(Kind::keyUp, 1)}) == std::vector<std::size_t>{1, 1});
  CHECK(sizesOfFrames({event(Kind::keyUp, 1), event(Kind::keyDown, 2)}) == std::vector<std::size_t>{2});
}

TEST_CASE("moves and other events without an effect on each other share a frame") {
  CHECK(sizesOfFrames({event(Kind::move), event(Kind::move), event(Kind::other), event(Kind::wheel), event(Kind::wheel)}) ==
        std::vector<std::size_t>{5});
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
  CHECK_FALSE(clicks.isSecond(press(10.4)));  // a third begins anew
  CHECK(clicks.isSecond(press(10.5)));
  CHECK_FALSE(clicks.isSecond(press(11.0)));
  CHECK_FALSE(clicks.isSecond(press(11.6)));  // too late
  CHECK_FALSE(clicks.isSecond(press(11.7, 120.0)));  // elsewhere
  CHECK_FALSE(clicks.isSecond(press(11.8, 120.0, 2)));  // another button
}
