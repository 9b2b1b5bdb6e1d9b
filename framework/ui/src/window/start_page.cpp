// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/start_page.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/core/background_jobs.h"
#include "c3de/core/path_text.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/scene/scene_graph.h"
#include "window/chrome.h"
#include "window/execute_command.h"

namespace c3de::ui {
namespace {

constexpr const char *kStartArea = "start";
constexpr float kCardPadding = 8.0f, kCardGap = 12.0f;  // logical pixels

/// Size of a recent file on the page.
ImVec2 cardSize(const FrameContext &frame) {
  return {frame.theme.px(static_cast<float>(kThumbnailWidth) + 2.0f * kCardPadding),
          frame.theme.px(static_cast<float>(kThumbnailHeight) + 2.0f * kCardPadding + 6.0f) +
              frame.theme.bold->FontSize + 2.0f * frame.theme.small->FontSize + frame.theme.px(8.0f)};
}

bool isPageWanted(const FrameContext &frame) {
  if (frame.services.startPage == nullptr || frame.simulation.exists || frame.shownImages()) return false;
  if (frame.services.panels && frame.services.panels->hasViewPanel()) return false;
  if (frame.services.scene && !frame.services.scene->rows().empty()) return false;
  // A file that is being opened at the start of the program is shown without the page before it.
  const bool isBusy = frame.services.jobs && !frame.services.jobs->running().empty();
  return !isBusy || frame.state.startPage.isShown;
}

void openRecent(const FrameContext &frame, const RecentItem &item) {
  if (frame.actions.open && !item.isMissing) frame.actions.open({item.file.files, item.file.meshUnit, false});
}

/// The recent file that Enter opens. @param recent  not empty
std::size_t markedItem(const StartPageState &state, const std::vector<RecentItem> &recent) {
  if (state.marked) return std::min(*state.marked, recent.size() - 1);
  const auto first = std::find_if(recent.begin(), recent.end(), [](const RecentItem &item) { return !item.isMissing; });
  return first == recent.end() ? 0 : static_cast<std::size_t>(first - recent.begin());
}

/// The end of a path is more informative than its beginning.
std::string elidedPath(const std::string &path, float width) {
  std::string shown = path;
  for (std::size_t cut = 0; ImGui::CalcTextSize(shown.c_str()).x > width && cut + 1 < path.size();) {
    do ++cut;
    while (cut + 1 < path.size() && (static_cast<unsigned char>(path[cut]) & 0xC0u) == 0x80u);
    shown = "…" + path.substr(cut);
  }
  return shown;
}

/// Wraps to the next line if the button does not fit.
bool pageButton(FrameContext &frame, const char *id, const char *label, const std::string &doc, bool isMain) {
  const float width = ImGui::CalcTextSize(label).x + frame.theme.px(36.0f);
  if (ImGui::GetCursorPosX() + width > ImGui::GetContentRegionMax().x) ImGui::NewLine();
  if (isMain) ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isPressed = ImGui::Button(label, ImVec2(width, 1.4f * ImGui::GetFrameHeight()));
  if (isMain) ImGui::PopStyleColor();
  markItem(frame, kStartArea, id);
  itemTooltip(frame, doc);
  ImGui::SameLine(0.0f, frame.theme.px(kCardGap));
  return isPressed;
}

void drawButtons(FrameContext &frame) {
  const auto commandButton = [&](const char *id, const char *label, Command command) {
    if (pageButton(frame, id, label, commandInfo(command).doc, true)) frame.request(command);
  };
  commandButton("open_scan", "Open scan…", Command::openImage);
  commandButton("open_folder", "Open DICOM folder…", Command::openFolder);
  if (pageButton(frame, "open_scene", "Open scene or session…", "Open a scene (TOML) or continue a session (.c3de)",
                 true))
    openSceneOrSession(frame);
  ImGui::NewLine();
  ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
  std::optional<std::filesystem::path> example;
  for (const ExampleScene &one : frame.services.startPage->examples)
    if (pageButton(frame, ("example." + one.id).c_str(), one.label.c_str(), one.doc, false)) example = one.file;
  ImGui::NewLine();
  if (example && frame.actions.open) frame.actions.open({{*example}, {}, false});
}

void drawTexts(const FrameContext &frame, const RecentItem &item, ImVec2 at, float width) {
  ImDrawList *list = ImGui::GetWindowDrawList();
  const ImU32 dim = ImGui::GetColorU32(item.isMissing ? ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled) : colour::kDim);
  const auto line = [&](ImFont *font, ImU32 tint, const auto &text) {
    ImGui::PushFont(font);
    list->AddText(font, font->FontSize, at, tint, text(width).c_str());
    ImGui::PopFont();
    at.y += font->FontSize + frame.theme.px(3.0f);
  };
  line(frame.theme.bold, item.isMissing ? dim : ImGui::GetColorU32(colour::kText),
       [&](float room) { return elided(nameText(item.file), room); });
  line(frame.theme.small, dim,
       [&](float room) { return elidedPath(pathText(item.file.files.front().parent_path()), room); });
  line(frame.theme.small, dim,
       [&](float room) { return elided(std::string(kindText(item.file.kind)) + ", " + dateText(item.file), room); });
}

void drawPicture(const FrameContext &frame, PictureTextures &textures, const RecentItem &item, ImVec2 min, ImVec2 max) {
  ImDrawList *list = ImGui::GetWindowDrawList();
  if (item.picture) {
    const ImVec4 tint = item.isMissing ? ImVec4(1, 1, 1, 0.25f) : ImVec4(1, 1, 1, 1);
    list->AddImage(textures.of(item.picture), min, max, ImVec2(0, 0), ImVec2(1, 1), ImGui::GetColorU32(tint));
  } else {
    list->AddRectFilled(min, max, ImGui::GetColorU32(ImVec4(0.08f, 0.09f, 0.11f, 1.0f)));
  }
  const char *text = item.isMissing ? "missing" : item.picture ? "" : kindText(item.file.kind);
  const ImVec2 size = ImGui::CalcTextSize(text);
  const float y = item.isMissing ? min.y + 0.2f * (max.y - min.y) : 0.5f * (min.y + max.y - size.y);
  const ImVec2 at(0.5f * (min.x + max.x - size.x), y);
  if (item.isMissing)
    list->AddRectFilled(ImVec2(at.x - frame.theme.px(8.0f), at.y - frame.theme.px(2.0f)),
                        ImVec2(at.x + size.x + frame.theme.px(8.0f), at.y + size.y + frame.theme.px(2.0f)),
                        ImGui::GetColorU32(ImVec4(0.08f, 0.09f, 0.11f, 0.9f)), frame.theme.px(4.0f));
  list->AddText(at, ImGui::GetColorU32(item.isMissing ? colour::kWarn : colour::kDim), text);
}

/// What the user did with a recent file.
struct CardAction {
  const RecentItem *opened = nullptr, *removed = nullptr;
};

void drawCardMenu(FrameContext &frame, const RecentItem &item, const std::string &id, CardAction &action) {
  if (!ImGui::BeginPopup("card")) return;
  if (ImGui::MenuItem("Open", nullptr, false, !item.isMissing)) action.opened = &item;
  markItem(frame, kStartArea, id + ".open", !item.isMissing);
  if (ImGui::MenuItem("Remove from list")) action.removed = &item;
  markItem(frame, kStartArea, id + ".remove");
  ImGui::EndPopup();
}

void drawCard(FrameContext &frame, PictureTextures &textures, std::size_t index, const RecentItem &item,
              CardAction &action) {
  const std::string id = "recent." + std::to_string(index);
  const ImVec2 size = cardSize(frame), at = ImGui::GetCursorScreenPos(), end(at.x + size.x, at.y + size.y);
  const float padding = frame.theme.px(kCardPadding);
  const ImVec2 pictureMin(at.x + padding, at.y + padding);
  const ImVec2 pictureMax(pictureMin.x + frame.theme.px(kThumbnailWidth),
                          pictureMin.y + frame.theme.px(kThumbnailHeight));
  ImGui::PushID(static_cast<int>(index));
  ImGui::BeginGroup();
  const ImVec2 begin = ImGui::GetCursorPos();
  if (item.isMissing)
    ImGui::Dummy(size);
  else if (ImGui::InvisibleButton("card", size))
    action.opened = &item;
  markItem(frame, kStartArea, id, !item.isMissing);
  const bool isHovered = ImGui::IsItemHovered();
  std::string paths;
  for (const std::filesystem::path &file : item.file.files) paths += (paths.empty() ? "" : "\n") + pathText(file);
  itemTooltip(frame, item.isMissing ? paths + "\nThe file does not exist any more." : paths);
  if (isHovered && ImGui::IsMouseReleased(ImGuiMouseButton_Right)) ImGui::OpenPopup("card");
  StartPageState &state = frame.state.startPage;
  const bool isMarked = markedItem(state, frame.services.startPage->recent) == index;
  if (isMarked && state.isMarkMoved) ImGui::SetScrollHereY();
  ImDrawList *list = ImGui::GetWindowDrawList();
  const ImGuiCol fill = isHovered && !item.isMissing ? ImGuiCol_HeaderHovered : ImGuiCol_Header;
  list->AddRectFilled(at, end, ImGui::GetColorU32(fill, item.isMissing ? 0.5f : 1.0f), frame.theme.px(5.0f));
  if (isMarked)
    list->AddRect(at, end, ImGui::GetColorU32(colour::kAccent), frame.theme.px(5.0f), 0, frame.theme.px(1.5f));
  drawPicture(frame, textures, item, pictureMin, pictureMax);
  drawTexts(frame, item, ImVec2(pictureMin.x, pictureMax.y + frame.theme.px(6.0f)), pictureMax.x - pictureMin.x);
  if (item.isMissing) {
    const ImVec2 after = ImGui::GetCursorPos();
    const float width = frame.theme.px(140.0f);
    ImGui::SetCursorPos(
        ImVec2(begin.x + 0.5f * (size.x - width), begin.y + padding + 0.55f * (pictureMax.y - pictureMin.y)));
    if (ImGui::Button("Remove from list", ImVec2(width, 0))) action.removed = &item;
    markItem(frame, kStartArea, id + ".remove");
    ImGui::SetCursorPos(after);
  }
  drawCardMenu(frame, item, id, action);
  ImGui::EndGroup();
  ImGui::PopID();
  frame.automation.value(kStartArea, id, nameText(item.file));
  frame.automation.value(kStartArea, id + ".kind", kindText(item.file.kind));
  frame.automation.value(kStartArea, id + ".state",
                         item.isMissing ? "missing"
                         : item.picture ? "with picture"
                                        : "listed");
}

void takeKeys(FrameContext &frame, std::size_t columns, CardAction &action) {
  StartPageState &state = frame.state.startPage;
  const std::vector<RecentItem> &recent = frame.services.startPage->recent;
  const Modes::Above above = frame.above();
  if (recent.empty() || above.isPopup || above.isTyping || ImGui::IsAnyItemActive()) return;
  const auto isPressed = [](ImGuiKey key, bool repeats) {
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeats);
  };
  const std::pair<ImGuiKey, GridStep> steps[] = {{ImGuiKey_LeftArrow, GridStep::left},
                                                 {ImGuiKey_RightArrow, GridStep::right},
                                                 {ImGuiKey_UpArrow, GridStep::up},
                                                 {ImGuiKey_DownArrow, GridStep::down}};
  for (const auto &[key, step] : steps)
    if (isPressed(key, true)) {
      state.marked = nextCell(markedItem(state, recent), recent.size(), columns, step);
      state.isMarkMoved = true;
    }
  if (isPressed(ImGuiKey_Enter, false) || isPressed(ImGuiKey_KeyPadEnter, false))
    action.opened = &recent[markedItem(state, recent)];
}

