// SPDX-License-Identifier: Apache-2.0
#include "logic/window_size.h"

#include <limits>

#include "support/catch.h"

using c3de::ui::sizeThatFits;
using Size = std::array<int, 2>;

TEST_CASE("a window is no larger than its screen, also where each unit is several pixels") {
  CHECK(sizeThatFits({1280, 800}, {1920, 1040}, {1.0f, 1.0f}) == Size{1280, 800});
  CHECK(sizeThatFits({3000, 2000}, {1920, 1040}, {1.0f, 1.0f}) == Size{1920, 1040});
  // Enlarged by two, 1280 x 800 would be 2560 x 1600 pixels.
  CHECK(sizeThatFits({1280, 800}, {2560, 1500}, {2.0f, 2.0f}) == Size{1280, 750});
  CHECK(sizeThatFits({1280, 800}, {1920, 1080}, {2.0f, 2.0f}) == Size{960, 540});
  CHECK(sizeThatFits({1280, 800}, {1920, 1080}, {1.5f, 1.5f}) == Size{1280, 720});
  for (const float scale : {1.0f, 1.25f, 1.5f, 2.0f, 3.0f}) {
    const Size size = sizeThatFits({1500, 1100}, {1920, 1043}, {scale, scale});
    CHECK(static_cast<float>(size[0]) * scale <= 1920.0f);
    CHECK(static_cast<float>(size[1]) * scale <= 1043.0f);
  }
}

TEST_CASE("a screen of which nothing is known limits nothing") {
  CHECK(sizeThatFits({1280, 800}, {0, 0}, {1.0f, 1.0f}) == Size{1280, 800});
  CHECK(sizeThatFits({1280, 800}, {1000, 1000}, {0.0f, std::numeric_limits<float>::quiet_NaN()}) == Size{1000, 800});
  CHECK(sizeThatFits({1280, 800}, {1, 1}, {4.0f, 4.0f}) == Size{1, 1});
}
