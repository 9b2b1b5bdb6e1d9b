// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "c3de/abi/panels.h"
#include "c3de/core/text.h"
#include "c3de/registry/number_text.h"
#include "panels/fields.h"

namespace c3de::ui {
namespace {

std::string withUnit(const std::string &text, const std::string &unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string fallbackText(const ParameterDecl &decl) {
  const ParameterValue value = decl.fallbackValue();
  if (value.type == C3DE_PARAM_TEXT || value.type == C3DE_PARAM_CHOICE) return value.text;
  return withUnit(value.display(), decl.unit);
}

std::string documentation(const ParameterDecl &decl) {
  std::string text = decl.doc;
  if (!text.empty()) text += "\n\n";
  text += "Accepted: " + decl.accepted() + "\nDefault: " + fallbackText(decl);
  if (decl.flags & C3DE_PARAM_NEEDS_RESET) text += "\nApplies when the body is built again.";
  if (decl.type == C3DE_PARAM_F64 || decl.type == C3DE_PARAM_I64) text += "\nCtrl+click to type an exact value.";
  return text + "\n" + decl.id;
}

/// The number to use when "auto" is switched off.
double numberAfterAuto(const FieldState &state, const ParameterDecl &decl) {
  const auto accepted = [&](double x) {
    ParameterValue v;
    v.id = decl.id;
    v.type = decl.type;
    v.num = x;
    return checkParameter(decl, v).has_value();
  };
  if (state.hasLastNumber && accepted(state.lastNumber)) return state.lastNumber;
  const double middle = decl.softMin > 0.0 && (decl.flags & C3DE_PARAM_LOG_SCALE)
                            ? std::sqrt(decl.softMin * decl.softMax)
                            : 0.5 * (decl.softMin + decl.softMax);
  for (const double x : {decl.fallback, middle, decl.softMin, decl.softMax})
    if (accepted(x)) return x;
  return decl.fallback;
}

std::optional<ParameterValue> numberParameter(const FrameContext &frame, const std::string &area, FieldState &state,
                                              const ParameterDecl &decl, const ParameterValue &value) {
  std::optional<ParameterValue> changed;
  const bool mayBeAuto = (decl.flags & C3DE_PARAM_AUTO) != 0;
  const bool isAuto = mayBeAuto && value.type == C3DE_PARAM_TEXT;
  if (!isAuto) {
    state.lastNumber = value.num;
    state.hasLastNumber = true;
  }

  NumberSpec spec;
  spec.low = decl.softMin;
  spec.high = decl.softMax;
  if (!(spec.low < spec.high) && decl.min < decl.max && std::isfinite(decl.max - decl.min)) {
    spec.low = decl.min;
    spec.high = decl.max;
  }
  spec.isLogarithmic = (decl.flags & C3DE_PARAM_LOG_SCALE) && spec.low > 0.0;
  spec.isInteger = decl.type == C3DE_PARAM_I64;
  spec.isEnabled = !isAuto;
  spec.unit = decl.unit;
  if (isAuto) spec.shown = "auto";

  double number = isAuto ? numberAfterAuto(state, decl) : value.num;
  ParameterValue wanted;
  wanted.id = decl.id;
  wanted.type = decl.type;
  const auto check = [&](double x) {
    ParameterValue tried = wanted;
    tried.num = x;
    return checkParameter(decl, tried);
  };
  if (numberField(frame, area, decl.id, state, spec, number, check) & C3DE_UI_CHANGED) {
    wanted.num = number;
    changed = wanted;
  }
  if (mayBeAuto) {
    ImGui::SameLine();
    bool isChecked = isAuto;
    if (ImGui::Checkbox("auto", &isChecked)) {
      wanted.type = isChecked ? C3DE_PARAM_TEXT : decl.type;
      wanted.text = isChecked ? "auto" : "";
      wanted.num = numberAfterAuto(state, decl);
      changed = wanted;
      state.error.clear();
    }
    markItem(frame, area, decl.id + ".auto");
  }
  return changed;
}

std::optional<ParameterValue> textParameter(const FrameContext &frame, const std::string &area, FieldState &state,
                                            const ParameterDecl &decl, const ParameterValue &value) {
  constexpr std::size_t kCapacity = 512;
  if (!state.isTyping) {
    state.buffer.assign(std::max(kCapacity, value.text.size() + 1), '\0');
    registry::copyText(state.buffer.data(), state.buffer.size(), value.text);
  }
  ImGui::InputText("##text", state.buffer.data(), state.buffer.size());
  state.isTyping = ImGui::IsItemActive();
  const bool isLeft = ImGui::IsItemDeactivatedAfterEdit();
  markItem(frame, area, decl.id);
  frame.automation.value(area, decl.id, value.text);
  if (!isLeft) return std::nullopt;
  ParameterValue wanted = value;
  wanted.id = decl.id;
  wanted.type = C3DE_PARAM_TEXT;
  wanted.text = registry::bufferText(state.buffer.data(), state.buffer.size());
  return wanted;
}

std::optional<ParameterValue> vectorParameter(const FrameContext &frame, const std::string &area, FieldState &state,
                                              const ParameterDecl &decl, const ParameterValue &value) {
  if (!state.hasDraft) state.draft = value;
  const double range = decl.softMax > decl.softMin ? decl.softMax - decl.softMin : 1.0;
  const bool hasLimits = decl.min < decl.max;
  const bool isMoved =
      ImGui::DragScalarN("##vec", ImGuiDataType_Double, state.draft.vec.data(), 3, static_cast<float>(range * 0.005),
                         hasLimits ? &decl.min : nullptr, hasLimits ? &decl.max : nullptr, "%.4g");
  state.hasDraft = ImGui::IsItemActive();
  const bool isLeft = ImGui::IsItemDeactivatedAfterEdit();
  markItem(frame, area, decl.id);
  const float reserved = ImGui::CalcTextSize(decl.unit.c_str()).x;
  if (reserved > 0.0f) {
    ImGui::SameLine();
    ImGui::TextColored(colour::kDim, "%s", decl.unit.c_str());
  }
  frame.automation.value(area, decl.id, withUnit(value.display(), decl.unit));
  if (!isMoved && !isLeft) return std::nullopt;
  ParameterValue wanted = state.draft;
  wanted.id = decl.id;
  wanted.type = C3DE_PARAM_VEC3;
  return wanted;
}

}  // namespace

std::optional<ParameterValue> parameterField(const FrameContext &frame, const std::string &area, FieldState &state,
                                             const ParameterDecl &decl, const ParameterValue &value, bool isInline) {
  std::optional<ParameterValue> changed;
  const float innerSpacing = ImGui::GetStyle().ItemSpacing.x;
  float reserved = 0.0f;
  if (decl.flags & C3DE_PARAM_AUTO)
    reserved =
        ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize("auto").x + innerSpacing;
  else if (decl.type == C3DE_PARAM_VEC3 && !decl.unit.empty())
    reserved = ImGui::CalcTextSize(decl.unit.c_str()).x + innerSpacing;
  const char *badge = nullptr;
  if (decl.flags & C3DE_PARAM_NEEDS_RESET) badge = frame.theme.hasGlyph(0x21BB) ? "↻" : "*";

  ImGui::PushID(decl.id.c_str());
  beginRow(frame, decl.label.empty() ? decl.id : decl.label, badge, isInline, reserved);
  switch (decl.type) {
    case C3DE_PARAM_F64:
    case C3DE_PARAM_I64: changed = numberParameter(frame, area, state, decl, value); break;
    case C3DE_PARAM_BOOL: {
      bool isChecked = value.num != 0.0;
      if (ImGui::Checkbox("##check", &isChecked)) {
        changed = value;
        changed->id = decl.id;
        changed->type = C3DE_PARAM_BOOL;
        changed->num = isChecked ? 1.0 : 0.0;
      }
      markItem(frame, area, decl.id);
      frame.automation.value(area, decl.id, isChecked ? "true" : "false");
      break;
    }
    case C3DE_PARAM_CHOICE: {
      const auto it = std::find(decl.choices.begin(), decl.choices.end(), value.text);
      auto index = static_cast<std::uint32_t>(it - decl.choices.begin());
      if (choiceField(frame, area, decl.id, decl.choices, index) & C3DE_UI_CHANGED) {
        changed = value;
        changed->id = decl.id;
        changed->type = C3DE_PARAM_CHOICE;
        changed->text = decl.choices[index];
      }
      break;
    }
    case C3DE_PARAM_TEXT: changed = textParameter(frame, area, state, decl, value); break;
    case C3DE_PARAM_VEC3: changed = vectorParameter(frame, area, state, decl, value); break;
    default: ImGui::TextDisabled("(unknown type)"); break;
  }
  endRow();
  itemTooltip(frame, documentation(decl));
  fieldError(frame, state);
  ImGui::PopID();
  return changed;
}

}  // namespace c3de::ui
