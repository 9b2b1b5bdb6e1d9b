// SPDX-License-Identifier: Apache-2.0
// What a report about a problem contains, and where it is saved.
#include <utility>

#include "c3de/core/path_text.h"
#include "frame/file_dialog.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kReportArea = "report";

void drawReportContents(FrameContext &frame, const ReportContents &contents, bool hasImage) {
  const bool hasRecording = contents.isMeasured && (hasImage || !contents.needsImage);
  const std::string recording = !contents.isMeasured ? "…"
                                : hasRecording       ? contents.recording
                                                     : "none: the bodies are made from the image; check the box below";
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(("Recording: " + recording).c_str());
  ImGui::TextUnformatted("Log of this run, values of the panels, versions of program and plugins with SHA-256");
  ImGui::TextUnformatted("Operating system, processor, graphics, number of threads");
  ImGui::TextColored(colour::kDim,
                     "Your home folder and your user name are replaced in texts. Names of files, bodies and "
                     "landmarks are kept: check that they do not name a patient.");
  ImGui::PopTextWrapPos();
  frame.automation.value(kReportArea, "recording", recording);
}

void chooseReportFile(FrameContext &frame, const ReportContents &contents) {
  FileDialog::Request request;
  request.isSaving = true;
  request.title = "Save report";
  request.extensions = "c3dr";
  request.proposed = "report.c3dr";
  const ReportDialog &dialog = frame.state.report;
  request.note = dialog.wanted.hasImage ? contents.sizeWithImage : contents.size;
  request.chosen = [save = frame.actions.saveReport, wanted = dialog.wanted](
                       const std::filesystem::path &file, const std::string &) { save(wanted, file); };
  frame.fileDialog.open(std::move(request));
}

}  // namespace

void drawReportDialog(FrameContext &frame) {
  ReportDialog &dialog = frame.state.report;
  if (!frame.actions.saveReport || !frame.actions.measureReport) dialog.isShown = false;
  if (!dialog.isShown || frame.fileDialog.isOpen()) return;
  if (!std::exchange(dialog.isMeasured, true)) frame.actions.measureReport();
  const ReportContents &contents = frame.actions.reportContents();
  bool isShown = true;
  if (!beginDialog(frame, "Save a report", "save_report", isShown, ImVec2(620, 420))) {
    dialog.isShown = isShown;
    return;
  }
  ImGui::TextUnformatted("What happened?");
  ImGui::InputTextMultiline("###description", dialog.description.data(), dialog.description.size(),
                            ImVec2(-1.0f, frame.theme.px(96.0f)));
  markItem(frame, kReportArea, "description");
  itemTooltip(frame, "What you did, what you expected, and what happened instead");
  frame.automation.value(kReportArea, "description", dialog.description.data());
  dialog.wanted.description = dialog.description.data();
  ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
  ImGui::TextUnformatted("The file contains:");
  ImGui::Indent();
  drawReportContents(frame, contents, dialog.wanted.hasImage);
  ImGui::Unindent();
  ImGui::Checkbox("With the image, which may contain the name of the patient###image", &dialog.wanted.hasImage);
  markItem(frame, kReportArea, "image");
  frame.automation.value(kReportArea, "image", dialog.wanted.hasImage ? "true" : "false");
  const std::string size = (dialog.wanted.hasImage ? contents.sizeWithImage : contents.size) +
                           (dialog.wanted.hasImage ? "" : " Without the image.");
  ImGui::TextColored(colour::kDim, "%s", contents.isMeasured ? size.c_str() : "Files are being counted…");
  frame.automation.value(kReportArea, "size", contents.isMeasured ? size : std::string());
  ImGui::BeginDisabled(!contents.isMeasured);
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isSaved = ImGui::Button("Save…", ImVec2(frame.theme.px(120.0f), 0));
  ImGui::PopStyleColor();
  ImGui::EndDisabled();
  markItem(frame, kReportArea, "save", contents.isMeasured);
  itemTooltip(frame, "Writes one file. c3de replay FILE repeats its recording, c3de info FILE shows the rest");
  ImGui::SameLine();
  if (isSaved) {
    isShown = false;
    ImGui::CloseCurrentPopup();
  }
  endDialog(frame, isShown);
  dialog.isShown = isShown;
  if (isSaved) chooseReportFile(frame, contents);
}

}  // namespace c3de::ui
