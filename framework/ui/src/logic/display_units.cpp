// SPDX-License-Identifier: Apache-2.0
#include "logic/display_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "c3de/registry/number_text.h"

namespace c3de::ui {
namespace {

struct Change {
  const char *unit = nullptr;  ///< null: the declared one
  double ratio = 1.0;          ///< of the two units, above 1
  bool isLarger = false;       ///< than the declared one; otherwise smaller
};

constexpr double kThousand = 1000.0;

Change changeOf(const ParameterDecl &decl, const DisplayUnits &units) {
  using Pressure = DisplayUnits::Pressure;
  const double usual = std::max(std::abs(decl.softMin), std::abs(decl.softMax));
  constexpr double kLargestBody_m = 10.0, kHundred = 100.0, kTen = 10.0;
  const bool isCentimetre = units.length == DisplayUnits::Length::cm;
  if (decl.unit == "Pa" && units.pressure == Pressure::mmHg) return {"mmHg", kPascalPerMmHg, true};
  if (decl.unit == "Pa" && units.pressure == Pressure::kPa && usual >= kThousand) return {"kPa", kThousand, true};
  if (decl.unit == "m" && usual > 0.0 && usual <= kLargestBody_m)
    return isCentimetre ? Change{"cm", kHundred, false} : Change{"mm", kThousand, false};
  if (decl.unit == "mm" && isCentimetre) return {"cm", kTen, true};
  if (decl.unit == "N" && units.force == DisplayUnits::Force::mN) return {"mN", kThousand, false};
  return {};
}

/// The decimal number that is meant: 8.5, not 8.500000000000002.
double decimal(double x) {
  if (!std::isfinite(x)) return x;
  char text[40];
  std::snprintf(text, sizeof text, "%.15g", x);
  return registry::parseNumber(text, {}).value_or(x);
}

double shownNumber(const Change &change, double x) {
  return decimal(change.isLarger ? x / change.ratio : x * change.ratio);
}

// A division rounds once, so that a typed 2.5 mm is the same number as 0.0025 m in a scene.
double declaredNumber(const Change &change, double x) { return change.isLarger ? x * change.ratio : x / change.ratio; }

template <typename Convert>
ParameterValue converted(const Change &change, const ParameterValue &value, Convert &&convert) {
  if (!change.unit || value.type == C3DE_PARAM_TEXT || value.type == C3DE_PARAM_CHOICE) return value;
  ParameterValue out = value;
  out.num = convert(change, value.num);
  for (double &x : out.vec) x = convert(change, x);
  return out;
}

}  // namespace

ParameterDecl shownDeclaration(const ParameterDecl &declared, const DisplayUnits &units) {
  const Change change = changeOf(declared, units);
  if (!change.unit) return declared;
  ParameterDecl out = declared;
  out.unit = change.unit;
  for (double *x : {&out.min, &out.max, &out.softMin, &out.softMax, &out.fallback}) *x = shownNumber(change, *x);
  for (double &x : out.fallbackVec) x = shownNumber(change, x);
  return out;
}

ParameterValue shownValue(const ParameterDecl &declared, const ParameterValue &value, const DisplayUnits &units) {
  return converted(changeOf(declared, units), value, shownNumber);
}

ParameterValue declaredValue(const ParameterDecl &declared, const ParameterValue &shown, const DisplayUnits &units) {
  return converted(changeOf(declared, units), shown, declaredNumber);
}

std::optional<double> numberInUnit(std::string_view typed, std::string_view unit) {
  if (const auto number = registry::parseNumber(typed, unit)) return number;
  struct Unit {
    std::string_view name, quantity;
    double size;  ///< in the unit of its quantity
  };
  constexpr std::array kUnits{Unit{"kPa", "Pa", 1e3}, Unit{"MPa", "Pa", 1e6}, Unit{"mmHg", "Pa", kPascalPerMmHg},
                              Unit{"Pa", "Pa", 1.0},  Unit{"mm", "mm", 1.0},  Unit{"cm", "mm", 10.0},
                              Unit{"m", "mm", 1e3},   Unit{"ml", "ml", 1.0},  Unit{"l", "ml", 1e3},
                              Unit{"mN", "mN", 1.0},  Unit{"N", "mN", 1e3}};
  const auto *const wanted = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit &u) { return u.name == unit; });
  if (wanted == kUnits.end()) return std::nullopt;
  for (const Unit &other : kUnits) {
    if (other.quantity != wanted->quantity || !typed.ends_with(other.name)) continue;
    // Only a number with this unit: "5 cm" is not 5 c in metres.
    if (const auto number = registry::parseNumber(typed, other.name))
      return decimal(other.size < wanted->size ? *number / (wanted->size / other.size)
                                               : *number * (other.size / wanted->size));
  }
  return std::nullopt;
}

}  // namespace c3de::ui
