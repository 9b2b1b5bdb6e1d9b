// SPDX-License-Identifier: Apache-2.0
// What the user prefers. Choices apply at once; typed values apply when their field is left.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/registry/number_text.h"
#include "frame/file_dialog.h"
#include "panels/fields.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kPreferencesArea = "preferences";
constexpr float kLabelWidth_px = 150.0f, kFieldWidth_px = 150.0f, kWidth_px = 560.0f, kHeight_px = 600.0f;

struct PreferenceChoice {
  const char *id, *label;
};

void preferenceHeading(const FrameContext &frame, const char *text) {
  ImGui::Dummy(ImVec2(0, frame.theme.px(4.0f)));
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted(text);
  ImGui::PopFont();
}

void preferenceLabel(const FrameContext &frame, const char *label, float width_px = kFieldWidth_px) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  ImGui::SameLine(frame.theme.px(kLabelWidth_px));
  ImGui::SetNextItemWidth(frame.theme.px(width_px));
}

template <typename Choice, std::size_t count>
bool preferenceChoice(FrameContext &frame, const char *id, const char *label,
                      const std::array<PreferenceChoice, count> &options, Choice &chosen, const char *tooltip) {
  preferenceLabel(frame, label);
  const PreferenceChoice &shown = options[static_cast<std::size_t>(chosen)];
  const bool isOpen = ImGui::BeginCombo((std::string("###") + id).c_str(), shown.label);
  markOpener(frame, kPreferencesArea, id, isOpen);
  if (!isOpen) itemTooltip(frame, tooltip);
  const Choice before = chosen;
  if (isOpen) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto option = static_cast<Choice>(i);
      if (ImGui::Selectable(options[i].label, option == before)) chosen = option;
      markItem(frame, kPreferencesArea, std::string(id) + ".option." + options[i].id);
    }
    ImGui::EndCombo();
  }
  frame.automation.value(kPreferencesArea, id, options[static_cast<std::size_t>(chosen)].id);
  return chosen != before;
}

/// @return whether the field was left with another, accepted number
bool preferenceNumber(FrameContext &frame, const std::string &id, double &edited, double &value, double least,
                      double most, double step, const char *format, const std::string &what) {
  PreferencesDialog &dialog = frame.state.preferencesDialog;
  ImGui::InputDouble(("###" + id).c_str(), &edited, step, step, format);
  const bool isLeft = ImGui::IsItemDeactivatedAfterEdit();
  markItem(frame, kPreferencesArea, id);
  itemTooltip(frame, what);
  frame.automation.value(kPreferencesArea, id, shortNumber(value));
  if (!isLeft || edited == value) return false;
  if (std::isfinite(edited) && edited >= least && edited <= most) {
    dialog.problem.clear();
    value = edited;
    return true;
  }
  dialog.problem = shortNumber(edited) + ": " + what;
  edited = value;
  return false;
}

bool drawAppearance(FrameContext &frame, Preferences &wanted) {
  static constexpr std::array<PreferenceChoice, 2> kThemes{{{"dark", "Dark"}, {"light", "Light"}}};
  preferenceHeading(frame, "Appearance");
  bool isChanged =
      preferenceChoice(frame, "theme", "Theme", kThemes, wanted.theme, "Views of images and bodies stay dark");
  preferenceLabel(frame, "Font size");
  isChanged |= preferenceNumber(frame, "font_size", frame.state.preferencesDialog.edited.fontSize_px,
                                wanted.fontSize_px, Preferences::kSmallestFont, Preferences::kLargestFont, 1.0, "%.4g",
                                "Accepted: 10 to 28 pixels; the whole interface is scaled with it");
  ImGui::SameLine();
  ImGui::TextUnformatted("pixels, 10 to 28");
  return isChanged;
}

bool drawUnits(FrameContext &frame, DisplayUnits &units) {
  static constexpr std::array<PreferenceChoice, 2> kLengths{{{"mm", "mm"}, {"cm", "cm"}}};
  static constexpr std::array<PreferenceChoice, 3> kPressures{{{"kPa", "kPa"}, {"mmHg", "mmHg"}, {"Pa", "Pa"}}};
  static constexpr std::array<PreferenceChoice, 2> kForces{{{"N", "N"}, {"mN", "mN"}}};
  preferenceHeading(frame, "Units");
  const char *where = "In the panel, in read-outs, plots and measurements, and in the tables that they save";
  bool isChanged = preferenceChoice(frame, "length", "Lengths", kLengths, units.length, where);
  isChanged |= preferenceChoice(frame, "pressure", "Pressures, moduli", kPressures, units.pressure, where);
  return preferenceChoice(frame, "force", "Forces", kForces, units.force, where) || isChanged;
}

