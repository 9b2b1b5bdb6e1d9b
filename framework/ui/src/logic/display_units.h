// SPDX-License-Identifier: Apache-2.0
// Units in which panels show parameters. Scenes, recordings and plugins keep the declared unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "c3de/core/parameter.h"
#include "c3de/ui/display_units.h"

namespace c3de::ui {

/// The declaration as a panel shows it: a stiffness or pressure in Pa, a length in m or mm and a force in N in the unit
/// of the user. Others are unchanged. So are pressures whose usual range is too small for kPa, and lengths whose usual
/// range is too large.
[[nodiscard]] ParameterDecl shownDeclaration(const ParameterDecl &declared, const DisplayUnits &units = {});
/// A value of `declared` in the unit of shownDeclaration(), and back. Texts such as "auto" are unchanged.
[[nodiscard]] ParameterValue shownValue(const ParameterDecl &declared, const ParameterValue &value,
                                        const DisplayUnits &units = {});
[[nodiscard]] ParameterValue declaredValue(const ParameterDecl &declared, const ParameterValue &shown,
                                           const DisplayUnits &units = {});

/// A typed number in `unit`. Another unit of the same quantity may follow it: "5 cm" for mm, "9 kPa" for mmHg, "2 l" for
/// ml. Empty: it is no number, or has an unknown unit.
[[nodiscard]] std::optional<double> numberInUnit(std::string_view typed, std::string_view unit);

}  // namespace c3de::ui
