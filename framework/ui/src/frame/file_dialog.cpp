// SPDX-License-Identifier: Apache-2.0
#include "frame/file_dialog.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "c3de/core/platform.h"
#include "c3de/registry/number_text.h"
#include "frame/frame_context.h"

namespace c3de::ui {
namespace {

constexpr const char *kArea = "dialog";
constexpr int kMaxFramesToFocus = 10;
constexpr const char *kUnits[] = {"", "mm", "cm", "m"};
constexpr const char *kUnitLabels[] = {"as the file says, else mm", "millimetres (mm)", "centimetres (cm)",
                                       "metres (m)"};

}  // namespace

void FileDialog::open(Request request) {
  request_ = std::move(request);
  // No file has this extension.
  browser_.setExtensions(request_.folders == Folders::only ? "/" : request_.extensions);
  error_.clear();
  toReplace_.clear();
  typed_[0] = '\0';
  isOpen_ = isNew_ = true;
  isDone_ = false;
  framesToFocus_ = kMaxFramesToFocus;
  openFolder();
  if (request_.isSaving && !request_.proposed.empty())
    registry::copyText(typed_, sizeof typed_, freeName(browser_.folder(), request_.proposed));
}

void FileDialog::openFolder() {
  std::error_code ignored;
  const auto recent = recentFolders_.find(request_.extensions);
  if (recent != recentFolders_.end() && browser_.open(recent->second)) return;
  if (!firstFolder_.empty() && browser_.open(firstFolder_)) return;
  if (!browser_.folder().empty() && browser_.refresh()) return;
  if (!browser_.open(std::filesystem::current_path(ignored))) (void)browser_.open(std::filesystem::path("/"));
}

void FileDialog::choose(const std::string &typed) {
  const auto choice = request_.isSaving ? browser_.resolveNew(typed) : browser_.resolve(typed);
  if (!choice) {
    error_ = choice.error().message;
    return;
  }
  error_.clear();
  if (choice->isFolder) {
    if (auto opened = browser_.open(choice->path); !opened) error_ = opened.error().message;
    typed_[0] = '\0';
    return;
  }
  std::error_code ignored;
  if (request_.isSaving && std::filesystem::exists(choice->path, ignored) && toReplace_ != choice->path) {
    toReplace_ = choice->path;
    error_ = pathText(choice->path.filename()) + " already exists. Press Save again to replace it.";
    return;
  }
  recentFolders_[request_.extensions] = usedFolder_ = choice->path.parent_path();
  isDone_ = true;
  if (request_.chosen) request_.chosen(choice->path, kUnits[unit_]);
}

/// The marked or typed folder, otherwise the one that is shown. For a file its folder is used.
void FileDialog::chooseFolder() {
  std::filesystem::path folder = browser_.folder();
  if (typed_[0] != '\0') {
    const auto choice = browser_.resolve(typed_);
    if (!choice) {
      error_ = choice.error().message;
      return;
    }
    folder = choice->isFolder ? choice->path : choice->path.parent_path();
  }
  recentFolders_[request_.extensions] = usedFolder_ = folder;
  isDone_ = true;
  if (request_.chosen) request_.chosen(folder, kUnits[unit_]);
}

void FileDialog::drawFolders(FrameContext &frame) {
  if (ImGui::Button("Up")) (void)browser_.openParent();
  markItem(frame, kArea, "up");
  ImGui::SameLine();
  if (ImGui::Button("Home")) {
    const FileBrowser::Choice fallback{true, browser_.folder()};
    if (auto opened = browser_.open(browser_.resolve("~").value_or(fallback).path); !opened)
      error_ = opened.error().message;
  }
  markItem(frame, kArea, "home");
  ImGui::SameLine();
  drawPlaces(frame);
  ImGui::AlignTextToFramePadding();
  const std::string folder = pathText(browser_.folder());
  ImGui::TextColored(colour::kDim, "%s", elided(folder, ImGui::GetContentRegionAvail().x).c_str());
  itemTooltip(frame, folder);
  frame.automation.value(kArea, "folder", folder);
}

void FileDialog::go(const std::string &folder) {
  const auto opened = browser_.open(pathFromText(folder));
  error_ = opened ? std::string() : opened.error().message;
  if (opened) typed_[0] = '\0';
}

void FileDialog::drawPlaces(FrameContext &frame) {
  const Preferences &preferences = frame.state.preferences;
  const std::string here = pathText(browser_.folder());
  std::string wanted;
  const auto list = [&](const char *label, const char *id, const std::vector<std::string> &folders) {
    ImGui::BeginDisabled(folders.empty());
    const std::string popup = std::string("###places-") + id;
    if (ImGui::Button(label)) ImGui::OpenPopup(popup.c_str());
    ImGui::EndDisabled();
    markOpener(frame, kArea, id, ImGui::IsPopupOpen(popup.c_str()), !folders.empty());
    if (ImGui::BeginPopup(popup.c_str())) {
      for (std::size_t i = 0; i < folders.size(); ++i) {
        if (ImGui::Selectable((folders[i] + "###" + std::to_string(i)).c_str(), folders[i] == here))
          wanted = folders[i];
        markItem(frame, kArea, std::string(id) + "." + std::to_string(i));
      }
      ImGui::EndPopup();
    }
    ImGui::SameLine();
  };
  list("Recent", "recent", preferences.recentFolders);
  list("Bookmarks", "bookmarks", preferences.bookmarks);
  const auto mark = std::find(preferences.bookmarks.begin(), preferences.bookmarks.end(), here);
  const bool isMarked = mark != preferences.bookmarks.end();
  if (ImGui::Button(isMarked ? "−###bookmark" : "+###bookmark", ImVec2(ImGui::GetFrameHeight(), 0)) &&
      frame.actions.preferences.change) {
    Preferences changed = preferences;
    if (isMarked)
      std::erase(changed.bookmarks, here);
    else
      changed.bookmarks.push_back(here);
    frame.actions.preferences.change(changed);
  }
  markItem(frame, kArea, "bookmark");
  itemTooltip(frame, isMarked ? "Remove this folder from the bookmarks" : "Add this folder to the bookmarks");
  frame.automation.value(kArea, "bookmarked", isMarked ? "true" : "false");
  ImGui::SameLine();
  if (!wanted.empty()) go(wanted);
}

void FileDialog::drawList(FrameContext &frame) {
  std::string picked;
  bool isPickedFinal = false;
  const float bottom = ImGui::GetFrameHeightWithSpacing() * (request_.asksMeshUnit ? 3.0f : 2.0f) +
                       (error_.empty() ? 0.0f : 2.0f * ImGui::GetTextLineHeightWithSpacing()) +
                       (request_.note.empty() ? 0.0f : ImGui::GetTextLineHeightWithSpacing()) + frame.theme.px(10.0f);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, colour::kChrome);
  ImGui::BeginChild("list", ImVec2(0, -bottom), true);
  for (const FileBrowser::Entry &entry : browser_.entries()) {
    ImGui::PushID(entry.name.c_str());
    const std::string shown = entry.isFolder ? entry.name + "/" : entry.name;
    if (entry.isFolder) ImGui::PushStyleColor(ImGuiCol_Text, colour::kAccent);
    const bool isClicked =
        ImGui::Selectable(shown.c_str(), entry.name == typed_,
                          ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_DontClosePopups);
    if (entry.isFolder) ImGui::PopStyleColor();
    markItem(frame, kArea, "entry." + entry.name);
    if (!entry.isFolder) {
      const std::string size = sizeText(entry.bytes);
      ImGui::SameLine(std::max(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(size.c_str()).x, 0.0f));
      ImGui::TextColored(colour::kDim, "%s", size.c_str());
    }
    if (isClicked) {
      picked = entry.name;
      isPickedFinal = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    }
    ImGui::PopID();
  }
  if (browser_.entries().empty())
    ImGui::TextDisabled(request_.folders == Folders::only ? "No folders"
                        : request_.isSaving               ? "No files of this type yet"
                                                          : "No files that can be opened");
  ImGui::EndChild();
  ImGui::PopStyleColor();
  if (picked.empty()) return;
  registry::copyText(typed_, sizeof typed_, picked);
  if (isPickedFinal) choose(picked);
}