void chooseFolder(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Folder in which file dialogs begin";
  request.folders = FileDialog::Folders::only;
  request.chosen = [&frame_state = frame.state, change = frame.actions.preferences.change](
                       const std::filesystem::path &folder, const std::string &) {
    Preferences changed = frame_state.preferences;
    changed.folder = pathText(folder);
    frame_state.preferencesDialog.isFilled = false;
    change(changed);
  };
  frame.fileDialog.open(std::move(request));
}

bool drawFolder(FrameContext &frame, Preferences &wanted) {
  PreferencesDialog &dialog = frame.state.preferencesDialog;
  preferenceHeading(frame, "Files");
  preferenceLabel(frame, "Dialogs begin in", 250.0f);
  ImGui::InputTextWithHint("###folder", "Working folder", dialog.folder.data(), dialog.folder.size());
  const bool isLeft = ImGui::IsItemDeactivatedAfterEdit();
  markItem(frame, kPreferencesArea, "folder");
  itemTooltip(frame, "Folder of the first file dialog; empty: the working folder");
  frame.automation.value(kPreferencesArea, "folder", wanted.folder);
  ImGui::SameLine();
  if (ImGui::Button("Choose…")) chooseFolder(frame);
  markItem(frame, kPreferencesArea, "choose_folder");
  preferenceLabel(frame, "Autosave every");
  bool isChanged = preferenceNumber(frame, "autosave", dialog.edited.autosave_s, wanted.autosave_s,
                                    Preferences::kShortestAutosave_s, Preferences::kLongestAutosave_s, 0.0, "%.4g",
                                    "Accepted: 2 to 3600 s; unsaved work is copied for a restart after a crash");
  ImGui::SameLine();
  ImGui::TextUnformatted("s, 2 to 3600");
  if (!isLeft) return isChanged;
  const std::string typed(registry::bufferText(dialog.folder.data(), dialog.folder.size()));
  std::error_code ignored;
  if (!typed.empty() && !std::filesystem::is_directory(pathFromText(typed), ignored)) {
    dialog.problem = typed + ": there is no such folder; accepted: an existing folder, or nothing";
    registry::copyText(dialog.folder.data(), dialog.folder.size(), wanted.folder);
    return isChanged;
  }
  dialog.problem.clear();
  isChanged = isChanged || wanted.folder != typed;
  wanted.folder = typed;
  return isChanged;
}

/// One line of the table; `isRemoved` if its button is pressed.
bool drawRule(FrameContext &frame, std::size_t i, WindowLevelRule &rule, bool &isRemoved) {
  PreferencesDialog &dialog = frame.state.preferencesDialog;
  WindowLevelRule &edited = dialog.edited.windowLevels[i];
  const std::string id = "rule." + std::to_string(i) + ".";
  constexpr double kLargest = 1e6;
  bool isChanged = false;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0f);
  ImGui::InputText(("###" + id + "words").c_str(), dialog.words[i].data(), dialog.words[i].size());
  const bool isLeft = ImGui::IsItemDeactivatedAfterEdit();
  markItem(frame, kPreferencesArea, id + "words");
  itemTooltip(frame, "Words that are all in modality, series description or file name");
  frame.automation.value(kPreferencesArea, id + "words", rule.words);
  const std::string typed(registry::bufferText(dialog.words[i].data(), dialog.words[i].size()));
  if (isLeft && typed.find_first_not_of(' ') == std::string::npos) {
    dialog.problem = "A rule without words would apply to no image; accepted: words such as CT lung";
    registry::copyText(dialog.words[i].data(), dialog.words[i].size(), rule.words);
  } else if (isLeft && typed != rule.words) {
    rule.words = typed;
    isChanged = true;
  }
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0f);
  isChanged |= preferenceNumber(frame, id + "centre", edited.centre, rule.centre, -kLargest, kLargest, 0.0, "%.6g",
                                "Level: the value in the middle of the grey scale, for CT in HU");
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0f);
  isChanged |= preferenceNumber(frame, id + "width", edited.width, rule.width, 1e-6, kLargest, 0.0, "%.6g",
                                "Window: the range of values from black to white, above 0, for CT in HU");
  ImGui::TableNextColumn();
  isRemoved = iconButton(id.c_str(), Icon::close, ImGui::GetFrameHeight(), colour::kDim, true);
  markItem(frame, kPreferencesArea, id + "remove");
  itemTooltip(frame, "Remove this rule");
  return isChanged;
}

