// SPDX-License-Identifier: Apache-2.0
// What is exported of a stretch of a recording, and where to.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "c3de/registry/number_text.h"
#include "c3de/ui/file_browser.h"
#include "c3de/ui/stretch.h"
#include "frame/file_dialog.h"
#include "panels/fields.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kStretchArea = "stretch";

void wantedBox(FrameContext &frame, const char *id, const char *label, bool &value, const std::string &whyNot) {
  if (!whyNot.empty()) value = false;
  ImGui::BeginDisabled(!whyNot.empty());
  ImGui::Checkbox((std::string(label) + "###" + id).c_str(), &value);
  ImGui::EndDisabled();
  markItem(frame, kStretchArea, id, whyNot.empty());
  frame.automation.value(kStretchArea, id, value ? "true" : "false");
  if (whyNot.empty()) return;
  ImGui::SameLine();
  ImGui::TextColored(colour::kDim, "%s", elided(whyNot, ImGui::GetContentRegionAvail().x).c_str());
  itemTooltip(frame, whyNot);
  frame.automation.value(kStretchArea, std::string(id) + ".why", whyNot);
}

/// A number between two texts.
void wantedNumber(FrameContext &frame, const char *id, const char *before, const char *after, double &value) {
  if (*before != '\0') {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(before);
    ImGui::SameLine();
  }
  ImGui::SetNextItemWidth(frame.theme.px(84.0f));
  double typed = value;
  if (ImGui::InputDouble((std::string("###") + id).c_str(), &typed, 0.0, 0.0, "%.6g") && std::isfinite(typed))
    value = typed;
  markItem(frame, kStretchArea, id);
  frame.automation.value(kStretchArea, id, shortNumber(value));
  if (*after == '\0') return;
  ImGui::SameLine();
  ImGui::TextUnformatted(after);
}

void wantedSize(FrameContext &frame, const char *id, const char *before, const char *after, int &value) {
  double typed = value;
  wantedNumber(frame, id, before, after, typed);
  value = static_cast<int>(std::lround(std::clamp(typed, -1e6, 1e6)));
}

void chooseStretchFolder(FrameContext &frame) {
  FileDialog::Request request;
  request.title = "Folder of the export";
  request.folders = FileDialog::Folders::only;
  request.chosen = [&folder = frame.state.stretch.folder](const std::filesystem::path &chosen, const std::string &) {
    registry::copyText(folder.data(), folder.size(), pathText(chosen));
  };
  frame.fileDialog.open(std::move(request));
}

/// Returns whether a folder is to be chosen.
bool drawPlace(FrameContext &frame, StretchDialog &dialog) {
  const float label = frame.theme.px(70.0f), button = frame.theme.px(96.0f);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Folder");
  ImGui::SameLine(label);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x);
  ImGui::InputText("###folder", dialog.folder.data(), dialog.folder.size());
  markItem(frame, kStretchArea, "folder");
  frame.automation.value(kStretchArea, "folder", dialog.folder.data());
  ImGui::SameLine();
  const bool isChosen = ImGui::Button("Choose…", ImVec2(button, 0));
  markItem(frame, kStretchArea, "choose");
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Name");
  ImGui::SameLine(label);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x);
  ImGui::InputText("###name", dialog.name.data(), dialog.name.size());
  markItem(frame, kStretchArea, "name");
  frame.automation.value(kStretchArea, "name", dialog.name.data());
  itemTooltip(frame, "Of all files, without extension");
  dialog.wanted.folder = pathFromText(dialog.folder.data());
  dialog.wanted.name = dialog.name.data();
  return isChosen;
}

void drawContents(FrameContext &frame, const ReplayView &replay, StretchExport &wanted) {
  wantedBox(frame, "frames", "Series for ParaView (.pvd)", wanted.hasFrames, {});
  ImGui::SameLine();
  wantedNumber(frame, "frame_every", "  every", "ms of simulated time", wanted.frameEvery_ms);
  wantedBox(frame, "probes", "Table of the probes (.csv), every step", wanted.hasProbes,
            replay.hasProbes ? "" : "The simulation has no probes.");
  wantedBox(frame, "pictures", "Pictures of the 3D view (.png)", wanted.hasPictures, {});
  wantedBox(frame, "film", "Film of the 3D view (.mp4)", wanted.hasFilm, replay.whyNoFilm);
  ImGui::Indent();
  wantedNumber(frame, "rate", "", "pictures per simulated second", wanted.pictureRate);
  wantedSize(frame, "width", "", "×", wanted.width);
  ImGui::SameLine();
  wantedSize(frame, "height", "", "pixels", wanted.height);
  ImGui::Unindent();
}

