// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "c3de/registry/panel_registry.h"
#include "c3de/ui/preferences.h"
#include "c3de/ui/workstation_window.h"

namespace c3de::app {

/// Reads what the user prefers, applies it to the parts of the program, and stores changes at once. Main thread.
class PreferencesController {
 public:
  /// @param apply  receives what applies, at each change
  PreferencesController(registry::PanelRegistry &panels, std::function<void(const ui::Preferences &)> apply);

  /// Reads the file, and applies and reports what it has.
  void read();
  void connect(ui::WindowActions &actions);
  [[nodiscard]] const ui::Preferences &values() const { return values_; }

 private:
  void change(const ui::Preferences &wanted, bool replacesInvalid);

  registry::PanelRegistry &panels_;
  std::function<void(const ui::Preferences &)> apply_;
  std::filesystem::path file_;
  ui::Preferences values_;
  std::string reported_;  ///< why the last change could not be stored
};

}  // namespace c3de::app
