// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <thread>

#include "c3de/abi/panels.h"
#include "c3de/registry/panel_registry.h"
#include "frame/frame_context.h"
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
  void value(c3de_str name, c3de_str value);
  void progress(double fraction, c3de_str text);
  /// plainWords() of a panel's text.
  [[nodiscard]] std::string plainText(c3de_str text) const;
  void params(c3de_handle set, c3de_str group);
  void parameterRows(Handle handle, const std::string &group, bool isAdvanced);

  c3de_ui_v1 table_{};
  FrameContext *frame_ = nullptr;  ///< inside draw() only
  std::thread::id thread_;
  std::string area_;  ///< id of the panel
  std::set<std::string> used_;
  bool isSameLine_ = false, isInList_ = false;
  bool isLocked_ = false;  ///< nothing may be changed
  std::map<std::string, FieldState> fields_;
};

}  // namespace c3de::ui
