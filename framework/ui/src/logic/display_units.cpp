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
  bool isLarger = false;       ///< than the declared one, by 1000; otherwise smaller by 1000
};

constexpr double kThousand = 1000.0;

Change changeOf(const ParameterDecl &decl) {
  const double usual = std::max(std::abs(decl.softMin), std::abs(decl.softMax));
  constexpr double kLargestBody_m = 10.0;
  if (decl.unit == "Pa" && usual >= kThousand) return {"kPa", true};
  if (decl.unit == "m" && usual > 0.0 && usual <= kLargestBody_m) return {"mm", false};
  return {};
}

/// The decimal number that is meant: 8.5, not 8.500000000000002.
double decimal(double x) {
  if (!std::isfinite(x)) return x;
  char text[40];
  std::snprintf(text, sizeof text, "%.15g", x);
  return registry::parseNumber(text, {}).value_or(x);
}

double shownNumber(const Change &change, double x) { return decimal(change.isLarger ? x / kThousand : x * kThousand); }

// A division rounds once, so that a typed 2.5 mm is the same number as 0.0025 m in a scene.
double declaredNumber(const Change &change, double x) { return change.isLarger ? x * kThousand : x / kThousand; }

template <typename Convert>
ParameterValue converted(const ParameterDecl &declared, const ParameterValue &value, Convert &&convert) {
  const Change change = changeOf(declared);
  if (!change.unit || value.type == C3DE_PARAM_TEXT || value.type == C3DE_PARAM_CHOICE) return value;
  ParameterValue out = value;
  out.num = convert(change, value.num);
  for (double &x : out.vec) x = convert(change, x);
  return out;
}

}  // namespace

ParameterDecl shownDeclaration(const ParameterDecl &declared) {
  const Change change = changeOf(declared);
  if (!change.unit) return declared;
  ParameterDecl out = declared;
  out.unit = change.unit;
  for (double *x : {&out.min, &out.max, &out.softMin, &out.softMax, &out.fallback}) *x = shownNumber(change, *x);
  for (double &x : out.fallbackVec) x = shownNumber(change, x);
  return out;
}

ParameterValue shownValue(const ParameterDecl &declared, const ParameterValue &value) {
  return converted(declared, value, shownNumber);
}

ParameterValue declaredValue(const ParameterDecl &declared, const ParameterValue &shown) {
  return converted(declared, shown, declaredNumber);
}

std::optional<double> numberInUnit(std::string_view typed, std::string_view unit) {
  if (const auto number = registry::parseNumber(typed, unit)) return number;
  struct Other {
    std::string_view unit, name;
    double factor;
  };
  constexpr std::array kOthers{Other{"kPa", "Pa", 1e-3}, Other{"kPa", "MPa", 1e3}, Other{"kPa", "mmHg", 0.133322},
                               Other{"mm", "m", 1e3},    Other{"mm", "cm", 10.0},  Other{"ml", "l", 1e3}};
  for (const Other &other : kOthers) {
    if (other.unit != unit || !typed.ends_with(other.name)) continue;
    // Only a number with this unit: "5 cm" is not 5 c in metres.
    if (const auto number = registry::parseNumber(typed, other.name)) return decimal(*number * other.factor);
  }
  return std::nullopt;
}

}  // namespace c3de::ui