void FileDialog::drawError(FrameContext &frame) {
  if (error_.empty()) return;
  ImGui::PushStyleColor(ImGuiCol_Text, colour::kError);
  ImGui::TextWrapped("%s", error_.c_str());
  ImGui::PopStyleColor();
  frame.automation.value(kArea, "error", error_);
}

void FileDialog::drawUnit(FrameContext &frame) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Unit of the numbers in the file");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(frame.theme.px(220.0f));
  const bool isComboOpen = ImGui::BeginCombo("##unit", kUnitLabels[unit_]);
  markOpener(frame, kArea, "unit", isComboOpen);
  if (isComboOpen) {
    for (int i = 0; i < static_cast<int>(std::size(kUnits)); ++i) {
      if (ImGui::Selectable(kUnitLabels[i], i == unit_)) unit_ = i;
      markItem(frame, kArea, std::string("unit.option.") + kUnits[i]);
    }
    ImGui::EndCombo();
  }
  frame.automation.value(kArea, "unit", kUnits[unit_]);
}

bool FileDialog::drawName(FrameContext &frame) {
  ImGui::SetNextItemWidth(-1.0f);
  if (isNew_) ImGui::SetKeyboardFocusHere();
  isNew_ = false;
  const bool isEntered = ImGui::InputTextWithHint(
      "##typed",
      request_.isSaving                   ? "Name of the file; a path may be typed"
      : request_.folders == Folders::only ? "Folder; a path may be typed"
                                          : "File or folder; a path may be typed",
      typed_, sizeof typed_,
      ImGuiInputTextFlags_EnterReturnsTrue | (request_.isSaving ? ImGuiInputTextFlags_AutoSelectAll : 0));
  framesToFocus_ = ImGui::IsItemActive() ? 0 : std::max(framesToFocus_ - 1, 0);
  markItem(frame, kArea, "path");
  frame.automation.value(kArea, "path", typed_);
  return isEntered;
}

