// SPDX-License-Identifier: Apache-2.0
// One body of a whole scan: the material of each of its labels, and further settings.
#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <optional>

#include "c3de/segmentation/scan_body.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "frame/file_dialog.h"
#include "logic/label_list.h"
#include "panels/fields.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

using segmentation::LabelUse;
using segmentation::ScanBody;
using segmentation::ScanBodySettings;
constexpr const char *kArea = "scan";
constexpr float kHandleSize = 12.0f;  // logical pixels
constexpr float kFindingLines = 6.0f;
constexpr double kFewestPoints = 50.0, kMaxPoints = 200000.0;

void checkbox(FrameContext &frame, const char *id, const char *label, bool &value, const char *doc) {
  ImGui::Checkbox((std::string(label) + "###" + id).c_str(), &value);
  markItem(frame, kArea, id);
  frame.automation.value(kArea, id, value ? "true" : "false");
  itemTooltip(frame, doc);
}

/// A number followed by its unit.
void number(FrameContext &frame, const std::string &id, const char *label, const std::string &unit, double &value) {
  ImGui::SameLine();
  ImGui::TextUnformatted(label);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(frame.theme.px(84.0f));
  double typed = value;
  if (ImGui::InputDouble(("###" + id).c_str(), &typed, 0.0, 0.0, "%.6g") && std::isfinite(typed)) value = typed;
  markItem(frame, kArea, id);
  frame.automation.value(kArea, id, shortNumber(value));
  if (unit.empty()) return;
  ImGui::SameLine();
  ImGui::TextColored(colour::kDim, "%s", unit.c_str());
}

void choice(FrameContext &frame, const std::string &id, float width, const std::vector<std::string> &names,
            std::uint32_t &index) {
  ImGui::SetNextItemWidth(width);
  (void)choiceField(frame, kArea, id, names, index);
}

/// Possible uses of a label; the rest of the list are presets.
std::vector<LabelUse> usesOf(const ScanBody &scan, bool isAir) {
  std::vector<LabelUse> uses{{LabelUse::Kind::none, {}}, {LabelUse::Kind::rigid, {}}};
  if (isAir) uses.push_back({LabelUse::Kind::air, {}});
  for (const scene::MaterialPreset &preset : scan.materials().presets())
    uses.push_back({LabelUse::Kind::material, preset.name});
  return uses;
}

std::string nameOf(const LabelUse &use, bool hasBackground) {
  switch (use.kind) {
    case LabelUse::Kind::none: return hasBackground ? "background" : "left out";
    case LabelUse::Kind::air: return "air";
    case LabelUse::Kind::rigid: return "rigid";
    case LabelUse::Kind::material: break;
  }
  return use.preset;
}

void drawRow(FrameContext &frame, ScanBody &scan, std::size_t at) {
  const ScanBody::Row &row = scan.rows()[at];
  ImGui::PushID(static_cast<int>(at));
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  swatch({row.colour[0], row.colour[1], row.colour[2]});
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(row.name.c_str());
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  if (row.known.empty())
    ImGui::TextColored(colour::kWarn, "not known");
  else
    ImGui::TextUnformatted(row.known.c_str());
  frame.automation.value(kArea, row.name + ".known", row.known.empty() ? "not known" : row.known);
  itemTooltip(frame, row.known.empty() ? "No known tissue has this name; choose one" : row.remark);
  ImGui::TableNextColumn();
  const std::vector<LabelUse> uses = usesOf(scan, row.isAir);
  std::vector<std::string> names;
  std::uint32_t index = 0;
  for (const LabelUse &use : uses) {
    if (use == row.use) index = static_cast<std::uint32_t>(names.size());
    names.push_back(nameOf(use, scan.settings().hasBackground));
  }
  const std::uint32_t before = index;
  choice(frame, "use." + row.name, -FLT_MIN, names, index);
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  if (row.material != nullptr) {
    const std::string stiffness = segmentation::stiffnessText(
        row.material->youngsModulus, row.material->youngsModulusMin, row.material->youngsModulusMax);
    ImGui::TextUnformatted(stiffness.c_str());
    frame.automation.value(kArea, row.name + ".stiffness", stiffness);
    itemTooltip(frame, row.material->evidence + "\n" + row.material->source);
  } else {
    ImGui::TextColored(colour::kDim, "–");
  }
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  const std::string volume = row.volume_ml ? fmt::format("{:.1f} ml", *row.volume_ml) : std::string("… ml");
  ImGui::TextUnformatted(volume.c_str());
  frame.automation.value(kArea, row.name + ".volume", volume);
  ImGui::PopID();
  if (index != before) scan.setUse({at}, uses[index]);
}