bool drawRules(FrameContext &frame, std::vector<WindowLevelRule> &rules) {
  preferenceHeading(frame, "Window and level when an image is opened");
  ImGui::TextColored(colour::kDim,
                     "The first rule applies whose words are all in modality, series description or file name.");
  bool isChanged = false;
  std::optional<std::size_t> removed;
  if (!rules.empty() && ImGui::BeginTable("rules", 4)) {
    ImGui::TableSetupColumn("Name contains", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Centre", ImGuiTableColumnFlags_WidthFixed, frame.theme.px(80.0f));
    ImGui::TableSetupColumn("Width", ImGuiTableColumnFlags_WidthFixed, frame.theme.px(80.0f));
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFrameHeight());
    ImGui::TableHeadersRow();
    for (std::size_t i = 0; i < rules.size(); ++i) {
      bool isRemoved = false;
      isChanged |= drawRule(frame, i, rules[i], isRemoved);
      if (isRemoved) removed = i;
    }
    ImGui::EndTable();
  }
  if (removed) rules.erase(rules.begin() + static_cast<std::ptrdiff_t>(*removed));
  const bool isAdded = ImGui::Button("Add a rule");
  markItem(frame, kPreferencesArea, "add_rule");
  if (isAdded) rules.push_back({"CT", 40.0, 400.0});
  return isChanged || removed || isAdded;
}

/// Fields have the values that apply.
void fillFields(FrameContext &frame) {
  PreferencesDialog &dialog = frame.state.preferencesDialog;
  dialog.edited = frame.state.preferences;
  registry::copyText(dialog.folder.data(), dialog.folder.size(), dialog.edited.folder);
  dialog.words.assign(dialog.edited.windowLevels.size(), {});
  for (std::size_t i = 0; i < dialog.words.size(); ++i)
    registry::copyText(dialog.words[i].data(), dialog.words[i].size(), dialog.edited.windowLevels[i].words);
  dialog.isFilled = true;
}

}  // namespace

void drawPreferences(FrameContext &frame) {
  PreferencesDialog &dialog = frame.state.preferencesDialog;
  const PreferenceActions &actions = frame.actions.preferences;
  if (!actions.change || !actions.restore) dialog.isShown = false;
  if (!dialog.isShown || frame.fileDialog.isOpen()) return;
  if (!dialog.isFilled) fillFields(frame);
  if (!beginDialog(frame, "Preferences", "preferences", dialog.isShown, ImVec2(kWidth_px, kHeight_px),
                   ImGuiWindowFlags_NoResize))
    return;
  // The font size may have changed.
  const ImVec2 window(static_cast<float>(frame.windowSize[0]), static_cast<float>(frame.windowSize[1]));
  const ImVec2 size(std::floor(std::min(frame.theme.px(kWidth_px), 0.95f * window.x)),
                    std::floor(std::min(frame.theme.px(kHeight_px), 0.95f * window.y)));
  if (ImGui::GetWindowSize().x != size.x || ImGui::GetWindowSize().y != size.y) {
    ImGui::SetWindowSize(size);
    ImGui::SetWindowPos(ImVec2(std::floor(0.5f * (window.x - size.x)), std::floor(0.5f * (window.y - size.y))));
  }
  const float below = ImGui::GetFrameHeightWithSpacing() + 2.0f * ImGui::GetTextLineHeightWithSpacing();
  Preferences wanted = frame.state.preferences;
  ImGui::BeginChild("rows", ImVec2(0, -below), false, ImGuiWindowFlags_NavFlattened);
  bool isChanged = drawAppearance(frame, wanted);
  isChanged |= drawUnits(frame, wanted.units);
  isChanged |= drawFolder(frame, wanted);
  isChanged |= drawRules(frame, wanted.windowLevels);
  ImGui::EndChild();
  ImGui::TextColored(colour::kError, "%s", elided(dialog.problem, ImGui::GetContentRegionAvail().x).c_str());
  itemTooltip(frame, dialog.problem);
  frame.automation.value(kPreferencesArea, "problem", dialog.problem);
  const std::string file = actions.file ? pathText(actions.file()) : std::string();
  ImGui::TextColored(colour::kDim, "%s", elided(file, ImGui::GetContentRegionAvail().x).c_str());
  itemTooltip(frame, file + "\nCan be edited; it is read when the program starts");
  if (isChanged) {
    actions.change(wanted);
    fillFields(frame);
  }
  if (ImGui::Button("Restore defaults")) {
    dialog.problem.clear();
    actions.restore();
    fillFields(frame);
  }
  markItem(frame, kPreferencesArea, "restore");
  itemTooltip(frame, "The usual value of each preference. Bookmarks and recent folders stay.");
  ImGui::SameLine();
  endDialog(frame, dialog.isShown);
}

}  // namespace c3de::ui