void drawRecent(FrameContext &frame, PictureTextures &textures) {
  const std::vector<RecentItem> &recent = frame.services.startPage->recent;
  StartPageState &state = frame.state.startPage;
  ImGui::Dummy(ImVec2(0, frame.theme.px(10.0f)));
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted("Recent files");
  ImGui::PopFont();
  if (recent.empty()) {
    ImGui::TextColored(colour::kDim, "The files that you open are listed here.");
    return;
  }
  const float gap = frame.theme.px(kCardGap), cell = cardSize(frame).x + gap;
  const auto columns =
      static_cast<std::size_t>(std::max(1.0f, std::floor((ImGui::GetContentRegionAvail().x + gap) / cell)));
  CardAction action;
  takeKeys(frame, columns, action);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(gap, gap));
  for (std::size_t i = 0; i < recent.size(); ++i) {
    if (i % columns != 0) ImGui::SameLine();
    drawCard(frame, textures, i, recent[i], action);
  }
  ImGui::PopStyleVar();
  state.isMarkMoved = false;
  // The actions may replace the list.
  if (action.opened) return openRecent(frame, *action.opened);
  if (action.removed && frame.actions.removeRecent) frame.actions.removeRecent(RecentFile(action.removed->file));
}

/// The list is read again when the page appears, and when the user comes back from another program.
void refreshIfDue(const FrameContext &frame, bool isNew) {
  StartPageState &state = frame.state.startPage;
  const bool isBack = frame.isFocused && !state.wasFocused;
  state.wasFocused = frame.isFocused;
  if (isNew) state.marked.reset();
  if ((isNew || isBack) && frame.actions.refreshRecent) frame.actions.refreshRecent();
}

}  // namespace

