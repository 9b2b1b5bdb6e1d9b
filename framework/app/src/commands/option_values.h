// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// Numbers of the command line as people write them: decimal, with a point whatever the locale, finite, and nothing
/// behind. The error says the range that is accepted. @param unit  "s", or empty
[[nodiscard]] Expected<double> parseDecimal(std::string_view text, double least, double most, std::string_view unit);
/// The same without a point or an exponent.
[[nodiscard]] Expected<long long> parseWhole(std::string_view text, long long least, long long most);

struct PictureSize {
  int width = 0, height = 0;
};
/// "1280x720"
[[nodiscard]] Expected<PictureSize> parseSize(std::string_view text);

}  // namespace c3de::app
