// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/abi/iface/simulator.h"

namespace c3de::ui {
namespace {

constexpr double kShrinkBelow = 0.4;  // fraction of the range

struct ShownUnit {
  const char *si, *shown;
  double factor;
};
constexpr std::array kShownUnits{ShownUnit{"Pa", "kPa", 1e-3}, ShownUnit{"m", "mm", 1e3}, ShownUnit{"m/s", "mm/s", 1e3},
                                 ShownUnit{"1", "", 1.0}};

}  // namespace

Quantity quantityOf(Overlay overlay, const std::string &name, const std::string &unit, const DisplayUnits &units) {
  if (overlay == Overlay::none) return {};
  Quantity quantity{name, unit};
  if (overlay == Overlay::shift) quantity = {"|u|", "mm"};
  if (overlay == Overlay::volumeChange) return {"volume change", "%", 100.0, -100.0};
  if (overlay == Overlay::field && name == C3DE_SIM_FIELD_EQUIVALENT_STRESS) quantity.title = "equivalent stress";
  std::replace(quantity.title.begin(), quantity.title.end(), '_', ' ');
  if (overlay == Overlay::field)
    for (const ShownUnit &one : kShownUnits)
      if (unit == one.si) quantity.unit = one.shown, quantity.factor = one.factor;
  const DisplayUnit shown = displayUnit(units, quantity.unit);
  quantity.unit = shown.name;
  quantity.factor *= shown.factor;
  return quantity;
}

std::string rangeText(const OverlayRange &range, const std::string &unit) {
  return fmt::format("{:.4g} … {:.4g}{}{}", range.low, range.high, unit.empty() ? "" : " ", unit);
}

double roundedUp(double value) {
  constexpr std::array kSteps{1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0};
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : kSteps)
    if (value <= step * power * (1.0 + 1e-12)) return step * power;
  return 10.0 * power;
}

void StableRange::follow(double low, double high, bool isSigned, double least) {
  const bool isBelow = isSigned || low < -least;
  const double most = std::max({isBelow ? std::abs(low) : 0.0, high, least});
  if (!std::isfinite(most)) return;
  const bool isNew = range_.high == 0.0 || isBelow != (range_.low < 0.0);
  if (isNew || most > range_.high || most < kShrinkBelow * range_.high) range_.high = roundedUp(most);
  range_.low = isBelow ? -range_.high : 0.0;
}

}  // namespace c3de::ui
