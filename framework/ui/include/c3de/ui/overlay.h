// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace c3de::ui {

/// What slices show of the tissue in colours.
enum class Overlay : std::uint32_t {
  none,
  shift,         ///< |u|
  volumeChange,  ///< det F - 1
  field          ///< one that the simulator has at its points
};

/// How a quantity is written for people: shown = factor * value + offset.
struct Quantity {
  std::string title, unit;
  double factor = 1.0, offset = 0.0;

  [[nodiscard]] double shown(double value) const { return factor * value + offset; }
  [[nodiscard]] double value(double shown) const { return (shown - offset) / factor; }
};
/// @param name, unit  of the field, as the simulator calls it: "contact_pressure" in Pa is "contact pressure" in kPa
[[nodiscard]] Quantity quantityOf(Overlay overlay, const std::string &name = {}, const std::string &unit = {});

/// Of what is shown in colours, in the unit that is shown.
struct OverlayRange {
  double low = 0.0, high = 10.0;
  friend bool operator==(const OverlayRange &, const OverlayRange &) = default;
};
/// "0 … 10 mm"
[[nodiscard]] std::string rangeText(const OverlayRange &range, const std::string &unit);

/// The next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 and 10 times a power of ten; of a positive number.
[[nodiscard]] double roundedUp(double value);

/// A range that follows what is seen and stays as it is meanwhile: it ends at a round number, grows as soon as
/// something is beyond, and shrinks once nothing is beyond two fifths of it. From 0; where something is negative, or
/// signed as a change of volume is, as far below 0 as above.
class SteadyRange {
 public:
  /// @param low, high  that nearly everything is between
  /// @param least  below it a range shows nothing but round-off
  void follow(double low, double high, bool isSigned, double least);
  void forget() { range_ = {0.0, 0.0}; }
  [[nodiscard]] const OverlayRange &range() const { return range_; }

 private:
  OverlayRange range_{0.0, 0.0};
};

}  // namespace c3de::ui