std::string summaryOf(const ReplayView &replay, const StretchExport &wanted) {
  const double begin_s = replay.timeAt_s(replay.stretch.begin), end_s = replay.timeAt_s(replay.stretch.end);
  const std::uint64_t steps = replay.stretch.end - replay.stretch.begin;
  std::string text = fmt::format("t = {:.3f} to {:.3f} s, {} steps", begin_s, end_s, steps);
  const auto countOf = [&](double interval_s) {
    return end_s > begin_s ? frameCount(end_s - begin_s, interval_s) : static_cast<double>(steps + 1);
  };
  if (wanted.hasFrames && wanted.frameEvery_ms > 0.0)
    text += fmt::format("; {:.0f} frames", countOf(1e-3 * wanted.frameEvery_ms));
  if ((wanted.hasPictures || wanted.hasFilm) && wanted.pictureRate > 0.0)
    text += fmt::format("; {:.0f} pictures", countOf(1.0 / wanted.pictureRate));
  return text;
}

/// Why the last attempt was refused, or what it would replace.
void drawAnswer(FrameContext &frame, const StretchDialog &dialog) {
  std::string text = dialog.problem;
  for (const std::filesystem::path &file : dialog.toReplace)
    text += (text.empty() ? "" : ", ") + pathText(file.filename());
  if (!dialog.toReplace.empty())
    text += dialog.toReplace.size() == 1 ? " already exists. Press Export again to replace it."
                                         : " already exist. Press Export again to replace them.";
  ImGui::BeginChild("answer", ImVec2(0, 3.0f * ImGui::GetTextLineHeightWithSpacing()));
  ImGui::PushStyleColor(ImGuiCol_Text, dialog.problem.empty() ? colour::kWarn : colour::kError);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  ImGui::EndChild();
  frame.automation.value(kStretchArea, "answer", text);
}

double durationOf(const ReplayView &replay) {
  return replay.timeAt_s(replay.stretch.end) - replay.timeAt_s(replay.stretch.begin);
}

/// An answer that no longer applies to what was typed since.
void forgetAnswer(const ReplayView &replay, StretchDialog &dialog) {
  if (!dialog.problem.empty()) dialog.problem = problemOf(dialog.wanted, durationOf(replay));
  if (!dialog.toReplace.empty() && existingFiles(dialog.wanted) != dialog.toReplace) dialog.toReplace.clear();
}

/// Returns whether it can begin: all values are right, and nothing is replaced that was not asked about.
bool checkExport(const ReplayView &replay, StretchDialog &dialog) {
  const std::vector<std::filesystem::path> asked = std::exchange(dialog.toReplace, {});
  dialog.problem = problemOf(dialog.wanted, durationOf(replay));
  if (!dialog.problem.empty()) return false;
  const std::vector<std::filesystem::path> existing = existingFiles(dialog.wanted);
  if (existing.empty() || existing == asked) return true;
  dialog.toReplace = existing;
  return false;
}

void proposePlace(const ReplayView &replay, StretchDialog &dialog) {
  const std::string recording = pathText(replay.folder) + "/" + replay.file;
  if (dialog.recording == recording) return;
  dialog.recording = recording;
  std::error_code ignored;
  const std::filesystem::path folder = absolutePath(replay.folder, ignored);
  registry::copyText(dialog.folder.data(), dialog.folder.size(), pathText(folder));
  registry::copyText(dialog.name.data(), dialog.name.size(),
                     fileNamePart(pathText(pathFromText(replay.file).stem()) + "-stretch"));
}

}  // namespace

void drawStretchDialog(FrameContext &frame) {
  StretchDialog &dialog = frame.state.stretch;
  if (!frame.simulation.replay || !frame.simulation.replay->timeAt_s) dialog.isShown = false;
  // It reappears when the file dialog closes.
  if (!dialog.isShown || frame.fileDialog.isOpen()) return;
  const ReplayView &replay = *frame.simulation.replay;
  proposePlace(replay, dialog);
  bool isShown = true;
  if (!beginDialog(frame, "Export stretch", "export_stretch", isShown, ImVec2(620, 396))) {
    dialog.isShown = isShown;
    return;
  }
  drawContents(frame, replay, dialog.wanted);
  ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
  const bool isFolderChosen = drawPlace(frame, dialog);
  ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
  const std::string summary = summaryOf(replay, dialog.wanted);
  ImGui::TextColored(colour::kDim, "%s", elided(summary, ImGui::GetContentRegionAvail().x).c_str());
  frame.automation.value(kStretchArea, "summary", summary);
  forgetAnswer(replay, dialog);
  drawAnswer(frame, dialog);
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isPressed = ImGui::Button("Export", ImVec2(frame.theme.px(120.0f), 0));
  ImGui::PopStyleColor();
  markItem(frame, kStretchArea, "export");
  itemTooltip(frame,
              "The recording is replayed from the begin of the stretch; then the timeline returns to this moment");
  ImGui::SameLine();
  const bool isBegun = isPressed && checkExport(replay, dialog);
  if (isBegun) isShown = false;
  if (isBegun || isFolderChosen) ImGui::CloseCurrentPopup();
  endDialog(frame, isShown);
  dialog.isShown = isShown;
  if (!isShown) {
    dialog.problem.clear();
    dialog.toReplace.clear();
  }
  if (isFolderChosen) chooseStretchFolder(frame);
  if (isBegun) frame.actions.replay.exportStretch(dialog.wanted);
}

}  // namespace c3de::ui
