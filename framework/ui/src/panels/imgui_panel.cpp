// SPDX-License-Identifier: Apache-2.0
#include "panels/imgui_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/registry/number_text.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/plain_words.h"
#include "frame/file_dialog.h"

namespace c3de::ui {
namespace {

constexpr std::uint32_t kListRows = 12, kMaxListRows = 100;
constexpr float kCurveRows = 3.0f;

std::string significant(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string text(c3de_str s) { return displayText(fromAbi(s), Lines::many); }

void wrappedText(const std::string &shown) {
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(shown.data(), shown.data() + shown.size());
  ImGui::PopTextWrapPos();
}

}  // namespace

ImGuiPanels::ImGuiPanels() { fillTable(); }

std::string ImGuiPanels::plainText(c3de_str shown) const {
  const registry::ParameterRegistry *parameters = frame_->services.parameters;
  return parameters ? registry::plainWords(text(shown), *parameters) : text(shown);
}

void ImGuiPanels::draw(FrameContext &frame, const registry::Panel &panel) {
  if (!panel.onUi) return;
  frame_ = &frame;
  thread_ = std::this_thread::get_id();
  area_ = panel.id;
  used_.clear();
  isSameLine_ = isRowBegun_ = false;
  ImGui::PushID(panel.id.c_str());
  SearchedPanel &searched = searched_[panel.id];
  searched.top = ImGui::GetCursorScreenPos().y;
  drawSearchField(searched);
  search_ = &searched.rows;
  search_->begin();
  isLocked_ = frame.simulation.replay != nullptr;
  if (isLocked_) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextColored(colour::kWarn, "%s", kReplayLocks);
    ImGui::PopTextWrapPos();
  }
  ImGui::BeginDisabled(isLocked_);
  panel.onUi(panel.self, &table_);
  listEnd();
  ImGui::EndDisabled();
  search_->end();
  drawSearchResult(*search_);
  searched.bottom = ImGui::GetCursorScreenPos().y;
  searched.frame = frame.frame;
  search_ = nullptr;
  ImGui::PopID();
  frame_ = nullptr;
}

std::string ImGuiPanels::uniqueId(c3de_str id) {
  const std::string wanted = text(id);
  std::string unique = wanted.empty() ? "unnamed" : wanted;
  for (int i = 2; !used_.insert(unique).second; ++i)
    unique = (wanted.empty() ? "unnamed" : wanted) + "#" + std::to_string(i);
  return unique;
}

bool ImGuiPanels::isDrawn(const std::string &key, const std::string &texts, RowSearch::Kind kind) {
  if (isInList_) return true;
  return follow(search_->row(key, texts, kind));
}

// A widget beside a hidden one begins a row itself.
bool ImGuiPanels::follow(bool isShown) {
  if (!search_->isActive()) return true;
  if (!isSameLine_) isRowBegun_ = false;
  if (!isShown) {
    isSameLine_ = false;
    return false;
  }
  isSameLine_ = isSameLine_ && isRowBegun_;
  isRowBegun_ = true;
  if (const auto heading = search_->takeHeading()) drawHeading(*heading);
  return true;
}

bool ImGuiPanels::isOfTheView(const std::string &id) const { return isLocked_ && id.starts_with("view."); }

bool ImGuiPanels::takeSameLine(const std::string &key) {
  const bool was = std::exchange(isSameLine_, false);
  if (was)
    ImGui::SameLine();
  else if (!key.empty())
    frame_->state.sideRows.row(area_ + "/" + key);
  return was;
}

std::uint32_t ImGuiPanels::button(c3de_str id, c3de_str label, bool isEnabled) {
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return 0;
  takeSameLine(unique);
  const bool isFree = isOfTheView(unique);
  if (isFree) ImGui::EndDisabled();
  ImGui::BeginDisabled(!isEnabled);
  const bool isPressed = ImGui::Button((text(label) + "###" + unique).c_str());
  ImGui::EndDisabled();
  if (isFree) ImGui::BeginDisabled(isLocked_);
  markItem(*frame_, area_, unique, isEnabled);
  return isPressed && isEnabled ? C3DE_UI_COMMITTED : 0;
}

std::uint32_t ImGuiPanels::checkbox(c3de_str id, c3de_str label, std::uint32_t *value) {
  if (!value) return 0;
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return 0;
  takeSameLine(unique);
  bool isChecked = *value != 0;
  const bool isChanged = ImGui::Checkbox((text(label) + "###" + unique).c_str(), &isChecked);
  markItem(*frame_, area_, unique);
  if (isChanged) *value = isChecked ? 1 : 0;
  frame_->automation.value(area_, unique, *value ? "true" : "false");
  return isChanged ? C3DE_UI_CHANGED | C3DE_UI_COMMITTED : 0;
}

std::uint32_t ImGuiPanels::slider(c3de_str id, c3de_str label, c3de_str unit, double *value, double lo, double hi) {
  if (!value) return 0;
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return 0;
  const bool isInline = takeSameLine(unique);
  FieldState &state = field(unique);
  NumberSpec spec;
  spec.low = lo;
  spec.high = hi;
  spec.unit = text(unit);
  const auto check = [&](double x) -> Expected<void> {
    if (std::isfinite(x) && (!(lo <= hi) || (x >= lo && x <= hi))) return {};
    const std::string unitText = spec.unit.empty() ? "" : " " + spec.unit;
    return fail(ErrorCode::usage, formatNumber(x) + " is not accepted; accepted: " + formatNumber(lo) + " … " +
                                      formatNumber(hi) + unitText);
  };
  beginRow(*frame_, text(label), nullptr, isInline, 0.0f);
  const std::uint32_t result = numberField(*frame_, area_, unique, state, spec, *value, check);
  endRow();
  fieldError(*frame_, state);
  return result;
}

std::uint32_t ImGuiPanels::choice(c3de_str id, c3de_str label, std::uint32_t *index, const c3de_str *names,
                                  std::uint64_t n) {
  if (!index) return 0;
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return 0;
  const bool isInline = takeSameLine(unique);
  std::vector<std::string> list;
  for (std::uint64_t i = 0; names && i < n; ++i) list.push_back(text(names[i]));
  beginRow(*frame_, text(label), nullptr, isInline, 0.0f);
  const std::uint32_t result = choiceField(*frame_, area_, unique, list, *index);
  endRow();
  return result;
}

std::uint32_t ImGuiPanels::inputText(c3de_str id, c3de_str label, char *buffer, std::uint64_t capacity) {
  if (!buffer || capacity == 0) return 0;
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return 0;
  const bool isInline = takeSameLine(unique);
  buffer[capacity - 1] = '\0';
  beginRow(*frame_, text(label), nullptr, isInline, 0.0f);
  std::uint32_t result = 0;
  if (ImGui::InputText(("###" + unique).c_str(), buffer, static_cast<std::size_t>(capacity))) result |= C3DE_UI_CHANGED;
  if (ImGui::IsItemActive()) result |= C3DE_UI_ACTIVE;
  if (ImGui::IsItemDeactivatedAfterEdit()) result |= C3DE_UI_COMMITTED;
  markItem(*frame_, area_, unique);
  endRow();
  frame_->automation.value(area_, unique, std::string(registry::bufferText(buffer, capacity)));
  return result;
}

std::uint32_t ImGuiPanels::fileButton(c3de_str id, c3de_str label, c3de_str extensions, char *buffer,
                                      std::uint64_t capacity) {
  if (!buffer || capacity == 0) return 0;
  const std::string unique = uniqueId(id);
  FieldState &state = field(unique);
  // A chosen file is delivered even if the search hides the row meanwhile.
  if (!isDrawn(unique, text(label) + '\n' + unique) && !state.chosenFile) return 0;
  takeSameLine(unique);
  std::uint32_t result = 0;
  if (state.chosenFile) {
    if (state.chosenFile->size() < capacity) {
      registry::copyText(buffer, capacity, *state.chosenFile);
      result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
      state.error.clear();
    } else {
      state.error = "the path is too long: " + std::to_string(state.chosenFile->size()) + " bytes; accepted: below " +
                    std::to_string(capacity);
    }
    state.chosenFile.reset();
  }

  ImGui::BeginGroup();
  if (ImGui::Button((text(label) + "###" + unique).c_str())) {
    FileDialog::Request request;
    request.title = text(label);
    request.extensions = text(extensions);
    // The result is stored here until the panel is drawn again; the panel or the plugin may no longer exist by then.
    request.chosen = [this, key = area_ + "/" + unique](const std::filesystem::path &file, const std::string &) {
      fields_[key].chosenFile = pathText(file);
    };
    frame_->fileDialog.open(std::move(request));
  }
  markItem(*frame_, area_, unique);
  const std::string chosen(registry::bufferText(buffer, capacity));
  ImGui::SameLine();
  const std::string name = chosen.empty() ? "no file" : pathText(pathFromText(chosen).filename());
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(chosen.empty() ? colour::kDim : colour::kText, "%s",
                     elided(name, ImGui::GetContentRegionAvail().x).c_str());
  ImGui::EndGroup();
  itemTooltip(*frame_, chosen);
  fieldError(*frame_, state);
  frame_->automation.value(area_, unique, chosen);
  return result;
}

void ImGuiPanels::listBegin(c3de_str id, std::uint32_t rows) {
  listEnd();
  isSameLine_ = false;
  if (search_->isActive()) return;  // its rows are those of the panel
  const float height =
      static_cast<float>(rows == 0 ? kListRows : std::min(rows, kMaxListRows)) * ImGui::GetFrameHeightWithSpacing();
  const std::string unique = uniqueId(id);
  takeSameLine(unique);
  ImGui::BeginChild(("###list" + unique).c_str(), ImVec2(0.0f, height + 2.0f * ImGui::GetStyle().WindowPadding.y),
                    true);
  isInList_ = true;
}

void ImGuiPanels::listEnd() {
  if (!isInList_) return;
  isInList_ = isSameLine_ = false;
  ImGui::EndChild();
}

void ImGuiPanels::curve(c3de_str id, c3de_str label, c3de_str unit, std::span<const double> values) {
  const std::string unique = uniqueId(id);
  if (!isDrawn(unique, text(label) + '\n' + unique)) return;
  takeSameLine(unique);
  double low = 0.0, high = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  ImGui::TextColored(colour::kDim, "%s", text(label).c_str());
  const std::string highText = significant(high) + " " + text(unit), lowText = significant(low);
  const float beside = frame_->theme.px(6.0f), height = kCurveRows * ImGui::GetFrameHeight();
  const float width =
      std::max(1.0f, ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(highText.c_str()).x - beside);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::Dummy(ImVec2(width, height));
  markItem(*frame_, area_, unique);
  ImDrawList &draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, ImVec2(at.x + width, at.y + height), ImGui::GetColorU32(ImGuiCol_FrameBg));
  const double range = high > low ? high - low : 1.0;
  const auto pointOf = [&](std::size_t i) {
    const double along = values.size() > 1 ? static_cast<double>(i) / static_cast<double>(values.size() - 1) : 1.0;
    return ImVec2(at.x + static_cast<float>(along) * width,
                  at.y + static_cast<float>((high - values[i]) / range) * height);
  };
  for (std::size_t i = 1; i < values.size(); ++i)
    if (std::isfinite(values[i - 1]) && std::isfinite(values[i]))
      draw.AddLine(pointOf(i - 1), pointOf(i), ImGui::GetColorU32(ImGuiCol_PlotLines), frame_->theme.px(1.5f));
  const ImU32 dim = ImGui::GetColorU32(colour::kDim);
  draw.AddText(ImVec2(at.x + width + beside, at.y), dim, highText.c_str());
  draw.AddText(ImVec2(at.x + width + beside, at.y + height - ImGui::GetTextLineHeight()), dim, lowText.c_str());
  frame_->automation.value(area_, unique, values.empty() ? std::string() : significant(values.back()));
}

