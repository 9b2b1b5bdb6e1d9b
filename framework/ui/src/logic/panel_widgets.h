// SPDX-License-Identifier: Apache-2.0
// Widgets of the program's own panels. They return true if changed, or pressed.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "c3de/abi/panels.h"
#include "c3de/core/text.h"

namespace c3de::ui {

inline bool checkbox(const c3de_ui_v1 &ui, const std::string &id, const std::string &label, bool &value,
                     const char *tooltip) {
  std::uint32_t on = value ? 1 : 0;
  const bool isChanged = (ui.checkbox(ui.ctx, toAbi(id), toAbi(label), &on) & C3DE_UI_CHANGED) != 0;
  if (*tooltip) ui.tooltip(ui.ctx, toAbi(std::string_view(tooltip)));
  value = on != 0;
  return isChanged;
}

inline bool slider(const c3de_ui_v1 &ui, const char *id, const char *label, const std::string &unit, double &value,
                   double low, double high, const char *tooltip) {
  const bool isChanged =
      (ui.slider(ui.ctx, toAbi(std::string_view(id)), toAbi(std::string_view(label)), toAbi(unit), &value, low, high) &
       C3DE_UI_CHANGED) != 0;
  if (*tooltip) ui.tooltip(ui.ctx, toAbi(std::string_view(tooltip)));
  return isChanged;
}

inline bool choice(const c3de_ui_v1 &ui, const char *id, const char *label, std::uint32_t &index,
                   const std::vector<std::string> &names) {
  std::vector<c3de_str> texts;
  for (const std::string &name : names) texts.push_back(toAbi(name));
  return (ui.choice(ui.ctx, toAbi(std::string_view(id)), toAbi(std::string_view(label)), &index, texts.data(),
                    texts.size()) &
          C3DE_UI_CHANGED) != 0;
}

inline bool button(const c3de_ui_v1 &ui, const std::string &id, const std::string &label, bool isEnabled = true) {
  return (ui.button(ui.ctx, toAbi(id), toAbi(label), isEnabled ? 1 : 0) & C3DE_UI_COMMITTED) != 0;
}

inline bool inputText(const c3de_ui_v1 &ui, const char *id, const char *label, std::string &value) {
  std::array<char, 128> buffer{};
  std::copy_n(value.begin(), std::min(value.size(), buffer.size() - 1), buffer.begin());
  const bool isChanged = (ui.input_text(ui.ctx, toAbi(std::string_view(id)), toAbi(std::string_view(label)),
                                        buffer.data(), buffer.size()) &
                          C3DE_UI_CHANGED) != 0;
  if (isChanged) value = buffer.data();
  return isChanged;
}

inline void heading(const c3de_ui_v1 &ui, const char *text) { ui.heading(ui.ctx, toAbi(std::string_view(text))); }

inline void row(const c3de_ui_v1 &ui, const char *name, const std::string &value) {
  ui.value(ui.ctx, toAbi(std::string_view(name)), toAbi(value));
}

inline void text(const c3de_ui_v1 &ui, const std::string &shown) { ui.text(ui.ctx, toAbi(shown)); }
inline void sameLine(const c3de_ui_v1 &ui) { ui.same_line(ui.ctx); }
inline void tooltip(const c3de_ui_v1 &ui, const char *shown) { ui.tooltip(ui.ctx, toAbi(std::string_view(shown))); }

}  // namespace c3de::ui
