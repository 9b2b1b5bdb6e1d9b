// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/missing_files.h"

#include <algorithm>

#include "c3de/core/background_jobs.h"
#include "frame/file_dialog.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kMissingArea = "missing";

void chooseFile(FrameContext &frame, const MissingFiles &files, std::size_t row) {
  FileDialog::Request request;
  request.title = "Locate " + files.rows[row].name;
  request.folders = FileDialog::Folders::accepted;
  request.chosen = [locate = files.locate, row](const std::filesystem::path &file, const std::string &) {
    if (locate) locate(row, file);
  };
  frame.fileDialog.open(std::move(request));
}

void chooseFolder(FrameContext &frame, const MissingFiles &files) {
  FileDialog::Request request;
  request.title = "Search in folder";
  request.folders = FileDialog::Folders::only;
  request.chosen = [search = files.search](const std::filesystem::path &folder, const std::string &) {
    if (search) search(folder);
  };
  frame.fileDialog.open(std::move(request));
}

/// Returns whether another file is to be chosen.
bool drawMissingFile(FrameContext &frame, MissingFiles &files, std::size_t index) {
  const MissingFiles::Row &row = files.rows[index];
  const std::string key = std::to_string(index);
  ImGui::PushID(static_cast<int>(index));
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(row.name.c_str());
  ImGui::TextColored(colour::kDim, "%s", row.path.c_str());
  ImGui::TextColored(colour::kDim, "%s", row.size.c_str());
  if (row.found.empty()) {
    ImGui::TextColored(colour::kWarn, "%s", row.why.c_str());
    if (!row.refusal.empty()) ImGui::TextColored(colour::kError, "%s", row.refusal.c_str());
  } else {
    ImGui::TextColored(colour::kGood, "%s", row.found.c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  ImGui::TableNextColumn();
  const bool isIdle = files.job.isNull();
  const ImVec2 size(frame.theme.px(124.0f), 0);
  ImGui::BeginDisabled(!isIdle);
  const bool isChosen = ImGui::Button("Locate…", size);
  markItem(frame, kMissingArea, "locate." + key, isIdle);
  itemTooltip(frame, "Choose the file or folder");
  if (row.canUseAnyway && row.found.empty()) {
    if (ImGui::Button("Use it anyway", size) && files.useAnyway) files.useAnyway(index);
    markItem(frame, kMissingArea, "use." + key, isIdle);
    itemTooltip(frame, "Use the file with its other content. The state may not fit it and is then not restored.");
  }
  ImGui::EndDisabled();
  frame.automation.value(kMissingArea, "name." + key, row.name);
  frame.automation.value(kMissingArea, "path." + key, row.path);
  frame.automation.value(kMissingArea, "size." + key, row.size);
  frame.automation.value(kMissingArea, "why." + key, row.why);
  frame.automation.value(kMissingArea, "found." + key, row.found);
  frame.automation.value(kMissingArea, "refusal." + key, row.refusal);
  ImGui::PopID();
  return isChosen;
}

/// What a running job does, and the button that ends it; otherwise the result of the last one.
void drawActivity(FrameContext &frame, const MissingFiles &files) {
  std::string text = files.note;
  if (!files.job.isNull() && frame.services.jobs != nullptr)
    for (const BackgroundJobs::Status &job : frame.services.jobs->running())
      if (job.handle == files.job) text = job.cancelling ? "Stopping…" : job.what.empty() ? job.title : job.what;
  ImGui::AlignTextToFramePadding();
  if (!files.job.isNull()) {
    if (ImGui::Button("Stop", ImVec2(frame.theme.px(96.0f), 0)) && frame.services.jobs != nullptr)
      frame.services.jobs->cancel(files.job);
    markItem(frame, kMissingArea, "stop");
    ImGui::SameLine();
  }
  ImGui::TextColored(colour::kDim, "%s", elided(text, ImGui::GetContentRegionAvail().x).c_str());
  frame.automation.value(kMissingArea, "activity", text);
}

}  // namespace

void drawMissingFiles(FrameContext &frame) {
  MissingFiles *files = frame.services.missingFiles;
  // The dialog reappears when the file dialog closes.
  if (files == nullptr || !files->isShown || frame.fileDialog.isOpen()) return;
  bool isShown = true;
  if (!beginDialog(frame, "Files of the session", "missing_files", isShown, ImVec2(760, 460))) {
    if (!isShown && files->cancel) files->cancel();
    return;
  }
  const bool isNew = ImGui::IsWindowAppearing();
  ImGui::PushTextWrapPos(0.0f);
  ImGui::Text("%s needs these files, which are missing or have changed.", files->session.c_str());
  ImGui::PopTextWrapPos();
  ImGui::BeginChild("list", ImVec2(0, -2.0f * ImGui::GetFrameHeightWithSpacing() - frame.theme.px(6.0f)));
  std::size_t chosen = files->rows.size();
  if (ImGui::BeginTable("files", 2, ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("file");
    ImGui::TableSetupColumn("action", ImGuiTableColumnFlags_WidthFixed, frame.theme.px(128.0f));
    for (std::size_t i = 0; i < files->rows.size(); ++i)
      if (drawMissingFile(frame, *files, i)) chosen = i;
    ImGui::EndTable();
  }
  ImGui::EndChild();
  drawActivity(frame, *files);
  const bool isIdle = files->job.isNull(), canOpen = isIdle && files->isComplete();
  const ImVec2 size(frame.theme.px(96.0f), 0);
  ImGui::BeginDisabled(!isIdle);
  const bool isSearched = ImGui::Button("Search in folder…");
  markItem(frame, kMissingArea, "search", isIdle);
  itemTooltip(frame, "Find the files in a folder and its subfolders by their content");
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!canOpen);
  const bool isOpened = ImGui::Button("Open", size);
  markItem(frame, kMissingArea, "open", canOpen);
  ImGui::EndDisabled();
  ImGui::SameLine();
  // The press that closed the file dialog does not cancel.
  const bool isEscaped = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)) && !isNew;
  const bool isCancelled = ImGui::Button("Cancel", size) || isEscaped || !isShown;
  markItem(frame, kMissingArea, "cancel");
  if (isOpened || isCancelled || isSearched || chosen < files->rows.size()) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  if (isCancelled && files->cancel) return files->cancel();
  if (isOpened && files->open) return files->open();
  if (isSearched) return chooseFolder(frame, *files);
  if (chosen < files->rows.size()) chooseFile(frame, *files, chosen);
}

}  // namespace c3de::ui