/// One material for all listed labels, and the button that reverts it.
void drawListed(FrameContext &frame, ScanBody &scan, const std::vector<std::size_t> &listed) {
  const std::vector<LabelUse> uses = usesOf(scan, false);
  std::vector<std::string> names;
  for (const LabelUse &use : uses) names.push_back(nameOf(use, scan.settings().hasBackground));
  names.emplace_back("All listed are…");
  const auto none = static_cast<std::uint32_t>(uses.size());
  const float undo = frame.theme.px(64.0f), list = frame.theme.px(170.0f);
  ImGui::SameLine(ImGui::GetContentRegionMax().x - undo - list - ImGui::GetStyle().ItemSpacing.x);
  std::uint32_t index = none;
  choice(frame, "use_listed", list, names, index);
  if (index != none) scan.setUse(listed, uses[index]);
  ImGui::SameLine();
  ImGui::BeginDisabled(!scan.canUndo());
  if (ImGui::Button("Undo###undo", ImVec2(undo, 0))) scan.undo();
  markItem(frame, kArea, "undo", scan.canUndo());
  itemTooltip(frame, "Undoes the last change of a material or of the region (Ctrl+Z)");
  ImGui::EndDisabled();
}

void drawLabels(FrameContext &frame, ScanBody &scan, float below) {
  std::array<char, 128> &filter = frame.state.labelFilter;
  ImGui::SetNextItemWidth(frame.theme.px(280.0f));
  ImGui::InputTextWithHint("###filter", "Filter: kidney, lung left, not known", filter.data(), filter.size());
  markItem(frame, kArea, "filter");
  std::vector<std::size_t> listed;
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < scan.rows().size(); ++i) {
    const ScanBody::Row &row = scan.rows()[i];
    unknown += row.known.empty() ? 1 : 0;
    if (isListed(row.name + " " + (row.known.empty() ? "not known" : row.known), filter.data())) listed.push_back(i);
  }
  ImGui::SameLine();
  const std::string count =
      fmt::format("{} of {} labels, {} not known by their names", listed.size(), scan.rows().size(), unknown);
  ImGui::TextColored(unknown > 0 ? colour::kWarn : colour::kDim, "%s", count.c_str());
  frame.automation.value(kArea, "count", count);
  drawListed(frame, scan, listed);
  if (!ImGui::BeginTable(
          "labels", 5,
          ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_Resizable,
          ImVec2(0, -below)))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("Label", ImGuiTableColumnFlags_WidthStretch, 0.26f);
  ImGui::TableSetupColumn("Assigned tissue", ImGuiTableColumnFlags_WidthStretch, 0.16f);
  ImGui::TableSetupColumn("Material", ImGuiTableColumnFlags_WidthStretch, 0.24f);
  ImGui::TableSetupColumn("Young's modulus (range)", ImGuiTableColumnFlags_WidthStretch, 0.24f);
  ImGui::TableSetupColumn("Volume", ImGuiTableColumnFlags_WidthStretch, 0.1f);
  ImGui::TableHeadersRow();
  for (const std::size_t at : listed) drawRow(frame, scan, at);
  ImGui::EndTable();
}

void drawBackground(FrameContext &frame, const ScanBody &scan, ScanBodySettings &settings) {
  checkbox(frame, "background", "Background", settings.hasBackground,
           "What has no label, where the image has values between the two. Without it that is left out");
  // Without a background, organs are separate.
  if (settings.hasBackground != scan.settings().hasBackground) settings.largestOnly = settings.hasBackground;
  if (!settings.hasBackground) return;
  const std::vector<std::string> names = scan.materials().names();
  auto index = static_cast<std::uint32_t>(std::find(names.begin(), names.end(), settings.background) - names.begin());
  ImGui::SameLine();
  choice(frame, "background.material", frame.theme.px(180.0f), names, index);
  if (index < names.size()) settings.background = names[index];
  number(frame, "from", "from", "", settings.from);
  number(frame, "to", "to", scan.unit(), settings.to);
  frame.automation.value(kArea, "unit", scan.unit());
}

/// True if the region is to be drawn.
bool drawRegion(FrameContext &frame, const ScanBody &scan, ScanBodySettings &settings) {
  bool hasRegion = settings.region.has_value();
  checkbox(frame, "region", "Only a region", hasRegion,
           "A box along the axes of the patient, LPS: what lies outside is left out");
  ImGui::SameLine();
  const bool isDrawn = ImGui::Button("Draw in slices…");
  markItem(frame, kArea, "draw_region");
  itemTooltip(frame, "As a box over the slices, by mouse; then back to here");
  if (!hasRegion) {
    settings.region.reset();
    return isDrawn;
  }
  if (!settings.region) settings.region = scan.extent_mm();
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    number(frame, "region." + axis + ".from", axis.c_str(), "", (*settings.region)[0][a]);
    number(frame, "region." + axis + ".to", "…", a == 2 ? "mm" : "", (*settings.region)[1][a]);
  }
  return isDrawn;
}

