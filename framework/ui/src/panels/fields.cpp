// SPDX-License-Identifier: Apache-2.0
#include "panels/fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "c3de/abi/panels.h"
#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/registry/number_text.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/plain_words.h"
#include "logic/display_units.h"

namespace c3de::ui {
namespace {

constexpr std::size_t kTypedCapacity = 128;

/// The slider works on 0 … 1, so that its scale and rounding are defined here and do not depend on the displayed text.
double fractionOf(const NumberSpec &spec, double value) {
  if (!std::isfinite(value)) return 0.0;
  if (spec.isLogarithmic && value <= spec.low) return 0.0;
  const double t = spec.isLogarithmic ? std::log(value / spec.low) / std::log(spec.high / spec.low)
                                      : (value - spec.low) / (spec.high - spec.low);
  return std::clamp(t, 0.0, 1.0);
}

/// Rounded to a resolution that a user can set: three digits of the value, or a thousandth of the range.
double valueOf(const NumberSpec &spec, double t) {
  if (t <= 0.0) return spec.low;
  if (t >= 1.0) return spec.high;
  const double raw =
      spec.isLogarithmic ? spec.low * std::pow(spec.high / spec.low, t) : spec.low + t * (spec.high - spec.low);
  if (spec.isInteger) return std::round(raw);
  const double digit = spec.isLogarithmic ? std::pow(10.0, std::floor(std::log10(std::abs(raw))) - 2.0)
                                          : std::pow(10.0, std::floor(std::log10(spec.high - spec.low)) - 3.0);
  const double rounded = std::round(raw / digit) * digit;
  // Rounded via text, so that 0.30000000000000004 becomes 0.3.
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", rounded);
  return std::clamp(registry::parseNumber(text, {}).value_or(rounded), spec.low, spec.high);
}

std::string literalFormat(const std::string &text) {
  std::string format;
  for (const char c : text) {
    format += c;
    if (c == '%') format += c;
  }
  return format;
}

/// Draws the slider as a bar behind its number: a grab in front of the number would hide it.
void pushBar(float fraction) {
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const ImVec2 max(min.x + ImGui::CalcItemWidth(), min.y + ImGui::GetFrameHeight());
  const bool isHovered = ImGui::IsMouseHoveringRect(min, max) && ImGui::IsWindowHovered();
  ImDrawList *list = ImGui::GetWindowDrawList();
  const float rounding = ImGui::GetStyle().FrameRounding, edge = min.x + fraction * (max.x - min.x);
  list->AddRectFilled(min, max, ImGui::GetColorU32(isHovered ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), rounding);
  if (fraction > 0.0f) {
    list->PushClipRect(min, ImVec2(edge, max.y), true);
    list->AddRectFilled(min, max, ImGui::GetColorU32(isHovered ? colour::kFilledHovered : colour::kFilled), rounding);
    list->PopClipRect();
    list->AddRectFilled(ImVec2(edge - 2.0f, min.y + 1.0f), ImVec2(edge, max.y - 1.0f),
                        ImGui::GetColorU32(colour::kAccent), 1.0f);
  }
  for (const ImGuiCol hidden : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive, ImGuiCol_SliderGrab,
                                ImGuiCol_SliderGrabActive})
    ImGui::PushStyleColor(hidden, ImVec4(0, 0, 0, 0));
}

void startTyping(FieldState &state, const std::string &text) {
  state.isTyping = true;
  state.typingFrames = 0;
  state.buffer.assign(std::max(kTypedCapacity, text.size() + 1), '\0');
  registry::copyText(state.buffer.data(), state.buffer.size(), text);
  state.error.clear();
}

std::uint32_t typedField(FieldState &state, const NumberSpec &spec, double &value,
                         const std::function<Expected<void>(double)> &check) {
  if (state.typingFrames == 0) ImGui::SetKeyboardFocusHere();
  const bool isEntered = ImGui::InputText("##typed", state.buffer.data(), state.buffer.size(),
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  const bool isActive = ImGui::IsItemActive();
  const bool isLeft = ImGui::IsItemDeactivated();
  ++state.typingFrames;
  if (isActive && !isEntered) return C3DE_UI_ACTIVE;
  if (!isEntered && !isLeft && state.typingFrames < 4) return 0;

  // Escape has restored the initial text, which changes nothing.
  state.isTyping = false;
  const std::string typed(registry::bufferText(state.buffer.data(), state.buffer.size()));
  const auto number = numberInUnit(typed, spec.unit);
  if (!number) {
    state.error = typed + ": not a number; write for example 0.3 or 5e3";
    return 0;
  }
  if (auto accepted = check(*number); !accepted) {
    state.error = accepted.error().message;
    return 0;
  }
  if (*number == value) return 0;
  value = *number;
  return C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
}

}  // namespace

std::string shortNumber(double value) {
  std::string text = formatNumber(value);
  if (text.size() <= 8) return text;
  char shortened[32];
  std::snprintf(shortened, sizeof shortened, "%.5g", value);
  return shortened;
}

void beginRow(const FrameContext &frame, const std::string &label, const char *badge, bool isInline, float reserved) {
  ImGui::BeginGroup();
  const float available = ImGui::GetContentRegionAvail().x;
  const float labelWidth = isInline ? available : std::floor(0.42f * available);
  const float badgeWidth = badge ? ImGui::CalcTextSize(badge).x + frame.theme.px(4.0f) : 0.0f;
  if (!label.empty()) {
    ImGui::AlignTextToFramePadding();
    const std::string shown = elided(label, labelWidth - badgeWidth - frame.theme.px(6.0f));
    ImGui::TextUnformatted(shown.c_str());
    if (badge) {
      ImGui::SameLine(0.0f, frame.theme.px(4.0f));
      ImGui::TextColored(colour::kWarn, "%s", badge);
    }
    if (isInline)
      ImGui::SameLine();
    else
      ImGui::SameLine(labelWidth);  // from the start of the group
  }
  const float width = ImGui::GetContentRegionAvail().x - reserved;
  ImGui::SetNextItemWidth(std::max(width, frame.theme.px(isInline ? 80.0f : 40.0f)));
}

void endRow() { ImGui::EndGroup(); }

std::uint32_t numberField(const FrameContext &frame, const std::string &area, const std::string &id, FieldState &state,
                          const NumberSpec &spec, double &value, const std::function<Expected<void>(double)> &check) {
  const std::string shown = !spec.shown.empty() ? spec.shown
                            : spec.unit.empty() ? shortNumber(value)
                                                : shortNumber(value) + " " + spec.unit;
  std::uint32_t result = 0;
  ImGui::PushID(id.c_str());
  if (state.isTyping && spec.isEnabled) {
    result = typedField(state, spec, value, check);
  } else {
    ImGui::BeginDisabled(!spec.isEnabled);
    const bool hasRange =
        spec.low < spec.high && std::isfinite(spec.high - spec.low) && (!spec.isLogarithmic || spec.low > 0.0);
    double t = hasRange ? fractionOf(spec, value) : 0.0;
    const double low = 0.0, high = 1.0;
    const std::string format = literalFormat(shown);
    pushBar(hasRange && spec.isEnabled ? static_cast<float>(t) : 0.0f);
    const bool isMoved = ImGui::SliderScalar("##slider", ImGuiDataType_Double, &t, &low, &high, format.c_str(),
                                             ImGuiSliderFlags_NoInput);
    ImGui::PopStyleColor(5);
    const bool isTypingAsked = ImGui::IsItemClicked() && (ImGui::GetIO().KeyCtrl || !hasRange);
    if (isTypingAsked) {
      startTyping(state, spec.unit.empty() ? formatNumber(value) : formatNumber(value) + " " + spec.unit);
    } else if (isMoved && hasRange) {
      const double moved = valueOf(spec, t);
      if (moved != value && check(moved)) {
        value = moved;
        state.error.clear();
        result |= C3DE_UI_CHANGED;
      }
    }
    if (ImGui::IsItemActive()) result |= C3DE_UI_ACTIVE;
    if (ImGui::IsItemDeactivatedAfterEdit()) result |= C3DE_UI_COMMITTED;
    ImGui::EndDisabled();
  }
  ImGui::PopID();
  markItem(frame, area, id, spec.isEnabled);
  frame.automation.value(area, id, shown);
  return result;
}

namespace {
// Choices are displayed as words; files and scripts still use the name.
std::string readable(const std::string &name) { return imaging::readableName(name); }
}  // namespace

std::uint32_t choiceField(const FrameContext &frame, const std::string &area, const std::string &id,
                          const std::vector<std::string> &names, std::uint32_t &index, bool isEnabled) {
  std::uint32_t result = 0;
  const std::string shown = index < names.size() ? names[index] : std::string("–");
  ImGui::PushID(id.c_str());
  ImGui::BeginDisabled(!isEnabled || names.empty());
  const bool isOpen = ImGui::BeginCombo("##choice", readable(shown).c_str(), ImGuiComboFlags_HeightLarge);
  markOpener(frame, area, id, isOpen, isEnabled && !names.empty());
  if (isOpen) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      const bool isSelected = i == index;
      if (ImGui::Selectable(names[i].empty() ? " " : readable(names[i]).c_str(), isSelected) && !isSelected) {
        index = static_cast<std::uint32_t>(i);
        result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
      }
      markItem(frame, area, id + ".option." + names[i]);
      if (isSelected) ImGui::SetItemDefaultFocus();
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  ImGui::PopID();
  frame.automation.value(area, id, shown);
  return result;
}

void swatch(const std::array<float, 3> &rgb) {
  const float side = ImGui::GetFrameHeight(), inset = 0.2f * side;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::Dummy(ImVec2(side - inset, side));
  ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, at.y + inset),
                                            ImVec2(at.x + side - 2.0f * inset, at.y + side - inset),
                                            ImGui::GetColorU32(ImVec4(rgb[0], rgb[1], rgb[2], 1.0f)), 2.0f);
}

void fieldError(const FrameContext &frame, const FieldState &state) {
  if (state.error.empty()) return;
  ImGui::PushFont(frame.theme.small);
  ImGui::PushStyleColor(ImGuiCol_Text, colour::kError);
  const registry::ParameterRegistry *parameters = frame.services.parameters;
  ImGui::TextWrapped("%s", (parameters ? registry::plainWords(state.error, *parameters) : state.error).c_str());
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

}  // namespace c3de::ui
