// SPDX-License-Identifier: Apache-2.0
// Rows of a property sheet: the name on the left, the control with its unit on the right.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "window/frame_context.h"

namespace c3de::ui {

/// What a field remembers between frames.
struct FieldState {
  bool isTyping = false;
  int typingFrames = 0;
  std::vector<char> buffer;
  std::string error;                      ///< why the last typed value was refused
  std::optional<std::string> chosenFile;  ///< waits for the widget to be drawn again
  double lastNumber = 0.0;                ///< goes back here when "auto" is switched off
  bool hasLastNumber = false;
  ParameterValue draft;  ///< of a vector that is being edited
  bool hasDraft = false;
};

/// Starts a row; the control follows and takes the width that is left after `reserved` pixels.
void beginRow(const FrameContext &frame, const std::string &label, const char *badge, bool isInline, float reserved);
/// Ends the row; the whole of it is the last item then.
void endRow();

struct NumberSpec {
  double low = 0.0, high = 1.0;  ///< range of the slider; low >= high: no slider, only typing
  bool isLogarithmic = false, isInteger = false, isEnabled = true;
  std::string unit;
  std::string shown;  ///< instead of the number, where not empty
};

/// A slider that can be typed into exactly (Ctrl+click). `check` says why a number is not accepted.
/// Returns C3DE_UI_*; `value` changes only to accepted numbers.
std::uint32_t numberField(const FrameContext &frame, const std::string &area, const std::string &id, FieldState &state,
                          const NumberSpec &spec, double &value, const std::function<Expected<void>(double)> &check);

/// A drop-down list; returns C3DE_UI_*.
std::uint32_t choiceField(const FrameContext &frame, const std::string &area, const std::string &id,
                          const std::vector<std::string> &names, std::uint32_t &index, bool isEnabled = true);

/// A square of a colour, as high as a field.
void swatch(const std::array<float, 3> &rgb);

/// The red line below a field whose typed value was refused.
void fieldError(const FrameContext &frame, const FieldState &state);

/// Short text of a number for a field; exact where that is short.
[[nodiscard]] std::string shortNumber(double value);

/// One row for a declared parameter. The new value, when a person has changed it.
[[nodiscard]] std::optional<ParameterValue> parameterField(const FrameContext &frame, const std::string &area,
                                                           FieldState &state, const ParameterDecl &decl,
                                                           const ParameterValue &value, bool isInline);

}  // namespace c3de::ui
