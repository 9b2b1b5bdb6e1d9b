// SPDX-License-Identifier: Apache-2.0
// Units in which the window shows quantities. Scenes, recordings, plugins and the command line keep theirs.
#pragma once

#include <string>
#include <string_view>

namespace c3de::ui {

/// With the first choice of each, quantities have the units in which they are computed, mm, kPa or Pa, and N.
struct DisplayUnits {
  enum class Length { mm, cm };
  enum class Pressure { kPa, mmHg, Pa };
  enum class Force { N, mN };
  Length length = Length::mm;
  Pressure pressure = Pressure::kPa;  ///< also of stresses and moduli
  Force force = Force::N;
  friend bool operator==(const DisplayUnits &, const DisplayUnits &) = default;
};

inline constexpr double kPascalPerMmHg = 133.322;

struct DisplayUnit {
  std::string name;
  double factor = 1.0;  ///< shown value / value
};
/// In which unit a quantity is shown whose unit is mm, kPa, Pa or N. Others are unchanged.
[[nodiscard]] DisplayUnit displayUnit(const DisplayUnits &units, std::string_view unit);
/// A text that is a number with one of these units, "12.3 mm", in the unit in which it is shown, with as many digits.
/// Other texts are unchanged.
[[nodiscard]] std::string shownText(const DisplayUnits &units, const std::string &text);

}  // namespace c3de::ui
