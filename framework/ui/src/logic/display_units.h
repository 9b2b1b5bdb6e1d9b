// SPDX-License-Identifier: Apache-2.0
// Units in which panels show parameters. Scenes, recordings and plugins keep the declared unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "c3de/core/parameter.h"

namespace c3de::ui {

/// The declaration as a panel shows it: kPa for a stiffness or pressure in Pa, mm for a length in m. Others are
/// unchanged, and so are values whose usual range is too small or too large for that unit.
[[nodiscard]] ParameterDecl shownDeclaration(const ParameterDecl &declared);
/// A value of `declared` in the unit of shownDeclaration(), and back. Texts such as "auto" are unchanged.
[[nodiscard]] ParameterValue shownValue(const ParameterDecl &declared, const ParameterValue &value);
[[nodiscard]] ParameterValue declaredValue(const ParameterDecl &declared, const ParameterValue &shown);

/// A typed number in `unit`. Another unit of the same quantity may follow it: Pa, MPa or mmHg for kPa, m or cm for mm,
/// l for ml. Empty: it is no number, or has an unknown unit.
[[nodiscard]] std::optional<double> numberInUnit(std::string_view typed, std::string_view unit);

}  // namespace c3de::ui
