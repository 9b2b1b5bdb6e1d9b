// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/panels.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"

namespace c3de::registry {

/// Draws a panel as text and acts on its widgets by id, so that panels can be tested and scripted without a window.
/// Widgets act in the next draw(), as they do in the window. Main thread.
///
/// One line per widget:
///   # heading            [button: Start] (start)       [x] Fixed step (fixed)
///   Spacing = 0.01 m (spacing)      Law = neo_hookean (law)      Mass: 0.32 kg        | tooltip
class TextPanel {
 public:
  /// @param parameters  for params(); may be null
  explicit TextPanel(ParameterRegistry *parameters);
  ~TextPanel();
  TextPanel(const TextPanel &) = delete;
  TextPanel &operator=(const TextPanel &) = delete;

  /// Calls the panel once and returns its text.
  std::string draw(const Panel &panel);

  void press(const std::string &id);
  void check(const std::string &id, bool value);
  void setNumber(const std::string &id, double value);
  /// Text fields, choices (by name), files, parameters (also "auto").
  void setText(const std::string &id, const std::string &text);

  struct Widget {
    std::string kind, id, label, text;
    bool enabled = true;
  };
  /// Of the last draw(), in order.
  [[nodiscard]] const std::vector<Widget> &widgets() const;
  [[nodiscard]] const Widget *find(const std::string &id) const;
  /// The value shown next to a name in the last draw().
  [[nodiscard]] std::optional<std::string> value(const std::string &name) const;
  /// Requests that were not executed: no such widget, disabled, refused value.
  [[nodiscard]] const std::vector<std::string> &problems() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::registry