/// True if the region is to be drawn.
bool drawSettings(FrameContext &frame, ScanBody &scan) {
  ScanBodySettings settings = scan.settings();
  drawBackground(frame, scan, settings);
  checkbox(frame, "largest", "Largest piece only", settings.largestOnly, "Exclude disconnected parts (e.g. the table)");
  number(frame, "points", "    Points", "", settings.points);
  settings.points = std::clamp(settings.points, kFewestPoints, kMaxPoints);
  checkbox(frame, "gravity", "Gravity, in balance with the scan", settings.hasGravity,
           "The scan shows the body as it lies in this gravity: it rests, and sinks when gravity becomes another one");
  if (settings.hasGravity) {
    auto posture = static_cast<std::uint32_t>(settings.posture);
    ImGui::SameLine();
    choice(frame, "posture", frame.theme.px(220.0f),
           {"supine", "prone", "lying on the left side", "lying on the right side", "upright"}, posture);
    settings.posture = static_cast<segmentation::Posture>(posture);
  }
  const bool isDrawn = drawRegion(frame, scan, settings);
  scan.setSettings(settings);
  return isDrawn;
}

/// Contradictions between image and labels, with a button if a limit of the background helps.
void drawFindings(FrameContext &frame, ScanBody &scan) {
  const std::vector<segmentation::LabelFinding> &findings = scan.findings();
  std::string all;
  ImGui::BeginChild("findings", ImVec2(0, kFindingLines * ImGui::GetTextLineHeightWithSpacing()));
  std::optional<double> chosen;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const segmentation::LabelFinding &finding = findings[i];
    const std::string text = finding.text + ": " + finding.advice + ".";
    if (finding.to) {
      const std::string id = "finding_to." + std::to_string(i);
      if (ImGui::SmallButton((fmt::format("Background to {}", shortNumber(*finding.to)) + "###" + id).c_str()))
        chosen = finding.to;
      markItem(frame, kArea, id);
      itemTooltip(frame, "Sets the upper limit of the background");
      ImGui::SameLine();
    }
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextColored(colour::kWarn, "%s", text.c_str());
    ImGui::PopTextWrapPos();
    all += (all.empty() ? "" : "\n") + text;
  }
  ImGui::EndChild();
  frame.automation.value(kArea, "findings", all);
  if (!chosen) return;
  ScanBodySettings settings = scan.settings();
  settings.to = *chosen;
  scan.setSettings(settings);
}

}  // namespace

void drawScanBody(FrameContext &frame) {
  ScanBody *scan = frame.services.scanBody;
  // The dialog reappears when the file dialog closes, and when drawing of the region ends.
  if (scan == nullptr || !scan->isShown() || scan->isHiddenTemporarily() || frame.fileDialog.isOpen()) return;
  bool isShown = true;
  if (!beginDialog(frame, "Create body from scan", "create_scan_body", isShown, ImVec2(980, 700))) {
    if (!isShown) scan->show(false);
    return;
  }
  const bool hasFindings = !scan->findings().empty();
  const float lines = 5.0f * ImGui::GetFrameHeightWithSpacing() +
                      (2.0f + (hasFindings ? kFindingLines : 0.0f)) * ImGui::GetTextLineHeightWithSpacing();
  drawLabels(frame, *scan, lines + frame.theme.px(8.0f));
  const bool isDrawn = drawSettings(frame, *scan);
  if (hasFindings)
    drawFindings(frame, *scan);
  else
    frame.automation.value(kArea, "findings", "");
  const std::string reason = scan->blockingReason();
  ImGui::BeginChild("reason", ImVec2(0, 2.0f * ImGui::GetTextLineHeightWithSpacing()));
  ImGui::PushTextWrapPos(0.0f);
  if (!scan->problem().empty()) ImGui::TextColored(colour::kError, "%s", scan->problem().c_str());
  if (!reason.empty()) ImGui::TextColored(colour::kWarn, "Not yet: %s.", reason.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndChild();
  frame.automation.value(kArea, "problem", scan->problem());
  frame.automation.value(kArea, "reason", reason);
  ImGui::BeginDisabled(!reason.empty());
  const bool isMade = ImGui::Button("Make", ImVec2(frame.theme.px(120.0f), 0));
  markItem(frame, kArea, "make", reason.empty());
  itemTooltip(frame, "Runs in the background and can be cancelled; the current scene is kept until it is complete");
  ImGui::EndDisabled();
  ImGui::SameLine();
  const bool isComplete = scan->sceneReason().empty();
  ImGui::BeginDisabled(!isComplete);
  const bool isSaved = ImGui::Button("Save scene…", ImVec2(frame.theme.px(120.0f), 0));
  markItem(frame, kArea, "save", isComplete);
  itemTooltip(frame, "Write these settings as a scene file, to open or run later");
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (isMade) isShown = false;
  if (isMade || isSaved || isDrawn) ImGui::CloseCurrentPopup();
  endDialog(frame, isShown);
  if (!isShown) scan->show(false);
  if (isMade) scan->make();
  if (isDrawn) frame.modes.beginRegion(frame.theme.px(kHandleSize));
  if (!isSaved) return;
  FileDialog::Request request;
  request.title = "Save the scene of the scan";
  request.extensions = "toml";
  request.isSaving = true;
  request.proposed = "scan.toml";
  request.chosen = [save = frame.actions.saveScanScene](const std::filesystem::path &file, const std::string &) {
    if (save) save(file);
  };
  frame.fileDialog.open(std::move(request));
}

}  // namespace c3de::ui
