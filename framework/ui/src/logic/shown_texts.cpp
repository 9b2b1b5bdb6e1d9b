// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/registry/number_text.h"
#include "c3de/ui/display_units.h"

namespace c3de::ui {
namespace {

/// Digits behind the decimal point with which the changed number is as exact as the text.
int decimalsFor(std::string_view number, double factor) {
  const std::size_t point = number.find('.');
  const auto written = point == std::string_view::npos ? 0 : static_cast<int>(number.size() - point - 1);
  return std::max(written - static_cast<int>(std::floor(std::log10(factor) + 1e-9)), 0);
}

}  // namespace

DisplayUnit displayUnit(const DisplayUnits &units, std::string_view unit) {
  using Pressure = DisplayUnits::Pressure;
  constexpr double kThousandfold = 1000.0;
  if (unit == "mm" && units.length == DisplayUnits::Length::cm) return {"cm", 0.1};
  if (unit == "N" && units.force == DisplayUnits::Force::mN) return {"mN", kThousandfold};
  if (unit == "kPa" && units.pressure == Pressure::Pa) return {"Pa", kThousandfold};
  if (unit == "kPa" && units.pressure == Pressure::mmHg) return {"mmHg", kThousandfold / kPascalPerMmHg};
  if (unit == "Pa" && units.pressure == Pressure::mmHg) return {"mmHg", 1.0 / kPascalPerMmHg};
  return {std::string(unit), 1.0};
}

std::string shownText(const DisplayUnits &units, const std::string &text) {
  const std::size_t space = text.find(' ');
  if (space == std::string::npos || units == DisplayUnits()) return text;
  const std::string number = text.substr(0, space);
  const DisplayUnit shown = displayUnit(units, text.substr(space + 1));
  const auto value = registry::parseNumber(number, {});
  if (!value || shown.factor == 1.0) return text;
  if (number.find_first_of("eE") != std::string::npos)
    return fmt::format("{:.4g} {}", *value * shown.factor, shown.name);
  return fmt::format("{:.{}f} {}", *value * shown.factor, decimalsFor(number, shown.factor), shown.name);
}

}  // namespace c3de::ui