void ImGuiPanels::paragraph(c3de_str shown) {
  const std::string words = plainText(shown);
  // Texts have no id. Equal ones have equal matches, so that the text itself is the key.
  if (!isDrawn({}, words)) return;
  if (takeSameLine()) ImGui::AlignTextToFramePadding();
  wrappedText(words);
}

void ImGuiPanels::tooltip(c3de_str shown) {
  const std::string words = plainText(shown);
  if (!isInList_) search_->tooltip(words);
  if (isInList_ || search_->isShown()) itemTooltip(*frame_, words);
}

void ImGuiPanels::heading(c3de_str shown) {
  const std::string headingText = text(shown);
  isSameLine_ = false;
  search_->heading(headingText);
  if (search_->isActive()) return;
  (void)search_->takeHeading();
  drawHeading(headingText);
}

void ImGuiPanels::drawHeading(const std::string &headingText) {
  isSameLine_ = false;
  takeSameLine("#" + headingText);
  ImGui::Dummy(ImVec2(0.0f, frame_->theme.px(2.0f)));
  ImGui::PushFont(frame_->theme.bold);
  ImGui::TextColored(colour::kAccent, "%s", headingText.c_str());
  ImGui::PopFont();
}

void ImGuiPanels::value(c3de_str name, c3de_str shown) {
  const std::string nameText = text(name), valueText = shownText(frame_->state.preferences.units, plainText(shown));
  if (!isDrawn("=" + nameText, nameText)) return;
  frame_->automation.value(area_, nameText, valueText);
  takeSameLine("=" + nameText);
  ImGui::BeginGroup();
  const float labelWidth = std::floor(0.42f * ImGui::GetContentRegionAvail().x);
  ImGui::TextColored(colour::kDim, "%s", elided(nameText, labelWidth - frame_->theme.px(6.0f)).c_str());
  ImGui::SameLine(labelWidth);
  wrappedText(valueText);
  ImGui::EndGroup();
}