void drawStartPage(FrameContext &frame, PictureTextures &textures) {
  constexpr std::size_t kMostTextures = 4 * kMaxRecentFiles;
  StartPageState &state = frame.state.startPage;
  const bool isNew = !state.isShown;
  state.isShown = isPageWanted(frame);
  if (!state.isShown || textures.count() > kMostTextures) textures.clear();
  if (!state.isShown) return;
  refreshIfDue(frame, isNew);
  beginFixed("##start", frame.area, colour::kChrome, ImVec2(frame.theme.px(28.0f), frame.theme.px(20.0f)));
  ImGui::BeginChild("scroll");
  if (isNew) ImGui::SetScrollY(0.0f);
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted("Start");
  ImGui::PopFont();
  ImGui::TextColored(colour::kDim, "Files and folders can be dropped on this window.");
  ImGui::Dummy(ImVec2(0, frame.theme.px(4.0f)));
  drawButtons(frame);
  drawRecent(frame, textures);
  ImGui::EndChild();
  ImGui::End();
  frame.state.overlays.push_back(frame.area);
}

void drawRecentMenu(FrameContext &frame) {
  const StartPage *page = frame.services.startPage;
  if (page == nullptr) return;
  StartPageState &state = frame.state.startPage;
  const bool isEnabled = !page->recent.empty();
  const bool wasOpen = state.isMenuOpen;
  state.isMenuOpen = ImGui::BeginMenu("Open recent", isEnabled);
  markOpener(frame, "menu", "file.open_recent", state.isMenuOpen, isEnabled);
  if (!state.isMenuOpen) return;
  if (!wasOpen && frame.actions.refreshRecent) frame.actions.refreshRecent();
  const RecentItem *opened = nullptr;
  for (std::size_t i = 0; i < page->recent.size(); ++i) {
    const RecentItem &item = page->recent[i];
    const std::string label =
        nameText(item.file) + (item.isMissing ? " (missing)" : "") + "###recent" + std::to_string(i);
    if (ImGui::MenuItem(label.c_str(), kindText(item.file.kind), false, !item.isMissing)) opened = &item;
    markItem(frame, "menu", "file.recent." + std::to_string(i), !item.isMissing);
    itemTooltip(frame, pathText(item.file.files.front()));
  }
  ImGui::Separator();
  const bool isCleared = ImGui::MenuItem("Clear list");
  markItem(frame, "menu", "file.clear_recent");
  itemTooltip(frame, "Remove all entries; the files themselves stay");
  ImGui::EndMenu();
  if (opened) return openRecent(frame, *opened);
  if (isCleared && frame.actions.clearRecent) frame.actions.clearRecent();
}

}  // namespace c3de::ui