bool FileDialog::drawConfirm(FrameContext &frame) {
  const bool hasText = typed_[0] != '\0';
  const char *label = request_.isSaving ? "Save" : "Open";
  ImGui::BeginDisabled(!hasText);
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isPressed = ImGui::Button(label, ImVec2(frame.theme.px(96.0f), 0));
  ImGui::PopStyleColor();
  markItem(frame, kArea, "open", hasText);
  ImGui::EndDisabled();
  if (request_.folders == Folders::none) return isPressed;
  ImGui::SameLine();
  if (ImGui::Button("Use this folder")) chooseFolder();
  markItem(frame, kArea, "use_folder");
  itemTooltip(frame, "The marked or typed folder, otherwise the one that is shown");
  return isPressed;
}

bool FileDialog::drawCancel(FrameContext &frame) {
  ImGui::SameLine();
  const bool isCancelled = ImGui::Button("Cancel", ImVec2(frame.theme.px(96.0f), 0));
  markItem(frame, kArea, "cancel");
  std::string filter;
  if (request_.folders != Folders::only)
    for (const std::string &extension : browser_.extensions()) filter += " ." + extension;
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(colour::kDim, "%s",
                     elided(request_.folders == Folders::only ? std::string()
                            : filter.empty()                  ? " all files"
                                                              : filter,
                            ImGui::GetContentRegionAvail().x)
                         .c_str());
  const bool isEscaped = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)) && !ImGui::IsAnyItemActive();
  return isCancelled || isEscaped;
}

void FileDialog::draw(FrameContext &frame) {
  if (!isOpen_) return;
  const std::string popup = request_.title + "###file-dialog";
  if (isNew_) ImGui::OpenPopup(popup.c_str());
  const ImVec2 window(static_cast<float>(frame.windowSize[0]), static_cast<float>(frame.windowSize[1]));
  const ImVec2 size(std::min(frame.theme.px(640.0f), 0.9f * window.x),
                    std::min(frame.theme.px(480.0f), 0.9f * window.y));
  ImGui::SetNextWindowSize(size, ImGuiCond_Appearing);
  ImGui::SetNextWindowPos(ImVec2(0.5f * window.x, 0.5f * window.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  bool keepsOpen = true;
  if (!ImGui::BeginPopupModal(popup.c_str(), &keepsOpen,
                              ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs)) {
    isOpen_ = false;
    return;
  }
  drawFolders(frame);
  drawList(frame);
  drawError(frame);
  if (!request_.note.empty()) ImGui::TextColored(colour::kDim, "%s", request_.note.c_str());
  frame.automation.value(kArea, "note", request_.note);
  if (request_.asksMeshUnit) drawUnit(frame);
  const bool isEntered = drawName(frame);
  const bool isPressed = drawConfirm(frame);
  // Enter also opens the selected entry of the list.
  const auto isDown = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false); };
  const bool isConfirmed =
      !isEntered && !ImGui::IsAnyItemActive() && (isDown(ImGuiKey_Enter) || isDown(ImGuiKey_KeyPadEnter));
  if ((isEntered || isPressed || isConfirmed) && typed_[0] != '\0') choose(typed_);
  const bool isCancelled = drawCancel(frame);
  if (const std::string used = pathText(std::exchange(usedFolder_, {})); !used.empty()) {
    Preferences changed = frame.state.preferences;
    changed.addRecentFolder(used);
    if (frame.actions.preferences.change && changed != frame.state.preferences)
      frame.actions.preferences.change(changed);
  }
  if (isDone_ || isCancelled || !keepsOpen) {
    ImGui::CloseCurrentPopup();
    isOpen_ = false;
  }
  ImGui::EndPopup();
}

}  // namespace c3de::ui