void ImGuiPanels::progress(double fraction, c3de_str shown) {
  const std::string label = text(shown);
  if (!isInList_ && !follow(search_->follower(label))) return;
  takeSameLine();
  const ImVec2 size(-1.0f, ImGui::GetFrameHeight());
  if (fraction >= 0.0) {
    ImGui::ProgressBar(static_cast<float>(std::min(fraction, 1.0)), size, label.c_str());
  } else {
    ImGui::ProgressBar(0.0f, size, label.c_str());
    const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    const float phase = static_cast<float>(std::fmod(ImGui::GetTime() * 0.6, 1.0)), width = max.x - min.x;
    const float begin = min.x + (1.25f * phase - 0.25f) * width;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(std::max(begin, min.x), max.y - frame_->theme.px(3.0f)),
                                              ImVec2(std::min(begin + 0.25f * width, max.x), max.y),
                                              ImGui::GetColorU32(colour::kAccent), 2.0f);
  }
  frame_->automation.value(area_, "progress", label);
}

void ImGuiPanels::fillTable() {
  c3de_ui_v1 &t = table_;
  t.size = sizeof t;
  t.rev = 4;
  t.ctx = this;
  t.heading = [](void *c, c3de_str s) noexcept {
    if (of(c).isUsable()) of(c).heading(s);
  };
  t.text = [](void *c, c3de_str s) noexcept {
    if (of(c).isUsable() && !fromAbi(s).empty()) of(c).paragraph(s);
  };
  t.separator = [](void *c) noexcept {
    if (!of(c).isUsable()) return;
    of(c).isSameLine_ = false;
    if (!of(c).search_->isActive()) ImGui::Separator();
  };
  t.same_line = [](void *c) noexcept {
    if (of(c).isUsable()) of(c).isSameLine_ = true;
  };
  t.button = [](void *c, c3de_str id, c3de_str label, std::uint32_t enabled) noexcept {
    return of(c).isUsable() ? of(c).button(id, label, enabled != 0) : 0u;
  };
  t.checkbox = [](void *c, c3de_str id, c3de_str label, std::uint32_t *v) noexcept {
    return of(c).isUsable() ? of(c).checkbox(id, label, v) : 0u;
  };
  t.slider = [](void *c, c3de_str id, c3de_str label, c3de_str unit, double *v, double lo, double hi) noexcept {
    return of(c).isUsable() ? of(c).slider(id, label, unit, v, lo, hi) : 0u;
  };
  t.choice = [](void *c, c3de_str id, c3de_str label, std::uint32_t *i, const c3de_str *names,
                std::uint64_t n) noexcept { return of(c).isUsable() ? of(c).choice(id, label, i, names, n) : 0u; };
  t.input_text = [](void *c, c3de_str id, c3de_str label, char *buffer, std::uint64_t capacity) noexcept {
    return of(c).isUsable() ? of(c).inputText(id, label, buffer, capacity) : 0u;
  };
  t.progress = [](void *c, double fraction, c3de_str s) noexcept {
    if (of(c).isUsable()) of(c).progress(fraction, s);
  };
  t.value = [](void *c, c3de_str name, c3de_str v) noexcept {
    if (of(c).isUsable()) of(c).value(name, v);
  };
  t.tooltip = [](void *c, c3de_str s) noexcept {
    if (of(c).isUsable()) of(c).tooltip(s);
  };
  t.params = [](void *c, c3de_handle set, c3de_str group) noexcept {
    if (of(c).isUsable()) of(c).params(set, group);
  };
  t.file_button = [](void *c, c3de_str id, c3de_str label, c3de_str extensions, char *buffer,
                     std::uint64_t capacity) noexcept {
    return of(c).isUsable() ? of(c).fileButton(id, label, extensions, buffer, capacity) : 0u;
  };
  t.swatch = [](void *c, float red, float green, float blue) noexcept {
    if (!of(c).isUsable() || (of(c).search_->isActive() && !of(c).isInList_)) return;
    of(c).takeSameLine();
    swatch({red, green, blue});
  };
  t.list_begin = [](void *c, c3de_str id, std::uint32_t rows) noexcept {
    if (of(c).isUsable()) of(c).listBegin(id, rows);
  };
  t.list_end = [](void *c) noexcept {
    if (of(c).isUsable()) of(c).listEnd();
  };
  t.curve = [](void *c, c3de_str id, c3de_str label, c3de_str unit, const double *values, std::uint64_t n) noexcept {
    if (of(c).isUsable() && (values || n == 0)) of(c).curve(id, label, unit, {values, static_cast<std::size_t>(n)});
  };
}

}  // namespace c3de::ui
