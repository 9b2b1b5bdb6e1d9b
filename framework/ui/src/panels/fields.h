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
#include "frame/frame_context.h"

namespace c3de::ui {

/// State of a field between frames.
struct FieldState {
  bool isTyping = false;
  int typingFrames = 0;
  std::vector<char> buffer;
  std::string error;                      ///< why the last typed value was refused
  std::optional<std::string> chosenFile;  ///< applied when the widget is drawn again
  double lastNumber = 0.0;                ///< restored when "auto" is switched off
  bool hasLastNumber = false;
  ParameterValue draft;  ///< of a vector that is being edited
  bool hasDraft = false;
};

/// Starts a row. The control that follows uses the width that remains after `reserved` pixels.
void beginRow(const FrameContext &frame, const std::string &label, const char *badge, bool isInline, float reserved);
/// Ends the row; all of it is then the last item.
void endRow();

struct NumberSpec {
  double low = 0.0, high = 1.0;  ///< range of the slider; low >= high: no slider, only typing
  bool isLogarithmic = false, isInteger = false, isEnabled = true;
  std::string unit;
  std::string shown;  ///< replaces the number, if not empty
};

/// A slider that also accepts typed values (Ctrl+click). `check` reports why a number is not accepted.
/// Returns C3DE_UI_*; `value` changes only to accepted numbers.
std::uint32_t numberField(const FrameContext &frame, const std::string &area, const std::string &id, FieldState &state,
                          const NumberSpec &spec, double &value, const std::function<Expected<void>(double)> &check);

/// A drop-down list; returns C3DE_UI_*.
std::uint32_t choiceField(const FrameContext &frame, const std::string &area, const std::string &id,
                          const std::vector<std::string> &names, std::uint32_t &index, bool isEnabled = true);

/// A coloured square, as high as a field.
void swatch(const std::array<float, 3> &rgb);

/// The red line below a field whose typed value was refused.
void fieldError(const FrameContext &frame, const FieldState &state);

/// Short text of a number for a field; exact if that is short.
[[nodiscard]] std::string shortNumber(double value);

/// One row for a declared parameter. Returns the new value if the user has changed it.
[[nodiscard]] std::optional<ParameterValue> parameterField(const FrameContext &frame, const std::string &area,
                                                           FieldState &state, const ParameterDecl &decl,
                                                           const ParameterValue &value, bool isInline);

}  // namespace c3de::ui
