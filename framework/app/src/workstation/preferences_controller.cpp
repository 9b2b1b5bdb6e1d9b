// SPDX-License-Identifier: Apache-2.0
#include "workstation/preferences_controller.h"

#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"

namespace c3de::app {

PreferencesController::PreferencesController(registry::PanelRegistry &panels,
                                             std::function<void(const ui::Preferences &)> apply)
    : panels_(panels), apply_(std::move(apply)), file_(ui::preferencesFile()) {}

void PreferencesController::read() {
  ui::ReadPreferences read = ui::readPreferences(file_);
  values_ = std::move(read.values);
  apply_(values_);
  if (read.problems.empty()) return;
  std::string text;
  for (const std::string &problem : read.problems) {
    log(LogLevel::warn, problem);
    text += (text.empty() ? "" : "\n") + problem;
  }
  panels_.notify(C3DE_LOG_WARN, "Some preferences are not understood",
                 text + "\nThe rest applies. These lines stay in the file.");
}

void PreferencesController::connect(ui::WindowActions &actions) {
  actions.preferences.change = [this](const ui::Preferences &wanted) { change(wanted, false); };
  actions.preferences.restore = [this] { change(ui::usualPreferences(values_), true); };
  actions.preferences.file = [this] { return file_; };
}

void PreferencesController::change(const ui::Preferences &wanted, bool replacesInvalid) {
  const ui::Preferences before = std::exchange(values_, wanted);
  const auto written = ui::writePreferences(file_, before, values_, replacesInvalid);
  apply_(values_);
  const std::string problem = written ? std::string() : written.error().message;
  // One message for a folder that cannot be written, not one for each change.
  if (std::exchange(reported_, problem) == problem || problem.empty()) return;
  log(LogLevel::warn, "the preferences were not stored: " + problem);
  panels_.notify(C3DE_LOG_WARN, "The preferences were not stored", problem + "\nThey apply until the program ends.");
}

}  // namespace c3de::app
