// SPDX-License-Identifier: Apache-2.0
// The declared parameters of a set as rows of a panel.
#include <algorithm>
#include <array>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/text.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/scene/materials.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "logic/display_units.h"
#include "logic/tissue_choice.h"
#include "panels/imgui_panel.h"

namespace c3de::ui {
namespace {

std::string textsOf(const ParameterDecl &decl) {
  std::string texts = decl.label + '\n' + decl.id + '\n' + decl.doc;
  for (const std::string &choice : decl.choices) texts += '\n' + choice;
  return texts;
}

bool isIn(const ParameterDecl &decl, const std::string &group) { return group.empty() || decl.group == group; }

}  // namespace

void ImGuiPanels::parameterRow(Handle handle, const ParameterDecl &decl, const ParameterValue &value) {
  FieldState &state = field(decl.id);
  takeSameLine(decl.id);
  // Within a disabled block nothing can be enabled.
  const bool isFree = isOfTheView(decl.id);
  if (isFree) ImGui::EndDisabled();
  const DisplayUnits &units = frame_->state.preferences.units;
  const auto changed =
      parameterField(*frame_, area_, state, shownDeclaration(decl, units), shownValue(decl, value, units), false);
  if (isFree) ImGui::BeginDisabled(isLocked_);
  if (!changed) return;
  auto done = frame_->services.parameters->edit(handle, declaredValue(decl, *changed, units));
  state.error = done ? std::string() : done.error().message;
}

bool ImGuiPanels::parameterRows(Handle handle, const std::string &group, bool isAdvanced) {
  registry::ParameterRegistry &registry = *frame_->services.parameters;
  if (!ImGui::IsAnyItemActive()) registry.history().endGesture();
  const registry::ParameterSet *set = registry.find(handle);
  if (!set) return false;
  // A copy, because a listener may change or remove the set.
  const std::vector<ParameterDecl> decls = set->decls;
  std::string heading;
  bool needsRebuild = false;
  for (std::size_t i = 0; i < decls.size(); ++i) {
    const ParameterDecl &decl = decls[i];
    if (!isIn(decl, group) || ((decl.flags & C3DE_PARAM_ADVANCED) != 0) != isAdvanced) continue;
    if (group.empty() && !decl.group.empty() && decl.group != heading) {
      heading = decl.group;
      this->heading(toAbi(std::string_view(heading)));
    }
    set = registry.find(handle);
    if (!set || set->values.size() != decls.size() || set->decls[i].id != decl.id) return needsRebuild;
    used_.insert(decl.id);
    const ParameterValue value = set->values[i];
    if (!isDrawn(decl.id, textsOf(decl), RowSearch::Kind::parameter)) continue;
    needsRebuild = needsRebuild || (decl.flags & C3DE_PARAM_NEEDS_RESET) != 0;
    parameterRow(handle, decl, value);
  }
  return needsRebuild;
}

// A tissue of the material library sets several parameters of a body, in one step of undo.
void ImGuiPanels::tissueRow(Handle handle, const registry::ParameterSet &set) {
  if (!frame_->services.workflow) return;
  const scene::MaterialLibrary &library = frame_->services.workflow->materials();
  const TissueChoice choice = tissueChoiceOf(set, library);
  const std::string id = uniqueId(toAbi(std::string_view("tissue")));
  if (!isDrawn(id, "Tissue\n" + id + "\nmaterial preset\n" + choice.texts(), RowSearch::Kind::parameter)) return;
  takeSameLine(id);
  std::uint32_t index = choice.index;
  beginRow(*frame_, "Tissue", nullptr, false, 0.0f);
  const std::uint32_t result = choiceField(*frame_, area_, id, choice.names, index);
  endRow();
  itemTooltip(*frame_, choice.tooltip);
  FieldState &state = field(id);
  fieldError(*frame_, state);
  if ((result & C3DE_UI_CHANGED) == 0 || index == choice.index || index == 0) return;
  const auto done =
      frame_->services.parameters->edit(handle, "Tissue", tissueValues(set, library.presets()[index - 1]));
  state.error = done ? std::string() : done.error().message;
}

void ImGuiPanels::params(c3de_handle set, c3de_str group) {
  isSameLine_ = false;
  const Handle handle = Handle::fromBits(set.v);
  const registry::ParameterSet *found =
      frame_->services.parameters ? frame_->services.parameters->find(handle) : nullptr;
  if (!found) return;
  const std::string wanted = displayText(fromAbi(group), Lines::many);
  const auto isAdvanced = [&](const ParameterDecl &decl) {
    return isIn(decl, wanted) && (decl.flags & C3DE_PARAM_ADVANCED) != 0;
  };
  const auto isStiffness = [&](const ParameterDecl &decl) {
    return isIn(decl, wanted) && decl.id == C3DE_PARAM_ID_YOUNGS_MODULUS;
  };
  const bool hasAdvanced = std::any_of(found->decls.begin(), found->decls.end(), isAdvanced);
  const bool hasStiffness = std::any_of(found->decls.begin(), found->decls.end(), isStiffness);
  bool needsRebuild = std::any_of(found->decls.begin(), found->decls.end(), [&](const ParameterDecl &decl) {
    return isIn(decl, wanted) && (decl.flags & C3DE_PARAM_NEEDS_RESET) != 0;
  });

  ImGui::PushID(static_cast<int>(handle.index));
  if (hasStiffness) tissueRow(handle, *found);
  bool isBadgeShown = parameterRows(handle, wanted, false);
  if (hasAdvanced && search_->isActive()) {
    // A search opens what is folded; afterwards it is folded or open as before.
    isBadgeShown = parameterRows(handle, wanted, true) || isBadgeShown;
  } else if (hasAdvanced) {
    takeSameLine("advanced." + wanted);
    const bool isOpen = ImGui::TreeNodeEx(("Advanced###advanced" + wanted).c_str(), ImGuiTreeNodeFlags_SpanAvailWidth);
    markItem(*frame_, area_, wanted.empty() ? "advanced" : "advanced." + wanted);
    if (isOpen) {
      (void)parameterRows(handle, wanted, true);
      ImGui::TreePop();
    }
  }
  if (search_->isActive()) needsRebuild = isBadgeShown;
  if (needsRebuild) {
    ImGui::PushFont(frame_->theme.small);
    ImGui::TextColored(colour::kWarn, "%s", frame_->theme.hasGlyph(0x21BB) ? "↻" : "*");
    ImGui::SameLine(0.0f, frame_->theme.px(4.0f));
    ImGui::TextColored(colour::kDim, "applies on rebuild");
    ImGui::PopFont();
  }
  ImGui::PopID();
}

}  // namespace c3de::ui
