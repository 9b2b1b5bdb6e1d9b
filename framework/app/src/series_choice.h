// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "c3de/imaging/reading.h"
#include "c3de/ui/panel_registry.h"

namespace c3de::app {

/// What an image is called: its file or folder, never what is in it.
[[nodiscard]] std::string imageName(const std::filesystem::path &path);

/// Asks in the view which of several series to open; it goes with the object. Main thread.
class SeriesChoice {
 public:
  /// Called with the identifier, or with an empty one when none is wanted; the object may end in it.
  using Chosen = std::function<void(const std::string &id)>;
  SeriesChoice(ui::PanelRegistry &panels, const std::filesystem::path &path, std::vector<imaging::SeriesInfo> series,
               Chosen chosen);
  ~SeriesChoice();
  SeriesChoice(const SeriesChoice &) = delete;
  SeriesChoice &operator=(const SeriesChoice &) = delete;

 private:
  void draw(const c3de_ui_v0 &ui);

  ui::PanelRegistry &panels_;
  std::string name_;
  std::vector<imaging::SeriesInfo> series_;
  Chosen chosen_;
  Handle panel_;
};

}  // namespace c3de::app
