// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "c3de/ui/display_units.h"

namespace c3de::ui {

/// Quantity that slices show of the tissue in colours.
enum class Overlay : std::uint32_t {
  none,
  shift,         ///< |u|
  volumeChange,  ///< det F - 1
  field          ///< a field that the simulator has at its points
};

/// Display form of a quantity: shown = factor * value + offset.
struct Quantity {
  std::string title, unit;
  double factor = 1.0, offset = 0.0;

  [[nodiscard]] double shown(double value) const { return factor * value + offset; }
  [[nodiscard]] double value(double shown) const { return (shown - offset) / factor; }
};
/// @param name, unit  of the field as the simulator reports it: "contact_pressure" in Pa is "contact pressure" in kPa
[[nodiscard]] Quantity quantityOf(Overlay overlay, const std::string &name = {}, const std::string &unit = {},
                                  const DisplayUnits &units = {});

/// Range of the colours, in the displayed unit.
struct OverlayRange {
  double low = 0.0, high = 10.0;
  friend bool operator==(const OverlayRange &, const OverlayRange &) = default;
};
/// "0 … 10 mm"
[[nodiscard]] std::string rangeText(const OverlayRange &range, const std::string &unit);

/// The next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 and 10 times a power of ten, for a positive number.
[[nodiscard]] double roundedUp(double value);

/// A range that follows the visible values but remains steady. It ends at a round number, grows as soon as a value is
/// beyond it, and shrinks once no value is beyond two fifths of it. It begins at 0. With negative values, or for a
/// signed quantity such as a change of volume, it extends as far below 0 as above.
class StableRange {
 public:
  /// @param low, high  bounds of nearly all values
  /// @param least      a smaller range shows only round-off
  void follow(double low, double high, bool isSigned, double least);
  void forget() { range_ = {0.0, 0.0}; }
  [[nodiscard]] const OverlayRange &range() const { return range_; }

 private:
  OverlayRange range_{0.0, 0.0};
};

}  // namespace c3de::ui
