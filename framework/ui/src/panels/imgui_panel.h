// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <set>
#include <span>
#include <string>
#include <thread>

#include "c3de/abi/panels.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "frame/frame_context.h"
#include "logic/row_search.h"
#include "panels/fields.h"

namespace c3de::ui {

/// Draws plugins' panels with Dear ImGui: the c3de_ui_v1 table. This object exists as long as the window, so a table
/// stored by a plugin remains valid memory. Outside on_ui and on other threads its functions do nothing.
class ImGuiPanels {
 public:
  ImGuiPanels();
  ImGuiPanels(const ImGuiPanels &) = delete;
  ImGuiPanels &operator=(const ImGuiPanels &) = delete;

  /// Draws into the present ImGui window.
  void draw(FrameContext &frame, const registry::Panel &panel);
  /// The search field of the panel under the mouse receives the keyboard, otherwise that of the panel with the most
  /// rows. False: no panel is shown.
  bool beginSearch(const FrameContext &frame);

 private:
  static ImGuiPanels &of(void *ctx) { return *static_cast<ImGuiPanels *>(ctx); }
  void fillTable();
  [[nodiscard]] bool isUsable() const { return frame_ && std::this_thread::get_id() == thread_; }
  /// Makes ids unique if a panel uses one twice.
  [[nodiscard]] std::string uniqueId(c3de_str id);
  [[nodiscard]] FieldState &field(const std::string &id) { return fields_[area_ + "/" + id]; }
  /// Whether same_line was requested for the next widget; otherwise the widget begins a row.
  /// @param key  identifies the row in all frames; empty: not anchored
  bool takeSameLine(const std::string &key = {});

  /// Whether the search draws the row; its heading is drawn before it. Call it once for each widget.
  [[nodiscard]] bool isDrawn(const std::string &key, const std::string &texts,
                             RowSearch::Kind kind = RowSearch::Kind::widget);
  [[nodiscard]] bool follow(bool isShown);
  /// How the simulation is shown is no part of it: such widgets are enabled while nothing may be changed.
  [[nodiscard]] bool isOfTheView(const std::string &id) const;

  /// Of one panel.
  struct SearchedPanel {
    RowSearch rows;
    std::array<char, 128> typed{};
    bool isWanted = false;    ///< the field receives the keyboard in the next frame
    bool isShown = false;     ///< in the last frame, because it was wanted
    bool wasFocused = false;  ///< in the last frame
    float top = 0.0f, bottom = 0.0f;
    std::uint64_t frame = 0;  ///< in which the panel was drawn last
  };
  void drawSearchField(SearchedPanel &panel);
  void drawSearchResult(const RowSearch &rows);

  std::uint32_t button(c3de_str id, c3de_str label, bool isEnabled);
  std::uint32_t checkbox(c3de_str id, c3de_str label, std::uint32_t *value);
  std::uint32_t slider(c3de_str id, c3de_str label, c3de_str unit, double *value, double lo, double hi);
  std::uint32_t choice(c3de_str id, c3de_str label, std::uint32_t *index, const c3de_str *names, std::uint64_t n);
  std::uint32_t inputText(c3de_str id, c3de_str label, char *buffer, std::uint64_t capacity);
  std::uint32_t fileButton(c3de_str id, c3de_str label, c3de_str extensions, char *buffer, std::uint64_t capacity);
  void listBegin(c3de_str id, std::uint32_t rows);
  void listEnd();
  void curve(c3de_str id, c3de_str label, c3de_str unit, std::span<const double> values);
  void heading(c3de_str text);
  void drawHeading(const std::string &text);
  void paragraph(c3de_str text);
  void tooltip(c3de_str text);
  void value(c3de_str name, c3de_str value);
  void progress(double fraction, c3de_str text);
  /// plainWords() of a panel's text.
  [[nodiscard]] std::string plainText(c3de_str text) const;
  void params(c3de_handle set, c3de_str group);
  /// @return whether one of the rows that were drawn applies on rebuild
  bool parameterRows(Handle handle, const std::string &group, bool isAdvanced);
  void parameterRow(Handle handle, const ParameterDecl &decl, const ParameterValue &value);
  void tissueRow(Handle handle, const registry::ParameterSet &set);

  c3de_ui_v1 table_{};
  FrameContext *frame_ = nullptr;  ///< inside draw() only
  std::thread::id thread_;
  std::string area_;  ///< id of the panel
  std::set<std::string> used_;
  std::map<std::string, SearchedPanel> searched_;  ///< by the id of the panel
  RowSearch *search_ = nullptr;                    ///< of the panel that is drawn
  bool isSameLine_ = false, isInList_ = false;
  bool isRowBegun_ = false;  ///< while rows are filtered: a widget of the present row was drawn
  bool isLocked_ = false;    ///< nothing may be changed
  std::map<std::string, FieldState> fields_;
};

}  // namespace c3de::ui
