// SPDX-License-Identifier: Apache-2.0
// Panels: derive, say in draw() what stands in it, call show() when it is ready.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "c3de/sdk/services.hpp"

namespace c3de::sdk {

/// The widgets; valid inside Panel::draw() only. Ids are unique within a panel.
class Ui {
 public:
  explicit Ui(const c3de_ui_v1 *ui) noexcept : ui_(ui) {}
  [[nodiscard]] const c3de_ui_v1 *abi() const noexcept { return ui_; }

  void heading(std::string_view t) const { ui_->heading(ui_->ctx, str(t)); }
  void text(std::string_view t) const { ui_->text(ui_->ctx, str(t)); }
  void separator() const { ui_->separator(ui_->ctx); }
  void sameLine() const { ui_->same_line(ui_->ctx); }
  /// True: pressed.
  [[nodiscard]] bool button(std::string_view id, std::string_view label, bool enabled = true) const {
    return (ui_->button(ui_->ctx, str(id), str(label), enabled ? 1u : 0u) & C3DE_UI_COMMITTED) != 0;
  }
  /// True: changed.
  bool checkbox(std::string_view id, std::string_view label, bool &value) const {
    std::uint32_t v = value ? 1u : 0u;
    const std::uint32_t result = ui_->checkbox(ui_->ctx, str(id), str(label), &v);
    value = v != 0;
    return (result & C3DE_UI_CHANGED) != 0;
  }
  /// C3DE_UI_* flags.
  std::uint32_t slider(std::string_view id, std::string_view label, std::string_view unit, double &value, double lo,
                       double hi) const {
    return ui_->slider(ui_->ctx, str(id), str(label), str(unit), &value, lo, hi);
  }
  /// True: another one was chosen.
  bool choice(std::string_view id, std::string_view label, std::uint32_t &index,
              std::span<const std::string> names) const {
    std::vector<c3de_str> abiNames;
    for (const std::string &name : names) abiNames.push_back(str(name));
    return (ui_->choice(ui_->ctx, str(id), str(label), &index, abiNames.data(), abiNames.size()) & C3DE_UI_CHANGED) !=
           0;
  }
  /// C3DE_UI_* flags; room for `capacity` bytes.
  std::uint32_t inputText(std::string_view id, std::string_view label, std::string &value,
                          std::size_t capacity = 1024) const {
    std::vector<char> buffer = bufferOf(value, capacity);
    const std::uint32_t result = ui_->input_text(ui_->ctx, str(id), str(label), buffer.data(), buffer.size());
    value = buffer.data();
    return result;
  }
  /// Negative fraction: unknown.
  void progress(double fraction, std::string_view t) const { ui_->progress(ui_->ctx, fraction, str(t)); }
  /// A line of a table: name, and value with its unit.
  void value(std::string_view name, std::string_view v) const { ui_->value(ui_->ctx, str(name), str(v)); }
  /// Of the widget before.
  void tooltip(std::string_view t) const { ui_->tooltip(ui_->ctx, str(t)); }
  /// The declared parameters of a group (empty: all).
  void params(c3de_handle set, std::string_view group = {}) const { ui_->params(ui_->ctx, set, str(group)); }
  /// True: a file was chosen. extensions: "obj;stl".
  bool fileButton(std::string_view id, std::string_view label, std::string_view extensions, std::string &path,
                  std::size_t capacity = 4096) const {
    std::vector<char> buffer = bufferOf(path, capacity);
    const std::uint32_t result =
        ui_->file_button(ui_->ctx, str(id), str(label), str(extensions), buffer.data(), buffer.size());
    path = buffer.data();
    return (result & (C3DE_UI_CHANGED | C3DE_UI_COMMITTED)) != 0;
  }

  /// A patch of colour, sRGB 0 … 1, before what sameLine() puts beside it; nothing in hosts that do not have it.
  void swatch(float red, float green, float blue) const {
    if (ui_->rev >= 2) ui_->swatch(ui_->ctx, red, green, blue);
  }

  /// What follows until listEnd() scrolls in a frame of its own, `rows` lines high; in line in hosts that do not have
  /// it.
  void listBegin(std::string_view id, std::uint32_t rows = 12) const {
    if (ui_->rev >= 3) ui_->list_begin(ui_->ctx, str(id), rows);
  }
  void listEnd() const {
    if (ui_->rev >= 3) ui_->list_end(ui_->ctx);
  }

  /// Values over equal steps, the latest last; nothing in hosts that do not have it. Values that are not finite are
  /// gaps.
  void curve(std::string_view id, std::string_view label, std::string_view unit, std::span<const double> values) const {
    if (ui_->rev >= 4) ui_->curve(ui_->ctx, str(id), str(label), str(unit), values.data(), values.size());
  }

 private:
  static std::vector<char> bufferOf(const std::string &value, std::size_t capacity) {
    std::vector<char> buffer(std::max(capacity, value.size() + 1), '\0');
    std::copy(value.begin(), value.end(), buffer.begin());
    return buffer;
  }
  const c3de_ui_v1 *ui_;
};

/// Base of a panel. Registered by show(), taken back by hide() or the destructor. Main thread.
class Panel {
 public:
  Panel() = default;
  Panel(const Panel &) = delete;
  Panel &operator=(const Panel &) = delete;
  virtual ~Panel() = default;

  /// Once per frame while shown; an exception becomes a line in the log.
  virtual void draw(Ui &ui) = 0;

  /// C3DE_E_UNSUPPORTED in a run without a window.
  Result<void> show(Host host, std::string_view id, std::string_view title) {
    auto table = host.require<c3de_panels_v1>();
    if (!table) return table.failure();
    const c3de_panel panel{sizeof(c3de_panel), 1, str(id), str(title), this, &drawThunk};
    c3de_handle handle{0};
    if (const c3de_status status = (*table)->add((*table)->ctx, &panel, &handle); status < 0)
      return host.failure(status);
    registration_ = {*table, handle};
    return {};
  }
  void hide() noexcept { registration_.reset(); }
  [[nodiscard]] bool isRegistered() const noexcept { return static_cast<bool>(registration_); }

 private:
  static void C3DE_CALL drawThunk(void *self, const c3de_ui_v1 *ui) noexcept {
    guardQuietly("panel", [&] {
      Ui wrapped(ui);
      static_cast<Panel *>(self)->draw(wrapped);
    });
  }
  Owned<c3de_panels_v1, &c3de_panels_v1::remove> registration_;
};

/// Messages to the person.
class Notifier : public Service<c3de_panels_v1> {
 public:
  using Service::Service;
  /// @param severity  C3DE_LOG_*; stays until closed or replaced by one of the same title
  Result<void> notify(std::uint32_t severity, std::string_view title, std::string_view message) const {
    return call<&c3de_panels_v1::notify>(severity, str(title), str(message));
  }
};

}  // namespace c3de::sdk
